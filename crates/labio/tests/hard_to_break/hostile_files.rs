//! Small files that require much memory or much time.

use std::io::Write as _;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use labio::format::{MemoryLimit, Reader, Strictness, mat5, npz};
use labio::{Contents, LabioError, Ordinate, Provenance, Series, SeriesKind, Welch};
use zip::CompressionMethod::Deflated;

use crate::mat5::LITTLE;
use crate::npy::{archive_by, npy};
use crate::series::{axis, bare, contents_of, even};

const BOTH: [Strictness; 2] = [Strictness::Strict, Strictness::Tolerant];

/// A MATLAB file with `variables`, each deflated.
fn packed(variables: &[Vec<u8>]) -> Vec<u8> {
    let deflated = variables.iter().map(|variable| {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(variable).unwrap();
        LITTLE.element(15, &encoder.finish().unwrap())
    });
    LITTLE.file(&deflated.collect::<Vec<_>>())
}

#[track_caller]
fn refused_for_memory(bytes: &[u8], read: impl Fn(Strictness) -> Result<Contents, LabioError>) {
    for strictness in BOTH {
        match read(strictness) {
            Err(LabioError::MemoryLimit { needed, limit, .. }) => {
                assert!(needed > limit);
                assert_eq!(limit, MemoryLimit::of_file(bytes.len()).bytes());
            }
            other => panic!("{strictness:?}: {:?}", other.map(|c| c.series.len())),
        }
    }
}

#[test]
fn r20_a_small_matlab_file_is_not_unpacked_beyond_the_limit() {
    let n = 1_500_000_u32;
    let characters = LITTLE.element(2, &vec![b' '; n as usize]);
    // a tall text: each of its 1 500 000 rows would be a property with the long name
    let long = "x".repeat(500);
    let tall_text = LITTLE.matrix(4, &[n, 1], &long, &[characters]);
    // each of 1 500 000 numbers would be a series
    let numbers = LITTLE.element(2, &vec![0; n as usize]);
    let columns = packed(&[LITTLE.matrix(9, &[1, 1, n], &long, std::slice::from_ref(&numbers))]);
    let read = mat5::Mat5.read(&columns, Strictness::Strict).unwrap();
    let mut properties = read.properties.iter();
    assert!(read.series.is_empty());
    assert!(properties.any(|(_, text)| text.contains("1 x 1 x 1500000, skipped")));
    // each empty cell would be a property
    let empty = LITTLE.element(14, &[]).repeat(n as usize);
    let cells = LITTLE.matrix(1, &[n, 1], &long, &[empty]);
    // each element that is not a cell would be a defect
    let wrong = LITTLE.element(9, &[]).repeat(n as usize);
    let defects = LITTLE.matrix(1, &[n, 1], &long, &[wrong]);
    for variable in [tall_text, cells] {
        let file = packed(&[variable]);
        assert!(file.len() < 40_000, "{}", file.len());
        refused_for_memory(&file, |strictness| mat5::Mat5.read(&file, strictness));
    }
    let file = packed(&[defects]);
    assert!(matches!(
        mat5::Mat5.read(&file, Strictness::Tolerant),
        Err(LabioError::MemoryLimit { .. })
    ));
}

#[test]
fn r20_a_caller_sets_the_limit() {
    let n = 100_000_u32;
    let numbers = LITTLE.element(2, &vec![7; n as usize]);
    let file = packed(&[LITTLE.matrix(9, &[1, n], "a", &[numbers])]);
    let read = |bytes| mat5::read_within(&file, Strictness::Strict, MemoryLimit::new(bytes));
    // 100 000 bytes after unpacking, each of which becomes a number of eight bytes
    assert!(matches!(
        read(899_999),
        Err(LabioError::MemoryLimit { limit: 899_999, .. })
    ));
    let contents = read(910_000).unwrap();
    assert_eq!(
        contents.series[0].ordinate,
        Ordinate::Real(vec![7.0; n as usize])
    );
}

fn zeros(descr: &str, shape: &str, n_bytes: usize) -> Vec<u8> {
    npy(descr, "False", shape, &vec![0; n_bytes])
}

#[test]
fn r20_a_small_archive_is_not_unpacked_beyond_the_limit() {
    let n = 20_000_000;
    for (descr, shape, n_bytes) in [
        ("|b1", format!("({},)", 2 * n), 2 * n),
        ("|b1", format!("(2, {n})"), 2 * n),
        ("|S1", format!("({n},)"), n),
    ] {
        let file = archive_by(Deflated, &[("a.npy", zeros(descr, &shape, n_bytes))]);
        assert!(file.len() < 50_000, "{}", file.len());
        refused_for_memory(&file, |strictness| npz::Npz.read(&file, strictness));
    }
    // no single member exceeds the limit
    let names: Vec<String> = (0..12).map(|i| format!("a{i}.npy")).collect();
    let member = zeros("|b1", "(400000,)", 400_000);
    let members = names.iter().map(|name| (name.as_str(), member.clone()));
    let file = archive_by(Deflated, &members.collect::<Vec<_>>());
    let read = |bytes| npz::read_within(&file, Strictness::Strict, MemoryLimit::new(bytes));
    assert!(matches!(
        read(30_000_000),
        Err(LabioError::MemoryLimit {
            limit: 30_000_000,
            ..
        })
    ));
    assert_eq!(read(40_000_000).unwrap().series.len(), 12);
}

fn history(name: &str, start: f64) -> Series {
    Series {
        kind: SeriesKind::TimeResponse,
        abscissa: even(start, 0.5),
        abscissa_axis: axis("", "s"),
        ordinate_axis: axis("", "N"),
        ..bare(name, Ordinate::Real(vec![1.0, 2.0]))
    }
}

/// A hundred thousand series are combined into records in seconds. A comparison of every series, or
/// of every record, with all others would take minutes.
#[test]
fn r20_a_hundred_thousand_series_are_put_together_one_by_one() {
    const N: u32 = 100_000;
    let records = |series: &dyn Fn(u32) -> Series| {
        let contents = contents_of((0..N).map(series).collect());
        let found = contents.records(&Provenance::computed("test"));
        assert!(found.left_out.is_empty());
        found.records
    };
    // three cases: hits of one channel, series with different time axes, channels of one record
    let hits = records(&|_| history("force", 0.0));
    assert_eq!(hits.len(), N as usize);
    let axes = records(&|i| history("force", f64::from(i)));
    assert_eq!(axes.len(), N as usize);
    let channels = records(&|i| history(&format!("gauge {i}"), 0.0));
    assert_eq!(channels.len(), 1);
    assert_eq!(channels[0].channels().len(), N as usize);
}

#[test]
fn r20_segments_overlap_so_far_and_no_farther() {
    let welch = Welch::new(1 << 20).unwrap();
    let error = welch.with_overlap((1 << 20) - 1).unwrap_err();
    assert_eq!(
        error.to_string(),
        "samples of overlap, at most: found 1048575, expected 1032192"
    );
    welch.with_overlap(1_032_192).unwrap();
    assert!(Welch::new(8).unwrap().with_overlap(7).is_ok());
    assert!(Welch::new(8).unwrap().with_overlap(8).is_err());
}

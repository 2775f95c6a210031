//! Small files that require much memory or much time.

use std::io::Write as _;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use labio::format::{MemoryLimit, Reader, Strictness, mat5, npz};
use labio::{Contents, LabioError, Ordinate, Provenance, Series, SeriesKind, Welch};
use zip::write::SimpleFileOptions;

use crate::series::{axis, bare, contents_of, even};

const BOTH: [Strictness; 2] = [Strictness::Strict, Strictness::Tolerant];

fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = kind.to_le_bytes().to_vec();
    bytes.extend(u32::try_from(data.len()).unwrap().to_le_bytes());
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

/// A MATLAB array of `class` whose parts follow its flags, shape and name.
fn array(class: u8, shape: &[u32], name: &str, parts: &[Vec<u8>]) -> Vec<u8> {
    let shape: Vec<u8> = shape.iter().flat_map(|n| n.to_le_bytes()).collect();
    let mut body = element(6, &[class, 0, 0, 0, 0, 0, 0, 0]);
    body.extend(element(5, &shape));
    body.extend(element(1, name.as_bytes()));
    body.extend(parts.concat());
    element(14, &body)
}

/// A MATLAB file with `variables`, each deflated.
fn packed(variables: &[Vec<u8>]) -> Vec<u8> {
    let mut file = vec![b' '; 124];
    file.extend([0x00, 0x01, b'I', b'M']);
    for variable in variables {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(variable).unwrap();
        let deflated = encoder.finish().unwrap();
        file.extend(15_u32.to_le_bytes());
        file.extend(u32::try_from(deflated.len()).unwrap().to_le_bytes());
        file.extend(deflated);
    }
    file
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
    let characters = element(2, &vec![b' '; n as usize]);
    // a row of text for every character, each with the long name
    let long = "x".repeat(500);
    let tall_text = array(4, &[n, 1], &long, &[characters]);
    // a series for every number
    let numbers = element(2, &vec![0; n as usize]);
    let columns = packed(&[array(9, &[1, 1, n], &long, std::slice::from_ref(&numbers))]);
    let read = mat5::Mat5.read(&columns, Strictness::Strict).unwrap();
    let mut properties = read.properties.iter();
    assert!(read.series.is_empty());
    assert!(properties.any(|(_, text)| text.contains("1 x 1 x 1500000, skipped")));
    // a property for every empty cell
    let empty = element(14, &[]).repeat(n as usize);
    let cells = array(1, &[n, 1], &long, &[empty]);
    // a defect for every element that is not a cell
    let wrong = element(9, &[]).repeat(n as usize);
    let defects = array(1, &[n, 1], &long, &[wrong]);
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
    let numbers = element(2, &vec![7; n as usize]);
    let file = packed(&[array(9, &[1, n], "a", &[numbers])]);
    let read = |bytes| mat5::read_within(&file, Strictness::Strict, MemoryLimit::new(bytes));
    // 100 000 unpacked bytes, and a number of eight bytes for each of them
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

/// An array of NumPy with this header and zeros.
fn npy(descr: &str, shape: &str, n_bytes: usize) -> Vec<u8> {
    let text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend(u16::try_from(text.len()).unwrap().to_le_bytes());
    bytes.extend(text.bytes());
    bytes.resize(bytes.len() + n_bytes, 0);
    bytes
}

fn archive(members: &[(String, Vec<u8>)]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
    for (name, bytes) in members {
        archive.start_file(name.as_str(), options).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

#[test]
fn r20_a_small_archive_is_not_unpacked_beyond_the_limit() {
    let n = 20_000_000;
    for (descr, shape, each) in [
        ("|b1", format!("({},)", 2 * n), 1),
        ("|b1", format!("(2, {n})"), 1),
        ("|S1", format!("({n},)"), 1),
    ] {
        let n_bytes = if shape.starts_with(&format!("({n}")) {
            n
        } else {
            2 * n
        };
        let file = archive(&[("a.npy".to_owned(), npy(descr, &shape, n_bytes * each))]);
        assert!(file.len() < 50_000, "{}", file.len());
        refused_for_memory(&file, |strictness| npz::Npz.read(&file, strictness));
    }
    // no single member exceeds the limit
    let members: Vec<(String, Vec<u8>)> = (0..12)
        .map(|i| (format!("a{i}.npy"), npy("|b1", "(400000,)", 400_000)))
        .collect();
    let file = archive(&members);
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

/// Each case would take minutes if every series, or every record, were compared with every other.
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

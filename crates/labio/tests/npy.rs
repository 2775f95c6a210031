//! Arrays and archives of NumPy: bytes that NumPy wrote, an independent library, round trips and
//! streams.

use std::io::{Cursor, Write as _};

use labio::format::npy::{Blocks, Npy};
use labio::format::npz::Npz;
use labio::format::{Reader, Strictness};
use labio::{
    Abscissa, BlockSource, Channel, Contents, LabioError, Ordinate, Quantity, Series, SeriesKind,
};
use ndarray::{Array2, array};
use ndarray_npy::{ReadNpyExt, WriteNpyExt};
use num_complex::Complex64;
use proptest::prelude::*;

use crate::series::{axis, bare, contents_of, even, pair, real, refusals, values, written};

/// A file as NumPy 2.4 writes it: blanks pad the header so that the numbers begin at byte 128.
pub(crate) fn npy(descr: &str, fortran_order: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let mut text =
        format!("{{'descr': '{descr}', 'fortran_order': {fortran_order}, 'shape': {shape}, }}");
    text.extend(std::iter::repeat_n(' ', 117 - text.len()));
    let mut bytes = b"\x93NUMPY\x01\x00v\x00".to_vec();
    bytes.extend(text.bytes());
    bytes.push(b'\n');
    bytes.extend(data);
    bytes
}

fn f64s(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

fn read(bytes: &[u8]) -> Result<Contents, LabioError> {
    Npy.read(bytes, Strictness::Strict)
}

#[test]
fn what_numpy_writes_is_read_and_written_again() {
    let six = f64s(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    let rows = npy("<f8", "False", "(2, 3)", &six);
    let contents = read(&rows).unwrap();
    assert_eq!(
        (real(&contents, 0), real(&contents, 1)),
        (&[1.0, 2.0, 3.0][..], &[4.0, 5.0, 6.0][..])
    );
    assert_eq!(contents.series[1].name, "[1, :]");
    let columns = npy("<f8", "False", "(3, 2)", &six);
    let contents = read(&columns).unwrap();
    assert_eq!(
        (real(&contents, 0), real(&contents, 1)),
        (&[1.0, 3.0, 5.0][..], &[2.0, 4.0, 6.0][..])
    );
    assert_eq!(contents.series[1].name, "[:, 1]");
    let fortran = npy("<f8", "True", "(3, 2)", &six);
    let contents = read(&fortran).unwrap();
    assert_eq!(real(&contents, 1), [4.0, 5.0, 6.0]);
    let integers = npy(">i2", "False", "(2,)", &[0, 1, 0xff, 0xfe]);
    assert_eq!(real(&read(&integers).unwrap(), 0), [1.0, -2.0]);
    let parts: Vec<u8> = [1.5_f32, -2.0, 0.25, 8.0]
        .iter()
        .flat_map(|x| x.to_be_bytes())
        .collect();
    let complex = npy(">c8", "False", "(2,)", &parts);
    let expected = vec![Complex64::new(1.5, -2.0), Complex64::new(0.25, 8.0)];
    assert_eq!(
        read(&complex).unwrap().series[0].ordinate,
        Ordinate::Complex(expected)
    );
    for bytes in [
        rows,
        columns,
        fortran,
        integers,
        complex,
        npy("|b1", "False", "(3,)", &[1, 0, 1]),
        npy("<u8", "True", "(1, 1)", &[7, 0, 0, 0, 0, 0, 0, 0]),
    ] {
        assert_eq!(written(&Npy, &read(&bytes).unwrap()).unwrap(), bytes);
    }
}

#[test]
fn an_independent_library_agrees() {
    let array = array![[1.5, -2.0], [0.25, 1e300], [f64::MIN_POSITIVE, 0.0]];
    let mut bytes = Vec::new();
    array.write_npy(&mut bytes).unwrap();
    let contents = read(&bytes).unwrap();
    assert_eq!(real(&contents, 0), [1.5, 0.25, f64::MIN_POSITIVE]);
    let again = written(&Npy, &contents).unwrap();
    assert_eq!(Array2::<f64>::read_npy(again.as_slice()).unwrap(), array);
    let integers = array![[1_i32, -2], [3, i32::MIN]];
    let mut bytes = Vec::new();
    integers.write_npy(&mut bytes).unwrap();
    let again = written(&Npy, &read(&bytes).unwrap()).unwrap();
    assert_eq!(Array2::<i32>::read_npy(again.as_slice()).unwrap(), integers);
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    let good = npy("<f8", "False", "(2,)", &f64s(&[1.0, 2.0]));
    let mut version = good.clone();
    version[6] = 9;
    let mut long = good.clone();
    long[8..10].copy_from_slice(&[0xff, 0xff]);
    let named = |text: &str| {
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend(u16::try_from(text.len()).unwrap().to_le_bytes());
        bytes.extend(text.bytes());
        bytes
    };
    let wrong = [
        Vec::new(),
        b"\x93NUMPX".to_vec(),
        good[..7].to_vec(),
        good[..60].to_vec(),
        version,
        long,
        good[..good.len() - 3].to_vec(),
        [good.clone(), vec![0; 2]].concat(),
        npy("<f2", "False", "(2,)", &[0; 4]),
        npy("|O", "False", "(2,)", &[0; 4]),
        npy("<U2", "False", "(1,)", &[0; 8]),
        npy("<f8", "Maybe", "(2,)", &[0; 16]),
        npy("<f8", "False", "(2 3)", &[0; 16]),
        npy("<f8", "False", "(-2,)", &[0; 16]),
        npy("<f8", "False", "()", &[0; 8]),
        npy("<f8", "False", "(1, 1, 1)", &[0; 8]),
        npy("<f8", "False", "(0,)", &[]),
        npy("<f8", "False", "(0, 18446744073709551615)", &[]),
        npy("<f8", "False", "(4294967296, 4294967296)", &[0; 8]),
        npy("<f8", "False", "(1000000000000,)", &[0; 8]),
        npy(
            "<i8",
            "False",
            "(2,)",
            &[0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0x20, 0],
        ),
        named("{'descr': [('t', '<f8')], 'fortran_order': False, 'shape': (2,), }\n"),
        named("{'descr': '<f8', 'shape': (2,), }\n"),
        named("{'descr': '<f8', 'colour': 1}\n"),
        named("{'descr': '<f8\n"),
        named("{} {}"),
    ]
    .map(|bytes| read(&bytes));
    insta::assert_snapshot!(refusals(wrong), @r"
    npy, byte 0: first six bytes is ``, expected those of a NumPy array
    npy, byte 0: first six bytes is `�NUMPX`, expected those of a NumPy array
    the npy data end 5 bytes too early
    the npy data end 68 bytes too early
    npy, byte 6: version is 9, expected 1, 2 or 3
    the npy data end 65401 bytes too early
    the npy data end 3 bytes too early
    2 bytes follow the npy data
    npy, byte 10: descr is `<f2`, expected another type of numbers: half floats are not read, save as float32
    npy, byte 10: descr is `|O`, expected integers, floating-point or complex numbers, or characters
    the npy array contains <U2, expected numbers
    npy, byte 44: header is `Maybe, 'shape': (2,), }`, expected `True` or `False`
    npy, byte 63: header is `3), }`, expected `,` or `)`
    npy, byte 61: header is `-2,), }`, expected a length of an axis
    the npy array has 0 axes, expected 2
    the npy array has 3 axes, expected 2
    the npy file contains no data
    the npy file contains no data
    the npy data end 18446744073709551607 bytes too early
    the npy data end 7999999999992 bytes too early
    npy, byte 136: element 1 is an integer beyond 2^53, expected one that a double represents exactly
    npy, byte 20: header is `[('t', '<f8')], 'fortran_order': False, ...`, expected a single element type, not a structured one
    npy, byte 44: header is ``, expected `fortran_order` in the dictionary
    npy, byte 27: header is `'colour': 1}`, expected `descr`, `fortran_order` or `shape`
    npy, byte 20: header is `'<f8`, expected the end of a text in quotes
    npy, byte 13: header is `{}`, expected the end of the header
    ");
    let cut = Npy
        .read(&good[..good.len() - 3], Strictness::Tolerant)
        .unwrap();
    assert_eq!((real(&cut, 0), cut.defects.len()), (&[1.0][..], 1));
    let longer = Npy
        .read(&[good, vec![0; 2]].concat(), Strictness::Tolerant)
        .unwrap();
    assert_eq!(
        (real(&longer, 0), longer.defects.len()),
        (&[1.0, 2.0][..], 1)
    );
}

#[test]
fn an_array_holds_numbers_and_nothing_else() {
    let series = || bare("", Ordinate::Real(vec![1.5, 2.5]));
    let refusal = |given: Contents| written(&Npy, &given).unwrap_err().to_string();
    let with = |change: fn(&mut Series)| {
        let mut series = series();
        change(&mut series);
        refusal(contents_of(vec![series]))
    };
    let property = |key: &str, value: &str| {
        let mut series = series();
        series.properties.push(pair(key, value));
        refusal(contents_of(vec![series]))
    };
    let mut described = contents_of(vec![series()]);
    described.properties.push(pair("Operator", "me"));
    let refusals = [
        refusal(described),
        refusal(contents_of(Vec::new())),
        with(|s| s.name = "F".to_owned()),
        with(|s| s.ordinate_axis.unit_text = "N".to_owned()),
        with(|s| s.abscissa = even(0.0, 0.5)),
        property("descr", "<i2"),
        property("descr", "<c16"),
        property("descr", "<U3"),
        property("shape", "(7, 2)"),
        property("block", "1"),
    ]
    .join("\n");
    insta::assert_snapshot!(refusals, @r"
    npy cannot hold the property `Operator`; npz can hold properties
    npy cannot hold contents without a series
    npy cannot hold the name `F`, only ``; npz can hold names
    npy cannot hold an abscissa, a kind or units of ``; npz can hold them
    npy cannot hold an abscissa, a kind or units of ``; npz can hold them
    npy cannot hold the numbers as <i2
    npy cannot hold the numbers of `` as <c16
    npy cannot hold the element `<U3`
    npy cannot hold 1 series of 2 samples in an array of shape (7, 2)
    npy cannot hold the property `block` of `` in an array
    ");
}

/// fixtures/reference/npz/make.py
pub(crate) const SAVED: &[u8] = include_bytes!("../../../fixtures/reference/npz/savez.npz");

fn described() -> Contents {
    let mut force = bare("F", Ordinate::Real(vec![1.0, -2.5]));
    force.kind = SeriesKind::TimeResponse;
    force.abscissa = even(-0.1, 1.0 / 51200.0);
    force.abscissa_axis = axis("Time", "s");
    force.ordinate_axis = axis("Force", "N");
    force.properties.push(pair("block", "2"));
    let mut response = bare(
        "H(\u{3c9})",
        Ordinate::Complex(vec![Complex64::new(1.0, -0.0), Complex64::new(0.5, 2.0)]),
    );
    response.kind = SeriesKind::FrequencyResponse;
    response.abscissa = Abscissa::Uneven(vec![1.0, 10.0]);
    let mut counts = bare("counts", Ordinate::Real(vec![1.0, -7.0]));
    counts.properties.push(pair("descr", "<i2"));
    let mut all = contents_of(vec![force, response, counts]);
    all.properties.push(pair("Operator", "S. \u{d6}deen"));
    all
}

#[test]
fn an_archive_holds_all_that_belongs_to_a_series() {
    let given = described();
    let bytes = written(&Npz, &given).unwrap();
    let back = Npz.read(&bytes, Strictness::Strict).unwrap();
    assert_eq!(back.series, given.series);
    assert_eq!(back.properties, given.properties);
    assert_eq!(written(&Npz, &back).unwrap(), bytes);
    let with = |change: fn(&mut Contents)| {
        let mut given = described();
        change(&mut given);
        written(&Npz, &given).unwrap_err().to_string()
    };
    let refusals = [
        with(|c| c.series[1].name = "F".to_owned()),
        with(|c| c.series[1].name = "F.about".to_owned()),
        with(|c| c.series[1].name = "a/b".to_owned()),
        with(|c| c.series[1].name = String::new()),
        with(|c| c.series[2].ordinate = Ordinate::Real(vec![1.5])),
        with(|c| c.series[1].abscissa = Abscissa::Uneven(vec![1.0])),
        with(|c| c.properties[0].1 = "zero\0".to_owned()),
        with(|c| {
            c.series[0].properties.push(pair("array", "A"));
        }),
        with(|c| *c = contents_of(Vec::new())),
    ]
    .join("\n");
    insta::assert_snapshot!(refusals, @r#"
    npz cannot hold `F` twice
    npz cannot hold a series called `F.about`
    npz cannot hold `a/b` as the name of a member
    npz cannot hold a series called ``
    npz cannot hold the numbers of `counts` as <i2
    npz cannot hold `H(ω)`, which has 1 abscissae for 2 samples
    npz cannot hold the text "zero\0" in `about`, which ends with a NUL character
    npz cannot hold the property `block` of `F` in an array
    npz cannot hold contents without a series
    "#);
}

fn archive(members: &[(&str, Vec<u8>)]) -> Vec<u8> {
    archive_by(zip::CompressionMethod::Stored, members)
}

pub(crate) fn archive_by(method: zip::CompressionMethod, members: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in members {
        let options = zip::write::SimpleFileOptions::default().compression_method(method);
        writer.start_file(*name, options).unwrap();
        writer.write_all(bytes).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

#[test]
fn members_that_are_no_series_are_refused() {
    let good = ("F.npy", npy("<f8", "False", "(1,)", &f64s(&[1.0])));
    let cube = ("cube.npy", npy("<f8", "False", "(1, 1, 1)", &f64s(&[1.0])));
    let cases = [
        b"PK\x03\x04".to_vec(),
        archive(&[]),
        archive(&[good.clone(), ("notes.txt", b"hello".to_vec())]),
        archive(&[good.clone(), cube.clone()]),
        archive(&[good.clone(), ("x.npy", b"\x93NUMPY\x01\x00v".to_vec())]),
        archive(&[
            good.clone(),
            ("huge.npy", npy("<f8", "False", "(1000000000000,)", &[])),
        ]),
        archive(&[
            good.clone(),
            (
                "F.start_step.npy",
                npy("<f8", "False", "(1,)", &f64s(&[1.0])),
            ),
        ]),
        archive(&[
            good.clone(),
            (
                "F.abscissa.npy",
                npy("<f8", "False", "(2,)", &f64s(&[1.0, 2.0])),
            ),
        ]),
        archive(&[
            good.clone(),
            ("F.about.npy", npy("<f8", "False", "(1,)", &f64s(&[1.0]))),
        ]),
    ];
    let wrong = cases.map(|bytes| Npz.read(&bytes, Strictness::Strict));
    insta::assert_snapshot!(refusals(wrong), @r"
    npz, byte 0: archive is `invalid Zip archive: Could not find EOCD`, expected a ZIP archive with stored or deflated members
    the npz file contains no data
    npz, byte 171: member 1 is `notes.txt`, expected an array, `.npy`
    npz, byte 0: `cube` is of shape (1, 1, 1) and element <f8, expected numbers with at most two axes, or a text
    the npz data end 3 bytes too early
    the npz data end 8000000000000 bytes too early
    npz, byte 0: `F.start_step` is 1 numbers, expected first value and step
    npz, byte 0: `F.abscissa` is of shape [2] and element <f8, expected 1 real numbers, one per sample
    npz, byte 0: `F.about` is of shape [1], expected texts of shape (n, 2)
    ");
    let tolerant = Npz
        .read(&archive(&[cube, good]), Strictness::Tolerant)
        .unwrap();
    assert_eq!((tolerant.series.len(), tolerant.defects.len()), (1, 1));
    assert!(!Npz.recognises(&archive(&[("notes.txt", Vec::new())])));
}

fn channels() -> Vec<Channel> {
    vec![
        Channel::new("force", Quantity::Force).unwrap(),
        Channel::new("acceleration", Quantity::Acceleration).unwrap(),
    ]
}

/// Array of a file with times at 1024 Hz and two channels.
fn record(n: u32) -> Vec<f64> {
    let row = |f: fn(f64) -> f64| (0..n).map(move |i| f(f64::from(i)));
    row(|i| i / 1024.0)
        .chain(row(|i| i))
        .chain(row(|i| -0.5 * i))
        .collect()
}

#[test]
fn a_stream_delivers_the_rows() {
    let n = 30_000;
    let bytes = npy("<f8", "False", &format!("(3, {n})"), &f64s(&record(n)));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.npy");
    std::fs::write(&path, &bytes).unwrap();
    let mut blocks = Blocks::open(&path, &channels()).unwrap();
    assert_eq!(
        (blocks.n_samples(), blocks.sampling_rate_hz()),
        (Some(30_000), 1024.0)
    );
    let mut streamed: [Vec<f64>; 2] = Default::default();
    let mut block = Array2::zeros((2, 9001));
    loop {
        let n = blocks.read_block(&mut block).unwrap();
        if n == 0 {
            break;
        }
        for (channel, row) in streamed.iter_mut().zip(block.rows()) {
            channel.extend(row.iter().take(n));
        }
    }
    let n = n as usize;
    assert_eq!(streamed[0], record(30_000)[n..2 * n]);
    assert_eq!(streamed[1], record(30_000)[2 * n..]);

    let two = npy(
        "<f8",
        "False",
        &format!("(2, {n})"),
        &f64s(&record(30_000)[n..]),
    );
    let mut given = Blocks::without_times(Cursor::new(two), &channels(), 2048.0).unwrap();
    assert_eq!(given.sampling_rate_hz(), 2048.0);
    assert_eq!(given.read_block(&mut block).unwrap(), 9001);
    assert_eq!(block[(1, 9000)], -4500.0);
}

#[test]
fn a_stream_of_something_else_is_refused() {
    let open = |bytes: Vec<u8>| {
        let mut blocks = Blocks::new(Cursor::new(bytes), &channels())?;
        blocks.read_block(&mut Array2::zeros((2, 100)))
    };
    let with = |at: usize, value: f64| {
        let mut values = record(8);
        values[at] = value;
        npy("<f8", "False", "(3, 8)", &f64s(&values))
    };
    let good = with(0, 0.0);
    assert_eq!(open(good.clone()).unwrap(), 8);
    let refusals = [
        good[..good.len() - 4].to_vec(),
        [good.clone(), vec![0; 8]].concat(),
        npy("<f8", "True", "(3, 8)", &f64s(&record(8))),
        npy("<f4", "False", "(3, 16)", &f64s(&record(8))),
        npy("<f8", "False", "(24,)", &f64s(&record(8))),
        npy("<f8", "False", "(4, 6)", &f64s(&record(8))),
        npy("<f8", "False", "(3, 1)", &f64s(&record(1))),
        npy(
            "<f8",
            "False",
            "(3, 4000000000000000000)",
            &f64s(&record(8)),
        ),
        with(3, 0.01),
        with(7, -1.0),
        with(7, f64::NAN),
        with(12, f64::INFINITY),
    ]
    .map(|bytes| open(bytes).unwrap_err().to_string())
    .join("\n");
    insta::assert_snapshot!(refusals, @r"
    the npy data end 4 bytes too early
    8 bytes follow the npy data
    the npy array contains '<f8' in Fortran order, expected '<f8' in C order
    the npy array contains '<f4' in C order, expected '<f8' in C order
    the npy array has 1 axes, expected 2
    rows of the array, one per channel and, if there are times, one for them: found 4, expected 3
    the row of times has 1 samples, expected at least 2
    the npy data end 18446744073709551295 bytes too early
    time step 2 is 0.008046875 s, expected 0.0009765625 s within a relative deviation of 0.000001
    mean time step [s] is -0.14285714285714285, expected a finite value above 0
    mean time step [s] is NaN, expected a finite value above 0
    sample 4 of channel `force` is inf, expected a finite value
    ");
}

/// Intact files: an array, an archive of our writer and one of NumPy.
pub(crate) fn whole() -> [Vec<u8>; 3] {
    let array = npy("<f8", "False", "(3, 8)", &f64s(&record(8)));
    [array, written(&Npz, &described()).unwrap(), SAVED.to_vec()]
}

proptest! {
    #[test]
    fn arrays_round_trip(
        rows in (1..4_usize, 4..9_usize).prop_flat_map(|(c, n)| proptest::collection::vec(proptest::collection::vec(any::<f64>(), n), c)),
        fortran in any::<bool>(),
    ) {
        let n = rows[0].len();
        let mut given = contents_of(rows.iter().enumerate().map(|(c, row)| bare(&format!("[{c}, :]"), Ordinate::Real(row.clone()))).collect());
        if given.series.len() == 1 {
            given.series[0].name = String::new();
        }
        for series in &mut given.series {
            if fortran {
                series.properties.push(pair("fortran_order", "True"));
            }
        }
        let bytes = written(&Npy, &given).unwrap();
        let back = read(&bytes).unwrap();
        for (c, row) in rows.iter().enumerate() {
            prop_assert!(real(&back, c).iter().zip(row).all(|(a, b)| a.to_bits() == b.to_bits()));
            prop_assert_eq!(real(&back, c).len(), n);
        }
        // the order of the memory has no meaning for an array of one axis
        if given.series.len() > 1 {
            prop_assert_eq!(written(&Npy, &back).unwrap(), bytes);
        }
    }

    #[test]
    fn archives_round_trip(
        rows in (1..4_usize, 2..20_usize).prop_flat_map(|(c, n)| {
            proptest::collection::vec((proptest::collection::vec(any::<f64>(), n), 0..9_usize), c)
        }),
        start in -1e3..1e3_f64,
        step in prop_oneof![1e-7..1.0_f64, Just(1.0 / 51_200.0), Just(1.0 / 3.0)],
    ) {
        let given = contents_of(rows.iter().enumerate().map(|(index, (samples, quantity))| Series {
            kind: SeriesKind::TimeResponse,
            abscissa: even(start, step),
            abscissa_axis: axis("Time", "s"),
            ordinate_axis: axis("", labio::Unit::si(Quantity::ALL[*quantity]).symbol()),
            ..bare(&format!("channel_{index}"), Ordinate::Real(samples.clone()))
        }).collect());
        let back = Npz.read(&written(&Npz, &given).unwrap(), Strictness::Strict).unwrap();
        for (index, (found, given)) in back.series.iter().zip(&given.series).enumerate() {
            prop_assert_eq!(&found.name, &given.name);
            prop_assert_eq!(&found.ordinate_axis.unit_text, &given.ordinate_axis.unit_text);
            prop_assert!(real(&back, index).iter().zip(values(given)).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
        prop_assert_eq!(back.series.len(), given.series.len());
    }
}

//! Universal files written by pyuff and read by this software, and the reverse:
//! `fixtures/reference/pyuff`.

use labio::format::uff58::{ByteOrder, Encoding, Precision, STEP_HALF_UNIT, Uff58Writer};
use labio::format::{self, Writer};
use labio::{Abscissa, Contents, Ordinate, SeriesKind, Unit};
use num_complex::Complex64;

use crate::series::rows_of;

const VALUES: &str = include_str!("../../../fixtures/reference/pyuff/values.csv");
const OURS: &str = include_str!("../../../fixtures/reference/pyuff/ours_read_by_pyuff.csv");

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_bytes!(concat!("../../../fixtures/reference/pyuff/", $name, ".uff")).as_slice())),*]
    };
}

pub(crate) const THEIRS: [(&str, &[u8]); 7] = files![
    "text",
    "complex",
    "uneven",
    "binary",
    "complex_binary",
    "uneven_binary",
    "single",
];

/// Files of `text`, `complex` and `uneven` that labio wrote and pyuff read.
const WRITTEN: [(&str, &[u8]); 9] = files![
    "ours_text_text",
    "ours_text_little-endian",
    "ours_text_big-endian",
    "ours_complex_text",
    "ours_complex_little-endian",
    "ours_complex_big-endian",
    "ours_uneven_text",
    "ours_uneven_little-endian",
    "ours_uneven_big-endian",
];

struct Point {
    data_set: usize,
    index: usize,
    x: f64,
    y: Complex64,
}

fn points(table: &str, file: &str) -> Vec<Point> {
    let point = |row: Vec<&str>| Point {
        data_set: row[1].parse().unwrap(),
        index: row[2].parse().unwrap(),
        x: row[3].parse().unwrap(),
        y: Complex64::new(row[4].parse().unwrap(), row[5].parse().unwrap()),
    };
    rows_of(table, file).into_iter().map(point).collect()
}

fn bytes_of(file: &str) -> &'static [u8] {
    THEIRS
        .into_iter()
        .chain(WRITTEN)
        .find(|(name, _)| *name == file)
        .unwrap()
        .1
}

fn value(contents: &Contents, data_set: usize, index: usize) -> Complex64 {
    match &contents.series[data_set].ordinate {
        Ordinate::Real(values) => values[index].into(),
        Ordinate::Complex(values) => values[index],
    }
}

/// Compares the values that we read from `file` with those that pyuff read; returns the number of
/// points.
fn compare(table: &str, file: &str) -> usize {
    let contents = format::read_bytes(bytes_of(file)).unwrap();
    let points = points(table, file);
    let total: usize = contents.series.iter().map(|s| s.ordinate.len()).sum();
    assert_eq!(total, points.len(), "{file}");
    for point in &points {
        let what = format!("{file}, data set {}, point {}", point.data_set, point.index);
        // both programs read numbers in text to the nearest double, and copy the numbers of a 58b
        assert_eq!(
            value(&contents, point.data_set, point.index),
            point.y,
            "{what}"
        );
        match &contents.series[point.data_set].abscissa {
            Abscissa::Uneven(x) => assert_eq!(x[point.index], point.x, "{what}"),
            Abscissa::Even { start, step } => {
                // tolerance: a few rounding errors, because pyuff adds the step of the header
                // repeatedly or multiplies it
                let x = start + step * point.index as f64;
                assert!((x - point.x).abs() <= 1e-14 * point.x.abs(), "{what}: {x}");
            }
        }
    }
    points.len()
}

#[test]
fn files_of_pyuff_are_read_as_it_reads_them() {
    let compared: usize = THEIRS.iter().map(|(file, _)| compare(VALUES, file)).sum();
    assert_eq!(compared, VALUES.lines().count() - 1);
}

/// The headers contain what the script next to the files passed to pyuff.
#[test]
fn headers_of_pyuff_are_understood() {
    let contents = format::read_bytes(bytes_of("text")).unwrap();
    let series = &contents.series[1];
    assert_eq!(series.name, "end B");
    assert_eq!(series.kind, SeriesKind::TimeResponse);
    assert_eq!(series.ordinate_axis.unit_text, "m/s^2");
    assert_eq!(series.abscissa_axis.unit_text, "s");
    let property = |name: &str| {
        let found = series.properties.iter().find(|(key, _)| key == name);
        found.unwrap_or_else(|| panic!("no {name}")).1.clone()
    };
    assert_eq!(property("uff58.id2"), "made by pyuff");
    assert_eq!(property("uff58.response_node"), "12");
    assert_eq!(property("uff58.reference_entity"), "HAMMER");
    assert_eq!(property("uff58.reference_direction"), "-1");
    // pyuff writes 1/8192 s with six digits: the error of the step is less than the stated half
    // unit
    let Abscissa::Even { step, .. } = series.abscissa else {
        panic!("even");
    };
    let half_unit: f64 = property(STEP_HALF_UNIT).parse().unwrap();
    assert!((step - 1.0 / 8192.0).abs() <= half_unit * (1.0 + 1e-12) && step != 1.0 / 8192.0);

    let contents = format::read_bytes(bytes_of("complex")).unwrap();
    let series = &contents.series[0];
    assert_eq!(series.kind, SeriesKind::FrequencyResponse);
    // record 9 divided by record 10
    assert_eq!(
        series.ordinate_axis.unit,
        Some(Unit::parse("(m/s^2)/N").unwrap())
    );
    assert_eq!(series.abscissa_axis.unit_text, "Hz");
}

/// pyuff reads the same numbers from our files as we read from its files: text of 13 digits keeps
/// the 12 digits of its text, and binary files keep all digits.
#[test]
fn pyuff_reads_what_is_written_here() {
    let mut compared = 0;
    for (file, _) in WRITTEN {
        let original = file.split('_').nth(1).unwrap();
        let contents = format::read_bytes(bytes_of(original)).unwrap();
        let points = points(OURS, file);
        let total: usize = contents.series.iter().map(|s| s.ordinate.len()).sum();
        assert_eq!(points.len(), total, "{file}");
        for point in points {
            let expected = value(&contents, point.data_set, point.index);
            assert_eq!(point.y, expected, "{file}, point {}", point.index);
            compared += 1;
        }
        compare(OURS, file);
    }
    assert_eq!(compared, OURS.lines().count() - 1);
}

/// The files that pyuff read are identical to those that the writer produces now.
#[test]
fn the_writer_still_writes_these_bytes() {
    for (file, bytes) in WRITTEN {
        let mut parts = file.split('_').skip(1);
        let original = parts.next().unwrap();
        let encoding = match parts.next().unwrap() {
            "text" => Encoding::Ascii,
            "little-endian" => Encoding::Binary(ByteOrder::LittleEndian),
            _ => Encoding::Binary(ByteOrder::BigEndian),
        };
        let writer = Uff58Writer {
            encoding,
            precision: Precision::Double,
        };
        let contents = format::read_bytes(bytes_of(original)).unwrap();
        let mut written = Vec::new();
        writer.write(&contents, &mut written).unwrap();
        assert!(
            written == bytes,
            "{file}: run fixtures/reference/pyuff/make.py"
        );
    }
}

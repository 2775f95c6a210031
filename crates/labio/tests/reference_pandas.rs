//! Tables that pandas wrote in several dialects, read without a stated dialect:
//! `fixtures/reference/pandas`.

use labio::Abscissa;
use labio::format;

use crate::series::{real, rows_of};

const VALUES: &str = include_str!("../../../fixtures/reference/pandas/values.csv");

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_bytes!(concat!("../../../fixtures/reference/pandas/", $name, ".csv")).as_slice())),*]
    };
}

const FILES: [(&str, &[u8]); 9] = files![
    "comma",
    "semicolon_decimal_comma",
    "bom",
    "utf16",
    "tab_scientific",
    "tab_decimal_comma",
    "bar",
    "two_rows",
    "quoted",
];

fn rows(file: &str) -> Vec<[f64; 3]> {
    let rows = rows_of(VALUES, file).into_iter();
    rows.map(|row| [2, 3, 4].map(|cell| row[cell].parse().unwrap()))
        .collect()
}

/// Separator, decimal mark, encoding, names and units are found; every number is the double that
/// pandas reads.
#[test]
fn cells_are_pandas_s() {
    let mut compared = 0;
    for (file, bytes) in FILES {
        let contents = format::read_bytes(bytes).unwrap();
        assert_eq!(contents.format, "csv", "{file}");
        assert_eq!(contents.defects.len(), 0, "{file}");
        let names: Vec<_> = contents
            .series
            .iter()
            .map(|s| (s.name.as_str(), s.ordinate_axis.unit_text.as_str()))
            .collect();
        assert_eq!(names, [("F", "N"), ("a", "m/s^2")], "{file}");
        let rows = rows(file);
        for series in 0..2 {
            assert_eq!(real(&contents, series).len(), rows.len(), "{file}");
        }
        for (index, row) in rows.iter().enumerate() {
            assert_eq!(real(&contents, 0)[index], row[1], "{file}, row {index}");
            assert_eq!(real(&contents, 1)[index], row[2], "{file}, row {index}");
            compared += 2;
        }
    }
    assert_eq!(compared, 2 * (VALUES.lines().count() - 1));
}

/// The column of times is an even abscissa in seconds unless its digits do not determine the step:
/// six decimals over 29 steps of 20 µs determine the step only to 0.2 %, and these times are used
/// unchanged.
#[test]
fn times_are_even_where_they_can_be() {
    for (file, bytes) in FILES {
        let contents = format::read_bytes(bytes).unwrap();
        let axis = &contents.series[0].abscissa_axis;
        assert_eq!(axis.unit_text, "s", "{file}");
        match &contents.series[0].abscissa {
            Abscissa::Even { start, step } => {
                assert_eq!(*start, 0.0, "{file}");
                // the last time has at least ten digits
                assert!((step * 51_200.0 - 1.0).abs() <= 1e-9, "{file}: {step}");
                assert_ne!(file, "tab_decimal_comma");
            }
            Abscissa::Uneven(times) => {
                assert_eq!(file, "tab_decimal_comma");
                let expected: Vec<f64> = rows(file).iter().map(|row| row[0]).collect();
                assert_eq!(times, &expected);
            }
        }
    }
}

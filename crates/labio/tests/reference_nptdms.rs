//! TDMS files that npTDMS wrote, and files of layouts that it can only read, compared with the
//! values that npTDMS reads: `fixtures/reference/nptdms`.

use labio::format;
use labio::format::tdms::GROUP;
use labio::{Contents, Ordinate, Series};
use num_complex::Complex64;

use crate::series::{even, property, rows_of};

const VALUES: &str = include_str!("../../../fixtures/reference/nptdms/values.csv");
const PROPERTIES: &str = include_str!("../../../fixtures/reference/nptdms/properties.csv");

macro_rules! files {
    ($($name:literal),*) => {
        [$(($name, include_bytes!(concat!("../../../fixtures/reference/nptdms/", $name, ".tdms")).as_slice())),*]
    };
}

pub(crate) const FILES: [(&str, &[u8]); 7] = files![
    "types",
    "properties",
    "segments",
    "interleaved",
    "big_endian",
    "daqmx",
    "sensors"
];

fn contents(file: &str) -> Contents {
    let (_, bytes) = FILES.into_iter().find(|(name, _)| *name == file).unwrap();
    let contents = format::read_bytes(bytes).unwrap();
    assert_eq!(contents.format, "tdms");
    contents
}

fn find<'a>(contents: &'a Contents, group: &str, channel: &str) -> &'a Series {
    contents
        .series
        .iter()
        .find(|series| property(&series.properties, GROUP) == Some(group) && series.name == channel)
        .unwrap_or_else(|| panic!("no channel {channel} of {group}"))
}

/// Every value that npTDMS reads is found in the same order, and there is no further channel or
/// value.
#[test]
fn values_are_npt_dms_s() {
    let mut compared = 0;
    for (file, _) in FILES {
        let contents = contents(file);
        let rows = rows_of(VALUES, file);
        let total: usize = contents.series.iter().map(|s| s.ordinate.len()).sum();
        assert_eq!(total, rows.len(), "{file}");
        for row in rows {
            let name = match row[2] {
                "end_A_/_µ" => "end 'A' / µ", // quotes and blanks do not stand in values.csv
                name => name,
            };
            let series = find(&contents, row[1], name);
            let index: usize = row[3].parse().unwrap();
            let expected = Complex64::new(row[4].parse().unwrap(), row[5].parse().unwrap());
            let found = match &series.ordinate {
                Ordinate::Real(values) => values[index].into(),
                Ordinate::Complex(values) => values[index],
            };
            // tolerance: npTDMS evaluates the formulas of sensors in another order, and finds the
            // roots of a quartic as eigenvalues
            let rounding = if file == "sensors" {
                1e-10 * (1e-3 + expected.norm())
            } else {
                0.0
            };
            let off = (found - expected).norm();
            assert!(off <= rounding, "{file} {name} {index}: {found} {expected}");
            compared += 1;
        }
    }
    assert_eq!(compared, VALUES.lines().count() - 1);
    assert!(compared >= 170, "{compared}");
}

/// Properties of the file, of groups and of channels.
#[test]
fn properties_are_npt_dms_s() {
    let mut compared = 0;
    for line in PROPERTIES.lines().skip(1) {
        let cells: Vec<&str> = line.splitn(4, '|').collect();
        let [file, owner, name, expected] = cells[..] else {
            panic!("{line}");
        };
        let contents = contents(file);
        let found = if owner.is_empty() {
            property(&contents.properties, name)
        } else if let Some(path) = owner.strip_prefix("/'") {
            let (group, channel) = path.strip_suffix('\'').unwrap().split_once("'/'").unwrap();
            let series = find(&contents, group, &channel.replace("''", "'"));
            property(&series.properties, name)
        } else {
            property(&contents.properties, &format!("{owner}/{name}"))
        };
        let found = found.unwrap_or_else(|| panic!("{line}: no such property"));
        let same = match (found.parse::<f64>(), expected.parse::<f64>()) {
            // a number in single precision: its shortest form here, the digits of a double in
            // npTDMS
            (Ok(found), Ok(expected)) if name == "gain" => {
                (found - expected).abs() <= f64::from(f32::EPSILON) * expected.abs()
            }
            (Ok(found), Ok(expected)) => found == expected,
            _ => {
                // Python writes `True`, and a time with six decimals and without a zone
                found == expected.to_lowercase()
                    || found == expected
                    || found.trim_end_matches(['0', 'Z']) == expected.trim_end_matches('0')
            }
        };
        assert!(same, "{line}: found `{found}`");
        compared += 1;
    }
    assert_eq!(compared, PROPERTIES.lines().count() - 1);
}

/// The properties of a waveform give the same axis as the `time_track` of npTDMS.
#[test]
fn a_waveform_has_its_axis() {
    let contents = contents("properties");
    let series = find(&contents, "rod", "a1");
    assert_eq!(series.abscissa, even(-0.001, 1.0 / 51_200.0));
    assert_eq!(series.ordinate_axis.unit_text, "m/s^2");
    assert_eq!(series.abscissa_axis.unit_text, "s");
    assert_eq!(series.kind, labio::SeriesKind::TimeResponse);
}

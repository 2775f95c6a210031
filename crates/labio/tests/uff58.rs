//! Universal files as programs write them. Each file here is put together by hand from the
//! description of data set 58, not by the writer under test.

mod layouts;
mod round_trips;
mod surroundings;
mod text_lines;
mod wrong_files;

use testbed::measured;

use std::fmt::Write as _;

use labio::format::uff58::{
    ByteOrder, Encoding, Precision, SKIPPED, STEP_HALF_UNIT, Uff58, Uff58Writer,
};
use labio::format::{self, Reader, Strictness, Writer};
use labio::{Abscissa, Contents, LabioError, Ordinate, Series, SeriesKind};
use num_complex::Complex64;

use crate::series::{contents_of, even, property, values};

/// Records 1 to 11 with the fields that these tests use.
fn header(function_type: u8, data_type: u8, n: usize, even: u8) -> String {
    let mut text = String::from("end A\nNONE\n21-Nov-26 12:00:00\nNONE\nNONE\n");
    writeln!(text, "{function_type:5}         7    0         0 NONE               1   1 rig               2  -3").unwrap();
    writeln!(
        text,
        "{data_type:10}{n:10}{even:10}  2.50000E-01  1.25000E-01  0.00000E+00"
    )
    .unwrap();
    text.push_str("        17    0    0    0 Time                 s                   \n");
    text.push_str("        12    0    0    0 Acceleration         m/s^2               \n");
    text.push_str("        13    0    0    0 Force                N                   \n");
    text.push_str("         0    0    0    0 NONE                 NONE                \n");
    text
}

fn ascii(function_type: u8, data_type: u8, n: usize, even: u8, rows: &str) -> Vec<u8> {
    format!(
        "    -1\n    58\n{}{rows}    -1\n",
        header(function_type, data_type, n, even)
    )
    .into_bytes()
}

/// A 58b with `n_bytes` in its first line and `end` after its data.
fn binary(order: u8, n_bytes: usize, header: &str, data: &[u8], end: &str) -> Vec<u8> {
    let mut bytes = format!(
        "    -1\n    58b{order:6}{:6}{:12}{n_bytes:12}{:6}{:6}{:12}{:12}\n{header}",
        2, 11, 0, 0, 0, 0
    )
    .into_bytes();
    bytes.extend(data);
    bytes.extend(end.as_bytes());
    bytes
}

fn three_doubles() -> Vec<u8> {
    let three = [0.1_f64, 0.2, 0.3].iter();
    three.flat_map(|x| x.to_le_bytes()).collect()
}

fn strict(bytes: &[u8]) -> Result<Contents, LabioError> {
    Uff58.read(bytes, Strictness::Strict)
}

fn only_series(bytes: &[u8]) -> Series {
    let mut contents = strict(bytes).unwrap();
    assert_eq!(contents.series.len(), 1);
    contents.series.remove(0)
}

/// Both files contain the same recording of a microphone, one as text of six digits, the other as
/// 32-bit numbers.
#[test]
fn measured_files_are_read() {
    let Some(folder) = measured::folder() else {
        return;
    };
    let folder = folder.join("uff");
    let read = |name: &str| {
        format::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error:?}"))
    };
    let [text, binary] = ["Sample_UFF58_ascii.uff", "Sample_UFF58b_bin.uff"].map(read);
    let [text, binary] = [&text.series[0], &binary.series[0]];
    assert_eq!(
        (text.ordinate.len(), binary.ordinate.len()),
        (79_292, 79_292)
    );
    assert_eq!(text.abscissa, binary.abscissa);
    // the step has 6 digits, which are sufficient to determine the intended rate
    let Abscissa::Even { step, .. } = text.abscissa else {
        panic!("expected an even abscissa");
    };
    let half_unit = property(&text.properties, STEP_HALF_UNIT).unwrap();
    let rate = format::customary_rate(step, half_unit.parse().unwrap()).unwrap();
    assert_eq!(rate.rate_hz, 65_536.0);
    let together = format::read_records(folder.join("Sample_UFF58b_bin.uff")).unwrap();
    let microphone = together.records[0].channel("Mic 01.0Scalar").unwrap();
    assert_eq!(microphone.len(), 79_292);

    let measurement = read("measurement.uff");
    assert_eq!(measurement.series.len(), 3);
    for series in &measurement.series {
        assert_eq!(series.kind, SeriesKind::FrequencyResponse);
        assert_eq!(series.abscissa, even(0.0, 1.0));
        assert_eq!(series.ordinate.len(), 1001);
    }
    let nothing = read("1858.uff");
    assert!(nothing.series.is_empty());
    let skipped = (SKIPPED.to_owned(), "1858".to_owned());
    assert!(nothing.properties.contains(&skipped));
    let first = |name: &str| read(name).series.remove(0);
    assert_eq!(first("binary8byte.uff").ordinate.len(), 250);
    let filled = first("time-history-not-all-columns-filled.uff");
    assert_eq!(filled.ordinate.len(), 13);
    let unit = first("non_ascii_header.uff").ordinate_axis.unit_text;
    assert_eq!(unit, "(1/N)*(m/s\u{b2})");
    let density = first("sample_dataset58_psd.uff");
    assert_eq!(density.kind, SeriesKind::PowerSpectralDensity);
    assert_eq!(density.ordinate.len(), 3201);
}

fn written(series: &Series, encoding: Encoding, precision: Precision) -> Vec<u8> {
    let writer = Uff58Writer {
        encoding,
        precision,
    };
    crate::series::written(&writer, &contents_of(vec![series.clone()])).unwrap()
}

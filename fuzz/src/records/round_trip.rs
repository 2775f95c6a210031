//! Round trips: contents are written in every format that can represent them, and read again.

use labio::format::csv::Csv;
use labio::format::npy::Npy;
use labio::format::npz::Npz;
use labio::format::uff58::{ByteOrder, Encoding, Precision, Uff58, Uff58Writer};
use labio::format::wav::{Wav, WavEncoding, WavWriter};
use labio::format::{Reader, Strictness, Writer};
use labio::{Abscissa, Contents, Ordinate, Series};

use super::prints;

/// Writers, each with the reader of its format and the relative change of a value that it may
/// cause.
fn formats() -> [(&'static dyn Writer, &'static dyn Reader, f64); 7] {
    const BINARY: Uff58Writer = Uff58Writer {
        encoding: Encoding::Binary(ByteOrder::BigEndian),
        precision: Precision::Double,
    };
    const TEXT: Uff58Writer = Uff58Writer {
        encoding: Encoding::Ascii,
        precision: Precision::Double,
    };
    const FLOATS: WavWriter = WavWriter {
        encoding: WavEncoding::Float64,
    };
    [
        (&Csv, &Csv, 0.0),
        (&Npy, &Npy, 0.0),
        (&Npz, &Npz, 0.0),
        (&BINARY, &Uff58, 0.0),
        // written with thirteen digits
        (&TEXT, &Uff58, 1e-11),
        (&FLOATS, &Wav, 0.0),
        // written in the encoding of the file that was read
        (&Wav, &Wav, 0.0),
    ]
}

/// Checks that each writer either refuses the contents or writes a file that the strict reader
/// accepts, with the same values over the same abscissa.
pub fn check(contents: &Contents) {
    for (writer, reader, tolerance) in formats() {
        let mut bytes = Vec::new();
        if let Err(error) = writer.write(contents, &mut bytes) {
            prints(&error);
            continue;
        }
        let again = match reader.read(&bytes, Strictness::Strict) {
            Ok(again) => again,
            Err(error) => panic!(
                "the reader of {} rejects a written file: {error}",
                reader.name()
            ),
        };
        assert_eq!(
            again.series.len(),
            contents.series.len(),
            "series of {}",
            reader.name()
        );
        for (before, after) in contents.series.iter().zip(&again.series) {
            same(before, after, tolerance, reader.name());
        }
    }
}

/// Checks that two series have the same values over the same abscissa.
pub fn same(before: &Series, after: &Series, tolerance: f64, place: &str) {
    let of = format!("of `{}` in {place}", before.name);
    values(before, after, tolerance, &of);
    abscissa(before, after, &of);
}

fn parts(ordinate: &Ordinate) -> (bool, Vec<f64>) {
    match ordinate {
        Ordinate::Real(values) => (false, values.clone()),
        Ordinate::Complex(values) => (true, values.iter().flat_map(|v| [v.re, v.im]).collect()),
    }
}

fn values(before: &Series, after: &Series, tolerance: f64, of: &str) {
    let (was_complex, before) = parts(&before.ordinate);
    let (is_complex, after) = parts(&after.ordinate);
    assert_eq!(was_complex, is_complex, "real or complex {of}");
    assert_eq!(before.len(), after.len(), "values {of}");
    for (index, (a, b)) in before.iter().zip(&after).enumerate() {
        let same = a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
        let close = (a - b).abs() <= tolerance * a.abs() && a.is_finite();
        assert!(
            same || (tolerance > 0.0 && close),
            "value {index} {of}: {a:e} became {b:e}"
        );
    }
}

/// Returns the abscissa of value `index`.
fn place(abscissa: &Abscissa, index: usize) -> f64 {
    match abscissa {
        Abscissa::Even { start, step } => start + index as f64 * step,
        Abscissa::Uneven(values) => values[index],
    }
}

/// Compares abscissas relative to their whole range: an even abscissa may become a list of values,
/// and a list of evenly spaced values an even abscissa.
fn abscissa(before: &Series, after: &Series, of: &str) {
    let last = before.ordinate.len().saturating_sub(1);
    if before.ordinate.is_empty() {
        return;
    }
    let (first, end) = (place(&before.abscissa, 0), place(&before.abscissa, last));
    for index in [0, last / 2, last] {
        let (a, b) = (
            place(&before.abscissa, index),
            place(&after.abscissa, index),
        );
        let scale = (end - first)
            .abs()
            .max(first.abs())
            .max(end.abs())
            .max(a.abs());
        // tolerance: a list of rounded times becomes an even abscissa if its digits determine the
        // step to 1e-4
        assert!(
            (a - b).abs() <= 1e-4 * scale
                || a.to_bits() == b.to_bits()
                || (a.is_nan() && b.is_nan()),
            "abscissa {index} {of}: {a:e} became {b:e}"
        );
    }
}

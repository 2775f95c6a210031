//! Conversion between an array and series.

use num_complex::Complex64;

use super::header::{Element, Header, Kind, shape_text};
use crate::error::{malformed, truncated};
use crate::format::number_type::{NumberType, utf32};
use crate::unit::EXACT_INTEGERS;
use crate::{LabioError, Ordinate, Place, Series};

/// An array of numbers or of texts.
#[derive(Debug)]
pub(in crate::format) struct Array {
    pub(in crate::format) header: Header,
    pub(in crate::format) values: Values,
}

/// The elements in the order of the file.
#[derive(Debug)]
pub(in crate::format) enum Values {
    Real(Vec<f64>),
    Complex(Vec<Complex64>),
    Text(Vec<String>),
}

impl Array {
    /// Reads an array that extends to the end of `bytes`. `part` names the array in errors.
    pub(in crate::format) fn read(
        bytes: &[u8],
        format: &'static str,
        part: &str,
    ) -> Result<Self, LabioError> {
        let header = Header::read(bytes, format, part)?;
        let data = bytes.get(header.data_start..).unwrap_or(&[]);
        let awaited = header.data_length().unwrap_or(usize::MAX);
        if data.len() < awaited {
            return Err(truncated(format, awaited - data.len()));
        }
        if data.len() > awaited {
            return Err(LabioError::TrailingBytes {
                format,
                extra_bytes: data.len() - awaited,
            });
        }
        let malformed = |index: usize, found: String, expected: &str| {
            let place = Place::Byte((header.data_start + index * header.element.bytes) as u64);
            malformed(
                format,
                place,
                format!("{part}element {index}"),
                found,
                expected,
            )
        };
        let values = if header.element.is_text() {
            let texts = data.chunks_exact(header.element.bytes);
            let texts = texts.enumerate().map(|(index, text)| {
                characters(text, header.element)
                    .ok_or_else(|| malformed(index, format!("{text:02x?}"), "characters"))
            });
            Values::Text(texts.collect::<Result<_, _>>()?)
        } else {
            let (reals, inexact) = numbers(data, header.element);
            if let Some(index) = inexact {
                let found = "an integer beyond 2^53".to_owned();
                let expected = "one that a double represents exactly";
                return Err(malformed(index, found, expected));
            }
            if header.element.kind == Kind::Complex {
                let pairs = reals.as_chunks::<2>().0.iter();
                Values::Complex(pairs.map(|&[re, im]| Complex64::new(re, im)).collect())
            } else {
                Values::Real(reals)
            }
        };
        Ok(Self { header, values })
    }

    /// Returns the series of an array of one or two axes called `name`; empty if the array contains
    /// texts, has no element or has another number of axes.
    pub(in crate::format) fn into_series(self, name: &str) -> Vec<Series> {
        let (shape, element) = (&self.header.shape, self.header.element);
        let ordinate = match self.values {
            Values::Real(values) => Ordinate::Real(values),
            Values::Complex(values) => Ordinate::Complex(values),
            Values::Text(_) => return Vec::new(),
        };
        let mut properties = vec![("descr".to_owned(), element.to_string())];
        match shape.as_slice() {
            [_] => {
                if usual_element(&ordinate) == element {
                    properties.clear();
                }
                vec![Series::over_index(name.to_owned(), ordinate, properties)]
            }
            &[n_rows, n_columns] => {
                let rows_are_series = n_rows <= n_columns;
                let (n_series, length) = (n_rows.min(n_columns), n_rows.max(n_columns));
                // distance between consecutive samples, and between consecutive series, in the
                // order of the file
                let (sample, one) = match (rows_are_series, self.header.fortran_order) {
                    (true, false) | (false, true) => (1, length),
                    (true, true) | (false, false) => (n_series, 1),
                };
                properties.insert(0, ("array".to_owned(), name.to_owned()));
                properties.insert(1, ("shape".to_owned(), shape_text(shape)));
                if self.header.fortran_order {
                    properties.push(("fortran_order".to_owned(), "True".to_owned()));
                }
                let series = (0..n_series).map(|index| {
                    let ordinate = ordinate.every(index * one, sample, length);
                    Series::over_index(
                        member_name(name, shape, index),
                        ordinate,
                        properties.clone(),
                    )
                });
                series.collect()
            }
            _ => Vec::new(),
        }
    }
}

/// Returns the name of one series of an array of two axes.
pub(in crate::format) fn member_name(name: &str, shape: &[usize], index: usize) -> String {
    match shape {
        [n_rows, n_columns] if n_rows > n_columns => format!("{name}[:, {index}]"),
        _ => format!("{name}[{index}, :]"),
    }
}

/// Returns the default element type for the numbers of `ordinate`.
pub(in crate::format) fn usual_element(ordinate: &Ordinate) -> Element {
    match ordinate {
        Ordinate::Real(_) => Element::F64,
        Ordinate::Complex(_) => Element::C128,
    }
}

/// Returns the numbers, complex ones as pairs, and the index of the first integer that may not be
/// exact as `f64`.
fn numbers(data: &[u8], element: Element) -> (Vec<f64>, Option<usize>) {
    let kind = match (element.kind, element.bytes) {
        (Kind::Float, 4) | (Kind::Complex, 8) => NumberType::F32,
        (Kind::Float | Kind::Complex, _) => NumberType::F64,
        (Kind::Signed, 1) => NumberType::I8,
        (Kind::Signed, 2) => NumberType::I16,
        (Kind::Signed, 4) => NumberType::I32,
        (Kind::Signed, _) => NumberType::I64,
        (Kind::Unsigned, 2) => NumberType::U16,
        (Kind::Unsigned, 4) => NumberType::U32,
        (Kind::Unsigned, 8) => NumberType::U64,
        (Kind::Unsigned | Kind::Boolean | Kind::Wide | Kind::Narrow, _) => NumberType::U8,
    };
    let values = kind.numbers(data, element.big_endian);
    let long = element.bytes == 8 && matches!(element.kind, Kind::Signed | Kind::Unsigned);
    let inexact = values
        .iter()
        .position(|value| long && value.abs() >= EXACT_INTEGERS);
    (values, inexact)
}

/// Reads a text padded with zeros.
fn characters(bytes: &[u8], element: Element) -> Option<String> {
    let text: String = match element.kind {
        Kind::Wide => utf32(bytes, element.big_endian)?,
        _ => bytes.iter().copied().map(char::from).collect(),
    };
    Some(text.trim_end_matches('\0').to_owned())
}

/// Writes `series` as one array: several series are its rows, or its columns if the samples are
/// then along the longer axis of `shape`. `None` if a number does not fit into the element.
pub(in crate::format) fn write(series: &[&Series], header: &Header) -> Option<Vec<u8>> {
    let mut bytes = header.write();
    let element = header.element;
    let length = series.first().map_or(0, |series| series.ordinate.len());
    let rows_are_series = match header.shape.as_slice() {
        [n_rows, n_columns] => n_rows <= n_columns,
        _ => true,
    };
    let mut put = |series: &Series, sample: usize| match &series.ordinate {
        Ordinate::Real(values) => encode(*values.get(sample)?, element, &mut bytes),
        Ordinate::Complex(values) => {
            let value = values.get(sample)?;
            encode(value.re, element, &mut bytes)?;
            encode(value.im, element, &mut bytes)
        }
    };
    if rows_are_series != header.fortran_order {
        for one in series {
            for sample in 0..length {
                put(one, sample)?;
            }
        }
    } else {
        for sample in 0..length {
            for one in series {
                put(one, sample)?;
            }
        }
    }
    Some(bytes)
}

/// Writes one number, or one part of a complex number; `None` if the element cannot represent the
/// number exactly.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a number that the conversion changes is refused"
)]
fn encode(value: f64, element: Element, to: &mut Vec<u8>) -> Option<()> {
    let kept = |back: f64| {
        (back.to_bits() == value.to_bits() || (back.is_nan() && value.is_nan())).then_some(())
    };
    let at = to.len();
    match (element.kind, element.bytes) {
        (Kind::Float, 4) | (Kind::Complex, 8) => {
            kept(f64::from(value as f32))?;
            to.extend((value as f32).to_le_bytes());
        }
        (Kind::Float | Kind::Complex, _) => to.extend(value.to_le_bytes()),
        (Kind::Signed, n) => {
            let integer = value as i64;
            kept(integer as f64)?;
            let bits = 64 - 8 * u32::try_from(n).ok()?;
            if integer << bits >> bits != integer {
                return None;
            }
            to.extend(integer.to_le_bytes().iter().take(n));
        }
        (Kind::Unsigned | Kind::Boolean, n) => {
            let integer = value as u64;
            kept(integer as f64)?;
            let bits = 64 - 8 * u32::try_from(n).ok()?;
            let beyond = element.kind == Kind::Boolean && integer > 1;
            if integer << bits >> bits != integer || beyond {
                return None;
            }
            to.extend(integer.to_le_bytes().iter().take(n));
        }
        (Kind::Wide | Kind::Narrow, _) => return None,
    }
    if element.big_endian {
        to.get_mut(at..)?.reverse();
    }
    Some(())
}

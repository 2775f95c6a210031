//! Conversion between an array and series.

use num_complex::Complex64;

use super::header::{Element, Header, Kind, shape_text};
use crate::series::every;
use crate::{Abscissa, LabioError, Ordinate, Place, Series, SeriesAxis, SeriesKind};

/// Largest magnitude up to which every integer is exact as `f64`.
const LARGEST_EXACT: f64 = 9_007_199_254_740_992.0;

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
            return Err(LabioError::Truncated {
                format,
                missing_bytes: awaited - data.len(),
            });
        }
        if data.len() > awaited {
            return Err(LabioError::TrailingBytes {
                format,
                extra_bytes: data.len() - awaited,
            });
        }
        let malformed = |index: usize, found: String, expected: &str| LabioError::Malformed {
            format,
            place: Place::Byte((header.data_start + index * header.element.bytes) as u64),
            field: format!("{part}element {index}"),
            found,
            expected: expected.to_owned(),
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
                return Err(malformed(
                    index,
                    found,
                    "one that a double represents exactly",
                ));
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
        let shape = &self.header.shape;
        let descr = self.header.element.to_string();
        let series = |name: String, ordinate: Ordinate| Series {
            name,
            kind: SeriesKind::General,
            abscissa: Abscissa::Even {
                start: 0.0,
                step: 1.0,
            },
            ordinate,
            abscissa_axis: index_axis(),
            ordinate_axis: SeriesAxis::default(),
            properties: Vec::new(),
        };
        let whole = |values| match values {
            Values::Real(values) => Some(Ordinate::Real(values)),
            Values::Complex(values) => Some(Ordinate::Complex(values)),
            Values::Text(_) => None,
        };
        match shape.as_slice() {
            [_] => {
                let Some(ordinate) = whole(self.values) else {
                    return Vec::new();
                };
                let usual = usual_element(&ordinate) == self.header.element;
                let mut series = series(name.to_owned(), ordinate);
                if !usual {
                    series.properties.push(("descr".to_owned(), descr));
                }
                vec![series]
            }
            &[n_rows, n_columns] => {
                let rows_are_series = n_rows <= n_columns;
                let n_series = n_rows.min(n_columns);
                let length = n_rows.max(n_columns);
                // distance between consecutive samples, and between consecutive series, in the
                // order of the file
                let (sample, one) = match (rows_are_series, self.header.fortran_order) {
                    (true, false) | (false, true) => (1, length),
                    (true, true) | (false, false) => (n_series, 1),
                };
                let properties = |index| {
                    let mut properties = vec![
                        ("array".to_owned(), name.to_owned()),
                        ("shape".to_owned(), shape_text(shape)),
                        ("descr".to_owned(), descr.clone()),
                    ];
                    if self.header.fortran_order {
                        properties.push(("fortran_order".to_owned(), "True".to_owned()));
                    }
                    (member_name(name, shape, index), properties)
                };
                (0..n_series)
                    .filter_map(|index| {
                        let ordinate = match &self.values {
                            Values::Real(values) => {
                                Ordinate::Real(every(values, index * one, sample, length))
                            }
                            Values::Complex(values) => {
                                Ordinate::Complex(every(values, index * one, sample, length))
                            }
                            Values::Text(_) => return None,
                        };
                        let (name, properties) = properties(index);
                        Some(Series {
                            properties,
                            ..series(name, ordinate)
                        })
                    })
                    .collect()
            }
            _ => Vec::new(),
        }
    }
}

/// An axis of sample indices.
pub(in crate::format) fn index_axis() -> SeriesAxis {
    SeriesAxis {
        label: "index".to_owned(),
        ..SeriesAxis::default()
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
    fn each<const N: usize>(
        data: &[u8],
        big_endian: bool,
        value: impl Fn([u8; N]) -> f64,
    ) -> Vec<f64> {
        let flip = |mut bytes: [u8; N]| {
            if big_endian {
                bytes.reverse();
            }
            value(bytes)
        };
        data.as_chunks::<N>()
            .0
            .iter()
            .map(|&bytes| flip(bytes))
            .collect()
    }
    let big = element.big_endian;
    let values = match (element.kind, element.bytes) {
        (Kind::Float, 4) | (Kind::Complex, 8) => {
            each(data, big, |b| f64::from(f32::from_le_bytes(b)))
        }
        (Kind::Float | Kind::Complex, _) => each(data, big, f64::from_le_bytes),
        (Kind::Signed, 1) => each(data, big, |b| f64::from(i8::from_le_bytes(b))),
        (Kind::Signed, 2) => each(data, big, |b| f64::from(i16::from_le_bytes(b))),
        (Kind::Signed, 4) => each(data, big, |b| f64::from(i32::from_le_bytes(b))),
        (Kind::Signed, _) => each(data, big, |b| i64::from_le_bytes(b) as f64),
        (Kind::Unsigned, 2) => each(data, big, |b| f64::from(u16::from_le_bytes(b))),
        (Kind::Unsigned, 4) => each(data, big, |b| f64::from(u32::from_le_bytes(b))),
        (Kind::Unsigned, 8) => each(data, big, |b| u64::from_le_bytes(b) as f64),
        (Kind::Unsigned | Kind::Boolean, _) => each(data, big, |[b]| f64::from(b)),
        (Kind::Wide | Kind::Narrow, _) => Vec::new(),
    };
    let long = element.bytes == 8 && matches!(element.kind, Kind::Signed | Kind::Unsigned);
    let inexact = values
        .iter()
        .position(|value| long && value.abs() >= LARGEST_EXACT);
    (values, inexact)
}

/// Reads a text padded with zeros.
fn characters(bytes: &[u8], element: Element) -> Option<String> {
    let text: String = match element.kind {
        Kind::Wide => bytes
            .as_chunks::<4>()
            .0
            .iter()
            .map(|&four| {
                char::from_u32(match element.big_endian {
                    true => u32::from_be_bytes(four),
                    false => u32::from_le_bytes(four),
                })
            })
            .collect::<Option<_>>()?,
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

//! Writing of variables with numbers or text.

use std::collections::HashSet;
use std::io::Write;

use super::beside::{BESIDE, OF_WRITER};
use super::{FORMAT, HEADER_BYTES, MATRIX, Mat5};
use crate::error::{not_representable, not_written};
use crate::format::Writer;
use crate::format::kind::kind_name;
use crate::{Abscissa, Contents, LabioError, Ordinate, Series, SeriesKind};

/// Types of the data in an element.
const INT8: u32 = 1;
const UINT16: u32 = 4;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE: u32 = 9;

/// Classes of an array.
const OF_TEXT: u32 = 4;
const OF_DOUBLES: u32 = 6;

/// Flag of complex numbers, in the same word as the class.
const COMPLEX: u32 = 0x0800;

/// Greatest length of the name of a variable.
const LONGEST_NAME: usize = 63;

impl Writer for Mat5 {
    fn name(&self) -> &'static str {
        FORMAT
    }

    /// Writes each series as a column of doubles under its name, in which every character that
    /// MATLAB does not allow becomes `_`. The abscissae follow (`NAME_start` and `NAME_step`, or
    /// `NAME_x` if uneven), then the name if it was changed (`NAME_name`), the kind of the series
    /// if it is known (`NAME_kind`), labels and units of values and abscissae (`NAME_label`,
    /// `NAME_unit`, `NAME_x_label`, `NAME_x_unit`), and the properties of the contents as text.
    /// Properties of series are not written.
    fn write(&self, contents: &Contents, output: &mut dyn Write) -> Result<(), LabioError> {
        let mut file = OF_WRITER.as_bytes().to_vec();
        file.resize(HEADER_BYTES - 12, b' ');
        file.extend([0; 8]);
        file.extend([0x00, 0x01, b'I', b'M']);
        let mut names = Names::default();
        let named: Vec<(String, &Series)> = contents
            .series
            .iter()
            .map(|series| (names.of_series(&series.name), series))
            .collect();
        for (name, series) in &named {
            let (real, imaginary): (Vec<f64>, Option<Vec<f64>>) = match &series.ordinate {
                Ordinate::Real(values) => (values.clone(), None),
                Ordinate::Complex(values) => (
                    values.iter().map(|value| value.re).collect(),
                    Some(values.iter().map(|value| value.im).collect()),
                ),
            };
            file.extend(doubles(name, &real, imaginary.as_deref())?);
        }
        for (name, series) in &named {
            let mut number = |of: &str, values: &[f64]| {
                file.extend(doubles(&format!("{name}_{of}"), values, None)?);
                Ok::<(), LabioError>(())
            };
            match &series.abscissa {
                Abscissa::Even { start, step } => {
                    number("start", &[*start])?;
                    number("step", &[*step])?;
                }
                Abscissa::Uneven(values) => number("x", values)?,
            }
            let [values, abscissae] = [&series.ordinate_axis, &series.abscissa_axis];
            // returns an empty text, which is not written, if `found` is what the reader assumes
            // without it
            let unless = |usual: &str, found: &str| match found == usual {
                true => String::new(),
                false => found.to_owned(),
            };
            let usual_kind = kind_name(SeriesKind::General);
            let texts = [
                ("name", &unless(name, series.name.trim())),
                ("kind", &unless(&usual_kind, &kind_name(series.kind))),
                ("label", &values.label),
                ("unit", &values.unit_text),
                ("x_label", &abscissae.label),
                ("x_unit", &abscissae.unit_text),
            ];
            for (of, value) in texts {
                if !value.is_empty() {
                    file.extend(text(&format!("{name}_{of}"), value)?);
                }
            }
        }
        for (key, value) in &contents.properties {
            file.extend(text(&names.of(key), value)?);
        }
        output.write_all(&file).map_err(not_written)
    }
}

/// Names of variables, each of which is used once.
#[derive(Default)]
struct Names(HashSet<String>);

impl Names {
    /// Returns an unused variable name similar to `wanted`: a letter, then letters, digits and `_`.
    fn of(&mut self, wanted: &str) -> String {
        self.with(wanted, &[])
    }

    /// Returns a name for a series, and reserves the names of the variables that accompany it
    /// ([`BESIDE`]), so that no other series or property gets one of these names.
    fn of_series(&mut self, wanted: &str) -> String {
        self.with(wanted, &BESIDE)
    }

    fn with(&mut self, wanted: &str, beside: &[&str]) -> String {
        let longest = beside.iter().map(|of| of.len() + 1).max().unwrap_or(0);
        let longest = LONGEST_NAME - longest;
        let allowed = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        let mut name: String = wanted.trim().chars().map(allowed).collect();
        if !name.starts_with(|first: char| first.is_ascii_alphabetic()) {
            name.insert(0, 'x');
        }
        let mut tail = String::new();
        let mut count = 1;
        loop {
            name.truncate(longest - tail.len());
            let one = format!("{name}{tail}");
            let mut all: Vec<String> = beside.iter().map(|of| format!("{one}_{of}")).collect();
            all.push(one.clone());
            if !all.iter().any(|name| self.0.contains(name)) {
                self.0.extend(all);
                return one;
            }
            count += 1;
            tail = format!("_{count}");
        }
    }
}

/// Returns a column of numbers as an array.
fn doubles(name: &str, real: &[f64], imaginary: Option<&[f64]>) -> Result<Vec<u8>, LabioError> {
    let flag = if imaginary.is_some() { COMPLEX } else { 0 };
    let parts = [Some(real), imaginary].into_iter().flatten();
    let data = parts.map(|values| {
        let bytes = values.iter().flat_map(|value| value.to_le_bytes());
        (DOUBLE, bytes.collect())
    });
    array(name, OF_DOUBLES | flag, [real.len(), 1], data)
}

/// Returns a row of characters as an array.
fn text(name: &str, value: &str) -> Result<Vec<u8>, LabioError> {
    let units: Vec<u8> = value.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let n_units = units.len() / 2;
    let shape = [usize::from(n_units > 0), n_units];
    array(name, OF_TEXT, shape, std::iter::once((UINT16, units)))
}

fn array(
    name: &str,
    class: u32,
    shape: [usize; 2],
    data: impl Iterator<Item = (u32, Vec<u8>)>,
) -> Result<Vec<u8>, LabioError> {
    let too_long = || {
        not_representable(
            FORMAT,
            format!("`{name}`, which has {} numbers", shape[0].max(shape[1])),
        )
    };
    let mut lengths = Vec::new();
    for length in shape {
        let length = i32::try_from(length).map_err(|_| too_long())?;
        lengths.extend(length.to_le_bytes());
    }
    let flags = [class.to_le_bytes(), [0; 4]].concat();
    let mut body = Vec::new();
    for (kind, bytes) in [(UINT32, flags), (INT32, lengths), (INT8, name.into())] {
        body.extend(element(kind, &bytes).ok_or_else(too_long)?);
    }
    for (kind, bytes) in data {
        body.extend(element(kind, &bytes).ok_or_else(too_long)?);
    }
    let length = u32::try_from(body.len()).map_err(|_| too_long())?;
    Ok([&MATRIX.to_le_bytes()[..], &length.to_le_bytes(), &body].concat())
}

/// Returns a data element, padded to a multiple of eight bytes; up to four bytes are stored within
/// the tag.
fn element(kind: u32, bytes: &[u8]) -> Option<Vec<u8>> {
    let length = u32::try_from(bytes.len()).ok()?;
    let mut found = if (1..=4).contains(&length) {
        (kind | length << 16).to_le_bytes().to_vec()
    } else {
        [kind.to_le_bytes(), length.to_le_bytes()].concat()
    };
    found.extend(bytes);
    found.resize(found.len().next_multiple_of(8), 0);
    Some(found)
}

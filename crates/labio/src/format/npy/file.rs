//! Any array of one or two axes.

use std::io::Write;

use super::FORMAT;
use super::array::{self, Array, member_name, usual_element};
use super::header::{Element, Header, MAGIC};
use crate::error::{not_representable, not_written};
use crate::format::{Reader, Strictness, Writer, text};
use crate::{Abscissa, Contents, LabioError, Ordinate, Series, SeriesAxis, SeriesKind};

/// `NumPy` array files with one array each; see the [module](super).
///
/// # Examples
///
/// ```
/// use labio::Ordinate;
/// use labio::format::npy::Npy;
/// use labio::format::{Reader, Strictness, Writer};
///
/// let mut file = b"\x93NUMPY\x01\x00\x38\x00".to_vec();
/// file.extend(b"{'descr': '<i2', 'fortran_order': False, 'shape': (2,)}\n");
/// file.extend([1, 0, 0xff, 0xff]);
/// let contents = Npy.read(&file, Strictness::Strict)?;
/// assert_eq!(contents.series[0].ordinate, Ordinate::Real(vec![1.0, -1.0]));
/// # Ok::<(), labio::LabioError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Npy;

impl Reader for Npy {
    fn name(&self) -> &'static str {
        FORMAT
    }

    fn recognises(&self, head: &[u8]) -> bool {
        head.starts_with(MAGIC)
    }

    fn read(&self, bytes: &[u8], strictness: Strictness) -> Result<Contents, LabioError> {
        let mut contents = Contents::of_format(FORMAT);
        let array = match (Array::read(bytes, FORMAT, ""), strictness) {
            (Err(error), Strictness::Tolerant) => {
                let Some(part) = whole_samples(bytes) else {
                    return Err(error);
                };
                contents.defects.push(error);
                Array::read(&part, FORMAT, "")?
            }
            (array, _) => array?,
        };
        let shape = array.header.shape.clone();
        if shape.is_empty() || shape.len() > 2 {
            return Err(LabioError::WrongDimensions {
                format: FORMAT,
                found: shape.len(),
                expected: 2,
            });
        }
        if array.header.element.is_text() {
            return Err(LabioError::WrongElement {
                format: FORMAT,
                found: array.header.element.to_string(),
                expected: "numbers",
            });
        }
        contents.series = array.into_series("");
        if contents
            .series
            .iter()
            .all(|series| series.ordinate.is_empty())
        {
            return Err(LabioError::NoData { format: FORMAT });
        }
        Ok(contents)
    }
}

/// Returns the readable part of an array whose file is cut short or too long: the whole samples of
/// an array of one axis, or the array without the bytes that follow it.
fn whole_samples(bytes: &[u8]) -> Option<Vec<u8>> {
    let mut header = Header::read(bytes, FORMAT, "").ok()?;
    let data = bytes.get(header.data_start..)?;
    let there = match header.data_length() {
        Some(length) if length <= data.len() => length,
        _ => {
            // the first axis varies slowest, so that its leading part is complete; an array of one
            // axis may end after any sample
            let [n] = header.shape.as_mut_slice() else {
                return None;
            };
            *n = data.len() / header.element.bytes;
            *n * header.element.bytes
        }
    };
    let mut part = header.write();
    part.extend(data.get(..there)?);
    Some(part)
}

fn cannot_hold(what: impl Into<String>) -> LabioError {
    not_representable(FORMAT, what.into())
}

impl Writer for Npy {
    fn name(&self) -> &'static str {
        FORMAT
    }

    fn write(&self, contents: &Contents, output: &mut dyn Write) -> Result<(), LabioError> {
        if let Some((key, _)) = contents.properties.first() {
            return Err(cannot_hold(format!(
                "the property `{key}`; npz can hold properties"
            )));
        }
        let series: Vec<&Series> = contents.series.iter().collect();
        let header = header_of(&series, "", FORMAT)?;
        for (index, one) in series.iter().enumerate() {
            let name = match header.shape.len() {
                1 => String::new(),
                _ => member_name("", &header.shape, index),
            };
            if one.name != name {
                return Err(cannot_hold(format!(
                    "the name `{}`, only `{name}`; npz can hold names",
                    one.name
                )));
            }
            if !is_bare(one) {
                return Err(cannot_hold(format!(
                    "an abscissa, a kind or units of `{name}`; npz can hold them"
                )));
            }
        }
        let bytes = array::write(&series, &header)
            .ok_or_else(|| cannot_hold(format!("the numbers as {}", header.element)))?;
        output.write_all(&bytes).map_err(not_written)
    }
}

/// Returns true if a series consists of numbers only.
pub(in crate::format) fn is_bare(series: &Series) -> bool {
    series.kind == SeriesKind::General
        && matches!(series.abscissa, Abscissa::Even { start, step }
            if start.to_bits() == 0 && step.to_bits() == 1.0_f64.to_bits())
        && series.abscissa_axis == text::axis("index", "")
        && series.ordinate_axis == SeriesAxis::default()
}

/// Creates the header for writing `series` as the array called `name`, from the properties of the
/// series.
pub(in crate::format) fn header_of(
    series: &[&Series],
    name: &str,
    format: &'static str,
) -> Result<Header, LabioError> {
    let cannot_hold = |what: String| Err(not_representable(format, what));
    let Some(first) = series.first() else {
        return cannot_hold("contents without a series".to_owned());
    };
    let property = |key: &str| {
        let found = first.properties.iter().find(|(k, _)| k == key);
        found.map(|(_, value)| value.as_str())
    };
    let element = match property("descr") {
        None => usual_element(&first.ordinate),
        Some(descr) => match Element::parse(descr).filter(|element| !element.is_text()) {
            Some(element) => element,
            None => return cannot_hold(format!("the element `{descr}`")),
        },
    };
    let length = first.ordinate.len();
    let (long, wide) = (vec![length, series.len()], vec![series.len(), length]);
    let shape = match property("shape") {
        None if series.len() == 1 => vec![length],
        None => wide,
        Some(text) if text == super::header::shape_text(&wide) => wide,
        Some(text) if text == super::header::shape_text(&long) => long,
        Some(text) => {
            return cannot_hold(format!(
                "{} series of {length} samples in an array of shape {text}",
                series.len()
            ));
        }
    };
    if shape.len() == 2 && series.len() > length {
        return cannot_hold(format!(
            "{} series of {length} samples: the longer axis is that of the samples",
            series.len()
        ));
    }
    let fortran_order = match property("fortran_order") {
        None | Some("False") => false,
        Some("True") => true,
        Some(text) => return cannot_hold(format!("the order of memory `{text}`")),
    };
    let complex = |series: &Series| matches!(series.ordinate, Ordinate::Complex(_));
    for one in series {
        let alike = one.ordinate.len() == length && complex(one) == complex(first);
        if !alike || one.properties != first.properties {
            return cannot_hold(format!(
                "`{}` and `{}` in the array `{name}`: they differ in length, type or properties",
                first.name, one.name
            ));
        }
        let known = ["array", "shape", "descr", "fortran_order"];
        if let Some((key, _)) = one
            .properties
            .iter()
            .find(|(key, _)| !known.contains(&key.as_str()))
        {
            return cannot_hold(format!(
                "the property `{key}` of `{}` in an array",
                one.name
            ));
        }
    }
    if complex(first) != (element.kind == super::header::Kind::Complex) {
        return cannot_hold(format!("the numbers of `{}` as {element}", first.name));
    }
    Ok(Header {
        element,
        fortran_order,
        shape,
        data_start: 0,
    })
}

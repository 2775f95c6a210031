//! `NumPy`'s `.npz`: a ZIP archive of arrays, each with a name.
//!
//! Every array of one axis is a series with the name of the array; an array of two axes gives
//! several series (see [`npy`](super::npy)); single numbers and texts are properties of the
//! contents. Deflated and stored members are read; the writer stores its members.
//!
//! # Other information
//!
//! The writer stores the other information about a series (named `F` in this table) in separate
//! members, and writes no empty members. The reader restores the information from these members:
//!
//! | member | shape | content |
//! |---|---|---|
//! | `F.start_step` | `(2,)` | first value and step of an even abscissa |
//! | `F.abscissa` | `(n_samples,)` | values of an uneven abscissa |
//! | `F.about` | `(n, 2)` text | labels, units, kind and properties, each with its value |
//! | `about` | `(n, 2)` text | properties of the contents |
//!
//! # Strictness
//!
//! A member that is not an array, or whose element or shape does not allow a series, is rejected;
//! in a tolerant reading it is a defect. Contents beyond a [`MemoryLimit`] are rejected in both
//! kinds of reading.

mod about;
mod write;

use std::collections::{HashMap, HashSet};
use std::io::{Cursor, Read};

use zip::ZipArchive;
use zip::result::ZipError;

use crate::error::malformed;
use crate::format::memory::Budget;
use crate::format::npy::array::{Array, Values};
use crate::format::npy::header::{Header, shape_text};
use crate::format::{MemoryLimit, Reader, Strictness, text};
use crate::{Contents, LabioError, Place, Series};

const FORMAT: &str = "npz";

/// Largest number of bytes to which one deflated byte can expand.
const OF_A_DEFLATED_BYTE: usize = 1032;

/// Memory of a series without its numbers: its name and its four properties, each a short text.
const OF_A_SERIES: usize = size_of::<Series>() + 12 * (size_of::<String>() + 32);

/// `NumPy` archives of arrays.
///
/// # Examples
///
/// ```
/// use labio::format::npz::Npz;
/// use labio::format::{Reader, Strictness, Writer};
/// # use labio::{Abscissa, Contents, Ordinate, Series, SeriesAxis, SeriesKind};
///
/// # fn main() -> Result<(), labio::LabioError> {
/// # let mut contents = Contents::of_format("computed");
/// # contents.series.push(Series {
/// #     name: "hammer".to_owned(), kind: SeriesKind::TimeResponse,
/// #     abscissa: Abscissa::Even { start: 0.0, step: 1.0 / 8000.0 },
/// #     ordinate: Ordinate::Real(vec![0.0, 0.5, -0.25]),
/// #     abscissa_axis: SeriesAxis { unit_text: "s".to_owned(), unit: labio::Unit::parse("s").ok(), ..Default::default() },
/// #     ordinate_axis: SeriesAxis { unit_text: "N".to_owned(), unit: labio::Unit::parse("N").ok(), ..Default::default() },
/// #     properties: Vec::new(),
/// # });
/// let mut bytes = Vec::new();
/// Npz.write(&contents, &mut bytes)?;
/// let back = Npz.read(&bytes, Strictness::Strict)?;
/// assert_eq!(back.series[0].abscissa, contents.series[0].abscissa);
/// assert_eq!(back.series[0].ordinate_axis.unit_text, "N");
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Npz;

impl Reader for Npz {
    fn name(&self) -> &'static str {
        FORMAT
    }

    fn recognises(&self, head: &[u8]) -> bool {
        // the header of the first member, with the length of its name and the name
        let length = |at: usize| {
            let bytes = head.get(at..)?.first_chunk::<2>()?;
            Some(usize::from(u16::from_le_bytes(*bytes)))
        };
        head.starts_with(b"PK\x03\x04")
            && length(26)
                .and_then(|n| head.get(30..30_usize.checked_add(n)?))
                .is_some_and(|name| name.ends_with(b".npy"))
    }

    fn read(&self, bytes: &[u8], strictness: Strictness) -> Result<Contents, LabioError> {
        read_within(bytes, strictness, MemoryLimit::of_file(bytes.len()))
    }
}

/// Reads a whole archive whose contents may take memory up to `limit`.
///
/// # Errors
///
/// The errors of [`Npz`] as a [`Reader`]; [`LabioError::MemoryLimit`] beyond the limit.
pub fn read_within(
    bytes: &[u8],
    strictness: Strictness,
    limit: MemoryLimit,
) -> Result<Contents, LabioError> {
    let mut archive =
        ZipArchive::new(Cursor::new(bytes)).map_err(|error| zip_error(error, "archive"))?;
    let mut contents = Contents::of_format(FORMAT);
    let mut budget = Budget::new(FORMAT, limit);
    let mut arrays = Vec::new();
    for index in 0..archive.len() {
        match member(&mut archive, index, &mut budget) {
            Ok(array) => arrays.push(array),
            Err(error @ LabioError::MemoryLimit { .. }) => return Err(error),
            Err(error) => strictness.pass_over(error, &mut contents.defects)?,
        }
    }
    let mut beside = HashMap::new();
    let names: HashSet<String> = arrays.iter().map(|(name, _)| name.clone()).collect();
    let mut series: Vec<Series> = Vec::new();
    for (name, array) in arrays {
        if about::belongs_to_another(&name, &names) {
            beside.insert(name, array);
            continue;
        }
        match array.header.shape.as_slice() {
            [] | [_] if array.header.element.is_text() || array.header.shape.is_empty() => {
                contents
                    .properties
                    .extend(as_properties(&name, array.values));
            }
            [_] | [_, _] if !array.header.element.is_text() => {
                let n_series = match array.header.shape.as_slice() {
                    &[n_rows, n_columns] => n_rows.min(n_columns),
                    _ => 1,
                };
                budget.take(n_series, OF_A_SERIES, Place::Byte(0), &name)?;
                let shape = shape_text(&array.header.shape);
                let of_array = array.into_series(&name);
                if of_array.is_empty() {
                    contents
                        .properties
                        .push((name, format!("empty, shape {shape}")));
                }
                series.extend(of_array);
            }
            shape => {
                let (shape, element) = (shape_text(shape), array.header.element);
                let found = format!("of shape {shape} and element {element}");
                let expected = "numbers with at most two axes, or a text";
                let error = about::malformed(&name, found, expected);
                strictness.pass_over(error, &mut contents.defects)?;
            }
        }
    }
    about::attach(&mut beside, &mut series, &mut contents.properties)?;
    contents.series = series;
    if contents.series.is_empty() && contents.properties.is_empty() {
        return Err(contents
            .defects
            .pop()
            .unwrap_or(LabioError::NoData { format: FORMAT }));
    }
    Ok(contents)
}

/// Reads the array in the member at `index`, with its name.
fn member(
    archive: &mut ZipArchive<Cursor<&[u8]>>,
    index: usize,
    budget: &mut Budget,
) -> Result<(String, Array), LabioError> {
    let mut member = archive
        .by_index(index)
        .map_err(|error| zip_error(error, &format!("member {index}")))?;
    let full_name = member
        .name()
        .map_err(|error| zip_error(error, &format!("name of member {index}")))?
        .into_owned();
    let place = Place::Byte(member.header_start());
    // the compressed data cannot contain more than this, whatever the header announces
    let most_unpacked = usize::try_from(member.compressed_size())
        .unwrap_or(usize::MAX)
        .saturating_mul(OF_A_DEFLATED_BYTE);
    let Some(name) = full_name.strip_suffix(".npy") else {
        let (field, found) = (format!("member {index}"), text::quoted(&full_name));
        return Err(malformed(FORMAT, place, field, found, "an array, `.npy`"));
    };
    // a member is inflated as far as the header of its array states, whatever the archive states
    let mut bytes = Vec::new();
    let mut unpack = |count: u64, bytes: &mut Vec<u8>| {
        (&mut member)
            .take(count)
            .read_to_end(bytes)
            .map_err(|error| {
                let (field, found) = (text::quoted(&full_name), error.to_string());
                malformed(FORMAT, place, field, found, "a member that can be unpacked")
            })
    };
    unpack(1 << 16, &mut bytes)?;
    let part = format!("{}, ", text::quoted(&full_name));
    let header = Header::read(&bytes, FORMAT, &part)?;
    let end = header
        .data_length()
        .and_then(|data| data.checked_add(header.data_start))
        .unwrap_or(usize::MAX);
    let there = end.min(most_unpacked);
    budget.take(there, 1, place, &full_name)?;
    if there == end {
        let (count, each) = header.memory();
        budget.take(count, each, place, &full_name)?;
    }
    let missing = end.saturating_add(1).saturating_sub(bytes.len());
    unpack(missing as u64, &mut bytes)?;
    let array = Array::read(&bytes, FORMAT, &part);
    budget.give_back(there);
    Ok((name.to_owned(), array?))
}

fn zip_error(error: ZipError, field: &str) -> LabioError {
    match error {
        ZipError::Io(source) if source.kind() != std::io::ErrorKind::UnexpectedEof => {
            LabioError::Read { source }
        }
        error => {
            let found = text::quoted(&error.to_string());
            let expected = "a ZIP archive with stored or deflated members";
            malformed(FORMAT, Place::Byte(0), field, found, expected)
        }
    }
}

/// Returns single numbers and texts as properties.
fn as_properties(name: &str, values: Values) -> Vec<(String, String)> {
    let texts: Vec<String> = match values {
        Values::Real(values) => values.iter().map(|value| format!("{value}")).collect(),
        Values::Complex(values) => values.iter().map(ToString::to_string).collect(),
        Values::Text(texts) => texts,
    };
    match <[String; 1]>::try_from(texts) {
        Ok([text]) => vec![(name.to_owned(), text)],
        Err(texts) => texts
            .into_iter()
            .enumerate()
            .map(|(index, text)| (format!("{name}[{index}]"), text))
            .collect(),
    }
}

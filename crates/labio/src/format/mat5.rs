//! MATLAB files of version 5 (saved with `-v6` or `-v7`); the writer produces files as saved with
//! `-v6`.
//!
//! # Variables
//!
//! | variable | becomes |
//! |---|---|
//! | row or column of numbers `a`, real or complex, of any class | series `a` |
//! | matrix `a` | a series for each of its columns `a(:,1)`, ..., or of its rows `a(1,:)`, ... if these are longer |
//! | array of more axes | a series for each of its columns `a(:,1,1)`, ...; skipped if there are more than 256 and another axis is longer |
//! | single number or text | property of the contents |
//! | empty array | property of the contents that states this |
//! | structure `s` | its fields `s.length`; for an array of structures, `s(2).length` |
//! | cell array `c` | its cells `c{1}` |
//!
//! The abscissa is the sample index from 0, because the file does not state which variable contains
//! the times. There are two exceptions:
//!
//! - A single number with the name of a sampling rate in Hz (`fs`, `sample_rate`, `SamplingRate`,
//!   `sampling_frequency`, ...) or of an interval in s (`dt`, `sample_interval`, ...) gives the
//!   series their times, from 0. The property [`RATE_SOURCE`] names the variable. A rate below
//!   1 kHz is not used, because it may be in kHz, and neither are numbers that contradict each
//!   other, or any number in a file with complex series, which are spectra.
//! - In a file of this writer, which is recognised by its description, further variables give the
//!   abscissa, the name, the kind, and the labels and units of a series.
//!
//! The property `class` of a series names the class of the numbers if it is not `double`.
//!
//! # Rejected files
//!
//! - Files of version 4 and of version 7.3 (which are HDF5); the error names the version.
//! - Sparse matrices, objects, function handles and integers beyond $`2^{53}`$: a strict reading
//!   rejects the file; a tolerant one skips the variable with a defect. Damaged variables are
//!   treated in the same way.
//! - Contents beyond a [`MemoryLimit`], in a strict or a tolerant reading.

mod beside;
mod element;
mod matrix;
mod write;

use std::io::Read;

use flate2::read::ZlibDecoder;

use crate::error;
use crate::error::truncated;
use crate::format::matlab_array::sample_at_stated_rate;
use crate::format::memory::Budget;
use crate::format::reading::Reading;
use crate::format::{MemoryLimit, Reader, Strictness, text};
use crate::{Contents, LabioError, Place};

pub use crate::format::matlab_array::RATE_SOURCE;

use element::{Cursor, Element, Origin};

const FORMAT: &str = "mat5";

/// Bytes before the first variable.
const HEADER_BYTES: usize = 128;

/// Type of an element that contains an array; `COMPRESSED` is that of a deflated element.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;

/// Bytes of the tag of an element: its type and its length.
const TAG_BYTES: u64 = 8;

/// MATLAB files of version 5; see the [module](self).
///
/// # Examples
///
/// ```no_run
/// use labio::format::mat5::Mat5;
/// use labio::format::{Reader, Strictness};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let contents = Mat5.read(&std::fs::read("hits.mat")?, Strictness::Strict)?;
/// for series in &contents.series {
///     println!("{}: {} samples", series.name, series.ordinate.len());
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Mat5;

/// Versions of MATLAB files that can be distinguished.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Version {
    Four,
    Five { big_endian: bool },
    SevenPointThree,
}

impl Version {
    fn of(head: &[u8]) -> Option<Self> {
        match head.get(124..128) {
            Some([0x00, 0x01, b'I', b'M']) => Some(Self::Five { big_endian: false }),
            Some([0x01, 0x00, b'M', b'I']) => Some(Self::Five { big_endian: true }),
            Some([0x00, 0x02, b'I', b'M'] | [0x02, 0x00, b'M', b'I']) => {
                Some(Self::SevenPointThree)
            }
            _ => (is_version_4(head, i32::from_le_bytes, 0)
                || is_version_4(head, i32::from_be_bytes, 1))
            .then_some(Self::Four),
        }
    }
}

/// Returns true for a file of version 4, which begins with five integers that describe a variable,
/// followed by its name and a zero byte. The thousands digit of the first integer gives the byte
/// order.
fn is_version_4(head: &[u8], integer: fn([u8; 4]) -> i32, machine: i32) -> bool {
    let Some((numbers, rest)) = head.split_first_chunk::<20>() else {
        return false;
    };
    let words = numbers.as_chunks::<4>().0;
    let mut integers = words.iter().map(|&word| integer(word));
    let mut next = || integers.next().unwrap_or(-1);
    let (kind, rows, columns, imaginary, name) = (next(), next(), next(), next(), next());
    let kind_known = kind / 1000 == machine
        && kind % 1000 / 100 == 0
        && (0..=5).contains(&(kind % 100 / 10))
        && (0..=2).contains(&(kind % 10));
    let named = usize::try_from(name)
        .ok()
        .and_then(|length| rest.get(..length)?.split_last())
        .is_some_and(|(end, name)| {
            *end == 0 && !name.is_empty() && name.iter().all(u8::is_ascii_graphic)
        });
    kind_known && rows >= 0 && columns >= 0 && (0..=1).contains(&imaginary) && named
}

impl Reader for Mat5 {
    fn name(&self) -> &'static str {
        FORMAT
    }

    /// Returns true for a MATLAB file of any version, so that an unsupported one gives an error
    /// that names its version.
    fn recognises(&self, head: &[u8]) -> bool {
        Version::of(head).is_some()
    }

    fn read(&self, bytes: &[u8], strictness: Strictness) -> Result<Contents, LabioError> {
        read_within(bytes, strictness, MemoryLimit::of_file(bytes.len()))
    }
}

/// Reads a whole file whose contents may take memory up to `limit`.
///
/// # Errors
///
/// The errors of [`Mat5`] as a [`Reader`]; [`LabioError::MemoryLimit`] beyond the limit.
pub fn read_within(
    bytes: &[u8],
    strictness: Strictness,
    limit: MemoryLimit,
) -> Result<Contents, LabioError> {
    let refused = |found: String| {
        let expected = "a MATLAB file of version 5";
        malformed(Place::Byte(124), "version", found, expected)
    };
    let big_endian = match Version::of(bytes) {
        Some(Version::Five { big_endian }) => big_endian,
        Some(Version::Four) => return Err(refused("4; save it with `-v7`".to_owned())),
        Some(Version::SevenPointThree) => {
            return Err(refused("7.3, which is HDF5; save it with `-v7`".to_owned()));
        }
        None => {
            let found = bytes.get(124..HEADER_BYTES).map_or_else(
                || format!("a file of {} bytes", bytes.len()),
                |version| format!("{version:02x?}"),
            );
            return Err(refused(found));
        }
    };
    let mut reading = Reading::new(FORMAT, limit, strictness);
    let description: String = bytes.iter().take(116).copied().map(char::from).collect();
    let description = description.trim_end_matches([' ', '\0']);
    if !description.is_empty() {
        reading.property(0, "description".to_owned(), description.to_owned())?;
    }
    let (_, variables) = bytes.split_at(HEADER_BYTES);
    let mut cursor = Cursor::new(variables, Origin::File(HEADER_BYTES as u64), big_endian);
    loop {
        // after a wrong length, the next element cannot be found
        let element = match cursor.element() {
            Ok(Some(element)) => element,
            Ok(None) => break,
            Err(error) => {
                reading.pass_over(error, HEADER_BYTES as u64)?;
                break;
            }
        };
        let read = match element.kind {
            MATRIX => matrix::read(cursor.within(&element), "", 0, &mut reading),
            COMPRESSED => packed(&element, big_endian, &mut reading),
            other => Err(malformed(
                Place::Byte(element.at),
                "type of the element",
                other.to_string(),
                "an array (14) or a compressed one (15)",
            )),
        };
        if let Err(error) = read {
            reading.pass_over(error, element.at)?;
        }
    }
    if description.starts_with(beside::OF_WRITER) {
        beside::join(&mut reading.contents);
    } else {
        sample_at_stated_rate(&mut reading.contents);
    }
    Ok(reading.contents)
}

/// Reads a deflated array.
fn packed(
    element: &Element<'_>,
    big_endian: bool,
    reading: &mut Reading,
) -> Result<(), LabioError> {
    let unpacked = unpack(element.data, element.at, big_endian, &mut reading.budget)?;
    let inner = Cursor::new(&unpacked, Origin::Packed(element.at), big_endian);
    let read = matrix::read(inner, "", 0, reading);
    reading.budget.give_back(unpacked.len());
    read
}

/// Inflates the body of an array, to the length stated in its tag. `budget` counts the bytes
/// produced.
fn unpack(
    deflated: &[u8],
    at: u64,
    big_endian: bool,
    budget: &mut Budget,
) -> Result<Vec<u8>, LabioError> {
    let mut inflated = ZlibDecoder::new(deflated);
    let failed = |error: std::io::Error| {
        let found = text::quoted(&error.to_string());
        malformed(
            Place::Byte(at),
            "compressed element",
            found,
            "deflated bytes",
        )
    };
    let mut tag = [0; 8];
    inflated.read_exact(&mut tag).map_err(failed)?;
    let [a, b, c, d, e, f, g, h] = tag;
    let word = |bytes| match big_endian {
        true => u32::from_be_bytes(bytes),
        false => u32::from_le_bytes(bytes),
    };
    let (kind, length) = (word([a, b, c, d]), word([e, f, g, h]));
    if kind != MATRIX {
        let (field, found) = ("type of the compressed element", kind.to_string());
        return Err(malformed(Place::Byte(at), field, found, "an array (14)"));
    }
    let length = length as usize;
    let mut body = Vec::new();
    let mut part = [0; 1 << 14];
    while body.len() < length {
        let n_wanted = (length - body.len()).min(part.len());
        let (room, _) = part.split_at_mut(n_wanted);
        let n = inflated.read(room).map_err(failed)?;
        let (new, _) = room.split_at(n);
        if new.is_empty() {
            budget.give_back(body.len());
            return Err(truncated(FORMAT, length - body.len()));
        }
        budget.take(n, 1, Place::Byte(at), "a compressed array")?;
        body.extend_from_slice(new);
    }
    Ok(body)
}

fn malformed(place: Place, field: &str, found: String, expected: &str) -> LabioError {
    error::malformed(FORMAT, place, field, found, expected)
}

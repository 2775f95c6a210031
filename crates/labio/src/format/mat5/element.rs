//! Elements of a MATLAB file: type, length and bytes.

use super::{FORMAT, malformed};
use crate::error::truncated;
use crate::format::number_type::{NumberType, utf32};
use crate::unit::EXACT_INTEGERS;
use crate::{LabioError, Place};

/// Origin of the bytes, for error messages.
#[derive(Debug, Clone, Copy)]
pub(super) enum Origin {
    /// The file, from this byte on.
    File(u64),
    /// Inflated from the element at this byte.
    Packed(u64),
}

/// One element.
#[derive(Debug, Clone, Copy)]
pub(super) struct Element<'a> {
    pub(super) kind: u32,
    pub(super) data: &'a [u8],
    /// Position of its tag.
    pub(super) at: u64,
    pub(super) big_endian: bool,
}

/// A sequence of elements.
#[derive(Debug, Clone)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    origin: Origin,
    big_endian: bool,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8], origin: Origin, big_endian: bool) -> Self {
        Self {
            bytes,
            at: 0,
            origin,
            big_endian,
        }
    }

    /// Returns a cursor over the elements within `element`.
    pub(super) fn within(&self, element: &Element<'a>) -> Self {
        let origin = match self.origin {
            Origin::File(_) => Origin::File(element.at + super::TAG_BYTES),
            packed => packed,
        };
        Self::new(element.data, origin, self.big_endian)
    }

    /// Returns the offset in the file at which the next element begins, or the offset of the
    /// element from which it was inflated.
    pub(super) fn offset(&self) -> u64 {
        match self.origin {
            Origin::File(start) => start + self.at as u64,
            Origin::Packed(at) => at,
        }
    }

    fn word(&self, at: usize) -> Option<u32> {
        let bytes = *self.bytes.get(at..)?.first_chunk::<4>()?;
        Some(match self.big_endian {
            true => u32::from_be_bytes(bytes),
            false => u32::from_le_bytes(bytes),
        })
    }

    /// Returns the next element, or `None` at the end.
    pub(super) fn element(&mut self) -> Result<Option<Element<'a>>, LabioError> {
        let at = self.offset();
        if self.at >= self.bytes.len() {
            return Ok(None);
        }
        let truncated = |missing_bytes| truncated(FORMAT, missing_bytes);
        let left = self.bytes.len() - self.at;
        let (Some(first), Some(second)) = (self.word(self.at), self.word(self.at + 4)) else {
            return Err(truncated(8 - left.min(8)));
        };
        // a small element has its length and its bytes within the tag
        let (kind, start, length, padded) = match first >> 16 {
            0 => {
                let length = usize::try_from(second).unwrap_or(usize::MAX);
                let padded = match first {
                    super::COMPRESSED => length,
                    _ => length.checked_next_multiple_of(8).unwrap_or(usize::MAX),
                };
                (first, self.at + 8, length, padded)
            }
            length @ 1..=4 => (first & 0xffff, self.at + 4, length as usize, 4),
            length => {
                let (field, found) = ("length of a small element", length.to_string());
                return Err(malformed(Place::Byte(at), field, found, "at most 4 bytes"));
            }
        };
        let end = start.saturating_add(length);
        let Some(data) = self.bytes.get(start..end) else {
            return Err(truncated(end - self.bytes.len()));
        };
        self.at = start.saturating_add(padded);
        Ok(Some(Element {
            kind,
            data,
            at,
            big_endian: self.big_endian,
        }))
    }

    /// Reads the next element, which must exist; `what` names it in the error.
    pub(super) fn expect(&mut self, what: &str) -> Result<Element<'a>, LabioError> {
        let at = self.offset();
        self.element()?.ok_or_else(|| {
            let found = "the end of the array".to_owned();
            malformed(Place::Byte(at), what, found, "an element")
        })
    }
}

impl Element<'_> {
    fn malformed(&self, field: &str, found: String, expected: &str) -> LabioError {
        malformed(Place::Byte(self.at), field, found, expected)
    }

    /// Returns the numbers, whatever their stored type.
    pub(super) fn numbers(&self, field: &str) -> Result<Vec<f64>, LabioError> {
        let kind = match self.kind {
            1 => NumberType::I8,
            2 => NumberType::U8,
            3 => NumberType::I16,
            4 => NumberType::U16,
            5 => NumberType::I32,
            6 => NumberType::U32,
            7 => NumberType::F32,
            9 => NumberType::F64,
            12 => NumberType::I64,
            13 => NumberType::U64,
            other => return Err(self.malformed(field, format!("of type {other}"), "numbers")),
        };
        if !self.data.len().is_multiple_of(kind.size()) {
            let found = format!("{} bytes", self.data.len());
            return Err(self.malformed(field, found, "a multiple of the size of its type"));
        }
        let values = kind.numbers(self.data, self.big_endian);
        let inexact = values.iter().find(|value| value.abs() >= EXACT_INTEGERS);
        match inexact.filter(|_| matches!(self.kind, 12 | 13)) {
            Some(value) => Err(self.malformed(
                field,
                format!("{value}"),
                "integers that a double represents exactly",
            )),
            None => Ok(values),
        }
    }

    /// Returns the characters, whatever their stored type.
    pub(super) fn characters(&self, field: &str) -> Result<Vec<char>, LabioError> {
        let wrong = || self.malformed(field, format!("of type {}", self.kind), "characters");
        match self.kind {
            1 | 2 => Ok(self.data.iter().copied().map(char::from).collect()),
            4 | 17 => {
                let (units, rest) = self.data.as_chunks::<2>();
                if !rest.is_empty() {
                    return Err(wrong());
                }
                let units = units.iter().map(|&unit| match self.big_endian {
                    true => u16::from_be_bytes(unit),
                    false => u16::from_le_bytes(unit),
                });
                char::decode_utf16(units)
                    .collect::<Result<_, _>>()
                    .map_err(|_| wrong())
            }
            16 => Ok(std::str::from_utf8(self.data)
                .map_err(|_| wrong())?
                .chars()
                .collect()),
            18 => utf32(self.data, self.big_endian)
                .filter(|_| self.data.len().is_multiple_of(4))
                .ok_or_else(wrong),
            _ => Err(wrong()),
        }
    }
}

//! The header of an array: element type, memory order and shape.

use std::fmt;

use crate::error::{malformed, truncated};
use crate::format::text;
use crate::{LabioError, Place};

pub(in crate::format) const MAGIC: &[u8] = b"\x93NUMPY";

/// Type of the numbers, without their byte order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::format) enum Kind {
    Float,
    Signed,
    Unsigned,
    Complex,
    Boolean,
    /// Characters of four bytes.
    Wide,
    /// Characters of one byte.
    Narrow,
}

/// One number or text of the array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::format) struct Element {
    pub(in crate::format) kind: Kind,
    pub(in crate::format) bytes: usize,
    pub(in crate::format) big_endian: bool,
}

impl Element {
    pub(in crate::format) const F64: Self = Self {
        kind: Kind::Float,
        bytes: 8,
        big_endian: false,
    };
    pub(in crate::format) const C128: Self = Self {
        kind: Kind::Complex,
        bytes: 16,
        big_endian: false,
    };

    pub(in crate::format) fn parse(descr: &str) -> Option<Self> {
        let (order, rest) = descr.split_at_checked(1)?;
        let big_endian = match order {
            "<" | "|" | "=" => false,
            ">" => true,
            _ => return None,
        };
        let (kind, size) = rest.split_at_checked(1)?;
        let size: usize = size.parse().ok()?;
        let (kind, bytes) = match (kind, size) {
            ("f", 4 | 8) => (Kind::Float, size),
            ("i", 1 | 2 | 4 | 8) => (Kind::Signed, size),
            ("u", 1 | 2 | 4 | 8) => (Kind::Unsigned, size),
            ("c", 8 | 16) => (Kind::Complex, size),
            ("b", 1) => (Kind::Boolean, size),
            ("U", 1..) => (Kind::Wide, size.checked_mul(4)?),
            ("S", 1..) => (Kind::Narrow, size),
            _ => return None,
        };
        Some(Self {
            kind,
            bytes,
            big_endian,
        })
    }

    pub(in crate::format) fn is_text(self) -> bool {
        matches!(self.kind, Kind::Wide | Kind::Narrow)
    }
}

impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (letter, size) = match self.kind {
            Kind::Float => ('f', self.bytes),
            Kind::Signed => ('i', self.bytes),
            Kind::Unsigned => ('u', self.bytes),
            Kind::Complex => ('c', self.bytes),
            Kind::Boolean => ('b', self.bytes),
            Kind::Wide => ('U', self.bytes / 4),
            Kind::Narrow => ('S', self.bytes),
        };
        let order = match (self.bytes, self.kind, self.big_endian) {
            (1, ..) | (_, Kind::Narrow, _) => '|',
            (_, _, true) => '>',
            (_, _, false) => '<',
        };
        write!(f, "{order}{letter}{size}")
    }
}

/// The header before the numbers of an array.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::format) struct Header {
    pub(in crate::format) element: Element,
    pub(in crate::format) fortran_order: bool,
    pub(in crate::format) shape: Vec<usize>,
    /// Offset of the first byte of the numbers.
    pub(in crate::format) data_start: usize,
}

impl Header {
    /// Reads the header at the beginning of `bytes`; `part` names the array in errors.
    pub(in crate::format) fn read(
        bytes: &[u8],
        format: &'static str,
        part: &str,
    ) -> Result<Self, LabioError> {
        let malformed = |place: usize, field: &str, found: String, expected: &str| {
            let place = Place::Byte(place as u64);
            Err(malformed(
                format,
                place,
                format!("{part}{field}"),
                found,
                expected,
            ))
        };
        let Some(rest) = bytes.strip_prefix(MAGIC) else {
            let start = bytes.get(..MAGIC.len().min(bytes.len())).unwrap_or(&[]);
            let found = text::quoted(&String::from_utf8_lossy(start));
            return malformed(0, "first six bytes", found, "those of a NumPy array");
        };
        let (text_start, length) = match rest {
            [1, _, a, b, ..] => (10, usize::from(u16::from_le_bytes([*a, *b]))),
            [2 | 3, _, a, b, c, d, ..] => (
                12,
                usize::try_from(u32::from_le_bytes([*a, *b, *c, *d])).unwrap_or(usize::MAX),
            ),
            [version, _, _, _, _, _, ..] => {
                return malformed(6, "version", version.to_string(), "1, 2 or 3");
            }
            _ => {
                return Err(truncated(format, 12 - bytes.len().min(12)));
            }
        };
        let data_start = length.saturating_add(text_start);
        let Some(literal) = bytes.get(text_start..data_start) else {
            return Err(truncated(format, data_start - bytes.len()));
        };
        let mut scanner = Scanner {
            bytes: literal,
            at: 0,
        };
        match scanner.dictionary() {
            Ok((descr, fortran_order, shape)) => match Element::parse(&descr) {
                Some(element) => Ok(Self {
                    element,
                    fortran_order,
                    shape,
                    data_start,
                }),
                None => malformed(
                    text_start,
                    "descr",
                    text::quoted(&descr),
                    if descr.ends_with("f2") {
                        "another type of numbers: half floats are not read, save as float32"
                    } else {
                        "integers, floating-point or complex numbers, or characters"
                    },
                ),
            },
            Err(expected) => {
                let found = String::from_utf8_lossy(literal.get(scanner.at..).unwrap_or(&[]));
                malformed(
                    text_start + scanner.at,
                    "header",
                    text::quoted(found.trim_end()),
                    expected,
                )
            }
        }
    }

    /// Number of bytes of all numbers, `None` on overflow.
    pub(in crate::format) fn data_length(&self) -> Option<usize> {
        self.shape
            .iter()
            .try_fold(self.element.bytes, |product, &n| product.checked_mul(n))
    }

    /// Returns the number of elements, and the memory that each takes after reading.
    pub(in crate::format) fn memory(&self) -> (usize, usize) {
        let count = self
            .shape
            .iter()
            .try_fold(1_usize, |product, &n| product.checked_mul(n));
        // an entry in a list and the smallest allocation
        let text = size_of::<String>() + 16;
        let bytes = self.element.bytes;
        let each = match self.element.kind {
            Kind::Wide => bytes.saturating_add(text),
            // a Latin-1 character may take two bytes
            Kind::Narrow => bytes.saturating_mul(2).saturating_add(text),
            Kind::Complex => 16,
            Kind::Float | Kind::Signed | Kind::Unsigned | Kind::Boolean => 8,
        };
        (count.unwrap_or(usize::MAX), each)
    }

    /// Writes the header as `NumPy` does: trailing blanks leave room for a longer first axis and
    /// align the numbers to a multiple of 64 bytes.
    pub(in crate::format) fn write(&self) -> Vec<u8> {
        let axes: Vec<String> = self.shape.iter().map(usize::to_string).collect();
        let growing = match self.fortran_order {
            true => axes.last(),
            false => axes.first(),
        };
        let room = growing.map_or(0, |axis| 21_usize.saturating_sub(axis.len()));
        let fortran = if self.fortran_order { "True" } else { "False" };
        let mut text = format!(
            "{{'descr': '{}', 'fortran_order': {fortran}, 'shape': {}, }}{}",
            self.element,
            shape_text(&self.shape),
            " ".repeat(room)
        );
        while !(MAGIC.len() + 4 + text.len() + 1).is_multiple_of(64) {
            text.push(' ');
        }
        text.push('\n');
        let mut bytes = MAGIC.to_vec();
        bytes.extend([1, 0]);
        // the header of two axes and an element is far shorter than the field for its length allows
        bytes.extend(u16::try_from(text.len()).unwrap_or(u16::MAX).to_le_bytes());
        bytes.extend(text.bytes());
        bytes
    }
}

/// The shape as Python writes a tuple.
pub(in crate::format) fn shape_text(shape: &[usize]) -> String {
    match shape {
        [n] => format!("({n},)"),
        _ => {
            let axes: Vec<String> = shape.iter().map(usize::to_string).collect();
            format!("({})", axes.join(", "))
        }
    }
}

/// Reads the literal of a dictionary; an error states what was expected at `at`.
struct Scanner<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Scanner<'_> {
    fn peek(&mut self) -> Option<u8> {
        while self.bytes.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
        self.bytes.get(self.at).copied()
    }

    fn sign(&mut self, sign: u8, expected: &'static str) -> Result<(), &'static str> {
        if self.peek() == Some(sign) {
            self.at += 1;
            return Ok(());
        }
        Err(expected)
    }

    fn take(&mut self, sign: u8) -> bool {
        self.sign(sign, "").is_ok()
    }

    fn string(&mut self) -> Result<String, &'static str> {
        let quote = match self.peek() {
            Some(quote @ (b'\'' | b'"')) => quote,
            _ => return Err("a text in quotes"),
        };
        let rest = self.bytes.get(self.at + 1..).unwrap_or(&[]);
        let length = rest
            .iter()
            .position(|&byte| byte == quote)
            .ok_or("the end of a text in quotes")?;
        self.at += length + 2;
        Ok(String::from_utf8_lossy(rest.get(..length).unwrap_or(&[])).into_owned())
    }

    fn word(&mut self, word: &str) -> bool {
        self.peek();
        let found = self
            .bytes
            .get(self.at..)
            .is_some_and(|rest| rest.starts_with(word.as_bytes()));
        if found {
            self.at += word.len();
        }
        found
    }

    fn number(&mut self) -> Result<usize, &'static str> {
        self.peek();
        let rest = self.bytes.get(self.at..).unwrap_or(&[]);
        let length = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
        let number = std::str::from_utf8(rest.get(..length).unwrap_or(&[]))
            .ok()
            .and_then(|digits| digits.parse().ok())
            .ok_or("a length of an axis")?;
        self.at += length;
        Ok(number)
    }

    fn shape(&mut self) -> Result<Vec<usize>, &'static str> {
        self.sign(b'(', "a shape in parentheses")?;
        let mut shape = Vec::new();
        while !self.take(b')') {
            shape.push(self.number()?);
            if !self.take(b',') && self.peek() != Some(b')') {
                return Err("`,` or `)`");
            }
        }
        Ok(shape)
    }

    fn dictionary(&mut self) -> Result<(String, bool, Vec<usize>), &'static str> {
        self.sign(b'{', "`{`")?;
        let (mut descr, mut fortran_order, mut shape) = (None, None, None);
        while !self.take(b'}') {
            let key_at = self.at;
            let key = self.string()?;
            self.sign(b':', "`:`")?;
            match key.as_str() {
                "descr" if self.peek() == Some(b'[') => {
                    return Err("a single element type, not a structured one");
                }
                "descr" => descr = Some(self.string()?),
                "fortran_order" => {
                    fortran_order = Some(match (self.word("True"), self.word("False")) {
                        (true, _) => true,
                        (_, true) => false,
                        _ => return Err("`True` or `False`"),
                    });
                }
                "shape" => shape = Some(self.shape()?),
                _ => {
                    self.at = key_at;
                    return Err("`descr`, `fortran_order` or `shape`");
                }
            }
            if !self.take(b',') && self.peek() != Some(b'}') {
                return Err("`,` or `}`");
            }
        }
        if self.peek().is_some() {
            return Err("the end of the header");
        }
        Ok((
            descr.ok_or("`descr` in the dictionary")?,
            fortran_order.ok_or("`fortran_order` in the dictionary")?,
            shape.ok_or("`shape` in the dictionary")?,
        ))
    }
}

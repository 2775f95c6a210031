//! Lines of bytes, with the place of each.

use std::borrow::Cow;

use crate::Place;

/// A line without its end, and its place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) place: Place,
}

impl Line<'_> {
    pub(super) fn is_blank(&self) -> bool {
        const END_OF_TEXT_IN_DOS: u8 = 0x1a;
        let mut bytes = self.bytes.iter();
        bytes.all(|byte| byte.is_ascii_whitespace() || *byte == END_OF_TEXT_IN_DOS)
    }

    /// Returns true for the line `    -1` before and after each data set: -1 in the first six
    /// columns, then blanks. A -1 in other columns belongs to a data set.
    pub(super) fn is_separator(&self) -> bool {
        let (first, rest) = self.bytes.split_at(self.bytes.len().min(6));
        first.trim_ascii() == b"-1" && rest.trim_ascii().is_empty()
    }
}

/// Reads bytes line by line; LF and CR LF end a line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lines<'a> {
    bytes: &'a [u8],
    position: usize,
    number: u64,
    /// True if lines can no longer be counted because a block of bytes without lines came before.
    after_bytes: bool,
}

impl<'a> Lines<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self {
            bytes,
            position: 0,
            number: 0,
            after_bytes: false,
        }
    }

    /// Returns the place of the next byte.
    pub(super) fn byte(&self) -> Place {
        Place::Byte(self.position as u64)
    }

    /// Returns the place of the next line: its line number or, after a block without lines, the
    /// offset of its first byte.
    pub(super) fn place(&self) -> Place {
        if self.after_bytes {
            self.byte()
        } else {
            Place::Line(self.number + 1)
        }
    }

    /// Returns all bytes that have not been read.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.position..).unwrap_or_default()
    }

    pub(super) fn next_line(&mut self) -> Option<Line<'a>> {
        let rest = self.rest();
        if rest.is_empty() {
            return None;
        }
        let place = self.place();
        let (line, consumed) = match rest.iter().position(|&byte| byte == b'\n') {
            Some(end) => (rest.get(..end)?, end + 1),
            None => (rest, rest.len()),
        };
        self.position += consumed;
        self.number += 1;
        let end = line
            .iter()
            .rposition(|&byte| byte != b'\r')
            .map_or(0, |last| last + 1);
        Some(Line {
            bytes: line.get(..end)?,
            place,
        })
    }

    pub(super) fn peek_line(&self) -> Option<Line<'a>> {
        let mut ahead = *self;
        ahead.next_line()
    }

    /// Returns the next line if it has exactly `width` columns before its end, without searching
    /// for the end.
    #[inline]
    pub(super) fn next_line_of(&mut self, width: usize) -> Option<&'a [u8]> {
        let rest = self.rest();
        let (line, end) = rest.split_at_checked(width)?;
        let consumed = match end {
            [b'\n', ..] => width + 1,
            [b'\r', b'\n', ..] => width + 2,
            _ => return None,
        };
        self.position += consumed;
        self.number += 1;
        Some(line)
    }

    /// Reads `n` bytes that are not divided into lines.
    pub(super) fn take_bytes(&mut self, n: usize) -> Option<&'a [u8]> {
        let taken = self.rest().get(..n)?;
        self.position += n;
        self.after_bytes = true;
        Some(taken)
    }

    /// Advances past the next separator; returns false if there is none.
    pub(super) fn skip_past_separator(&mut self) -> bool {
        while let Some(line) = self.next_line() {
            if line.is_separator() {
                return true;
            }
        }
        false
    }
}

/// Decodes the characters of a line: UTF-8 if valid, else Latin-1, in which every byte is a
/// character.
pub(super) fn decode(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(bytes.iter().map(|&byte| char::from(byte)).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_of_lines_are_understood() {
        let mut lines = Lines::new(b"one\r\ntwo\n\r\r\nlast");
        let mut found = Vec::new();
        while let Some(line) = lines.next_line() {
            found.push((line.place, String::from_utf8(line.bytes.to_vec()).unwrap()));
        }
        let expected = [(1, "one"), (2, "two"), (3, ""), (4, "last")]
            .map(|(n, t)| (Place::Line(n), t.to_owned()));
        assert_eq!(found, expected);
    }

    #[test]
    fn a_separator_is_minus_one_in_the_first_six_columns_alone() {
        let is = |text: &str| {
            Lines::new(text.as_bytes())
                .next_line()
                .unwrap()
                .is_separator()
        };
        assert!(is("    -1"));
        assert!(is("    -1\r\n"));
        assert!(is(&format!("    -1{}", " ".repeat(74))));
        assert!(!is("        -1"));
        assert!(!is("    -1         2"));
        assert!(!is("    -10"));
        assert!(!is("\n"));
    }

    #[test]
    fn a_byte_that_is_no_utf8_makes_the_line_latin_1() {
        assert_eq!(decode(b"m/s\xb2"), "m/s\u{b2}");
        assert_eq!(decode("m/s\u{b2}".as_bytes()), "m/s\u{b2}");
    }
}

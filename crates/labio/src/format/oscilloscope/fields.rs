//! Header fields at fixed offsets.

use crate::error::malformed;
use crate::{LabioError, Place};

/// A part of a file whose fields have fixed offsets.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fields<'a> {
    pub(super) format: &'static str,
    pub(super) bytes: &'a [u8],
    /// Offset of the first byte in the file.
    pub(super) offset: usize,
    pub(super) big_endian: bool,
}

macro_rules! number {
    ($name:ident, $kind:ty) => {
        pub(super) fn $name(&self, at: usize, field: &str) -> Result<$kind, LabioError> {
            let bytes = self.array(at, field)?;
            Ok(if self.big_endian {
                <$kind>::from_be_bytes(bytes)
            } else {
                <$kind>::from_le_bytes(bytes)
            })
        }
    };
}

impl<'a> Fields<'a> {
    number!(u16, u16);
    number!(i32, i32);
    number!(f32, f32);
    number!(f64, f64);

    fn array<const N: usize>(&self, at: usize, field: &str) -> Result<[u8; N], LabioError> {
        let found = self
            .bytes
            .get(at..)
            .and_then(|rest| rest.first_chunk::<N>());
        found.copied().ok_or_else(|| {
            let end = format!("the end of the file after {} bytes", self.bytes.len());
            self.wrong(at, field, end, "a whole header")
        })
    }

    /// Reads a length or a count, which must not be negative.
    pub(super) fn count(&self, at: usize, field: &str) -> Result<usize, LabioError> {
        let found = self.i32(at, field)?;
        usize::try_from(found)
            .map_err(|_| self.wrong(at, field, found.to_string(), "a number not below 0"))
    }

    /// Accepts a finite number other than 0.
    pub(super) fn step(&self, value: f64, at: usize, field: &str) -> Result<f64, LabioError> {
        if value.is_finite() && value != 0.0 {
            return Ok(value);
        }
        Err(self.wrong(at, field, value.to_string(), "a finite number other than 0"))
    }

    /// Reads a text of at most `n` bytes, which ends earlier at a zero byte.
    pub(super) fn text(&self, at: usize, n: usize) -> String {
        let bytes = self.bytes.get(at..at + n).unwrap_or(&[]);
        let text: String = bytes
            .iter()
            .take_while(|&&byte| byte != 0)
            .map(|&byte| char::from(byte))
            .collect();
        text.trim().to_owned()
    }

    /// Returns the bytes of `count` samples of `each` bytes, starting at `at`, and the number of
    /// missing bytes.
    pub(super) fn samples(&self, at: usize, count: usize, each: usize) -> (&'a [u8], usize) {
        let rest = self.bytes.get(at..).unwrap_or(&[]);
        let wanted = count.saturating_mul(each);
        let there = rest.len().min(wanted) / each.max(1) * each;
        (
            rest.get(..there).unwrap_or(&[]),
            wanted - rest.len().min(wanted),
        )
    }

    pub(super) fn wrong(
        &self,
        at: usize,
        field: &str,
        found: String,
        expected: &str,
    ) -> LabioError {
        let place = Place::Byte((self.offset + at) as u64);
        malformed(self.format, place, field, found, expected)
    }
}

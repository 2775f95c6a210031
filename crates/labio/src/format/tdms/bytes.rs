//! Reading of bytes from front to back in either byte order, with the offset of each byte.

use super::malformed;
use crate::{LabioError, Place};

/// A part of the file that is read from front to back.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bytes<'a> {
    rest: &'a [u8],
    /// Offset of the first byte of `rest` in the file.
    offset: usize,
    big_endian: bool,
}

macro_rules! number {
    ($name:ident, $kind:ty) => {
        pub(super) fn $name(&mut self, field: &str) -> Result<$kind, LabioError> {
            let bytes = self.array(field)?;
            Ok(if self.big_endian {
                <$kind>::from_be_bytes(bytes)
            } else {
                <$kind>::from_le_bytes(bytes)
            })
        }
    };
}

impl<'a> Bytes<'a> {
    pub(super) fn new(rest: &'a [u8], offset: usize, big_endian: bool) -> Self {
        Self {
            rest,
            offset,
            big_endian,
        }
    }

    /// Returns the same bytes in another byte order.
    pub(super) fn in_order(self, big_endian: bool) -> Self {
        Self { big_endian, ..self }
    }

    pub(super) fn place(&self) -> Place {
        Place::Byte(self.offset as u64)
    }

    pub(super) fn is_big_endian(&self) -> bool {
        self.big_endian
    }

    pub(super) fn len(&self) -> usize {
        self.rest.len()
    }

    pub(super) fn take(&mut self, n: usize, field: &str) -> Result<&'a [u8], LabioError> {
        match self.rest.split_at_checked(n) {
            Some((taken, rest)) => {
                self.rest = rest;
                self.offset += n;
                Ok(taken)
            }
            None => Err(malformed(
                self.place(),
                field,
                format!("cut after {} bytes", self.rest.len()),
                format!("{n} bytes"),
            )),
        }
    }

    fn array<const N: usize>(&mut self, field: &str) -> Result<[u8; N], LabioError> {
        let (bytes, _) = self.take(N, field)?.as_chunks::<N>();
        // `take` gave exactly N bytes
        Ok(bytes.first().copied().unwrap_or([0; N]))
    }

    number!(u8, u8);
    number!(i8, i8);
    number!(u16, u16);
    number!(i16, i16);
    number!(u32, u32);
    number!(i32, i32);
    number!(u64, u64);
    number!(i64, i64);
    number!(f32, f32);
    number!(f64, f64);

    /// Reads a text preceded by its length.
    pub(super) fn text(&mut self, field: &str) -> Result<&'a str, LabioError> {
        let place = self.place();
        let n = self.u32(field)?;
        let n_bytes = usize::try_from(n).unwrap_or(usize::MAX);
        let bytes = self.take(n_bytes, field)?;
        std::str::from_utf8(bytes).map_err(|error| {
            malformed(
                place,
                field,
                format!(
                    "a text whose byte {} is not valid UTF-8",
                    error.valid_up_to()
                ),
                "UTF-8",
            )
        })
    }
}

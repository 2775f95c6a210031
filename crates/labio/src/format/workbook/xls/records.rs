//! Records of a workbook, and the texts in them.

use super::{cut_off, of};
use crate::format::memory::Budget;
use crate::{LabioError, Place};

/// Returns the bytes at offset `at`.
pub(super) fn bytes<const N: usize>(data: &[u8], at: usize) -> Result<[u8; N], LabioError> {
    let found = data.get(at..at.saturating_add(N));
    found
        .and_then(|found| found.try_into().ok())
        .ok_or_else(cut_off)
}

/// Returns the two-byte number at offset `at`.
pub(super) fn number(data: &[u8], at: usize) -> Result<u16, LabioError> {
    Ok(u16::from_le_bytes(bytes(data, at)?))
}

/// A record of the stream.
pub(super) struct Record<'a> {
    pub(super) kind: u16,
    pub(super) data: &'a [u8],
    /// Offset of the next record.
    end: usize,
}

/// Returns the records of a substream from `begin` to its end.
pub(super) fn records(
    stream: &[u8],
    begin: usize,
) -> impl Iterator<Item = Result<Record<'_>, LabioError>> {
    let one = |at: usize| -> Result<Record<'_>, LabioError> {
        let (kind, length) = (number(stream, at)?, number(stream, at.saturating_add(2))?);
        let end = at.saturating_add(4 + usize::from(length));
        let data = stream.get(end - usize::from(length)..end);
        let data = data.ok_or_else(cut_off)?;
        Ok(Record { kind, data, end })
    };
    let (mut at, mut depth) = (Some(begin), 0_u32);
    std::iter::from_fn(move || {
        let found = one(at?);
        at = found.as_ref().ok().and_then(|record| {
            match record.kind {
                of::BEGIN => depth += 1,
                of::END => depth = depth.saturating_sub(1),
                _ => {}
            }
            (depth > 0).then_some(record.end)
        });
        Some(found)
    })
}

/// Place and style of a cell.
#[derive(Clone, Copy)]
pub(super) struct Cell {
    pub(super) row: u16,
    pub(super) column: u16,
    pub(super) style: u16,
}

impl Cell {
    /// Number of columns of a worksheet.
    pub(super) const COLUMNS: u16 = 256;

    pub(super) fn of(data: &[u8]) -> Result<Self, LabioError> {
        let column = number(data, 2)?;
        if column >= Self::COLUMNS {
            return Err(cut_off());
        }
        Ok(Self {
            row: number(data, 0)?,
            column,
            style: number(data, 4)?,
        })
    }
}

/// Reads a text preceded by its length in one byte.
pub(super) fn short_text(data: &[u8]) -> Result<String, LabioError> {
    let [length, flags] = bytes(data, 0)?;
    let mut parts = Parts {
        parts: vec![data],
        at: 2,
    };
    parts.signs(usize::from(length), flags & 1 != 0)
}

/// Reads a text preceded by its length in two bytes.
pub(super) fn text(data: &[u8]) -> Result<String, LabioError> {
    let mut parts = Parts {
        parts: vec![data],
        at: 0,
    };
    parts.text()
}

/// The texts that cells refer to, in one record and the records that continue it.
#[derive(Default)]
pub(super) struct SharedTexts<'a> {
    parts: Vec<&'a [u8]>,
    open: bool,
}

impl<'a> SharedTexts<'a> {
    pub(super) fn take(&mut self, kind: u16, data: &'a [u8]) {
        self.open = kind == of::SHARED_TEXTS || (self.open && kind == of::CONTINUE);
        if self.open {
            self.parts.push(data);
        }
    }

    pub(super) fn read(mut self, budget: &mut Budget) -> Result<Vec<String>, LabioError> {
        if self.parts.is_empty() {
            return Ok(Vec::new());
        }
        self.parts.reverse();
        let mut parts = Parts {
            parts: self.parts,
            at: 4,
        };
        let announced = u32::from_le_bytes(bytes(parts.part(), 4)?);
        parts.at = 8;
        let mut texts = Vec::new();
        for _ in 0..announced {
            let text = parts.text()?;
            budget.take(1, text.len() + size_of::<String>(), Place::Byte(0), "texts")?;
            texts.push(text);
        }
        Ok(texts)
    }
}

/// Data of records that continue each other, the last record first.
struct Parts<'a> {
    parts: Vec<&'a [u8]>,
    at: usize,
}

impl<'a> Parts<'a> {
    fn part(&self) -> &'a [u8] {
        self.parts.last().copied().unwrap_or(&[])
    }

    /// Advances to the next record if the current one is at its end.
    fn turn(&mut self) -> Result<bool, LabioError> {
        if self.at < self.part().len() {
            return Ok(false);
        }
        self.parts.pop();
        self.at = 0;
        match self.part() {
            [] => Err(cut_off()),
            _ => Ok(true),
        }
    }

    fn taken<const N: usize>(&mut self) -> Result<[u8; N], LabioError> {
        self.turn()?;
        let found = bytes(self.part(), self.at)?;
        self.at += N;
        Ok(found)
    }

    fn skip(&mut self, mut n: usize) -> Result<(), LabioError> {
        while n > 0 {
            self.turn()?;
            let here = n.min(self.part().len() - self.at);
            self.at += here;
            n -= here;
        }
        Ok(())
    }

    fn text(&mut self) -> Result<String, LabioError> {
        let length = u16::from_le_bytes(self.taken()?);
        let [flags] = self.taken()?;
        let runs = if flags & 8 == 0 {
            0
        } else {
            u16::from_le_bytes(self.taken()?)
        };
        let phonetic = if flags & 4 == 0 {
            0
        } else {
            u32::from_le_bytes(self.taken()?)
        };
        let text = self.signs(usize::from(length), flags & 1 != 0)?;
        self.skip(4 * usize::from(runs))?;
        self.skip(phonetic as usize)?;
        Ok(text)
    }

    /// Reads characters of one or two bytes; each continuation record states again which size it
    /// uses.
    fn signs(&mut self, length: usize, mut wide: bool) -> Result<String, LabioError> {
        let mut signs = Vec::new();
        for _ in 0..length {
            if self.turn()? {
                let [flags] = self.taken()?;
                wide = flags & 1 != 0;
            }
            signs.push(if wide {
                u16::from_le_bytes(self.taken()?)
            } else {
                let [sign] = self.taken()?;
                u16::from(sign)
            });
        }
        Ok(String::from_utf16_lossy(&signs))
    }
}

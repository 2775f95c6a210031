//! The stream of the workbook in a compound file ([MS-CFB]).

use super::records::{bytes, number};
use super::{cut_off, refused};
use crate::LabioError;

/// Sector number that ends a chain; `NONE` is the lowest of the numbers reserved for special
/// purposes.
const END: u32 = 0xffff_fffe;
const NONE: u32 = 0xffff_fffa;
/// Length of a directory entry in bytes.
const ENTRY: usize = 128;
/// Sector size of small streams in bytes.
const SMALL: usize = 64;

/// Sectors of equal size, with the table that gives the next sector of each.
struct Sectors<'a> {
    data: &'a [u8],
    size: usize,
    next: Vec<u32>,
}

impl Sectors<'_> {
    fn sector(&self, index: u32) -> Result<&[u8], LabioError> {
        let begin = (index as usize)
            .checked_mul(self.size)
            .ok_or_else(cut_off)?;
        // the last sector of a file may be shorter
        let end = self.data.len().min(begin.saturating_add(self.size));
        self.data
            .get(begin..end)
            .filter(|s| !s.is_empty())
            .ok_or_else(cut_off)
    }

    /// Returns the bytes of a chain, which is not longer than the file.
    fn chain(&self, first: u32) -> Result<Vec<u8>, LabioError> {
        let (mut at, mut all) = (first, Vec::new());
        while at != END {
            all.extend_from_slice(self.sector(at)?);
            if all.len() > self.data.len() {
                return Err(cut_off());
            }
            at = *self.next.get(at as usize).ok_or_else(cut_off)?;
        }
        Ok(all)
    }
}

fn long(data: &[u8], at: usize) -> Result<u32, LabioError> {
    Ok(u32::from_le_bytes(bytes(data, at)?))
}

fn longs(data: &[u8]) -> impl Iterator<Item = u32> {
    data.chunks_exact(4)
        .filter_map(|four| Some(u32::from_le_bytes(four.try_into().ok()?)))
}

/// Returns the stream `Workbook`.
pub(super) fn workbook(file: &[u8]) -> Result<Vec<u8>, LabioError> {
    let size = match number(file, 30)? {
        9 => 512,
        12 => 4096,
        _ => return Err(cut_off()),
    };
    let mut sectors = Sectors {
        data: file.get(size..).ok_or_else(cut_off)?,
        size,
        next: Vec::new(),
    };
    let n_sectors = sectors.data.len().div_ceil(size);
    // sector numbers of the table: in the header, and in a chain of sectors, each of which ends
    // with the number of the next
    let mut places: Vec<u32> = longs(file.get(76..512).ok_or_else(cut_off)?).collect();
    let mut further = long(file, 68)?;
    while further < NONE && places.len() <= n_sectors + 109 {
        places.extend(longs(sectors.sector(further)?));
        further = places.pop().ok_or_else(cut_off)?;
    }
    let mut next = Vec::new();
    for place in places.into_iter().filter(|place| *place < NONE) {
        if next.len() > n_sectors {
            break;
        }
        next.extend(longs(sectors.sector(place)?));
    }
    sectors.next = next;
    let directory = sectors.chain(long(file, 48)?)?;
    let entries = || directory.chunks_exact(ENTRY);
    let is_called = |entry: &[u8], name: &str| {
        let signs = name.encode_utf16().chain([0]).flat_map(u16::to_le_bytes);
        signs.zip(entry).all(|(a, b)| a == *b)
    };
    let Some(entry) = entries().find(|entry| is_called(entry, "Workbook")) else {
        let old = entries().any(|entry| is_called(entry, "Book"));
        let encrypted = entries().any(|entry| is_called(entry, "EncryptedPackage"));
        return Err(refused(match (old, encrypted) {
            (true, _) => "from Excel 95 or earlier",
            (_, true) => "encrypted",
            _ => "not a workbook",
        }));
    };
    let (first, length) = (long(entry, 116)?, long(entry, 120)? as usize);
    let mut stream = if length < long(file, 56)? as usize {
        let root = entries().next().ok_or_else(cut_off)?;
        let small = Sectors {
            data: &sectors.chain(long(root, 116)?)?,
            size: SMALL,
            next: longs(&sectors.chain(long(file, 60)?)?).collect(),
        };
        small.chain(first)?
    } else {
        sectors.chain(first)?
    };
    if stream.len() < length {
        return Err(cut_off());
    }
    stream.truncate(length);
    Ok(stream)
}

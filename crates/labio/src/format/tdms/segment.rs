//! Lead-in and metadata of a segment: which objects there are, and where their raw data lie.

use std::collections::HashMap;
use std::rc::Rc;

use super::bytes::Bytes;
use super::malformed;
use super::value::{Sample, Value};
use crate::LabioError;

const LEAD_IN: usize = 28;
const TAG: &[u8] = b"TDSm";

/// What the table of contents of a lead-in says.
#[derive(Debug, Clone, Copy)]
pub(super) struct Contains(u32);

impl Contains {
    const META_DATA: u32 = 1 << 1;
    const NEW_OBJECT_LIST: u32 = 1 << 2;
    const RAW_DATA: u32 = 1 << 3;
    const INTERLEAVED: u32 = 1 << 5;
    const BIG_ENDIAN: u32 = 1 << 6;

    fn has(self, flag: u32) -> bool {
        self.0 & flag != 0
    }

    pub(super) fn interleaved(self) -> bool {
        self.has(Self::INTERLEAVED)
    }
}

/// A segment cut out of the file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment<'a> {
    pub(super) contains: Contains,
    metadata: Bytes<'a>,
    pub(super) raw: Bytes<'a>,
    /// Whether its length was never written, as it is when the recording was cut off.
    pub(super) open: bool,
    /// Offset of the segment after it.
    pub(super) end: usize,
}

impl<'a> Segment<'a> {
    /// Cuts out the segment at `offset` of `file`.
    ///
    /// # Errors
    ///
    /// A lead-in that is none, or offsets that lead out of the file or backwards.
    pub(super) fn at(offset: usize, file: &'a [u8]) -> Result<Self, LabioError> {
        let rest = file.get(offset..).unwrap_or_default();
        let mut lead_in = Bytes::new(rest, offset, false);
        let place = lead_in.place();
        let tag = lead_in.take(TAG.len(), "lead-in")?;
        if tag != TAG {
            return Err(malformed(
                place,
                "tag of the lead-in",
                format!("\"{}\"", tag.escape_ascii()),
                "\"TDSm\"",
            ));
        }
        // written in this order whatever the order of the rest
        let contains = Contains(lead_in.u32("table of contents")?);
        let big_endian = contains.has(Contains::BIG_ENDIAN);
        let mut lead_in = Bytes::new(rest.get(8..).unwrap_or_default(), offset + 8, big_endian);
        let place = lead_in.place();
        match lead_in.u32("version")? {
            4712 | 4713 => {}
            other => return Err(malformed(place, "version", other.to_string(), "4712 or 4713")),
        }
        let place = lead_in.place();
        let stated = lead_in.u64("offset of the next segment")?;
        let raw_place = lead_in.place();
        let raw_offset = lead_in.u64("offset of the raw data")?;

        let body = rest.get(LEAD_IN..).unwrap_or_default();
        let open = stated == u64::MAX;
        let length = if open { body.len() } else { usize::try_from(stated).unwrap_or(usize::MAX) };
        let Some(body) = body.get(..length) else {
            let available = body.len();
            return Err(malformed(
                place,
                "offset of the next segment",
                stated.to_string(),
                format!("at most the {available} bytes to the end of the file"),
            ));
        };
        let split = usize::try_from(raw_offset).ok().and_then(|at| body.split_at_checked(at));
        let Some((metadata, raw)) = split else {
            return Err(malformed(
                raw_place,
                "offset of the raw data",
                raw_offset.to_string(),
                format!("at most the {length} bytes of the segment"),
            ));
        };
        let start = offset + LEAD_IN;
        Ok(Self {
            contains,
            metadata: Bytes::new(metadata, start, big_endian),
            raw: Bytes::new(raw, start + metadata.len(), big_endian),
            open,
            end: start + length,
        })
    }

    /// The same with a length that is cut at the end of the file, for a file that ends too early.
    pub(super) fn at_cut(offset: usize, file: &'a [u8]) -> Option<Self> {
        let mut lead_in: [u8; LEAD_IN] = file.get(offset..)?.get(..LEAD_IN)?.try_into().ok()?;
        if let Some(length) = lead_in.get_mut(12..20) {
            length.fill(0xff);
        }
        // only the offset of the raw data is needed of the lead-in that was made open
        let opened = Segment::at(0, &lead_in_and(&lead_in, file.len().checked_sub(offset + LEAD_IN)?)).ok().map(|segment| segment.metadata.len())?;
        let body = file.get(offset + LEAD_IN..)?;
        let (metadata, raw) = body.split_at_checked(opened)?;
        let contains = Contains(u32::from_le_bytes(lead_in.get(4..8)?.try_into().ok()?));
        let big_endian = contains.has(Contains::BIG_ENDIAN);
        let start = offset + LEAD_IN;
        Some(Self {
            contains,
            metadata: Bytes::new(metadata, start, big_endian),
            raw: Bytes::new(raw, start + metadata.len(), big_endian),
            open: true,
            end: file.len(),
        })
    }
}

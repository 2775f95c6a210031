//! The lead-in of a segment: its contents and its extent.

use super::bytes::Bytes;
use super::malformed;
use crate::LabioError;

const LEAD_IN: usize = 28;
const TAG: &[u8] = b"TDSm";

/// Table of contents of a lead-in.
#[derive(Debug, Clone, Copy)]
pub(super) struct Contains(u32);

impl Contains {
    const METADATA: u32 = 1 << 1;
    const NEW_OBJECT_LIST: u32 = 1 << 2;
    const RAW_DATA: u32 = 1 << 3;
    const INTERLEAVED: u32 = 1 << 5;
    const BIG_ENDIAN: u32 = 1 << 6;

    fn has(self, flag: u32) -> bool {
        self.0 & flag != 0
    }

    pub(super) fn metadata(self) -> bool {
        self.has(Self::METADATA)
    }

    /// Returns true if the segment replaces the list of objects.
    pub(super) fn new_object_list(self) -> bool {
        self.has(Self::NEW_OBJECT_LIST)
    }

    pub(super) fn raw_data(self) -> bool {
        self.has(Self::RAW_DATA)
    }

    pub(super) fn interleaved(self) -> bool {
        self.has(Self::INTERLEAVED)
    }
}

/// A segment cut out of the file.
#[derive(Debug)]
pub(super) struct Segment<'a> {
    pub(super) contains: Contains,
    pub(super) metadata: Bytes<'a>,
    pub(super) raw: Bytes<'a>,
    /// True if the segment extends to the end of the file: its length was never written, because
    /// the recording was cut off.
    pub(super) open: bool,
    /// The error if the file ends before the segment does; the segment is then cut off there.
    pub(super) overrun: Option<LabioError>,
    /// Offset of the next segment.
    pub(super) end: usize,
}

impl<'a> Segment<'a> {
    /// Returns the segment at `offset` of `file`.
    ///
    /// # Errors
    ///
    /// [`LabioError::Malformed`] for an invalid lead-in, and if the raw data are not in the
    /// segment.
    pub(super) fn at(offset: usize, file: &'a [u8]) -> Result<Self, LabioError> {
        let rest = file.get(offset..).unwrap_or_default();
        let mut lead_in = Bytes::new(rest, offset, false);
        let place = lead_in.place();
        let tag = lead_in.take(TAG.len().min(rest.len()), "tag of the lead-in")?;
        if tag != TAG {
            let found = format!("\"{}\"", tag.escape_ascii());
            return Err(malformed(place, "tag of the lead-in", found, "\"TDSm\""));
        }
        // this byte order does not depend on the byte order of the rest
        let contains = Contains(lead_in.u32("table of contents")?);
        let big_endian = contains.has(Contains::BIG_ENDIAN);
        let mut lead_in = lead_in.in_order(big_endian);
        let place = lead_in.place();
        match lead_in.u32("version")? {
            4712 | 4713 => {}
            other => {
                let found = other.to_string();
                return Err(malformed(place, "version", found, "4712 or 4713"));
            }
        }
        let length_place = lead_in.place();
        let stated = lead_in.u64("offset of the next segment")?;
        let raw_place = lead_in.place();
        let raw_offset = lead_in.u64("offset of the raw data")?;

        let body = lead_in.take(lead_in.len(), "segment")?;
        let open = stated == u64::MAX;
        let within = usize::try_from(stated)
            .ok()
            .and_then(|length| body.get(..length));
        let overrun = (within.is_none() && !open).then(|| {
            malformed(
                length_place,
                "offset of the next segment",
                stated.to_string(),
                format!(
                    "at most {}, the number of bytes to the end of the file",
                    body.len()
                ),
            )
        });
        let body = within.unwrap_or(body);
        let split = usize::try_from(raw_offset)
            .ok()
            .and_then(|at| body.split_at_checked(at));
        let Some((metadata, raw)) = split else {
            return Err(malformed(
                raw_place,
                "offset of the raw data",
                raw_offset.to_string(),
                format!("at most {}, the number of bytes in the segment", body.len()),
            ));
        };
        let start = offset + LEAD_IN;
        let end_of_metadata = start + metadata.len();
        Ok(Self {
            contains,
            metadata: Bytes::new(metadata, start, big_endian),
            raw: Bytes::new(raw, end_of_metadata, big_endian),
            open,
            overrun,
            end: end_of_metadata + raw.len(),
        })
    }
}

//! Binary Tektronix traces (`.wfm`), versions 1 to 3.
//!
//! A recorded number n represents the sample scale·n + offset, with scale and offset of the first
//! explicit dimension. Sample i is at the time scale·i + offset, with scale and offset of the first
//! implicit dimension; in a fast frame, the time of its trigger between samples is subtracted.

use super::fields::Fields;
use super::{Trace, contents};
use crate::error::truncated;
use crate::format::number_type::NumberType;
use crate::format::{Reader, Strictness};
use crate::{Contents, LabioError};

const FORMAT: &str = "wfm";

/// Binary Tektronix traces (`.wfm`); see the [module](super).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TektronixWfm;

/// Offsets that differ between versions.
struct Layout {
    /// Offset of the first explicit dimension.
    explicit: usize,
    /// Offset of the first implicit dimension.
    implicit: usize,
    /// Offset of the object that states where the samples are.
    curve: usize,
}

/// Types of numbers in version 3, indexed by their code; earlier versions use the same codes but
/// have no 8-bit integers.
const KINDS: [NumberType; 8] = [
    NumberType::I16,
    NumberType::I32,
    NumberType::U32,
    NumberType::U64,
    NumberType::F32,
    NumberType::F64,
    NumberType::U8,
    NumberType::I8,
];

fn version(head: &[u8]) -> Option<u8> {
    let order = head.get(..2)?;
    let is_known = order == [0x0f, 0x0f] || order == [0xf0, 0xf0];
    let digit = head.get(2..10)?.strip_prefix(b":WFM#00")?.first()?;
    let version = digit.checked_sub(b'0')?;
    (is_known && (1..=3).contains(&version)).then_some(version)
}

impl Reader for TektronixWfm {
    fn name(&self) -> &'static str {
        FORMAT
    }

    fn recognises(&self, head: &[u8]) -> bool {
        version(head).is_some()
    }

    fn read(&self, bytes: &[u8], strictness: Strictness) -> Result<Contents, LabioError> {
        let fields = Fields {
            format: FORMAT,
            bytes,
            offset: 0,
            big_endian: bytes.first() == Some(&0xf0),
        };
        let version = version(bytes).ok_or_else(|| {
            fields.wrong(2, "version", "unknown".to_owned(), ":WFM#001 to :WFM#003")
        })?;
        let layout = Layout::of(version);
        let n_frames = 1 + fields.count(0x48, "number of fast frames")?;
        let kind = fields.count(layout.explicit + 72, "kind of samples")?;
        let Some(&kind) = KINDS.get(kind) else {
            let found = kind.to_string();
            return Err(fields.wrong(
                layout.explicit + 72,
                "kind of samples",
                found,
                "a known kind of number",
            ));
        };
        let storage = fields.count(layout.explicit + 76, "storage of samples")?;
        if storage > 1 {
            // 0: one sample after the other; 1: the same in pages; 2 and 3: pairs of extreme values
            let found = format!("{storage}, extremes of an envelope");
            let expected = "one sample for each time (0 or 1)";
            return Err(fields.wrong(layout.explicit + 76, "storage of samples", found, expected));
        }
        let gain = fields.f64(layout.explicit, "scale of the samples")?;
        let gain = fields.step(gain, layout.explicit, "scale of the samples")?;
        let offset = fields.f64(layout.explicit + 8, "offset of the samples")?;
        let step = fields.f64(layout.implicit, "interval")?;
        let step = fields.step(step, layout.implicit, "interval")?;
        let start = fields.f64(layout.implicit + 8, "time of the first sample")?;
        let label = fields.text(0x28, 32);
        let buffer = fields.count(0x10, "place of the curve")?;
        let mut traces = Vec::new();
        let mut cut = None;
        let mut at = buffer;
        for frame in 0..n_frames {
            // the objects of the other frames follow the objects of the first frame and all updates
            let (update, own) = match frame {
                0 => (layout.curve - 24, layout.curve),
                frame => {
                    let updates = layout.curve + 30;
                    let objects = updates + 24 * (n_frames - 1);
                    (updates + 24 * (frame - 1), objects + 30 * (frame - 1))
                }
            };
            let late = match n_frames {
                1 => 0.0,
                _ => fields.f64(update + 4, "time of the trigger between samples")?,
            };
            let [first, end, last] =
                [14, 18, 26].map(|field| fields.count(own + field, "place of the samples"));
            let (first, end, last) = (first?, end?, last?);
            if end < first || last < end {
                let found = format!("from {first} to {end} of {last}");
                return Err(fields.wrong(own, "place of the samples", found, "ascending offsets"));
            }
            let count = (end - first) / kind.size();
            let (samples, missing) = fields.samples(at + first, count, kind.size());
            at += last;
            if missing > 0 {
                let error = truncated(FORMAT, missing);
                if strictness == Strictness::Strict {
                    return Err(fields.wrong(own, "samples", error.to_string(), "all of them"));
                }
                cut = Some(error);
            }
            traces.push(Trace {
                name: match n_frames {
                    1 => label.clone(),
                    _ => format!("{label} (segment {})", frame + 1).trim().to_owned(),
                },
                start: start - late,
                step,
                time_unit: fields.text(layout.implicit + 20, 20),
                values: kind
                    .numbers(samples, fields.big_endian)
                    .into_iter()
                    .map(|n| gain * n + offset)
                    .collect(),
                unit: fields.text(layout.explicit + 20, 20),
                properties: Vec::new(),
            });
            if cut.is_some() {
                break;
            }
        }
        Ok(contents(FORMAT, traces, cut))
    }
}

impl Layout {
    fn of(version: u8) -> Self {
        // one word more from version 2 on; the point density has 8 bytes instead of 4 in version 3
        let explicit = 0xa6 + if version > 1 { 2 } else { 0 };
        let density = if version > 2 { 8 } else { 4 };
        let implicit = explicit + 2 * (152 + density);
        let times = implicit + 2 * (128 + density);
        Self {
            explicit,
            implicit,
            curve: times + 2 * 12 + 24,
        }
    }
}

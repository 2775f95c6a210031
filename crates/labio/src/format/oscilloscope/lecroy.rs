//! LeCroy traces, template `LECROY_2_3` and similar ones.
//!
//! The descriptor `WAVEDESC` has 346 bytes; user text, trigger times and the samples follow it. A
//! recorded number n represents the sample gain·n - offset. Sample i is at the time offset +
//! i·interval from the trigger.

use super::fields::Fields;
use super::{Trace, contents, decimal};
use crate::error::truncated;
use crate::format::number_type::NumberType;
use crate::format::{Reader, Strictness};
use crate::{Contents, LabioError};

const FORMAT: &str = "lecroy";

/// Beginning of the descriptor, after a block header such as `#9000120346`.
const DESCRIPTOR: &[u8] = b"WAVEDESC";

/// Number of bytes at the start of a file within which the descriptor begins.
const LEAD: usize = 32;

/// Names of the record types, indexed by their code.
const RECORD_TYPES: [&str; 10] = [
    "single sweep",
    "interleaved",
    "histogram",
    "graph",
    "filter coefficient",
    "complex",
    "extrema",
    "sequence",
    "centered RIS",
    "peak detect",
];

/// Codes of the [`RECORD_TYPES`] that are read: samples over time.
const OVER_TIME: [u16; 4] = [0, 1, 7, 8];

/// LeCroy and Teledyne LeCroy traces (`.trc`); see the [module](super).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LeCroy;

fn beginning(head: &[u8]) -> Option<usize> {
    let lead = head.get(..head.len().min(LEAD + DESCRIPTOR.len()))?;
    let at = lead
        .windows(DESCRIPTOR.len())
        .position(|w| w == DESCRIPTOR)?;
    let template = head.get(at + 16..at + 22)?;
    (template == b"LECROY").then_some(at)
}

impl Reader for LeCroy {
    fn name(&self) -> &'static str {
        FORMAT
    }

    fn recognises(&self, head: &[u8]) -> bool {
        beginning(head).is_some()
    }

    fn read(&self, bytes: &[u8], strictness: Strictness) -> Result<Contents, LabioError> {
        let offset = beginning(bytes).unwrap_or(0);
        let mut fields = Fields {
            format: FORMAT,
            bytes: bytes.get(offset..).unwrap_or(&[]),
            offset,
            big_endian: false,
        };
        // read as little-endian, the byte-order field is 0 only in a big-endian file
        let order = fields.u16(34, "order of bytes")?;
        fields.big_endian = order == 0;
        let kind = match fields.u16(32, "size of a sample")? {
            0 => NumberType::I8,
            1 => NumberType::I16,
            other => {
                return Err(fields.wrong(32, "size of a sample", other.to_string(), "0 or 1"));
            }
        };
        let record = fields.u16(316, "kind of record")?;
        if !OVER_TIME.contains(&record) {
            let name = RECORD_TYPES
                .get(usize::from(record))
                .copied()
                .unwrap_or("unknown");
            return Err(fields.wrong(316, "kind of record", name.to_owned(), "samples over time"));
        }
        let mut data = 0;
        let mut trigger_times = 0;
        for (at, field) in [
            (36, "length of the descriptor"),
            (40, "length of the user text"),
            (44, "length of a reserved block"),
            (48, "length of the times of triggers"),
            (52, "length of the times of interleaved records"),
            (56, "length of a reserved array"),
        ] {
            if at == 48 {
                trigger_times = data;
            }
            data += fields.count(at, field)?;
        }
        let n_trigger_bytes = fields.count(48, "length of the times of triggers")?;
        let count = fields.count(60, "length of the samples")? / kind.size();
        let n_segments = fields.count(144, "number of segments")?.max(1);
        let length = count / n_segments;
        let gain = fields.step(f64::from(fields.f32(156, "gain")?), 156, "gain")?;
        let offset = f64::from(fields.f32(160, "offset")?);
        let interval = decimal(fields.f32(176, "interval")?);
        let interval = fields.step(interval, 176, "interval")?;
        let start = fields.f64(180, "time of the first sample")?;
        let (samples, missing) = fields.samples(data, count, kind.size());
        let cut = (missing > 0).then_some(truncated(FORMAT, missing));
        if let (Some(error), Strictness::Strict) = (&cut, strictness) {
            return Err(fields.wrong(60, "samples", error.to_string(), "all of them"));
        }
        let values = kind.numbers(samples, fields.big_endian);
        let name = name(&fields);
        let mut traces = Vec::new();
        for (index, part) in values.chunks(length.max(1)).take(n_segments).enumerate() {
            // pairs: the time from the first trigger, and the offset of the first sample
            let own = trigger_times + 16 * index;
            let (since_first, start) = if n_segments > 1 && 16 * (index + 1) <= n_trigger_bytes {
                let time = fields.f64(own, "time of a trigger")?;
                (Some(time), fields.f64(own + 8, "offset of a trigger")?)
            } else {
                (None, start)
            };
            let mut properties = vec![
                ("instrument".to_owned(), fields.text(76, 16)),
                ("trigger".to_owned(), trigger(&fields)?),
            ];
            if let Some(time) = since_first {
                properties.push((
                    "time since the first trigger (s)".to_owned(),
                    time.to_string(),
                ));
            }
            traces.push(Trace {
                name: if n_segments > 1 {
                    format!("{name} (segment {})", index + 1)
                } else {
                    name.clone()
                },
                start,
                step: interval,
                time_unit: fields.text(244, 48),
                values: part.iter().map(|n| gain * n - offset).collect(),
                unit: fields.text(196, 48),
                properties,
            });
        }
        Ok(contents(FORMAT, traces, cut))
    }
}

/// Returns the label of the trace or, without a label, its channel.
fn name(fields: &Fields<'_>) -> String {
    let label = fields.text(96, 16);
    match (label.is_empty(), fields.u16(344, "source")) {
        (true, Ok(source @ 0..=7)) => format!("C{}", source + 1),
        _ => label,
    }
}

/// Returns date and time of the trigger.
fn trigger(fields: &Fields<'_>) -> Result<String, LabioError> {
    let seconds = fields.f64(296, "time of the trigger")?;
    let year = fields.u16(308, "year of the trigger")?;
    let part = |at: usize| fields.bytes.get(at).copied().unwrap_or(0);
    let (minute, hour, day, month) = (part(304), part(305), part(306), part(307));
    Ok(format!(
        "{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{seconds:09.6}"
    ))
}

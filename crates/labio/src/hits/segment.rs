//! Division of a long record, or of a stream too long for the memory, into hits.

use std::collections::VecDeque;

use ndarray::{Array2, ArrayView2};

use super::trigger::{Scanner, Timing};
use super::{Criteria, Hit, HitLog, Reason, Trigger};
use crate::channel;
use crate::stream::read_next;
use crate::{BlockSource, Channel, LabioError, Provenance, Record};

/// Number of samples per channel that are read from a source at a time.
const BLOCK: usize = 8192;

/// Finds and checks the hits of `record`. Each hit keeps its position on the time axis, its sensor
/// chains and the provenance of the record.
///
/// A hit cut off by the beginning or end of the record is listed with that reason. If the trigger
/// never fires, the log has one entry with that reason and any others that concern the whole
/// record.
///
/// # Errors
///
/// - [`LabioError::UnknownChannel`]: the channel that triggers, or the force channel of the
///   criteria, is not in the record.
/// - [`LabioError::NonPhysical`], [`LabioError::TooFewSamples`]: the trigger is not valid at this
///   sampling rate.
///
/// # Examples
///
/// ```
/// use labio::hits::{Criteria, Extent, Trigger, find_hits};
/// use labio::{Channel, Provenance, Quantity, Record};
/// use ndarray::Array2;
///
/// # fn main() -> Result<(), labio::LabioError> {
/// // an impact every second, for three seconds
/// let force = Array2::from_shape_fn((1, 3000), |(_, k)| match k % 1000 {
///     500 => 40.0,
///     501 => 80.0,
///     502 => 30.0,
///     _ => 0.0,
/// });
/// let channels = vec![Channel::new("force", Quantity::Force)?];
/// let record = Record::new(force, 1000.0, 0.0, channels, Provenance::computed("example"))?;
///
/// let trigger = Trigger::new("force", 20.0, Extent::Seconds(0.5))?.with_pre_trigger(Extent::Seconds(0.05));
/// let log = find_hits(&record, &trigger, &Criteria::default())?;
/// let begins: Vec<f64> = log.accepted().map(Record::start_time).collect();
/// assert_eq!(begins, [0.45, 1.45, 2.45]);
/// # Ok(())
/// # }
/// ```
pub fn find_hits(
    record: &Record,
    trigger: &Trigger,
    criteria: &Criteria,
) -> Result<HitLog, LabioError> {
    let timing = trigger.at(record.sampling_rate_hz())?;
    let samples = record.channel(trigger.channel())?;
    let mut scanner = trigger.scanner(timing);
    let mut log = HitLog::new(trigger.channel());
    for (fired, _) in samples
        .iter()
        .enumerate()
        .filter(|(index, sample)| scanner.fires(*index, **sample))
    {
        let time = record.time_at(fired);
        let hit = match timing.range(fired, record.n_samples()) {
            Ok(range) => {
                let hit = record.part(range)?;
                let reasons = criteria.judge(&hit, trigger.channel(), Some(timing.before))?;
                Hit::new(time, Some(hit), reasons)
            }
            Err(cut) => Hit::new(time, None, vec![cut]),
        };
        log.push(hit);
    }
    if log.hits().is_empty() {
        let mut bounds = Bounds::default();
        samples.iter().for_each(|sample| bounds.widen(*sample));
        let mut reasons = vec![bounds.not_triggered(trigger)];
        reasons.extend(criteria.judge(record, trigger.channel(), None)?);
        log.push(Hit::new(record.start_time(), None, reasons));
    }
    Ok(log)
}

/// Finds and checks the hits of a stream as [`find_hits`] does; only the hits and one block are
/// kept in memory. Time is 0 at the first sample.
///
/// # Errors
///
/// The errors of [`find_hits`] and of the source; [`LabioError::CountMismatch`] if the source
/// returns more samples than requested, or replaces the block that it should fill. A hit with a
/// non-finite sample is rejected with that reason; this is not an error.
pub fn find_hits_in_blocks(
    source: &mut dyn BlockSource,
    provenance: &Provenance,
    trigger: &Trigger,
    criteria: &Criteria,
) -> Result<HitLog, LabioError> {
    let rate_hz = source.sampling_rate_hz();
    let timing = trigger.at(rate_hz)?;
    let channels = source.channels().to_vec();
    let (row, _) = channel::find(&channels, trigger.channel())?;
    let mut cutter = Cutter {
        timing,
        row,
        scanner: trigger.scanner(timing),
        buffers: vec![Vec::new(); channels.len()],
        first: 0,
        fed: 0,
        pending: VecDeque::new(),
        bounds: Bounds::default(),
        lost: None,
    };
    let mut log = HitLog::new(trigger.channel());
    let mut block = Array2::zeros((channels.len(), BLOCK));
    loop {
        let n = read_next(source, &mut block)?;
        let (filled, _) = block.view().split_at(ndarray::Axis(1), n);
        cutter.feed(filled);
        while let Some((fired, samples)) = cutter.next(n == 0) {
            let time = fired as f64 / rate_hz;
            let hit = match samples {
                Err(cut) => Hit::new(time, None, vec![cut]),
                Ok(samples) => match lost(&channels, samples.view()) {
                    Some(reason) => Hit::new(time, None, vec![reason]),
                    None => {
                        let start = (fired - timing.before) as f64 / rate_hz;
                        let hit = Record::new(
                            samples,
                            rate_hz,
                            start,
                            channels.clone(),
                            provenance.clone(),
                        )?;
                        let reasons =
                            criteria.judge(&hit, trigger.channel(), Some(timing.before))?;
                        Hit::new(time, Some(hit), reasons)
                    }
                },
            };
            log.push(hit);
        }
        if n == 0 {
            break;
        }
    }
    if log.hits().is_empty() {
        let mut reasons = vec![cutter.bounds.not_triggered(trigger)];
        // there may have been a hit where samples were lost
        reasons.extend(cutter.lost.map(|index| Reason::NonFinite {
            channel: trigger.channel().to_owned(),
            index,
        }));
        log.push(Hit::new(0.0, None, reasons));
    }
    Ok(log)
}

fn lost(channels: &[Channel], samples: ArrayView2<'_, f64>) -> Option<Reason> {
    let rows = samples.rows();
    rows.into_iter().zip(channels).find_map(|(row, channel)| {
        let index = row.iter().position(|sample| !sample.is_finite())?;
        Some(Reason::NonFinite {
            channel: channel.name().to_owned(),
            index,
        })
    })
}

impl Timing {
    /// Returns the range of samples of a hit for which the trigger fired at `fired`, in a record of
    /// `n_samples`.
    fn range(&self, fired: usize, n_samples: usize) -> Result<std::ops::Range<usize>, Reason> {
        let Some(begin) = fired.checked_sub(self.before) else {
            return Err(Reason::CutAtStart {
                missing: self.before - fired,
            });
        };
        let end = begin.saturating_add(self.length);
        if end > n_samples {
            return Err(Reason::CutAtEnd {
                missing: end - n_samples,
            });
        }
        Ok(begin..end)
    }
}

/// Range of values of the channel that triggers.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    least: f64,
    greatest: f64,
}

impl Default for Bounds {
    fn default() -> Self {
        Self {
            least: f64::INFINITY,
            greatest: f64::NEG_INFINITY,
        }
    }
}

impl Bounds {
    fn widen(&mut self, sample: f64) {
        self.least = self.least.min(sample);
        self.greatest = self.greatest.max(sample);
    }

    fn not_triggered(&self, trigger: &Trigger) -> Reason {
        Reason::NotTriggered {
            channel: trigger.channel().to_owned(),
            level: trigger.level(),
            hysteresis: trigger.hysteresis(),
            least: self.least,
            greatest: self.greatest,
        }
    }
}

/// Buffer for the part of a stream that is needed for incomplete hits and the pre-trigger.
struct Cutter {
    timing: Timing,
    row: usize,
    scanner: Scanner,
    /// Samples of every channel from `first` on.
    buffers: Vec<Vec<f64>>,
    first: usize,
    fed: usize,
    /// Samples at which the trigger fired and whose hits are not complete yet.
    pending: VecDeque<usize>,
    bounds: Bounds,
    /// First non-finite sample of the trigger channel.
    lost: Option<usize>,
}

impl Cutter {
    fn feed(&mut self, block: ArrayView2<'_, f64>) {
        self.forget();
        for (buffer, row) in self.buffers.iter_mut().zip(block.rows()) {
            buffer.extend(row.iter());
        }
        if let Some(row) = block.rows().into_iter().nth(self.row) {
            for (index, &sample) in (self.fed..).zip(row) {
                self.bounds.widen(sample);
                if !sample.is_finite() {
                    self.lost.get_or_insert(index);
                }
                if self.scanner.fires(index, sample) {
                    self.pending.push_back(index);
                }
            }
        }
        self.fed += block.ncols();
    }

    /// Drops samples that are not needed for any hit.
    fn forget(&mut self) {
        let next = self.pending.front().copied().unwrap_or(self.fed);
        let needed_from = next.saturating_sub(self.timing.before);
        let superfluous = needed_from.saturating_sub(self.first);
        // dropping moves the remaining samples: it waits until half of the buffer can be dropped,
        // so that a sample moves no more than once on average
        if 2 * superfluous < self.fed - self.first {
            return;
        }
        for buffer in &mut self.buffers {
            buffer.drain(..superfluous.min(buffer.len()));
        }
        self.first += superfluous;
    }

    /// Returns the next hit that is complete or, at the end of the stream, cut off.
    fn next(&mut self, at_end: bool) -> Option<(usize, Result<Array2<f64>, Reason>)> {
        let &fired = self.pending.front()?;
        match self.timing.range(fired, self.fed) {
            Err(Reason::CutAtEnd { .. }) if !at_end => None,
            Err(cut) => {
                self.pending.pop_front();
                Some((fired, Err(cut)))
            }
            Ok(range) => {
                self.pending.pop_front();
                let offset = range.start - self.first;
                let shape = (self.buffers.len(), range.len());
                #[allow(
                    clippy::indexing_slicing,
                    reason = "there is a buffer for each channel; the range ends within the samples that were fed, and `forget` keeps all samples from its start on"
                )]
                let samples =
                    Array2::from_shape_fn(shape, |(channel, k)| self.buffers[channel][offset + k]);
                Some((fired, Ok(samples)))
            }
        }
    }
}

//! The checks of one hit.

use super::double_hit::second_contact;
use super::rest::{
    BEYOND_NOISE, HIT_OVER_PEAK, LEAST_REST, PASSAGE_OVER_PEAK, Rest, mean_of_blocks, onset_of,
};
use super::{Criteria, Reason};
use crate::error::count_mismatch;
use crate::quantization::{are_multiples, same, smallest_step};
use crate::spectra::ending::{End, Ending};
use crate::{LabioError, Quantity, Record};

/// Number of standard errors by which two levels must differ to be significantly different.
const LEVELS_APART: f64 = 5.0;
/// The hit must be over in the last of this number of equal parts.
const TAIL: usize = 10;
/// The motion after the end of a hit is found from the last of this number of equal parts.
const QUARTER: usize = 4;
/// Fraction of its range that an 8-bit converter can still reach.
const FULL: f64 = 0.99;

impl Criteria {
    /// Returns the reasons to reject `hit`, an empty list if it is good. `reference` is the channel
    /// that triggers, usually the force; `onset` is the sample at which the hit begins. If it is
    /// `None`, the onset is the first sample of that channel that leaves its initial level by more
    /// than the noise there and by more than a tenth of the largest excursion (a fiftieth for waves
    /// in a bar).
    ///
    /// The rest level of a channel is the median of its samples before the onset; its noise is 1.48
    /// times their median absolute deviation; both tolerate up to half of the samples as outliers.
    ///
    /// # Validity
    ///
    /// Clipping ahead of an analogue or digital filter leaves no equal samples and is found only
    /// with [`Self::with_full_scale`]. A second contact weaker than the ringing of the force sensor
    /// is not found.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`] if the record lacks the reference or the named force channel;
    /// [`LabioError::CountMismatch`] for an onset beyond the record.
    pub fn judge(
        &self,
        hit: &Record,
        reference: &str,
        onset: Option<usize>,
    ) -> Result<Vec<Reason>, LabioError> {
        let trigger_samples = hit.channel(reference)?.to_vec();
        let part_of_peak = if self.several_passages {
            PASSAGE_OVER_PEAK
        } else {
            HIT_OVER_PEAK
        };
        let onset = match onset {
            Some(onset) if onset > hit.n_samples() => {
                return count_mismatch(
                    "sample of the onset of a hit, at most",
                    onset,
                    hit.n_samples(),
                );
            }
            Some(onset) => onset,
            None => onset_of(&trigger_samples, part_of_peak),
        };
        let weights = match self.window {
            None => Vec::new(),
            Some(decay) => {
                let window = decay.window(hit.duration())?;
                window.weights(hit.n_samples(), hit.sampling_rate_hz())?
            }
        };
        let mut reasons = Vec::new();
        if onset < LEAST_REST {
            reasons.push(Reason::CutAtStart {
                missing: LEAST_REST - onset,
            });
        }
        let force_channel = match &self.force_channel {
            Some(name) => {
                hit.channel(name)?;
                Some(name.as_str())
            }
            None => hit
                .channels()
                .iter()
                .find(|c| c.name() == reference && c.quantity() == Quantity::Force)
                .map(|c| c.name()),
        };
        for channel in hit.channels() {
            let name = channel.name();
            let samples = hit.channel(name)?.to_vec();
            let recorded = match hit.chain(name)? {
                Some(_) => Some(hit.recorded(name)?.to_vec()),
                None => None,
            };
            let recorded = recorded.as_ref().unwrap_or(&samples);
            let is_force = force_channel == Some(name);
            if let Some(value) = only_value(&samples) {
                reasons.push(Reason::Dead {
                    channel: name.to_owned(),
                    value,
                });
                continue;
            }
            self.check_range(name, recorded, &mut reasons);
            let Some(signal) = Signal::of(name, &samples, onset) else {
                continue;
            };
            let is_offset = self.check_offset(&signal, &mut reasons);
            // the peak of a channel with a large offset is not compared with its noise, because the
            // channel may drift
            if name == reference && !is_offset {
                self.check_peak(&signal, &mut reasons);
            }
            if let Some(raw) = Signal::of(name, recorded, onset) {
                let holds = Holds {
                    rest: is_force || self.several_passages,
                    plateaus: self.several_passages && channel.quantity() != Quantity::Acceleration,
                };
                self.check_standstill(&raw, holds, &mut reasons);
            }
            if is_force {
                self.check_contacts(&signal, hit.sampling_rate_hz(), &mut reasons);
            }
            let ending = Ending::of(channel.quantity());
            if ending == Ending::Rest {
                self.check_shift(&signal, &mut reasons);
            }
            if ending == Ending::Rest || !self.several_passages {
                self.check_remainder(&signal, ending, &weights, &mut reasons);
            }
        }
        Ok(reasons)
    }

    fn check_range(&self, channel: &str, recorded: &[f64], reasons: &mut Vec<Reason>) {
        let Some(&full_scale) = self.full_scales.get(channel) else {
            return;
        };
        let is_full = |u: &f64| u.abs() >= FULL * full_scale;
        if let Some(index) = recorded.iter().position(is_full) {
            reasons.push(Reason::Overload {
                channel: channel.to_owned(),
                full_scale,
                n_samples: recorded.iter().filter(|u| is_full(u)).count(),
                index,
            });
        }
    }

    fn check_peak(&self, signal: &Signal<'_>, reasons: &mut Vec<Reason>) {
        if let Some(limit) = self.peak_over_noise
            && signal.peak <= limit * signal.rest.noise
        {
            reasons.push(Reason::NoHit {
                channel: signal.channel.to_owned(),
                peak: signal.peak,
                noise: signal.rest.noise,
            });
        }
    }

    fn check_contacts(&self, signal: &Signal<'_>, rate_hz: f64, reasons: &mut Vec<Reason>) {
        let Some(limit) = self.double_hit else {
            return;
        };
        let sign = signal.sign;
        let force: Vec<f64> = signal
            .samples
            .iter()
            .map(|f| sign * (f - signal.rest.level))
            .collect();
        let threshold = (limit * signal.peak).max(BEYOND_NOISE * signal.rest.noise);
        if let Some(second) = second_contact(&force, threshold) {
            reasons.push(Reason::DoubleHit {
                channel: signal.channel.to_owned(),
                ratio: second.ratio,
                separation: second.separation as f64 / rate_hz,
            });
        }
    }

    /// Checks runs of equal samples: at an extreme they are clipping, elsewhere a drop-out unless
    /// the signal is at rest.
    fn check_standstill(&self, signal: &Signal<'_>, holds: Holds, reasons: &mut Vec<Reason>) {
        let clipped_run = self.clipped_run.map(|n| (n.saturating_sub(1)).max(2));
        let Some(shortest) = clipped_run.into_iter().chain(self.drop_out_run).min() else {
            return;
        };
        let step = smallest_step(signal.samples);
        let noise = signal.rest.noise;
        // plateaus of a signal without noise look like clipping
        let limit_is_told = !holds.plateaus || noise > step;
        let (mut clipped, mut dropped) = (None, None);
        let runs = runs(signal.samples, shortest);
        // a limit may cut off only two samples of a steep front: two equal samples are evidence if
        // noise makes equal neighbours rare
        let noise_in_steps = if are_multiples(signal.samples, step) {
            noise / step
        } else {
            WITHOUT_STEP
        };
        let shorter_is_told = noise > DUST * signal.peak
            && equal_by_chance(noise_in_steps) < RARE
            && (runs.len() as f64) < RARE * signal.samples.len() as f64 + FEW_RUNS;
        for run in runs {
            let from_rest = (run.value - signal.rest.level).abs();
            let is_extreme = same(run.value, signal.least) || same(run.value, signal.greatest);
            // For a parabola, the sample next to n equal samples at a round peak is at most
            // 4(n+1)/n² converter steps lower: less than two from n = 3 on.
            let leaps =
                |limit: f64| [run.step_in, run.step_out].map(|s| s.is_some_and(|s| s > limit));
            if is_extreme {
                let [into, out] = leaps(3.0 * step.max(f64::MIN_POSITIVE) + LEAP * noise);
                // in noise of several steps, three samples of a steep crest may be equal with a
                // large step on one side, whereas clipping has a large step on both sides
                let cut = if noise > step {
                    into && out
                } else {
                    into || out
                };
                if limit_is_told
                    && self.clipped_run.is_some_and(|n| {
                        run.length >= n || (shorter_is_told && run.length + 1 >= n)
                    })
                    && from_rest > BEYOND_NOISE * noise
                    && (cut
                        || is_improbable(run.length, noise / step)
                        || (shorter_is_told
                            && is_improbable(run.length.max(LEAST_EVIDENT), noise_in_steps)))
                {
                    clipped.get_or_insert(run);
                }
                continue;
            }
            let [into, out] = leaps(BEYOND_NOISE * noise.max(step));
            let at_rest = from_rest <= (3.0 * noise).max(step);
            let moving = if at_rest {
                into && out && !holds.rest
            } else {
                (into || out) && !holds.plateaus
            };
            if run.begin >= signal.onset
                && self.drop_out_run.is_some_and(|n| run.length >= n)
                && moving
            {
                dropped.get_or_insert(run);
            }
        }
        let channel = signal.channel;
        reasons.extend(clipped.map(|run| Reason::Clipped {
            channel: channel.to_owned(),
            value: run.value,
            run: run.length,
            index: run.begin,
        }));
        reasons.extend(dropped.map(|run| Reason::DropOut {
            channel: channel.to_owned(),
            value: run.value,
            run: run.length,
            index: run.begin,
        }));
    }

    fn check_offset(&self, signal: &Signal<'_>, reasons: &mut Vec<Reason>) -> bool {
        let (level, peak) = (signal.rest.level, signal.peak);
        let Some(limit) = self.static_offset.filter(|l| level.abs() > l * peak) else {
            return false;
        };
        reasons.push(Reason::StaticOffset {
            channel: signal.channel.to_owned(),
            level,
            peak,
            limit,
        });
        true
    }

    /// Checks the level at the end. The median of a motion that still rings differs from its level
    /// if its swings to both sides have different shapes, such as the passages of a pulse in a bar;
    /// its samples are not independent either. The mean of the last part, with the error shown by
    /// its blocks, must therefore be shifted as well.
    fn check_shift(&self, signal: &Signal<'_>, reasons: &mut Vec<Reason>) {
        let (rest, peak) = (signal.rest, signal.peak);
        let tail = signal.end_of(TAIL);
        let Some(end) = Rest::of(tail) else {
            return;
        };
        if let Some(limit) = self.level_shift {
            let is_shift = |level: f64, error: f64| {
                let shift = (level - rest.level).abs();
                let error = rest.level_error().hypot(error);
                shift > limit * peak && shift > LEVELS_APART * error
            };
            let mean_is_shifted =
                mean_of_blocks(tail).is_none_or(|(mean, error)| is_shift(mean, error));
            if is_shift(end.level, end.level_error()) && mean_is_shifted {
                reasons.push(Reason::LevelShift {
                    channel: signal.channel.to_owned(),
                    before: rest.level,
                    after: end.level,
                    peak,
                    limit,
                });
            }
        }
    }

    /// Checks the remainder at the end, relative to the level or the motion that follows, under the
    /// exponential window.
    fn check_remainder(
        &self,
        signal: &Signal<'_>,
        ending: Ending,
        weights: &[f64],
        reasons: &mut Vec<Reason>,
    ) {
        let tail = signal.end_of(TAIL);
        let (Some(limit), Some(end)) = (self.remainder, Rest::of(tail)) else {
            return;
        };
        let line = match ending {
            Ending::Rest => End {
                level: end.level,
                slope: 0.0,
            },
            goes_on => goes_on.fit(signal.end_of(QUARTER)),
        };
        let weight_from = |begin: usize| {
            let weights = weights.iter().skip(begin).copied();
            weights.chain(std::iter::repeat(1.0))
        };
        let begin = signal.samples.len() - tail.len();
        let n_tail = tail.len() as f64;
        let (mut squares, mut noise) = (0.0, 0.0);
        let places = (1..=tail.len()).rev();
        for ((x, before), weight) in tail.iter().zip(places).zip(weight_from(begin)) {
            squares += (weight * (x - line.at(before))).powi(2);
            noise += (weight * signal.rest.noise).powi(2);
        }
        let (squares, noise) = (squares / n_tail, noise / n_tail);
        let peak = if weights.is_empty() {
            signal.peak
        } else {
            let after = signal.samples.iter().skip(signal.onset);
            let weighed = after.zip(weight_from(signal.onset));
            weighed
                .map(|(x, weight)| weight * (x - signal.rest.level).abs())
                .fold(0.0, f64::max)
        };
        let remainder = (squares - noise).max(0.0).sqrt();
        // the estimate of the noise from few samples has a large error, so that a remainder of the
        // size of the noise may be noise
        if remainder > limit * peak && remainder > 3.0 * noise.sqrt() {
            reasons.push(Reason::NotDecayed {
                channel: signal.channel.to_owned(),
                remainder,
                peak,
                limit,
            });
        }
    }
}

/// Constant signals that are allowed within a hit.
#[derive(Debug, Clone, Copy)]
struct Holds {
    /// Rest, such as that of a force between two contacts.
    rest: bool,
    /// Plateaus away from rest, such as those of a strain while a long wave passes.
    plateaus: bool,
}

/// One channel of a hit, with the numbers needed by the checks.
struct Signal<'a> {
    channel: &'a str,
    samples: &'a [f64],
    onset: usize,
    rest: Rest,
    /// Largest excursion from the rest level after the onset.
    peak: f64,
    /// Sign of that excursion.
    sign: f64,
    least: f64,
    greatest: f64,
}

impl<'a> Signal<'a> {
    /// Returns the signal of a channel; `None` if there are no samples before or after the onset.
    fn of(channel: &'a str, samples: &'a [f64], onset: usize) -> Option<Self> {
        let (before, after) = samples.split_at_checked(onset)?;
        let rest = Rest::of(before)?;
        let (down, up) = extremes(after)?;
        let (down, up) = (rest.level - down, up - rest.level);
        let (least, greatest) = extremes(samples)?;
        Some(Self {
            channel,
            samples,
            onset,
            rest,
            peak: up.max(down).max(0.0),
            sign: if down > up { -1.0 } else { 1.0 },
            least,
            greatest,
        })
    }

    /// Returns the last of `parts` equal parts of the hit: at least eight samples, but at most half
    /// of those after the onset.
    fn end_of(&self, parts: usize) -> &'a [f64] {
        let after_onset = self.samples.len() - self.onset;
        let n_tail = (self.samples.len() / parts)
            .max(LEAST_REST)
            .min(after_onset / 2);
        let (_, tail) = self.samples.split_at(self.samples.len() - n_tail);
        tail
    }
}

/// Returns the smallest and the largest sample.
fn extremes(samples: &[f64]) -> Option<(f64, f64)> {
    let &first = samples.first()?;
    Some(
        samples
            .iter()
            .fold((first, first), |(least, greatest), &x| {
                let least = if x < least { x } else { least };
                (least, if x > greatest { x } else { greatest })
            }),
    )
}

/// A run of equal samples.
#[derive(Debug, Clone, Copy)]
struct Run {
    begin: usize,
    length: usize,
    value: f64,
    /// Distance to the sample before, if there is one.
    step_in: Option<f64>,
    /// Distance to the sample after, if there is one.
    step_out: Option<f64>,
}

fn runs(samples: &[f64], shortest: usize) -> Vec<Run> {
    let mut runs = Vec::new();
    let mut begin = 0;
    for chunk in samples.chunk_by(|a, b| same(*a, *b)) {
        let end = begin + chunk.len();
        if let (true, Some(&value)) = (chunk.len() >= shortest, chunk.first()) {
            let distance = |other: Option<&f64>| other.map(|x| (x - value).abs());
            runs.push(Run {
                begin,
                length: chunk.len(),
                value,
                step_in: begin.checked_sub(1).and_then(|b| distance(samples.get(b))),
                step_out: distance(samples.get(end)),
            });
        }
        begin = end;
    }
    runs
}

fn only_value(samples: &[f64]) -> Option<f64> {
    let first = *samples.first()?;
    samples.iter().all(|x| same(*x, first)).then_some(first)
}

/// Largest difference between neighbouring samples of a smooth crest, in standard deviations of the
/// noise, in addition to three converter steps.
const LEAP: f64 = 4.0;

/// Probability by chance of a run of equal samples in noise, below which the run is evidence of
/// clipping.
const BY_CHANCE: f64 = 1e-6;

/// Noise relative to the peak below which a record was computed without noise; symmetric pulses
/// then have equal samples.
const DUST: f64 = 1e-9;

/// Noise, in converter steps, assumed for a record whose samples are not multiples of a step: two
/// samples are then not equal by chance.
const WITHOUT_STEP: f64 = 1e12;

/// Smallest length with which a run is compared with [`BY_CHANCE`]: two equal samples at the
/// extreme are compared like three.
const LEAST_EVIDENT: usize = 3;

/// Fraction of equal neighbours below which they are rare.
const RARE: f64 = 0.01;
/// Number of runs of equal samples, in addition to the rare ones, up to which a record does not
/// count as upsampled; most neighbours of an upsampled record are equal.
const FEW_RUNS: f64 = 8.0;

/// Returns the probability that noise of this standard deviation, in steps of the converter, leaves
/// two samples equal: 1/(2√π σ).
fn equal_by_chance(noise: f64) -> f64 {
    0.5 / (std::f64::consts::PI.sqrt() * noise)
}

/// Returns true if noise of this standard deviation, in steps of the converter, is unlikely to
/// leave `length` samples equal.
fn is_improbable(length: usize, noise: f64) -> bool {
    let equal = equal_by_chance(noise);
    noise.is_finite() && equal < 0.6 && equal.powf(length as f64 - 1.0) < BY_CHANCE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_have_their_steps() {
        let found = runs(&[1.0, 1.0, 2.0, 5.0, 5.0, 5.0, 4.0], 2);
        let figures: Vec<_> = found.iter().map(|r| (r.begin, r.length)).collect();
        assert_eq!(figures, [(0, 2), (3, 3)]);
        assert_eq!(found[0].step_in, None);
        assert_eq!(found[1].step_in, Some(3.0));
        assert_eq!(found[1].step_out, Some(1.0));
    }
}

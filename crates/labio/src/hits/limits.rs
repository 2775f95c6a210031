//! Detection of clipping in peaks that are too short for a run: the same extreme value occurs
//! repeatedly.

use super::rest::{BEYOND_NOISE, HIT_OVER_PEAK, Rest, onset_of};
use super::{Criteria, Reason};
use crate::quantization::{same, smallest_step};
use crate::{LabioError, Record};

/// Number of converter steps below the extreme within which an unclipped signal has more samples
/// than at the extreme itself. The number of samples of a round peak down to a certain depth grows
/// as the square root of the depth, so the eight steps below contain twice as many samples as the
/// uppermost step.
const NUMBERS_BELOW: f64 = 8.0;
/// Fewest samples of a long record that must be at its limit.
const FEWEST_AT_LIMIT: usize = 4;
/// Smallest distance of an extreme from rest, as a fraction of the largest excursion.
const LEAST_PART: f64 = 0.1;

/// One channel of a hit, with its extreme in one direction.
struct Side {
    samples: Vec<f64>,
    rest: Rest,
    peak: f64,
    step: f64,
    /// True if there is noise: a signal without noise may repeat its extremes.
    is_live: bool,
}

impl Side {
    /// Creates the side from the samples times `sign`.
    fn of(recorded: &[f64], sign: f64) -> Option<Self> {
        let onset = onset_of(recorded, HIT_OVER_PEAK);
        let samples: Vec<f64> = recorded.iter().map(|x| sign * x).collect();
        let (before, _) = samples.split_at_checked(onset)?;
        let rest = Rest::of(before)?;
        let excursions = samples.iter().map(|x| (x - rest.level).abs());
        Some(Self {
            peak: excursions.fold(0.0, f64::max),
            step: smallest_step(&samples),
            is_live: smallest_step(before) > 0.0,
            rest,
            samples,
        })
    }

    fn greatest(&self) -> f64 {
        let samples = self.samples.iter().copied();
        samples.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Returns the number of samples at `limit`, the number of runs that they form, and the index
    /// of the first sample.
    fn at(&self, limit: f64) -> (usize, usize, usize) {
        let is_at = |x: &f64| same(*x, limit);
        let chunks = self.samples.chunk_by(|a, b| is_at(a) == is_at(b));
        let runs = chunks.filter(|run| run.first().is_some_and(is_at)).count();
        let count = self.samples.iter().filter(|x| is_at(x)).count();
        (
            count,
            runs,
            self.samples.iter().position(is_at).unwrap_or(0),
        )
    }
}

/// Returns the extreme of a long stationary record if only clipping explains it, and the number of
/// samples at that extreme: at least four, and more than in the eight converter steps next to it.
/// `None` if there is no such extreme.
#[must_use]
pub fn repeated_extreme(samples: &[f64]) -> Option<(f64, usize)> {
    let near = NUMBERS_BELOW * smallest_step(samples);
    [1.0, -1.0].into_iter().find_map(|sign| {
        let greatest = samples
            .iter()
            .map(|x| sign * x)
            .fold(f64::NEG_INFINITY, f64::max);
        let (mut count, mut below) = (0, 0);
        for depth in samples.iter().map(|x| greatest - sign * x) {
            count += usize::from(depth <= 0.0);
            below += usize::from(depth > 0.0 && depth <= near * (1.0 + f64::EPSILON));
        }
        (near > 0.0 && count >= FEWEST_AT_LIMIT && count > below)
            .then_some((sign * greatest, count))
    })
}

impl Criteria {
    /// Returns the clipping found in the extreme values of all `hits` together, each with its index
    /// in `hits`: a channel reaches the same extreme in at least two peaks, with at least as many
    /// samples as a clipped run has, and with more samples than in the eight converter steps below
    /// it. The samples are counted over the peaks of all hits, however few of them a peak has.
    /// Waves in bars and channels without noise at rest are not checked.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`] for a hit that lacks a channel of the first hit.
    pub fn judge_extremes(&self, hits: &[&Record]) -> Result<Vec<(usize, Reason)>, LabioError> {
        let mut found = Vec::new();
        let (Some(least), false, Some(first)) =
            (self.clipped_run, self.several_passages, hits.first())
        else {
            return Ok(found);
        };
        for channel in first.channels() {
            let name = channel.name();
            for sign in [1.0, -1.0] {
                let mut sides = Vec::with_capacity(hits.len());
                for (place, hit) in hits.iter().enumerate() {
                    let recorded = hit.recorded(name)?.to_vec();
                    sides.extend(Side::of(&recorded, sign).map(|side| (place, side)));
                }
                found.extend(clipped(&sides, least).map(|(place, limit, n, index)| {
                    (
                        place,
                        Reason::Clipped {
                            channel: name.to_owned(),
                            value: sign * limit,
                            run: n,
                            index,
                        },
                    )
                }));
            }
        }
        found.sort_by_key(|(place, _)| *place);
        Ok(found)
    }
}

/// Returns the hits whose greatest samples are clipped, each with the limit, the number of samples
/// at the limit and the index of the first of these samples.
fn clipped(
    sides: &[(usize, Side)],
    least: usize,
) -> impl Iterator<Item = (usize, f64, usize, usize)> {
    let limit = sides
        .iter()
        .map(|(_, side)| side.greatest())
        .fold(f64::NEG_INFINITY, f64::max);
    let steps = sides.iter().map(|(_, side)| side.step);
    let step = steps.filter(|s| *s > 0.0).fold(f64::INFINITY, f64::min);
    let (mut n_at, mut n_runs, mut n_below) = (0, 0, 0);
    let mut places = Vec::new();
    for (place, side) in sides {
        let below = |x: &&f64| {
            let depth = limit - **x;
            depth > 0.0 && depth <= NUMBERS_BELOW * step
        };
        n_below += side.samples.iter().filter(below).count();
        let (count, runs, index) = side.at(limit);
        let from_rest = limit - side.rest.level;
        let least = (BEYOND_NOISE * side.rest.noise).max(LEAST_PART * side.peak);
        if count > 0 && side.is_live && from_rest > least {
            n_at += count;
            n_runs += runs;
            places.push((*place, limit, count, index));
        }
    }
    let is_limit = n_at >= least && n_runs >= 2 && n_at > n_below + 1;
    places.into_iter().filter(move |_| is_limit)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sine of amplitude 10 in converter steps of 0.01, whole or cut at a limit.
    fn sine(limit: f64) -> Vec<f64> {
        let wave = (0..5000).map(|k| 10.0 * (0.0137 * f64::from(k)).sin().clamp(-limit, limit));
        wave.map(|x| (100.0 * x).round() / 100.0).collect()
    }

    #[test]
    fn an_extreme_that_only_clipping_explains_is_found_on_either_side() {
        assert_eq!(repeated_extreme(&sine(1.0)), None);
        let clipped = sine(0.8);
        let at = |limit: f64| {
            clipped
                .iter()
                .filter(|x| (**x - limit).abs() <= 0.0)
                .count()
        };
        assert_eq!(repeated_extreme(&clipped), Some((8.0, at(8.0))));
        let below: Vec<f64> = sine(1.0).iter().map(|x| x.max(-8.0)).collect();
        assert_eq!(repeated_extreme(&below), Some((-8.0, at(-8.0))));
        // three samples may be chance, and a constant has no converter step
        assert_eq!(repeated_extreme(&[0.0, 5.0, 5.0, 5.0, 1.0]), None);
        assert_eq!(repeated_extreme(&[5.0; 9]), None);
    }
}

//! Rest level and noise, by statistics that are robust to outliers.

use super::judgement::{PASSAGE_OVER_PEAK, onset_of};
use crate::{LabioError, Record};

/// Fraction of the samples before the onset that is taken as rest.
const PART_AT_REST: f64 = 0.75;
/// Fewest samples at rest that give a level and its noise.
const FEWEST_AT_REST: usize = 16;
/// Divisor of the hit: the last tenth, in which a body is at rest.
const TAIL: usize = 10;
/// Largest departure from rest there, as a fraction of the peak.
const MOST_LEFT: f64 = 1e-3;

/// Returns the number of samples before the impact in which `channels` are at rest in each of
/// `hits`: three quarters of those before the first of them leaves its level. `None` if fewer than
/// 16.
///
/// # Errors
///
/// [`LabioError::UnknownChannel`].
pub fn samples_at_rest(hits: &[&Record], channels: &[&str]) -> Result<Option<usize>, LabioError> {
    let mut least: Option<usize> = None;
    for hit in hits {
        for channel in channels {
            let onset = onset_of(&hit.channel(channel)?.to_vec(), PASSAGE_OVER_PEAK);
            least = Some(least.map_or(onset, |least| least.min(onset)));
        }
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a part of a number of samples"
    )]
    let part = |onset: usize| (PART_AT_REST * onset as f64) as usize;
    Ok(least.map(part).filter(|n| *n >= FEWEST_AT_REST))
}

/// Pads `hit` to `n_samples` samples, each channel with its level before the impact, or 0 if fewer
/// than 16 samples give it. This allows averages over hits of unequal length.
///
/// # Validity
///
/// The body must be at rest: the mean square of each channel about its level in the last tenth must
/// not exceed twice that of its noise plus the square of a thousandth of its peak. The padded
/// samples have no noise: rest noise, which is taken for the whole length, is then overestimated by
/// their fraction.
///
/// # Errors
///
/// [`LabioError::NotAtRest`]; [`LabioError::TooFewSamples`] for fewer samples than the hit has.
pub fn padded(hit: &Record, n_samples: usize) -> Result<Record, LabioError> {
    let channels: Vec<&str> = hit.channels().iter().map(|c| c.name()).collect();
    let n_rest = samples_at_rest(&[hit], &channels)?;
    for channel in channels {
        let samples = hit.channel(channel)?.to_vec();
        let rest = n_rest.and_then(|n| samples.get(..n));
        let level = rest.map_or(0.0, |rest| rest.iter().sum::<f64>() / rest.len() as f64);
        let noise = rest.and_then(Rest::of).map_or(0.0, |rest| rest.noise);
        let peak = samples
            .iter()
            .map(|x| (x - level).abs())
            .fold(0.0, f64::max);
        let n_tail = samples.len().div_ceil(TAIL);
        let tail = samples.iter().rev().take(n_tail);
        let square = tail.map(|x| (x - level).powi(2)).sum::<f64>() / n_tail as f64;
        // the noise of the tail, and as much again
        if square > 2.0 * noise * noise + (MOST_LEFT * peak).powi(2) {
            return Err(LabioError::NotAtRest {
                channel: channel.to_owned(),
                remainder: square.sqrt(),
                peak,
            });
        }
    }
    hit.continued(n_samples, n_rest)
}

/// A stretch of samples at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rest {
    /// Median.
    pub(super) level: f64,
    /// Standard deviation of Gaussian noise with the median absolute deviation found.
    pub(super) noise: f64,
    pub(super) n_samples: usize,
}

/// Standard deviation of a Gaussian over its median absolute deviation, 1/Φ⁻¹(3/4).
const DEVIATION_OVER_MAD: f64 = 1.482602218505602;

impl Rest {
    /// Rest of `samples`, if there are any.
    pub(super) fn of(samples: &[f64]) -> Option<Self> {
        let mut sorted = samples.to_vec();
        let level = median(&mut sorted)?;
        let mut deviations: Vec<f64> = samples.iter().map(|x| (x - level).abs()).collect();
        Some(Self {
            level,
            noise: DEVIATION_OVER_MAD * median(&mut deviations)?,
            n_samples: samples.len(),
        })
    }

    /// Standard error of the level: that of a median is √(π/2) times that of a mean.
    pub(super) fn level_error(&self) -> f64 {
        self.noise * (std::f64::consts::FRAC_PI_2 / self.n_samples as f64).sqrt()
    }
}

fn median(values: &mut [f64]) -> Option<f64> {
    let n = values.len();
    if n == 0 {
        return None;
    }
    let (below, &mut upper, _) = values.select_nth_unstable_by(n / 2, f64::total_cmp);
    if n.is_multiple_of(2) {
        let lower = below.iter().copied().reduce(f64::max)?;
        Some(lower + (upper - lower) / 2.0)
    } else {
        Some(upper)
    }
}

/// The smallest difference of consecutive samples that is not zero: the step of the recorder's
/// numbers, or less.
pub(super) fn smallest_step(samples: &[f64]) -> f64 {
    let mut smallest = f64::INFINITY;
    for (a, b) in samples.iter().zip(samples.iter().skip(1)) {
        let step = (b - a).abs();
        if step > 0.0 && step < smallest {
            smallest = step;
        }
    }
    if smallest.is_finite() { smallest } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn medians_of_odd_and_even_numbers() {
        for (values, expected) in [
            (vec![3.0], 3.0),
            (vec![3.0, 1.0], 2.0),
            (vec![5.0, 1.0, 2.0], 2.0),
            (vec![4.0, 1.0, 3.0, 2.0], 2.5),
        ] {
            let found = median(&mut values.clone()).unwrap();
            assert!((found - expected).abs() < 1e-15, "{values:?}: {found}");
        }
        assert_eq!(Rest::of(&[]), None);
    }

    #[test]
    fn a_tenth_of_wild_samples_moves_neither_level_nor_noise_much() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let n = 10_000;
        let mut samples: Vec<f64> = (0..n)
            .map(|_| {
                let unit: f64 = StandardNormal.sample(&mut rng);
                7.0 + 0.5 * unit
            })
            .collect();
        let clean = Rest::of(&samples).unwrap();
        // the median of n deviates errs by 0.5·√(π/2n) = 0.0063, the scaled deviation by
        // 0.5·1.17/√n = 0.0058: four of each
        assert!((clean.level - 7.0).abs() < 0.025 && (clean.noise - 0.5).abs() < 0.023);
        assert!((clean.level_error() - 0.0063).abs() < 0.0005);
        for sample in samples.iter_mut().step_by(10) {
            *sample = 1e6;
        }
        let spoiled = Rest::of(&samples).unwrap();
        // the median is then the quantile 5/9 of the clean ones, 0.14 deviations up
        assert!((spoiled.level - 7.07).abs() < 0.03 && (spoiled.noise - 0.5).abs() < 0.1);
    }
}

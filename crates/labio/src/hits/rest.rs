//! Rest level and noise, from statistics that are robust to outliers.

use statrs::statistics::{Data, OrderStatistics};

use crate::quantization::smallest_step;
use crate::{LabioError, LevelAtRest, Record};

/// Fewest samples for a rest level: with fewer, one outlier in three shifts its median.
pub(super) const LEAST_REST: usize = 8;
/// Number of standard deviations that noise does not reach within a record.
pub(super) const BEYOND_NOISE: f64 = 10.0;
/// Fraction of the largest excursion above which a hammer hit counts as begun: the signal is then
/// within the contact.
pub(super) const HIT_OVER_PEAK: f64 = 0.1;
/// Fraction of the largest excursion above which the first passage of a wave counts as begun: it
/// may be smaller than a later passage, but not smaller than the pre-ringing of filters.
pub(super) const PASSAGE_OVER_PEAK: f64 = 0.02;
/// Fraction of the samples before the onset that is treated as rest.
const PART_AT_REST: f64 = 0.75;
/// Fewest samples at rest for a level and its noise.
const FEWEST_AT_REST: usize = 16;
/// Number of equal parts of a hit; in the last one, the body must be at rest.
const TAIL: usize = 10;
/// Largest deviation from rest in the last tenth, as a fraction of the peak.
const MOST_LEFT: f64 = 1e-3;

/// Returns the number of samples before the impact in which `channels` are at rest in each of
/// `hits`: three quarters of the samples before the first of the channels leaves its level. `None`
/// if there are fewer than 16.
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
        reason = "a fraction of a number of samples"
    )]
    let part = |onset: usize| (PART_AT_REST * onset as f64) as usize;
    Ok(least.map(part).filter(|n| *n >= FEWEST_AT_REST))
}

/// Pads `hit` to `n_samples` samples, each channel with its level before the impact, or with 0 if
/// there are fewer than 16 samples for a level. This allows averages over hits of unequal length.
///
/// # Validity
///
/// The body must be at rest: the mean square of each channel about its level in the last tenth must
/// not exceed twice the mean square of its noise plus the square of a thousandth of its peak. The
/// padded samples have no noise, but the noise at rest is assumed over the whole length; it is
/// therefore overestimated by the fraction of padded samples.
///
/// # Errors
///
/// [`LabioError::NotAtRest`]; [`LabioError::TooFewSamples`] if `n_samples` is less than the length
/// of the hit.
pub fn padded(hit: &Record, n_samples: usize) -> Result<Record, LabioError> {
    let channels: Vec<&str> = hit.channels().iter().map(|c| c.name()).collect();
    let n_rest = samples_at_rest(&[hit], &channels)?;
    for channel in channels {
        let samples = hit.channel(channel)?.to_vec();
        let rest = n_rest.and_then(|n| samples.get(..n));
        let at_rest = rest.and_then(|rest| LevelAtRest::of(rest.iter().copied()));
        let level = at_rest.map_or(0.0, |rest| rest.level);
        let noise = rest.and_then(Rest::of).map_or(0.0, |rest| rest.noise);
        let peak = samples
            .iter()
            .map(|x| (x - level).abs())
            .fold(0.0, f64::max);
        let n_tail = samples.len().div_ceil(TAIL);
        let tail = samples.iter().rev().take(n_tail);
        let square = tail.map(|x| (x - level).powi(2)).sum::<f64>() / n_tail as f64;
        // twice the power of the noise, and a thousandth of the peak
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

/// Ratio of the standard deviation of a Gaussian to its median absolute deviation, 1/Φ⁻¹(3/4).
const DEVIATION_OVER_MAD: f64 = 1.482602218505602;

impl Rest {
    /// Returns the rest level and noise of `samples`, if there are any.
    pub(super) fn of(samples: &[f64]) -> Option<Self> {
        if samples.is_empty() {
            return None;
        }
        let level = Data::new(samples.to_vec()).median();
        let deviations: Vec<f64> = samples.iter().map(|x| (x - level).abs()).collect();
        Some(Self {
            level,
            noise: DEVIATION_OVER_MAD * Data::new(deviations).median(),
            n_samples: samples.len(),
        })
    }

    /// Standard error of the level: that of a median is √(π/2) times that of a mean.
    pub(super) fn level_error(&self) -> f64 {
        self.noise * (std::f64::consts::FRAC_PI_2 / self.n_samples as f64).sqrt()
    }
}

/// Number of equal blocks whose means show the error of the mean of a signal.
const BLOCKS: usize = 8;

/// Returns the mean of `samples` and its standard error from the scatter of the means of eight
/// equal blocks, which is also right for a signal that rings with periods shorter than a block;
/// `None` for fewer than eight samples. Up to seven samples at the beginning are left out.
pub(super) fn mean_of_blocks(samples: &[f64]) -> Option<(f64, f64)> {
    let length = samples.len() / BLOCKS;
    if length == 0 {
        return None;
    }
    let blocks = samples.rchunks_exact(length).take(BLOCKS);
    let means: Vec<f64> = blocks
        .map(|block| block.iter().sum::<f64>() / length as f64)
        .collect();
    let count = BLOCKS as f64;
    let mean = means.iter().sum::<f64>() / count;
    let square: f64 = means.iter().map(|x| (x - mean).powi(2)).sum();
    Some((mean, (square / (count * (count - 1.0))).sqrt()))
}

/// Returns the index of the first sample that differs from the initial level by more than the noise
/// at the beginning and by more than `part_of_peak` of the largest excursion, or the number of
/// samples if there is none.
///
/// Level and noise are found first from the first samples, and then from all samples before the
/// onset found in this way.
pub(super) fn onset_of(samples: &[f64], part_of_peak: f64) -> usize {
    let head = samples.get(..LEAST_REST).unwrap_or(samples);
    let Some(first) = Rest::of(head) else {
        return 0;
    };
    let peak = samples
        .iter()
        .map(|x| (x - first.level).abs())
        .fold(0.0, f64::max);
    let passage = |rest: &Rest, at_rest: &[f64], searched: &[f64]| {
        // rounding by a converter has a standard deviation that the median absolute deviation does
        // not show
        let noise = rest.noise.max(smallest_step(at_rest) / 12.0_f64.sqrt());
        let level = (BEYOND_NOISE * noise)
            .max(part_of_peak * peak)
            .min(0.5 * peak);
        searched.iter().position(|x| (x - rest.level).abs() > level)
    };
    let Some(coarse) = passage(&first, head, samples) else {
        return samples.len();
    };
    let (before, _) = samples.split_at(coarse);
    let (searched, _) = samples.split_at(coarse + 1);
    let rest = Rest::of(before).unwrap_or(first);
    passage(&rest, before, searched).unwrap_or(coarse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use testbed::noise::Noise;

    #[test]
    fn the_onset_is_found_on_an_offset_and_on_either_slope() {
        // the falling side is steeper than the rising side
        let mut pulse = vec![40.0; 100];
        for (k, x) in [1.0, 3.0, 6.0, 10.0, 1.0].into_iter().enumerate() {
            pulse[30 + k] += x;
        }
        // the first sample, 1.0, does not exceed a tenth of the peak
        assert_eq!(onset_of(&pulse, HIT_OVER_PEAK), 31);
        for sample in &mut pulse {
            *sample = -*sample;
        }
        assert_eq!(onset_of(&pulse, HIT_OVER_PEAK), 31);
        assert_eq!(onset_of(&pulse, PASSAGE_OVER_PEAK), 30);
        assert_eq!(onset_of(&[], HIT_OVER_PEAK), 0);
        assert_eq!(onset_of(&[1.0, 1.0], HIT_OVER_PEAK), 2, "no passage at all");
    }

    #[test]
    fn r17_the_onset_is_the_first_passage_and_not_the_steepest() {
        // a slow wave of 0.3, followed by a fast wave of -1, with the last digit of the converter
        // changing at every seventh sample
        let mut wave: Vec<f64> = (0..4000)
            .map(|k| if k % 7 == 0 { 0.004 } else { 0.0 })
            .collect();
        for (k, x) in wave.iter_mut().enumerate().skip(1000).take(600) {
            *x += 0.3 * (std::f64::consts::PI * (k - 1000) as f64 / 600.0).sin();
        }
        for x in wave.iter_mut().skip(2500).take(20) {
            *x -= 1.0;
        }
        // the sine passes a fiftieth of the peak where it is 0.067
        let onset = onset_of(&wave, PASSAGE_OVER_PEAK);
        assert!((1008..1016).contains(&onset), "{onset}");
        // the sine passes a tenth of the peak where it is 0.33
        let onset = onset_of(&wave, HIT_OVER_PEAK);
        assert!((1055..1067).contains(&onset), "{onset}");
    }

    /// A hit of 200 samples: a level of 3, an impact of 50 above this level in samples 100 to 109,
    /// and then a constant force of `left` above the level.
    fn hit(left: f64) -> Record {
        let mut samples = ndarray::Array2::from_elem((1, 200), 3.0);
        for (k, x) in samples.iter_mut().enumerate().skip(100) {
            *x += if k < 110 { 50.0 } else { left };
        }
        Record::of_test(samples, 1e4, &[("force", crate::Quantity::Force)])
    }

    #[test]
    fn a_padded_hit_stays_at_its_level_and_one_that_still_moves_is_refused() {
        let longer = padded(&hit(0.0), 260).unwrap();
        let samples = longer.channel("force").unwrap().to_vec();
        assert_eq!(samples.len(), 260);
        assert_eq!(samples[..200], hit(0.0).channel("force").unwrap().to_vec());
        assert!(
            samples[200..].iter().all(|x| (x - 3.0).abs() <= 0.0),
            "{samples:?}"
        );
        // at most a thousandth of the peak of 50 may remain
        assert!(padded(&hit(0.049), 260).is_ok());
        let error = padded(&hit(0.051), 260).unwrap_err();
        assert!(
            matches!(&error, LabioError::NotAtRest { peak, .. } if (peak - 50.0).abs() <= 0.0),
            "{error:?}"
        );
        let error = padded(&hit(0.0), 199).unwrap_err();
        let LabioError::TooFewSamples {
            found, expected, ..
        } = error
        else {
            panic!("{error}");
        };
        assert_eq!((found, expected), (199, 200));
    }

    /// The second record begins 20 samples before the impact: three quarters of 20 are 15 samples,
    /// too few for a level.
    #[test]
    fn a_level_needs_sixteen_samples_before_the_blow() {
        let record = hit(0.0);
        assert_eq!(samples_at_rest(&[&record], &["force"]).unwrap(), Some(75));
        let early = record.part(80..200).unwrap();
        assert_eq!(
            samples_at_rest(&[&record, &early], &["force"]).unwrap(),
            None
        );
        assert!(samples_at_rest(&[&record], &["velocity"]).is_err());
    }

    #[test]
    fn a_tenth_of_wild_samples_moves_neither_level_nor_noise_much() {
        let mut rng = Noise::seeded(5);
        let n = 10_000;
        let mut samples: Vec<f64> = (0..n).map(|_| 7.0 + 0.5 * rng.normal()).collect();
        assert_eq!(Rest::of(&[]), None);
        let clean = Rest::of(&samples).unwrap();
        // tolerance: four standard errors, which are 0.5·√(π/2n) = 0.0063 for the median and
        // 0.5·1.17/√n = 0.0058 for the scaled deviation
        assert!((clean.level - 7.0).abs() < 0.025 && (clean.noise - 0.5).abs() < 0.023);
        assert!((clean.level_error() - 0.0063).abs() < 0.0005);
        for sample in samples.iter_mut().step_by(10) {
            *sample = 1e6;
        }
        let spoiled = Rest::of(&samples).unwrap();
        // a tenth of the samples is too large: the median is the quantile 5/9 of the others, 0.14
        // standard deviations above their median
        assert!((spoiled.level - 7.07).abs() < 0.03 && (spoiled.noise - 0.5).abs() < 0.1);
    }
}

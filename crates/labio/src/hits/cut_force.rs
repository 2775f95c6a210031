//! Detection of a force that a window of the analyser cuts off before the impact ends.

use super::samples_at_rest;
use crate::quantization::{same, smallest_step};
use crate::{LabioError, LevelAtRest, Record};

/// Fraction of the peak force above which the impact has not ended.
const OF_BLOW: f64 = 0.02;
/// Number of standard deviations that noise does not reach during an impact.
const BEYOND_NOISE: f64 = 5.0;
/// Number of converter steps that a force at rest does not reach.
const STEPS: f64 = 3.0;
/// Smallest number of equal last samples that counts as the effect of a window.
const STILL: usize = 8;
/// Factor by which the number of equal last samples must exceed the longest run of equal samples
/// before the impact: noise below a step of the converter also leaves equal samples.
const LONGER: usize = 4;

/// A force that is cut off before the impact ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CutForce {
    /// Index of the hit.
    pub hit: usize,
    /// Last force before the cut, divided by the peak force.
    pub part_of_peak: f64,
}

/// Returns the `hits` whose `force` ends in a run of eight or more equal samples that begins before
/// the impact has ended. The cause is a force window of the analyser, which removes a part of the
/// spectrum of the force.
///
/// The force $`F`$ is counted from its level at rest, in the direction of its peak
/// $`F_\mathrm{max}`$. The impact has not ended if all samples from the peak to the run satisfy
///
/// ```math
/// F > \max(0.02\,F_\mathrm{max},\ 5\sigma,\ 3q) ,
/// ```
///
/// with the noise $`\sigma`$ at rest ([`LevelAtRest`]) and the [`smallest_step`] $`q`$ of the
/// converter. In addition, the force cannot have ended in this run by itself: the run is more than
/// four times as long as every run of equal samples before the impact, or the last samples
/// $`F_3, F_2, F_1`$ before the run satisfy
///
/// ```math
/// F_1 > \max(F_2 - F_1,\ 2(F_2 - F_1) - (F_3 - F_2)) + 5\sigma + 4q ,
/// ```
///
/// so that the force fell, and was about to fall, by less than $`F_1`$ in one sample.
///
/// # Validity
///
/// A window that begins after the impact has ended is not found. A tapered window is found if its
/// last sample exceeds 2 % of the peak; otherwise the force resembles a shorter impact. Hits in
/// which the channel is a motion are left out: a motion may stay constant.
///
/// # Errors
///
/// [`LabioError::UnknownChannel`].
///
/// # Examples
///
/// ```
/// use labio::hits::find_cut_forces;
/// use labio::{Channel, Provenance, Quantity, Record};
/// use ndarray::Array2;
///
/// // a half sine of 40 samples from sample 100 on, which a window cuts off after 30 samples
/// let hit = |end: usize| {
///     let samples = Array2::from_shape_fn((1, 400), |(_, n)| match n {
///         100..140 if n < end => (std::f64::consts::PI * (n as f64 - 100.0) / 40.0).sin(),
///         _ => 0.0,
///     });
///     let channels = vec![Channel::new("hammer", Quantity::Force)?];
///     Record::new(samples, 5e4, 0.0, channels, Provenance::computed("example"))
/// };
/// let (whole, cut) = (hit(400)?, hit(130)?);
/// let found = find_cut_forces(&[&whole, &cut], "hammer")?;
/// assert_eq!((found.len(), found[0].hit), (1, 1));
/// assert!((found[0].part_of_peak - 0.76).abs() < 0.01);
/// # Ok::<(), labio::LabioError>(())
/// ```
pub fn find_cut_forces(hits: &[&Record], force: &str) -> Result<Vec<CutForce>, LabioError> {
    let mut found = Vec::new();
    for (index, hit) in hits.iter().enumerate() {
        let (_, channel) = crate::channel::find(hit.channels(), force)?;
        if !channel.quantity().may_be_force() {
            continue;
        }
        let samples = hit.channel(force)?.to_vec();
        let n_rest = samples_at_rest(&[hit], &[force])?;
        found.extend(cut_at(&samples, n_rest).map(|part_of_peak| CutForce {
            hit: index,
            part_of_peak,
        }));
    }
    Ok(found)
}

/// Returns the last force before a run of equal last samples, relative to the peak, if the impact
/// has not ended there; `n_rest` is the number of samples at rest before the impact.
fn cut_at(samples: &[f64], n_rest: Option<usize>) -> Option<f64> {
    let last = *samples.last()?;
    let length = equal_at_end(samples);
    let (recorded, _) = samples.split_at_checked(samples.len().checked_sub(length)?)?;
    let rest = n_rest.and_then(|n| samples.get(..n)).unwrap_or_default();
    let at_rest = LevelAtRest::of(rest.iter().copied());
    let (level, noise) = at_rest.map_or((last, 0.0), |rest| (rest.level, rest.noise));
    let excursions = recorded.iter().map(|x| x - level).enumerate();
    let (at, extreme) = excursions.max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))?;
    let peak = extreme.abs();
    let from_peak: Vec<f64> = recorded
        .iter()
        .skip(at)
        .map(|x| extreme.signum() * (x - level))
        .collect();
    let step = smallest_step(samples);
    let least = (OF_BLOW * peak).max(BEYOND_NOISE * noise).max(STEPS * step);
    let is_within_blow = length >= STILL && from_peak.iter().all(|x| *x > least);
    if !is_within_blow {
        return None;
    }
    let longest = longest_run(rest);
    let is_proven = !rest.is_empty() && longest < rest.len() && length > LONGER * longest;
    let value = *from_peak.last()?;
    let is_steep = || {
        let before = |n: usize| {
            let place = recorded.len().checked_sub(n)?;
            Some(extreme.signum() * (recorded.get(place)? - level))
        };
        let (Some(second), Some(third)) = (before(2), before(3)) else {
            return false;
        };
        let (fall, fall_before) = (second - value, third - second);
        // four steps exceed the largest rounding error of the second difference, seven halves of a
        // step
        value > fall.max(2.0 * fall - fall_before) + BEYOND_NOISE * noise + 4.0 * step
    };
    (is_proven || is_steep()).then(|| value / peak)
}

fn equal_at_end(samples: &[f64]) -> usize {
    let runs = samples.chunk_by(|a, b| same(*a, *b));
    runs.last().map_or(0, <[f64]>::len)
}

/// Returns the length of the longest run of equal samples.
fn longest_run(samples: &[f64]) -> usize {
    let runs = samples.chunk_by(|a, b| same(*a, *b));
    runs.map(<[f64]>::len).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;
    use testbed::half_sine::half_sine;

    const REST: usize = 300;

    /// A squared sine of 40 samples from sample 400 on, with noise of 3e-4 of the peak.
    fn force(noise: f64) -> Vec<f64> {
        (0..2000_u32)
            .map(|n| {
                let blow = half_sine((f64::from(n) - 400.0) / 40.0).powi(2);
                // with noise, no two neighbouring samples are equal
                blow + noise * (f64::from(n) * 1.3).sin()
            })
            .collect()
    }

    /// The force under a window that ends, or falls to 0, at the sample `end`.
    fn windowed(noise: f64, end: usize, taper: usize) -> Vec<f64> {
        let weight = |n: usize| (end.saturating_sub(n) as f64 / taper.max(1) as f64).min(1.0);
        let samples = force(noise).into_iter().enumerate();
        samples.map(|(n, x)| weight(n) * x).collect()
    }

    #[test]
    fn a_force_window_that_ends_within_the_blow_is_found() {
        for noise in [0.0, 3e-4] {
            // the last sample is 429, at a phase of 29/40
            let expected = (PI * 29.0 / 40.0).sin().powi(2);
            let found = cut_at(&windowed(noise, 430, 1), Some(REST)).unwrap();
            assert!((found - expected).abs() < 2.0 * noise + 1e-12, "{found}");
            // cut at 2.4 % of the peak, near the end of the impact: found only if the record has
            // noise, because the samples after the cut have none
            let near = cut_at(&windowed(noise, 439, 1), Some(REST));
            assert_eq!(near.is_some(), noise > 0.0, "{near:?}");
            // windows that end after the impact, where the force is below 2 % of the peak
            for end in [441, 445, 500, 1000] {
                assert_eq!(cut_at(&windowed(noise, end, 1), Some(REST)), None);
            }
            assert_eq!(cut_at(&windowed(noise, 500, 40), Some(REST)), None);
            assert_eq!(cut_at(&force(noise), Some(REST)), None);
        }
        // a steep taper whose last sample is far above the noise
        assert!(cut_at(&windowed(3e-4, 434, 4), Some(REST)).is_some());
        // a window that also sets the last samples before the impact to 0
        let mut both = windowed(3e-4, 430, 1);
        both[..390].fill(0.0);
        assert!(cut_at(&both, Some(REST)).is_some());
        assert!(cut_at(&both, None).is_some());
        assert_eq!(cut_at(&[], None), None);
        assert_eq!(cut_at(&[1.0; 20], None), None);
    }

    /// A half sine without noise, of few or many samples, ends in zeros by itself.
    #[test]
    fn a_blow_that_ends_by_itself_is_not_cut() {
        for length in [4, 7, 8, 16, 50] {
            for shift in [0.0, 0.3, 0.6] {
                let samples: Vec<f64> = (0..200_u32)
                    .map(|n| half_sine((f64::from(n) - 100.0 + shift) / f64::from(length)))
                    .collect();
                assert_eq!(cut_at(&samples, Some(75)), None, "{length} {shift}");
                // a converter with steps of a fiftieth of the peak
                let coarse: Vec<f64> = samples.iter().map(|x| (50.0 * x).round() / 50.0).collect();
                assert_eq!(cut_at(&coarse, Some(75)), None, "{length} {shift}");
            }
        }
    }
}

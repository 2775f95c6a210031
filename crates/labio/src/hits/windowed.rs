//! Detection of noise that falls within the records, because the analyser has applied a window.

use ndarray::ArrayView1;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::rest::samples_at_rest;
use crate::quantization::smallest_step;
use crate::{LabioError, Record};

/// Fewest samples in each of the two compared parts.
const FEWEST_SAMPLES: usize = 32;
/// Each compared part is at most the hit divided by this number.
const END: usize = 8;
/// Factor by which a fourth difference multiplies the variance of white noise: the sum of its
/// squared coefficients.
const GAIN: f64 = 70.0;
/// Largest lag k of the autocorrelations.
const LAGS: usize = 16;
/// Number of equal last samples that shows that they were not measured: the analyser has continued
/// the hit at its level, or has set the force to 0 after the impact.
const STILL: usize = 4;
/// Smallest noise, in steps of the converter, for which the rounding error is independent of the
/// level.
const LEAST_STEPS: f64 = 0.5;
/// Smallest noise relative to the largest sample, above the rounding of single precision.
const FINEST: f64 = 2e-7;
/// Ratio of the noise variance at the end to that before the impact, below which the noise is
/// judged to fall.
const LARGEST_RATIO: f64 = 0.8;
/// Probability by chance of a ratio as small as the one found, below which the noise is judged to
/// fall.
const LEVEL: f64 = 1e-4;

/// Noise of a channel that is smaller at the end of the records than before the impacts.
#[derive(Debug, Clone, PartialEq)]
pub struct FallingNoise {
    /// Name of the channel.
    pub channel: String,
    /// Standard deviation before the impacts, computed from the mean square of fourth differences
    /// as for white noise.
    pub before: f64,
    /// Standard deviation at the end of the records, computed in the same way.
    pub after: f64,
    /// Decay rate \[1/s\] of the exponential window that would reduce the noise from `before` to
    /// `after`.
    pub decay_rate: f64,
}

/// Returns the `channels` whose noise at the end of the `hits` is smaller than before the impacts,
/// because a window was applied to the records.
///
/// The noise is measured by the fourth differences of the samples, which contain the noise at high
/// frequencies and almost nothing of a smooth motion. Two parts of equal length are compared over
/// all hits by an F test: the last half of the rest before the impact, but at most an eighth of the
/// hit, and the end of the hit. The $`n`$ differences of a part, with the autocorrelations $`r_k`$,
/// have $`n/(1 + 2\sum r_k^2)`$ degrees of freedom. The noise is judged to fall if the mean square
/// at the end is less than 0.8 times that before the impact, and if a ratio this small has a
/// probability below 1e-4 by chance. Of three or more hits, the hit with the greatest noise before
/// the impact is left out, because a single disturbance may have caused this noise.
///
/// # Validity
///
/// Valid if the noise is stationary apart from the window. A motion at the end increases the
/// differences there, so it can hide a window but not simulate one. The following hits are left
/// out: hits with fewer than 256 samples, or with fewer than 64 at rest before the impact; hits
/// whose noise in either part is below half a step of the converter; hits whose last four samples
/// in either part are equal.
///
/// # Errors
///
/// [`LabioError::UnknownChannel`].
pub fn find_falling_noise(
    hits: &[&Record],
    channels: &[&str],
) -> Result<Vec<FallingNoise>, LabioError> {
    let mut parts = Vec::with_capacity(hits.len());
    for hit in hits {
        let n_rest = samples_at_rest(&[hit], channels)?.unwrap_or(0);
        let n_samples = (n_rest / 2).min(hit.n_samples() / END);
        if n_samples >= FEWEST_SAMPLES {
            parts.push((*hit, n_rest, n_samples));
        }
    }
    let mut found = Vec::new();
    let mut work = Work::default();
    for channel in channels {
        let mut pairs = Vec::with_capacity(parts.len());
        let mut spans = 0.0;
        for (hit, n_rest, n_samples) in &parts {
            let samples = hit.channel(channel)?;
            let last = samples.len() - n_samples;
            let before = work.noise(samples, n_rest - n_samples, *n_samples);
            let after = work.noise(samples, last, *n_samples);
            if let (Some(before), Some(after)) = (before, after) {
                pairs.push((before, after));
                spans += (samples.len() - n_rest) as f64 / hit.sampling_rate_hz();
            }
        }
        let span = spans / pairs.len() as f64;
        if let Some((before, after)) = falls(pairs) {
            found.push(FallingNoise {
                channel: (*channel).to_owned(),
                before: before.sqrt(),
                after: after.sqrt(),
                decay_rate: 0.5 * (before / after).ln() / span,
            });
        }
    }
    Ok(found)
}

/// Returns the variances before the impacts and at the ends, if the second is significantly
/// smaller.
fn falls(mut pairs: Vec<(Noise, Noise)>) -> Option<(f64, f64)> {
    if pairs.len() > 2 {
        let variances = pairs.iter().map(|(before, _)| before.variance());
        let loudest = variances.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        pairs.swap_remove(loudest?.0);
    }
    let (mut before, mut after) = pairs.pop()?;
    for (one, other) in &pairs {
        before.add(one);
        after.add(other);
    }
    let ratio = after.variance() / before.variance();
    let law = FisherSnedecor::new(after.degrees_of_freedom(), before.degrees_of_freedom()).ok()?;
    let is_falling = ratio < LARGEST_RATIO && law.cdf(ratio) < LEVEL;
    is_falling.then(|| (before.variance(), after.variance()))
}

/// Sums from which the variance of the noise and its degrees of freedom are computed.
struct Noise {
    n_differences: f64,
    /// Sums of the products of two differences, by their lag from 0 on.
    products: [f64; LAGS + 1],
}

impl Noise {
    fn add(&mut self, other: &Self) {
        self.n_differences += other.n_differences;
        for (sum, product) in self.products.iter_mut().zip(other.products) {
            *sum += product;
        }
    }

    fn variance(&self) -> f64 {
        let [squares, ..] = self.products;
        squares / (GAIN * self.n_differences)
    }

    fn degrees_of_freedom(&self) -> f64 {
        let [squares, lagged @ ..] = &self.products;
        let correlated: f64 = lagged.iter().map(|sum| (sum / squares).powi(2)).sum();
        self.n_differences / (1.0 + 2.0 * correlated)
    }
}

/// Buffers for the samples of a part and their differences.
#[derive(Default)]
struct Work {
    part: Vec<f64>,
    differences: Vec<f64>,
}

impl Work {
    /// Returns the noise of `n_samples` samples from the sample `first` on; `None` if the noise is
    /// too small for the step of the converter or the precision of the numbers, or if the last
    /// samples are equal.
    fn noise(
        &mut self,
        samples: ArrayView1<'_, f64>,
        first: usize,
        n_samples: usize,
    ) -> Option<Noise> {
        self.part.clear();
        self.part.extend(samples.iter().skip(first).take(n_samples));
        let last = *self.part.last()?;
        let mut ending = self.part.iter().rev().take(STILL);
        if ending.all(|x| (x - last).abs() <= 0.0) {
            return None;
        }
        self.differences.clear();
        self.differences
            .extend(self.part.windows(5).filter_map(|five| match five {
                [a, b, c, d, e] => Some(a - 4.0 * b + 6.0 * c - 4.0 * d + e),
                _ => None,
            }));
        let products = std::array::from_fn(|lag| {
            let later = self.differences.iter().skip(lag);
            self.differences.iter().zip(later).map(|(a, b)| a * b).sum()
        });
        let noise = Noise {
            n_differences: self.differences.len() as f64,
            products,
        };
        let largest = self.part.iter().fold(0.0, |top: f64, x| top.max(x.abs()));
        let least = (LEAST_STEPS * smallest_step(&self.part)).max(FINEST * largest);
        (noise.variance().sqrt() > least).then_some(noise)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Quantity;
    use ndarray::Array2;
    use testbed::noise::Noise;

    const N: usize = 4096;
    const RATE_HZ: f64 = 20_000.0;

    /// Result for five hits: an impact at sample 400, ringing of 1 kHz with a time constant of 2
    /// ms, and noise with a standard deviation of 0.01. `change` converts the true sample at an
    /// index to the recorded sample.
    fn found(seed: u64, change: impl Fn(usize, f64) -> f64) -> Vec<FallingNoise> {
        let mut rng = Noise::seeded(seed);
        let hits: Vec<Record> = (0..5)
            .map(|_| {
                let samples = Array2::from_shape_fn((1, N), |(_, n)| {
                    let unit = rng.normal();
                    let t = n as f64 - 400.0;
                    let rings = if t > 0.0 {
                        (std::f64::consts::TAU * t / 20.0).sin() * (-t / 40.0).exp()
                    } else {
                        0.0
                    };
                    change(n, rings + 0.01 * unit)
                });
                Record::of_test(samples, RATE_HZ, &[("end", Quantity::Acceleration)])
            })
            .collect();
        let hits: Vec<&Record> = hits.iter().collect();
        find_falling_noise(&hits, &["end"]).unwrap()
    }

    #[test]
    fn noise_falls_under_a_window_only() {
        let t = |n: usize| n as f64 / RATE_HZ;
        for seed in 0..50 {
            assert_eq!(found(seed, |_, x| x), []);
            // a converter with steps of 1.5 or 10 standard deviations of the noise
            for step in [0.015, 0.1] {
                assert_eq!(found(seed, |_, x| (x / step).round() * step), []);
            }
            // a motion at half the sampling rate that does not decay
            let sign = |n: usize| if n.is_multiple_of(2) { 0.02 } else { -0.02 };
            assert_eq!(
                found(seed, |n, x| if n < 400 { x } else { x + sign(n) }),
                []
            );
            // the last 96 samples are replaced by 0
            assert_eq!(found(seed, |n, x| if n < 4000 { x } else { 0.0 }), []);
        }
        let [window] = &found(1, |n, x| x * (-t(n) / 0.1).exp())[..] else {
            panic!("an exponential window is not found");
        };
        // tolerance: three standard errors for 215 degrees of freedom of 4 x 146 differences, which
        // are 5 % of a standard deviation, 7 % of the ratio and 0.4 1/s of the decay rate
        assert!((window.after / window.before - (-1.9_f64).exp()).abs() < 0.25 * 0.15);
        assert!((window.decay_rate - 10.0).abs() < 1.2, "{window:?}");
        assert!((window.before - 0.0089).abs() < 0.0015, "{window:?}");
        let hann = |n: usize| (std::f64::consts::PI * n as f64 / N as f64).sin().powi(2);
        assert_eq!(found(2, |n, x| x * hann(n)).len(), 1);
    }
}

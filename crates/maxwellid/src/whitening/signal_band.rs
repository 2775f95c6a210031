//! Frequency up to which a test has a signal, and the low-pass filter that limits the excitation to
//! this band.

use faer::Mat;

use super::spectrum::{SMOOTHED, mirrored_spectrum};
use crate::noise::HistoryNoise;
use crate::test::RodTest;

/// Width of the transition of the low-pass, as a fraction of half of the sampling rate.
const TRANSITION: f64 = 0.1;

/// Number of weights of the low-pass on either side of the middle one; with Hann's window, the
/// transition then has the width [`TRANSITION`].
const HALF_LENGTH: usize = 31;

/// Number of standard deviations by which the mean power of a block of lines must exceed the noise
/// to be regarded as a signal. With four, noise alone was regarded as a signal in one of twenty
/// records.
const ABOVE_CHANCE: f64 = 6.0;

/// Largest number of blocks into which a spectrum is divided.
const BLOCKS: usize = 20;

/// Fraction of the largest noise power of a line that is added to the noise power of every line, so
/// that no line is without noise.
const LEAST_NOISE: f64 = 1e-3;

/// Zero-phase low-pass filter that passes the band in which a test has a signal. At its ends a
/// history is continued by its mirror image.
#[derive(Debug, Clone)]
pub(super) struct SignalBand {
    /// Weights from the middle one on.
    weights: Vec<f64>,
}

impl SignalBand {
    /// Returns the band of `test`, the same for all laws; `None` without stated noise, for a short
    /// record, and if the signal extends to nearly half of the sampling rate.
    pub(super) fn of(test: &RodTest) -> Option<Self> {
        let noise = test.noise.as_ref()?;
        if test.window <= 2 * HALF_LENGTH {
            return None;
        }
        let excitation = test.excitation_samples.get(..test.window)?;
        let response = test.response.get(..test.window)?;
        let edge = upper_edge(excitation, &noise.excitation);
        Self::up_to(edge.max(upper_edge(response, &noise.response)))
    }

    /// Creates the low-pass that passes frequencies up to `edge`, a fraction of half of the
    /// sampling rate.
    fn up_to(edge: f64) -> Option<Self> {
        if edge + 2.0 * TRANSITION > 1.0 {
            return None;
        }
        let cutoff = std::f64::consts::PI * (edge + 0.5 * TRANSITION);
        let weight = |lag: usize| {
            let x = lag as f64;
            let hann = (0.5 * std::f64::consts::PI * x / (HALF_LENGTH + 1) as f64)
                .cos()
                .powi(2);
            let sinc = if lag == 0 {
                1.0
            } else {
                (cutoff * x).sin() / (cutoff * x)
            };
            hann * sinc
        };
        let mut weights: Vec<f64> = (0..=HALF_LENGTH).map(weight).collect();
        let sum: f64 = weights.iter().sum::<f64>() * 2.0 - 1.0;
        weights.iter_mut().for_each(|weight| *weight /= sum);
        Some(Self { weights })
    }

    /// Places and weights of the samples that make up the filtered sample `at` of a history of
    /// `count` samples.
    fn terms(&self, at: usize, count: usize) -> impl Iterator<Item = (usize, f64)> {
        let after = self.weights.iter().enumerate();
        let before = after.clone().skip(1);
        let after = after.map(move |(lag, weight)| (mirrored(at + lag, count), *weight));
        after.chain(before.map(move |(lag, weight)| (at.abs_diff(lag), *weight)))
    }

    /// Filters a history that has more samples than the low-pass has weights.
    pub(super) fn of_history(&self, history: &[f64]) -> Vec<f64> {
        let at = |place: usize| history.get(place).copied().unwrap_or(0.0);
        let filtered = |place| {
            let terms = self.terms(place, history.len());
            terms.map(|(place, weight)| weight * at(place)).sum()
        };
        (0..history.len()).map(filtered).collect()
    }

    /// Returns H F of a transfer `matrix` H, with this low-pass F.
    pub(super) fn applied_before(&self, matrix: &Mat<f64>) -> Mat<f64> {
        let (rows, count) = (matrix.nrows(), matrix.ncols());
        let mut product = Mat::zeros(rows, count);
        for place in 0..count {
            let column = matrix.col_as_slice(place);
            for (to, weight) in self.terms(place, count) {
                let sum = product.col_as_slice_mut(to).iter_mut();
                sum.zip(column).for_each(|(sum, h)| *sum += weight * h);
            }
        }
        product
    }
}

/// Index of the sample of a history of `count` samples that continues it at the place `at` by its
/// mirror image.
fn mirrored(at: usize, count: usize) -> usize {
    let last = count - 1;
    if at <= last { at } else { 2 * last - at }
}

/// Highest frequency at which the mean power of a block of lines exceeds the noise, as a fraction
/// of half of the sampling rate. The noise power is limited to the power of the highest block.
#[allow(
    clippy::indexing_slicing,
    reason = "a block ends with the last line, and there is a sum before each"
)]
fn upper_edge(history: &[f64], noise: &HistoryNoise) -> f64 {
    let lines = mirrored_spectrum(history, noise);
    let largest = lines
        .iter()
        .fold(0.0, |top, (_, noise)| f64::max(top, *noise));
    let mut sums = vec![(0.0, 0.0)];
    let mut sum = (0.0, 0.0);
    for (power, noise) in &lines {
        sum = (sum.0 + power, sum.1 + noise + LEAST_NOISE * largest);
        sums.push(sum);
    }
    let length = (2 * SMOOTHED + 1).max(lines.len() / BLOCKS);
    let limit = 1.0 + ABOVE_CHANCE * (2.0 / length as f64).sqrt();
    let ratio = |end: usize| {
        let (start, end) = (sums[end - length], sums[end]);
        (end.0 - start.0) / (end.1 - start.1)
    };
    if lines.len() < length {
        return 1.0;
    }
    // factor on a noise that is stated too high, which would hide the signal
    let noise = ratio(lines.len()).min(1.0);
    let has_signal = |end: &usize| ratio(*end) > limit * noise;
    let last = (length..=lines.len()).rev().find(has_signal);
    last.unwrap_or(length) as f64 / lines.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// White noise by a linear congruential generator.
    fn noise(count: usize) -> impl Iterator<Item = f64> {
        let mut state = 12345_u64;
        let uniform = move || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        std::iter::repeat_with(uniform).take(count)
    }

    #[test]
    fn the_band_ends_above_the_highest_wave_that_exceeds_the_noise() {
        let white = HistoryNoise::White {
            standard_deviation: (1.0_f64 / 12.0).sqrt(),
        };
        let wave = |k: usize| (0.3 * std::f64::consts::PI * k as f64).cos();
        let history: Vec<f64> = noise(400).enumerate().map(|(k, n)| n + wave(k)).collect();
        let edge = upper_edge(&history, &white);
        // the wave is at 0.3; tolerance: one block, 20 of 400 lines
        assert!((0.3..=0.36).contains(&edge), "{edge}");
        assert!(upper_edge(&noise(400).collect::<Vec<_>>(), &white) <= 0.1);
        // stated noise of 0, and noise that is stated too high
        let silent = HistoryNoise::White {
            standard_deviation: 0.0,
        };
        assert!(upper_edge(&history, &silent) > 0.99);
        let loud = HistoryNoise::White {
            standard_deviation: 10.0,
        };
        let edge = upper_edge(&history, &loud);
        assert!((0.3..=0.36).contains(&edge), "{edge}");
    }

    /// Checks that a wave in the band passes unchanged within 1 %, that a wave above the transition
    /// is attenuated to less than 1 %, and that the transfer after the low-pass applied to a
    /// history equals the transfer applied to the filtered history.
    #[test]
    fn the_low_pass_separates_waves_and_commutes_with_a_transfer() {
        let band = SignalBand::up_to(0.4).unwrap();
        let wave = |f: f64| -> Vec<f64> {
            let phase = |k: usize| std::f64::consts::PI * f * k as f64;
            (0..=200).map(|k| phase(k).cos()).collect()
        };
        for (f, pass) in [(0.1, 1.0), (0.35, 1.0), (0.55, 0.0), (0.8, 0.0)] {
            for (filtered, v) in band.of_history(&wave(f)).iter().zip(wave(f)) {
                assert!((filtered - pass * v).abs() < 0.01, "{f}: {filtered} {v}");
            }
        }
        let transfer = Mat::from_fn(50, 201, |i, j| ((i * 7 + j * 3) % 11) as f64 - 5.0);
        let limited = band.applied_before(&transfer);
        let history: Vec<f64> = noise(201).collect();
        let filtered = band.of_history(&history);
        for i in 0..50 {
            let of = |h: &Mat<f64>, u: &[f64]| -> f64 { (0..201).map(|j| h[(i, j)] * u[j]).sum() };
            let (one, other) = (of(&limited, &history), of(&transfer, &filtered));
            // tolerance: rounding of sums of 201 terms of size 5
            assert!((one - other).abs() < 1e-11, "{one} {other}");
        }
        assert!(SignalBand::up_to(0.85).is_none());
    }
}

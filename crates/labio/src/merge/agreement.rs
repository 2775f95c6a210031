//! Gain and delay between two tests of the same points.

use num_complex::Complex64;

use crate::FrequencyResponse;
use crate::merge::entering::{common_error_at, relative_variance};

/// Largest difference between two tests, in standard errors, that is attributed to chance.
const COVERAGE: f64 = 3.0;

/// Relative variance of the ratio of two tests above which the logarithm of the ratio is not used.
const ROUGH: f64 = 0.1;

/// Fewest lines for a gain and a delay.
const FEWEST_LINES: usize = 8;

/// A gain and a delay between two tests, $`H_h = g\,H_1 e^{-i\omega\tau}`$, by a least-squares fit
/// to the logarithm of their ratio.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Agreement {
    /// Gain g relative to the first test; negative for an inverted sensor.
    pub gain: f64,
    /// Standard error of the logarithm of the gain, found from the scatter of the lines.
    pub relative_error: f64,
    /// Relative standard uncertainty expected from the common errors of both tests.
    pub expected: f64,
    /// Delay \[s\] relative to the first test.
    pub delay: f64,
    /// Standard error of the delay \[s\].
    pub delay_error: f64,
    /// Number of lines in the fit.
    pub n_lines: usize,
}

impl Agreement {
    /// Returns true if chance and the stated sensor uncertainties explain the gain: its distance from
    /// 1 is at most three standard errors, and it is not negative.
    #[must_use]
    pub fn explains_gain(&self) -> bool {
        let standard_error = self.relative_error.hypot(self.expected);
        self.gain > 0.0 && self.gain.ln().abs() / standard_error <= COVERAGE
    }

    /// Returns true if chance explains the delay.
    #[must_use]
    pub fn explains_delay(&self) -> bool {
        self.delay.abs() <= COVERAGE * self.delay_error
    }
}

/// Returns gain and delay of `other` relative to `first`, fitted to `lines`.
#[allow(
    clippy::indexing_slicing,
    reason = "`MergedResponse::like` has found the same number of lines in every list of every test"
)]
pub(super) fn agreement(
    first: &FrequencyResponse,
    other: &FrequencyResponse,
    lines: impl Iterator<Item = usize>,
) -> Option<Agreement> {
    let mut expected: f64 = 0.0;
    let ratios: Vec<(f64, Complex64, f64)> = lines
        .filter_map(|line| {
            let rough = relative_variance(first, line) + relative_variance(other, line);
            if !(rough > 0.0 && rough < ROUGH) {
                return None;
            }
            let errors = common_error_at(first, line).hypot(common_error_at(other, line));
            expected = expected.max(errors);
            let omega = std::f64::consts::TAU * first.frequency_hz[line];
            Some((omega, other.values[line] / first.values[line], 1.0 / rough))
        })
        .collect();
    if ratios.len() < FEWEST_LINES {
        return None;
    }
    let mean: Complex64 = ratios
        .iter()
        .map(|(_, ratio, w)| ratio * w / ratio.norm())
        .sum();
    let sign = if mean.re < 0.0 { -1.0 } else { 1.0 };
    let mut sums = [0.0; 4];
    let logarithms: Vec<(f64, Complex64, f64)> = ratios
        .into_iter()
        .map(|(omega, ratio, w)| (omega, (ratio * sign).ln(), w))
        .collect();
    for (omega, logarithm, w) in &logarithms {
        sums[0] += w;
        sums[1] += w * logarithm.re;
        sums[2] += w * omega * omega;
        sums[3] -= w * omega * logarithm.im;
    }
    let (log_gain, delay) = (sums[1] / sums[0], sums[3] / sums[2]);
    // from the residuals, which is valid for any weights
    let (mut of_gain, mut of_delay) = (0.0, 0.0);
    for (omega, logarithm, w) in &logarithms {
        of_gain += (w * (logarithm.re - log_gain)).powi(2);
        of_delay += (w * omega * (logarithm.im + delay * omega)).powi(2);
    }
    Some(Agreement {
        gain: sign * log_gain.exp(),
        relative_error: of_gain.sqrt() / sums[0],
        expected,
        delay,
        delay_error: of_delay.sqrt() / sums[2],
        n_lines: logarithms.len(),
    })
}

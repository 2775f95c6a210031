//! Samples and lines of a record, and the samples in which the force acts.

use faer::Mat;
use num_complex::Complex64;

use super::TimeInterval;
use crate::{ImpulseError, fourier};

/// Lines of a record of `n_samples` samples.
#[derive(Clone, Copy)]
pub(super) struct Grid {
    pub(super) n_samples: usize,
    pub(super) sampling_rate_hz: f64,
}

impl Grid {
    pub(super) fn n_lines(self) -> usize {
        self.n_samples / 2 + 1
    }

    pub(super) fn frequency_hz(self, line: usize) -> f64 {
        line as f64 * self.sampling_rate_hz / self.n_samples as f64
    }

    pub(super) fn omega(self, line: usize) -> f64 {
        std::f64::consts::TAU * self.frequency_hz(line)
    }

    /// Number of sides of a line: 1 at 0 Hz and at the Nyquist frequency, else 2.
    pub(super) fn sides(self, line: usize) -> f64 {
        if line == 0 || 2 * line == self.n_samples {
            1.0
        } else {
            2.0
        }
    }
}

/// Longest support: its equations are dense, and their decomposition costs the cube of its length.
pub(super) const LONGEST: usize = 2048;

/// Samples of the record in which the force acts.
#[derive(Debug, Clone, Copy)]
pub(super) struct Support {
    pub(super) first: usize,
    pub(super) length: usize,
}

impl Support {
    /// Finds the samples of `interval`.
    pub(super) fn of(
        interval: TimeInterval,
        n_samples: usize,
        sampling_rate_hz: f64,
    ) -> Result<Self, ImpulseError> {
        let TimeInterval { from, to } = interval;
        let is_inside = |index: &usize| {
            let time = *index as f64 / sampling_rate_hz;
            time >= from && time <= to
        };
        let Some(first) = (0..n_samples).find(is_inside) else {
            return Err(ImpulseError::SupportOutsideRecord { from, to });
        };
        let length = (first..n_samples).take_while(is_inside).count();
        if length > LONGEST {
            return Err(ImpulseError::SupportTooLong {
                found: length,
                expected: LONGEST,
            });
        }
        Ok(Self { first, length })
    }
}

/// Returns $`\sum_k s_k e^{i\theta_k l}`$, summed over both sides, for the lags of a support.
pub(super) fn lags(lines: &[f64], n_samples: usize, length: usize) -> Vec<f64> {
    let lines: Vec<Complex64> = lines.iter().map(|s| (*s).into()).collect();
    let mut lags = fourier::to_samples(&lines, n_samples);
    lags.truncate(length);
    lags
}

#[allow(
    clippy::indexing_slicing,
    reason = "two of n places are less than n apart"
)]
pub(super) fn toeplitz(first_row: &[f64]) -> Mat<f64> {
    let n = first_row.len();
    Mat::from_fn(n, n, |i, j| first_row[i.abs_diff(j)])
}

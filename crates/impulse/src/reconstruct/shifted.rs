//! Force from a frequency response under an exponential window.

use faer::Mat;
use num_complex::Complex64;

use super::grid::{Grid, Support};
use crate::{ImpulseError, fourier};

/// The exponential window $`e^{-\sigma t}`$ on all histories, from the first sample of the record
/// on.
///
/// On the line $`s = \sigma + i\omega`$ the spectra of the windowed histories obey
/// $`\hat x(s) = H(s)\hat F(s)`$ exactly. The windowed force is found there and then multiplied by
/// $`e^{\sigma t}`$. White noise decays with the window: its samples remain independent, its lines
/// become correlated.
pub(super) struct Shift {
    /// $`e^{-\sigma t_n}`$.
    weights: Vec<f64>,
}

impl Shift {
    pub(super) fn of(decay_rate: f64, grid: Grid) -> Result<Self, ImpulseError> {
        let weight = |n: usize| (-decay_rate * n as f64 / grid.sampling_rate_hz).exp();
        if !(decay_rate > 0.0 && weight(grid.n_samples) > f64::EPSILON) {
            return Err(ImpulseError::NonPhysical {
                quantity: "decay rate of the exponential window [1/s]",
                value: decay_rate,
                expected: "above 0, and low enough that the window exceeds 2e-16 at the end of the record",
            });
        }
        Ok(Self {
            weights: (0..grid.n_samples).map(weight).collect(),
        })
    }

    pub(super) fn windowed(&self, samples: &[f64]) -> Vec<f64> {
        let pairs = samples.iter().zip(&self.weights);
        pairs.map(|(x, weight)| x * weight).collect()
    }

    /// $`e^{\sigma t_n}`$ from sample `first` on.
    pub(super) fn growth_from(&self, first: usize) -> impl Iterator<Item = f64> {
        self.weights.iter().skip(first).map(|weight| 1.0 / weight)
    }

    /// Mean of $`e^{-2\sigma t_n}`$: fraction of the power of white noise that the window passes.
    pub(super) fn mean_square(&self) -> f64 {
        let squares = self.weights.iter().map(|weight| weight * weight);
        squares.sum::<f64>() / self.weights.len() as f64
    }

    /// Returns the covariance over a support of $`\sum_m c_{n-m}e_m`$,
    /// $`c_n = \sum_k C_k e^{i\theta_kn}`$, for noise e with mean variance N per line, summed over
    /// the `filters` C. It takes one transform per lag.
    #[allow(
        clippy::indexing_slicing,
        reason = "the support lies in the record, places in the record are taken modulo it, and lags are those of the support"
    )]
    pub(super) fn covariance(&self, filters: &[Vec<Complex64>], support: Support) -> Mat<f64> {
        let n_samples = self.weights.len();
        let Support { first, length } = support;
        let mean = self.mean_square();
        let power: Vec<f64> = self.weights.iter().map(|w| w * w / mean).collect();
        let power = fourier::to_spectrum(&power);
        let mut covariance = Mat::zeros(length, length);
        for filter in filters {
            let filter = fourier::to_samples(filter, n_samples);
            for lag in 0..length {
                let product: Vec<f64> = (0..n_samples)
                    .map(|n| filter[n] * filter[(n + lag) % n_samples])
                    .collect();
                let product = fourier::to_spectrum(&product);
                let lines: Vec<Complex64> =
                    product.iter().zip(&power).map(|(a, b)| a * b).collect();
                let sums = fourier::to_samples(&lines, n_samples);
                for at in 0..length - lag {
                    let sum = sums[first + at] / n_samples as f64;
                    covariance[(at, at + lag)] += sum;
                    if lag > 0 {
                        covariance[(at + lag, at)] += sum;
                    }
                }
            }
        }
        covariance
    }

    /// Returns $`\lvert C'_k\rvert^2`$, the variance of the lines of the sum in
    /// [`Self::covariance`] multiplied by $`e^{\sigma t_n}`$, which is stationary again:
    /// $`c'_n = c_ne^{\sigma t_n}`$ for lags n of either sign up to half the record.
    #[allow(
        clippy::indexing_slicing,
        reason = "a lag of at most half the record is an index of its weights"
    )]
    pub(super) fn unwound(&self, filter: &[Complex64]) -> Vec<f64> {
        let n_samples = self.weights.len();
        let scale = 1.0 / (n_samples as f64 * self.mean_square().sqrt());
        let mut samples = fourier::to_samples(filter, n_samples);
        for (n, sample) in samples.iter_mut().enumerate() {
            if 2 * n <= n_samples {
                *sample *= scale / self.weights[n];
            } else {
                *sample *= scale * self.weights[n_samples - n];
            }
        }
        let lines = fourier::to_spectrum(&samples);
        lines
            .iter()
            .map(|line| line.norm_sqr() * n_samples as f64)
            .collect()
    }
}

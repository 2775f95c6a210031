//! Time windows and their effect on levels and resolution.
//!
//! Theory: `docs/theory/spectra.md#accumulation`.

mod added_damping;
mod force;

pub use added_damping::{AddedDamping, DampedMode};
pub use force::ForceWindow;

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;

use crate::LabioError;
use crate::error::{check_enough_samples, count_mismatch, non_physical};

const HANN: [f64; 2] = [0.5, 0.5];
const HAMMING: [f64; 2] = [0.54, 0.46];
/// The four-term window with the lowest side lobes (F. J. Harris, Proc. IEEE 66 (1978) 51-83).
const BLACKMAN_HARRIS: [f64; 4] = [0.35875, 0.48829, 0.14128, 0.01168];
/// The five-term window that SciPy and MATLAB call flat top.
const FLAT_TOP: [f64; 5] = [
    0.21557895,
    0.41663158,
    0.277263158,
    0.083578947,
    0.006947368,
];

/// Weights applied to the samples before the transform, the same for all channels.
///
/// The cosine windows are $`w_n = \sum_k (-1)^k a_k\cos(2\pi kn/M)`$. *Periodic* means $`M = N`$,
/// one period in the N samples of the transform: the form for spectra. *Symmetric* means
/// $`M = N-1`$, first and last sample equal: the form for filter design, which some programs also
/// use for spectra.
///
/// A hit that decays within the record needs [`Window::Rectangular`]: any other shape weights the
/// beginning of the hit, which contains the force, differently from its end. The windows for hits,
/// the force window ([`ForceWindow`]) and the exponential window ([`AddedDamping`]), are not in
/// this list: they are treated as parts of the signals, not of the estimate, and levels are not
/// corrected for them.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Window {
    /// Weight 1 everywhere.
    Rectangular,
    /// $`a = (0.5, 0.5)`$ over N samples, the standard window for spectra of long records.
    HannPeriodic,
    /// $`a = (0.5, 0.5)`$ over N-1 samples: first and last sample are zero.
    HannSymmetric,
    /// $`a = (0.54, 0.46)`$ over N samples.
    HammingPeriodic,
    /// $`a = (0.54, 0.46)`$ over N-1 samples.
    HammingSymmetric,
    /// $`a = (0.35875, 0.48829, 0.14128, 0.01168)`$ over N samples: side lobes 92 dB down.
    BlackmanHarrisPeriodic,
    /// Weights of [`Self::BlackmanHarrisPeriodic`] over N-1 samples.
    BlackmanHarrisSymmetric,
    /// $`a = (0.21557895, 0.41663158, 0.277263158, 0.083578947, 0.006947368)`$ over N samples:
    /// amplitudes of spectral lines are correct to 0.01 dB at any frequency. Some weights are
    /// negative.
    FlatTopPeriodic,
    /// Weights of [`Self::FlatTopPeriodic`] over N-1 samples.
    FlatTopSymmetric,
    /// Flat, with half a Hann window over `taper/2` of the N samples at each end.
    TukeyPeriodic {
        /// Tapered part of the samples \[-\], 0 (rectangular) to 1 (Hann).
        taper: f64,
    },
    /// Weights of [`Self::TukeyPeriodic`] over N-1 samples.
    TukeySymmetric {
        /// Tapered part of the samples \[-\], 0 (rectangular) to 1 (Hann).
        taper: f64,
    },
}

/// The weights of a [`Window`] for a number of samples, with the corrections for it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SampledWindow {
    /// The weights, one per sample.
    pub weights: Vec<f64>,
    /// Mean weight $`\sum w/N`$, by which the amplitude of a sine on a spectral line is multiplied:
    /// divide an amplitude by the coherent gain.
    pub coherent_gain: f64,
    /// Mean squared weight $`\sum w^2/N`$, by which the power of stationary noise is multiplied.
    pub power_gain: f64,
    /// Equivalent noise bandwidth in units of the line spacing, $`N\sum w^2/(\sum w)^2`$.
    pub noise_bandwidth_lines: f64,
}

impl Window {
    /// Computes the weights over `n_samples` samples.
    ///
    /// # Errors
    ///
    /// [`LabioError::TooFewSamples`] for fewer than two samples with the rectangular window or
    /// three with the others, whose first weight may be zero; [`LabioError::NonPhysical`] for a
    /// taper outside 0 to 1.
    ///
    /// # Examples
    ///
    /// ```
    /// let hann = labio::Window::HannPeriodic.sample(1024)?;
    /// assert!((hann.coherent_gain - 0.5).abs() < 1e-12);
    /// assert!((hann.noise_bandwidth_lines - 1.5).abs() < 1e-12);
    /// # Ok::<(), labio::LabioError>(())
    /// ```
    pub fn sample(self, n_samples: usize) -> Result<SampledWindow, LabioError> {
        let fewest = match self {
            Self::Rectangular => 2,
            _ => 3,
        };
        check_enough_samples("the window", n_samples, fewest)?;
        check_length(n_samples)?;
        let (periodic, symmetric) = (n_samples, n_samples - 1);
        let weights = match self {
            Self::Rectangular => vec![1.0; n_samples],
            Self::HannPeriodic => cosines(&HANN, n_samples, periodic),
            Self::HannSymmetric => cosines(&HANN, n_samples, symmetric),
            Self::HammingPeriodic => cosines(&HAMMING, n_samples, periodic),
            Self::HammingSymmetric => cosines(&HAMMING, n_samples, symmetric),
            Self::BlackmanHarrisPeriodic => cosines(&BLACKMAN_HARRIS, n_samples, periodic),
            Self::BlackmanHarrisSymmetric => cosines(&BLACKMAN_HARRIS, n_samples, symmetric),
            Self::FlatTopPeriodic => cosines(&FLAT_TOP, n_samples, periodic),
            Self::FlatTopSymmetric => cosines(&FLAT_TOP, n_samples, symmetric),
            Self::TukeyPeriodic { taper } => tukey(taper, n_samples, periodic)?,
            Self::TukeySymmetric { taper } => tukey(taper, n_samples, symmetric)?,
        };
        let n = n_samples as f64;
        let sum: f64 = weights.iter().sum();
        let sum_of_squares: f64 = weights.iter().map(|w| w * w).sum();
        Ok(SampledWindow {
            weights,
            coherent_gain: sum / n,
            power_gain: sum_of_squares / n,
            noise_bandwidth_lines: n * sum_of_squares / (sum * sum),
        })
    }
}

impl SampledWindow {
    /// Returns the correlation of the spectra of two segments of white noise that begin `shift`
    /// samples apart, $`\rho = \left(\sum_n w_n w_{n+\mathrm{shift}} / \sum_n w_n^2\right)^2`$ (P.
    /// D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70-73). It is 1 without a shift, 0
    /// without an overlap.
    #[must_use]
    pub fn overlap_correlation(&self, shift: usize) -> f64 {
        let later = self.weights.get(shift..).unwrap_or_default();
        let product: f64 = self.weights.iter().zip(later).map(|(a, b)| a * b).sum();
        let squares: f64 = self.weights.iter().map(|w| w * w).sum();
        (product / squares).powi(2)
    }

    /// Returns the number of independent segments that would give the variance of the average over
    /// `n_segments` segments that begin `hop` samples apart,
    ///
    /// ```math
    /// n_e = \frac{K}{1 + 2\sum_{j=1}^{K-1}\left(1-\frac jK\right)\rho_j}, \qquad K = n_\mathrm{segments},
    /// ```
    ///
    /// with $`\rho_j`$ the [`SampledWindow::overlap_correlation`] at `j hop`. The sum is exact.
    ///
    /// # Validity
    ///
    /// Valid for white Gaussian noise, and for noise whose spectrum varies little over the
    /// bandwidth of the window. At 0 Hz and at the Nyquist frequency, where a spectrum has one
    /// component instead of two, the variance is twice as large.
    ///
    /// # Errors
    ///
    /// [`LabioError::CountMismatch`] without a segment or for a `hop` of 0.
    pub fn independent_averages(&self, n_segments: usize, hop: usize) -> Result<f64, LabioError> {
        for (what, found) in [
            ("segments", n_segments),
            ("samples from segment to segment", hop),
        ] {
            if found == 0 {
                return count_mismatch(what, found, 1);
            }
        }
        let k = n_segments as f64;
        let overlapping = self.weights.len().saturating_sub(1) / hop;
        let sum: f64 = (1..n_segments.min(overlapping + 1))
            .map(|j| (1.0 - j as f64 / k) * self.overlap_correlation(j * hop))
            .sum();
        Ok(k / (1.0 + 2.0 * sum))
    }

    /// Largest loss of amplitude for a frequency between two spectral lines, as the factor
    /// $`\lvert\sum_n w_n e^{-i\pi n/N}\rvert/\lvert\sum_n w_n\rvert`$.
    #[must_use]
    pub fn scalloping(&self) -> f64 {
        let n = self.weights.len() as f64;
        let midway: Complex64 = self
            .weights
            .iter()
            .enumerate()
            .map(|(i, w)| w * Complex64::cis(-PI * i as f64 / n))
            .sum();
        midway.norm() / (self.coherent_gain * n).abs()
    }
}

/// Greatest length of a window or transform: 2²⁸ samples, two gibibytes per channel.
const LONGEST: usize = 1 << 28;

/// Rejects a length above [`LONGEST`].
pub(crate) fn check_length(n_samples: usize) -> Result<(), LabioError> {
    if n_samples <= LONGEST {
        Ok(())
    } else {
        count_mismatch(
            "samples of a window or a transform, at most",
            n_samples,
            LONGEST,
        )
    }
}

fn cosines(coefficients: &[f64], n_samples: usize, period: usize) -> Vec<f64> {
    (0..n_samples)
        .map(|n| {
            let mut sign = 1.0;
            let mut weight = 0.0;
            for (k, a) in coefficients.iter().enumerate() {
                // the angle is reduced with integers, which is exact
                let turns = (k * n % period) as f64 / period as f64;
                weight += sign * a * (TAU * turns).cos();
                sign = -sign;
            }
            weight
        })
        .collect()
}

fn tukey(taper: f64, n_samples: usize, period: usize) -> Result<Vec<f64>, LabioError> {
    if !(0.0..=1.0).contains(&taper) {
        return non_physical(
            "taper of the Tukey window [-]",
            taper,
            "a fraction from 0 to 1",
        );
    }
    let edge = taper / 2.0 * period as f64;
    Ok((0..n_samples)
        .map(|n| {
            let from_end = n.min(period - n) as f64;
            if from_end < edge {
                0.5 - 0.5 * (PI * from_end / edge).cos()
            } else {
                1.0
            }
        })
        .collect())
}

#[cfg(test)]
mod tests;

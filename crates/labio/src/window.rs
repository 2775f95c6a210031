//! Windows in time and what they do to levels and to resolution.

use std::f64::consts::TAU;

use crate::LabioError;

/// A weight of the samples before the transform.
///
/// A hit that has died out inside the record needs [`Window::Rectangular`]: any other shape weighs the beginning of the
/// hit, where the force is, against its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Window {
    /// Weight 1 everywhere.
    Rectangular,
    /// $`w_n = \frac12 - \frac12\cos(2\pi n/N)`$: one period of the cosine in N samples. The one for spectra.
    HannPeriodic,
    /// $`w_n = \frac12 - \frac12\cos(2\pi n/(N-1))`$: first and last sample zero. The one for filter design.
    HannSymmetric,
}

/// The weights of a [`Window`] over a number of samples, with its two corrections.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SampledWindow {
    /// The weights, one a sample.
    pub weights: Vec<f64>,
    /// Mean weight $`\sum w/N`$. A line of a periodic signal that falls on a spectral line comes out multiplied by it: divide an
    /// amplitude by the coherent gain.
    pub coherent_gain: f64,
    /// Mean squared weight $`\sum w^2/N`$: the factor by which the level of a stationary noise comes out too low.
    pub power_gain: f64,
    /// Equivalent noise bandwidth in units of the line spacing, $`N\sum w^2/(\sum w)^2`$.
    pub noise_bandwidth_lines: f64,
}

impl Window {
    /// The weights over `n_samples` samples.
    ///
    /// # Errors
    ///
    /// [`LabioError::TooFewSamples`] below two samples, or three for the Hann windows, whose first weight is zero.
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
            Self::HannPeriodic | Self::HannSymmetric => 3,
        };
        if n_samples < fewest {
            return Err(LabioError::TooFewSamples {
                what: "the window",
                found: n_samples,
                expected: fewest,
            });
        }
        let hann = |period: usize| -> Vec<f64> {
            (0..n_samples)
                .map(|n| 0.5 - 0.5 * (TAU * n as f64 / period as f64).cos())
                .collect()
        };
        let weights = match self {
            Self::Rectangular => vec![1.0; n_samples],
            Self::HannPeriodic => hann(n_samples),
            Self::HannSymmetric => hann(n_samples - 1),
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of a sum of a thousand terms of order one.
    const SUM_ROUNDING: f64 = 1e-12;

    #[test]
    fn corrections_are_the_sums_of_cosines() {
        let n = 1000;
        let samples = n as f64;
        // sums of cos and cos^2 over whole periods; the symmetric one has N-1 samples a period and one extra zero
        let expected = [
            (Window::Rectangular, 1.0, 1.0, 1.0),
            (Window::HannPeriodic, 0.5, 0.375, 1.5),
            (
                Window::HannSymmetric,
                0.5 * (samples - 1.0) / samples,
                0.375 * (samples - 1.0) / samples,
                1.5 * samples / (samples - 1.0),
            ),
        ];
        for (window, coherent_gain, power_gain, bandwidth) in expected {
            let sampled = window.sample(n).unwrap();
            assert!((sampled.coherent_gain - coherent_gain).abs() < SUM_ROUNDING);
            assert!((sampled.power_gain - power_gain).abs() < SUM_ROUNDING);
            assert!((sampled.noise_bandwidth_lines - bandwidth).abs() < SUM_ROUNDING);
        }
    }

    #[test]
    fn the_two_hann_windows_differ_in_their_last_sample() {
        let periodic = Window::HannPeriodic.sample(8).unwrap().weights;
        let symmetric = Window::HannSymmetric.sample(8).unwrap().weights;
        // cos(2 pi 7/8) = 1/sqrt 2; rounding of one cosine
        assert!((periodic[7] - (0.5 - 0.5 / 2.0_f64.sqrt())).abs() < 1e-15);
        assert!(symmetric[7].abs() < 1e-15);
    }

    #[test]
    fn a_window_of_zeros_is_refused() {
        assert!(Window::HannSymmetric.sample(2).is_err());
        assert!(Window::Rectangular.sample(1).is_err());
    }
}

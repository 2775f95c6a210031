//! Options of a reconstruction.

use num_complex::Complex64;

use crate::fourier;

/// Regularisation of components that the response determines too weakly.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Regularisation {
    /// Plain least squares; for one sensor $`\hat F = \hat x/H`$. Noise of the response is
    /// amplified by $`1/|H|`$ without limit.
    #[default]
    None,
    /// Minimum of `Σ w |x̂ - H F̂|² + λ Σ ω²ᵖ |F̂|²` over all lines, of both signs of the
    /// frequency. A line keeps the fraction $`\varphi = \mu/(\mu+\lambda)`$ of its force,
    /// $`\mu = \sum_r w_r|H_r|^2/\omega^{2p}`$.
    Tikhonov {
        /// Penalised quantity.
        penalty: Penalty,
        /// Source of $`\lambda`$.
        parameter: Parameter,
    },
    /// Truncation to well-determined components: lines with
    /// $`\mu = \sum_r w_r|H_r|^2 \ge \lambda`$, or, with a support, the components of the force
    /// along the eigenvectors whose $`\mu`$ meets this condition (truncated singular values).
    Truncated {
        /// Source of $`\lambda`$.
        parameter: Parameter,
    },
}

/// Quantity penalised by Tikhonov's method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Penalty {
    /// The force, $`p = 0`$.
    #[default]
    Size,
    /// The first derivative of the force, $`p = 1`$.
    Slope,
    /// The second derivative of the force, $`p = 2`$.
    Curvature,
}

impl Penalty {
    /// Returns $`\omega^{2p}`$.
    pub(super) fn weight(self, omega: f64) -> f64 {
        match self {
            Self::Size => 1.0,
            Self::Slope => omega * omega,
            Self::Curvature => omega.powi(4),
        }
    }
}

/// Source of the parameter $`\lambda`$ of a regularisation.
///
/// It has the unit of $`\mu`$ of [`Regularisation`], which is that of $`|H|^2`$ if the noise is not
/// known and $`w = 1`$.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Parameter {
    /// Value given by the caller, above zero.
    Given(f64),
    /// Corner of the curve of $`\log\eta^2`$ against $`\log\rho^2`$, with the residual $`\rho`$ and
    /// the penalised norm $`\eta`$: the point of largest curvature (Tikhonov), or the point
    /// farthest from the chord between the ends (truncated). It needs no noise level but satisfies
    /// no optimality criterion: at the corner the noise no longer dominates the norm, but may still
    /// be several times that of cross validation.
    LCurve,
    /// Minimum of $`n\rho^2/(n - \sum\varphi)^2`$ with n data: the best prediction of a left-out
    /// datum, if the noise is white after weighting. Needs no noise level.
    GeneralisedCrossValidation,
    /// Largest regularisation consistent with the noise: the explainable but unexplained part,
    /// $`\sum(1-\varphi)^2\beta^2`$, equals its expectation under noise alone. Needs the noise
    /// of the response.
    Discrepancy,
}

/// Fraction of a limit of a band by which a line may lie beyond it, since the sampling rate of a
/// time axis is rounded.
const ROUNDED: f64 = 1e-6;

/// Band of the lines used, including both limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrequencyBand {
    /// Lowest frequency \[Hz\].
    pub from_hz: f64,
    /// Highest frequency \[Hz\].
    pub to_hz: f64,
}

impl FrequencyBand {
    /// Returns true for a frequency in the band.
    pub(super) fn holds(&self, frequency_hz: f64) -> bool {
        let range = (1.0 - ROUNDED) * self.from_hz..=(1.0 + ROUNDED) * self.to_hz;
        range.contains(&frequency_hz)
    }

    /// Returns `samples` without the lines outside the band.
    #[must_use]
    pub fn of(&self, samples: &[f64], sampling_rate_hz: f64) -> Vec<f64> {
        let n = samples.len();
        let lines = fourier::to_spectrum(samples).into_iter().enumerate();
        let inside: Vec<Complex64> = lines
            .map(|(line, value)| {
                let frequency_hz = line as f64 * sampling_rate_hz / n as f64;
                if self.holds(frequency_hz) {
                    value / n as f64
                } else {
                    Complex64::ZERO
                }
            })
            .collect();
        fourier::to_samples(&inside, n)
    }
}

/// A time span relative to the first sample, including both limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeInterval {
    /// Start \[s\].
    pub from: f64,
    /// End \[s\].
    pub to: f64,
}

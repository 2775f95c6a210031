//! What the caller decides about a reconstruction.

use num_complex::Complex64;

use crate::fourier;

/// How what the response says too little of is kept from becoming force.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Regularisation {
    /// Least squares as they are; of one sensor, $`\hat F = \hat x/H`$. Noise of the response is amplified by $`1/|H|`$ without limit.
    #[default]
    None,
    /// The minimum of `Σ w |x̂ - H F̂|² + λ Σ ω²ᵖ |F̂|²` over all lines, of both
    /// signs of the frequency. A line keeps the part $`\varphi = \mu/(\mu+\lambda)`$ of its force,
    /// $`\mu = \sum_r w_r|H_r|^2/\omega^{2p}`$.
    Tikhonov {
        /// What is to be small.
        penalty: Penalty,
        /// Where $`\lambda`$ comes from.
        parameter: Parameter,
    },
    /// Only what the responses tell well: lines with $`\mu = \sum_r w_r|H_r|^2 \ge \lambda`$, or, with a support, the
    /// components of the force along the eigenvectors with such a $`\mu`$ (truncated singular values).
    Truncated {
        /// Where $`\lambda`$ comes from.
        parameter: Parameter,
    },
}

/// What Tikhonov's method keeps small.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Penalty {
    /// The force, $`p = 0`$.
    #[default]
    Size,
    /// Its rate, $`p = 1`$.
    Slope,
    /// The rate of its rate, $`p = 2`$.
    Curvature,
}

impl Penalty {
    /// $`\omega^{2p}`$.
    pub(super) fn weight(self, omega: f64) -> f64 {
        match self {
            Self::Size => 1.0,
            Self::Slope => omega * omega,
            Self::Curvature => omega.powi(4),
        }
    }
}

/// Where the parameter $`\lambda`$ of a regularisation comes from.
///
/// Its unit is that of $`\mu`$ of [`Regularisation`]: of $`|H|^2`$ where the noise is not known and $`w = 1`$.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Parameter {
    /// From the caller, above zero.
    Given(f64),
    /// From the corner of the curve of $`\log\eta^2`$ over $`\log\rho^2`$, with the residual $`\rho`$ and the penalised norm
    /// $`\eta`$: the largest curvature (Tikhonov), or the point farthest from the chord between the ends (truncated). Needs no
    /// noise level and has no optimum to show for it: at the corner the noise no longer rules the norm, and may still be
    /// several times what cross validation leaves.
    LCurve,
    /// From the minimum of $`n\rho^2/(n - \sum\varphi)^2`$ over n data: what predicts a left-out datum best, if
    /// the noise is white after the weights. Needs no noise level.
    GeneralisedCrossValidation,
    /// The largest regularisation that the noise excuses: what a force could have explained and was left,
    /// $`\sum(1-\varphi)^2\beta^2`$, equals its expectation under noise alone. Needs the noise of the response.
    Discrepancy,
}

/// The lines used, both limits included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrequencyBand {
    /// Lowest frequency \[Hz\].
    pub from_hz: f64,
    /// Highest frequency \[Hz\].
    pub to_hz: f64,
}

impl FrequencyBand {
    /// `samples` without the lines outside of the band.
    #[must_use]
    pub fn of(&self, samples: &[f64], sampling_rate_hz: f64) -> Vec<f64> {
        let n = samples.len();
        let lines = fourier::to_spectrum(samples).into_iter().enumerate();
        let inside: Vec<Complex64> = lines
            .map(|(line, value)| {
                let frequency_hz = line as f64 * sampling_rate_hz / n as f64;
                if (self.from_hz..=self.to_hz).contains(&frequency_hz) {
                    value / n as f64
                } else {
                    Complex64::ZERO
                }
            })
            .collect();
        fourier::to_samples(&inside, n)
    }
}

/// A time span from the first sample on, both limits included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeInterval {
    /// Begin \[s\].
    pub from: f64,
    /// End \[s\].
    pub to: f64,
}

//! The result of every method: a modulus a line, with its error, its validity and how it was found.

use std::fmt;

use num_complex::Complex64;

use crate::branch::ResolvedRoot;
use crate::validity::Validity;

/// Complex modulus on the lines of a measurement.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ModulusEstimate {
    lines: Vec<ModulusLine>,
    refused: Vec<RefusedLine>,
}

impl ModulusEstimate {
    pub(crate) fn new(lines: Vec<ModulusLine>, refused: Vec<RefusedLine>) -> Self {
        Self { lines, refused }
    }

    /// All lines that have a modulus, valid or not, in order of frequency. All their numbers are finite.
    #[must_use]
    pub fn lines(&self) -> &[ModulusLine] {
        &self.lines
    }

    /// The lines that fulfil every condition of [`crate::validity`].
    pub fn valid(&self) -> impl Iterator<Item = &ModulusLine> {
        self.lines.iter().filter(|line| line.validity.is_valid())
    }

    /// The lines that have no modulus at all, with the reason.
    #[must_use]
    pub fn refused(&self) -> &[RefusedLine] {
        &self.refused
    }
}

/// Complex modulus at one frequency.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ModulusLine {
    /// Position of the line in the measured arrays, from 0.
    pub index: usize,
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// Propagation coefficient γ = α + ik [1/m].
    pub propagation_coefficient: Complex64,
    /// Complex modulus E = E' + iE'' \[Pa\].
    pub modulus: Complex64,
    /// Loss factor E''/E'.
    pub loss_factor: f64,
    /// Phase velocity ω/k [m/s].
    pub phase_velocity: f64,
    /// Standard errors that the variance of what was measured gives to first order.
    pub standard_error: StandardError,
    /// |dE/E| by |dΨ/Ψ|: how many times the relative error of what was measured comes out in the modulus. Of several gauges
    /// it is the relative error of their root mean square.
    pub error_amplification: f64,
    /// The root in closed form with its branch, from which the solution starts: that without end mass of the two-point
    /// method, that of the three-point method. `None` for gauges at any positions, where there is no closed form.
    pub closed_form: Option<ResolvedRoot>,
    /// How the solution ended.
    pub termination: Termination,
    /// Whether the line may be believed.
    pub validity: Validity,
}

impl ModulusLine {
    /// Wavelength λ = 2π/k \[m\]; its sign is that of k.
    #[must_use]
    pub fn wavelength(&self) -> f64 {
        std::f64::consts::TAU / self.propagation_coefficient.im
    }
}

/// Standard errors of one line, to first order in the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct StandardError {
    /// Of E' \[Pa\].
    pub storage_modulus: f64,
    /// Of E'' \[Pa\].
    pub loss_modulus: f64,
    /// Of E''/E'.
    pub loss_factor: f64,
}

impl StandardError {
    /// From `sensitivity` dE/dΨ \[Pa\] of the `modulus` E \[Pa\] and the `variance` E|δΨ|² of a circular error of Ψ.
    ///
    /// E is an analytic function of Ψ, so its error is circular as well: half of the variance each for E' and E'', and
    /// no correlation. By that, the error of E''/E' is |E| σ/E'².
    #[must_use]
    pub fn propagated(modulus: Complex64, sensitivity: Complex64, variance: f64) -> Self {
        let sigma = sensitivity.norm() * (0.5 * variance).sqrt();
        Self {
            storage_modulus: sigma,
            loss_modulus: sigma,
            loss_factor: sigma * modulus.norm() / (modulus.re * modulus.re),
        }
    }

    fn of_modulus(&self) -> Complex64 {
        Complex64::new(self.storage_modulus, self.loss_modulus)
    }
}

/// Written as the modulus is, `E'+E''i`, in Pa.
impl fmt::Display for StandardError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.of_modulus(), formatter)
    }
}

/// As [`Display`](fmt::Display), with exponents.
impl fmt::LowerExp for StandardError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::LowerExp::fmt(&self.of_modulus(), formatter)
    }
}

/// How the solution of one line ended.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Termination {
    /// A formula: nothing was iterated.
    ClosedForm,
    /// The last step, or the residual, is of the size of the rounding.
    Converged {
        /// Newton steps taken.
        iterations: u32,
        /// |f(γL)| at the solution.
        residual: f64,
    },
    /// The iteration was ended before it settled.
    LostPatience {
        /// Newton steps taken.
        iterations: u32,
        /// |f(γL)| where it stopped.
        residual: f64,
    },
}

impl Termination {
    /// Whether the solution solves its equation.
    #[must_use]
    pub fn was_successful(&self) -> bool {
        !matches!(self, Self::LostPatience { .. })
    }
}

/// A line without a modulus.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct RefusedLine {
    /// Position of the line in the measured arrays, from 0.
    pub index: usize,
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// Why.
    pub reason: Refusal,
}

/// Why a line has no modulus.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// At 0 Hz both ends move alike whatever the material: Ψ = 1.
    #[error("a line at 0 Hz contains no information on the modulus")]
    ZeroFrequency,
    /// The ratio, or its variance, is NaN or infinite, as where an auto-spectrum is 0.
    #[error("the measured ratio or its variance is not finite")]
    NotFinite,
    /// A value of a gauge is NaN or infinite.
    #[error("a spectrum or its noise is not finite")]
    SpectrumNotFinite,
    /// The noise of some gauges is 0 and that of others is not: the first would have infinite weight.
    #[error("the noise of some gauges is 0, expected of all or of none")]
    NoiseOfSomeGauges,
    /// Any wave number explains the line: there is no signal, a node at the middle gauge, or gauges that cannot tell the two
    /// waves apart.
    #[error("the gauges do not determine a wave number")]
    Undetermined,
    /// The iteration ran to infinity, or to γ = 0, where there is no modulus.
    #[error("no root with a finite modulus was found")]
    NoRoot,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// σ of E''/E' by central differences over an even sample of phases of δE.
    #[test]
    fn error_of_the_loss_factor_is_the_gradient_of_a_circular_error() {
        let modulus = Complex64::new(2.0e9, 0.3e9);
        let error = StandardError::propagated(modulus, Complex64::new(3e9, 4e9), 2e-6);
        // |dE/dΨ| = 5e9, σ = 5e9 (1e-6)^½
        assert!((error.storage_modulus / 5e6 - 1.0).abs() < 1e-14);
        let phases = 64;
        let mean_square: f64 = (0..phases)
            .map(|j| {
                let angle = std::f64::consts::TAU * f64::from(j) / f64::from(phases);
                let delta = Complex64::from_polar(5e6 * 2.0_f64.sqrt(), angle);
                let (plus, minus) = (modulus + delta, modulus - delta);
                (0.5 * (plus.im / plus.re - minus.im / minus.re)).powi(2)
            })
            .sum::<f64>()
            / f64::from(phases);
        // Differences at 0.35 % of E: second-order error 1e-5.
        assert!((error.loss_factor / mean_square.sqrt() - 1.0).abs() < 3e-5);
    }
}

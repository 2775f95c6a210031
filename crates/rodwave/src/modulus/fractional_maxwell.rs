//! Modulus of a spring in series with a spring-pot.

use num_complex::Complex64;
use statrs::function::gamma::gamma;

use super::differentiable::{exactly, named, write};
use super::time_domain::{after_step, finite_compliance, fractional_decay};
use super::zener::ModulusStep;
use super::{
    ComplexModulus, DifferentiableModulus, LaplaceModulus, TimeDomainModulus, check_exponent,
};
use crate::RodwaveError;
use crate::error::check_positive;
use crate::quotient::times_ln;

/// Material without equilibrium modulus that creeps as a power of time: the
/// [`FractionalZener`](super::FractionalZener) with E₀ = 0.
///
/// ```text
/// E(s) = E₁ (sτ)^α/(1 + (sτ)^α) ,    0 < α <= 1
/// E(t) = E₁ E_α(-(t/τ)^α) ,    J(t) = (1 + (t/τ)^α/Γ(1 + α))/E₁
/// ```
///
/// with the Mittag-Leffler function E_α. For α = 1 it is the [`Maxwell`](super::Maxwell) model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FractionalMaxwell {
    step: ModulusStep,
    relaxation_time: f64,
    exponent: f64,
}

impl FractionalMaxwell {
    /// Creates a spring of `modulus` E₁ = E(∞) \[Pa\] in series with a spring-pot, with
    /// `relaxation_time` τ \[s\] and `exponent` α.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless all are finite and above 0 and α is at most 1.
    pub fn new(modulus: f64, relaxation_time: f64, exponent: f64) -> Result<Self, RodwaveError> {
        Ok(Self {
            step: ModulusStep {
                relaxed: 0.0,
                unrelaxed: check_positive("unrelaxed modulus [Pa]", modulus)?,
            },
            relaxation_time: check_positive("relaxation time [s]", relaxation_time)?,
            exponent: check_exponent("exponent of the relaxation", exponent)?,
        })
    }

    /// Computes (sτ)^α.
    fn power(&self, s: Complex64) -> Complex64 {
        (s * self.relaxation_time).powf(self.exponent)
    }
}

impl ComplexModulus for FractionalMaxwell {
    fn at(&self, omega: f64) -> Complex64 {
        self.at_s(Complex64::new(0.0, omega))
    }

    fn slope(&self, omega: f64) -> Complex64 {
        self.step
            .slope(self.exponent, self.power(Complex64::new(0.0, omega)))
    }
}

impl LaplaceModulus for FractionalMaxwell {
    fn at_s(&self, s: Complex64) -> Complex64 {
        self.step.at(self.power(s))
    }
}

/// Parameters: `ln_unrelaxed_modulus`, `ln_relaxation_time`, `exponent`.
impl DifferentiableModulus for FractionalMaxwell {
    fn parameter_names(&self) -> Vec<String> {
        named(&["ln_unrelaxed_modulus", "ln_relaxation_time", "exponent"])
    }

    fn parameters(&self) -> Vec<f64> {
        vec![
            self.step.unrelaxed.ln(),
            self.relaxation_time.ln(),
            self.exponent,
        ]
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, RodwaveError> {
        let [modulus, relaxation_time, exponent] = exactly(parameters)?;
        Self::new(modulus.exp(), relaxation_time.exp(), exponent)
    }

    fn gradient_at_s(
        &self,
        s: Complex64,
        derivatives: &mut [Complex64],
    ) -> Result<Complex64, RodwaveError> {
        let slope = self.step.slope(self.exponent, self.power(s));
        let by_exponent = times_ln(slope, s * self.relaxation_time) / self.exponent;
        let modulus = self.at_s(s);
        write(modulus, &[modulus, slope, by_exponent], derivatives)
    }
}

impl TimeDomainModulus for FractionalMaxwell {
    fn relaxation_modulus(&self, time: f64) -> Result<f64, RodwaveError> {
        let decay = fractional_decay(self.exponent, after_step(time)? / self.relaxation_time)?;
        Ok(self.step.unrelaxed * decay)
    }

    fn creep_compliance(&self, time: f64) -> Result<f64, RodwaveError> {
        let growth = (after_step(time)? / self.relaxation_time).powf(self.exponent);
        finite_compliance((1.0 + growth / gamma(1.0 + self.exponent)) / self.step.unrelaxed)
    }
}

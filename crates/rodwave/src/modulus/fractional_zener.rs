//! Modulus of the Zener model with a spring-pot in place of its dashpot.

use num_complex::Complex64;

use super::differentiable::{exactly, named, write};
use super::time_domain::{
    after_step, finite_compliance, fractional_decay, fractional_decay_of_power,
};
use super::zener::ModulusStep;
use super::{
    ComplexModulus, DifferentiableModulus, LaplaceModulus, TimeDomainModulus, check_exponent,
};
use crate::RodwaveError;
use crate::error::check_positive;
use crate::quotient::times_ln;

/// Solid with a broad, symmetric loss peak. For α = 1 it is the Zener model.
///
/// ```text
/// E(s) = E₀ + (E₁ - E₀) (sτ)^α/(1 + (sτ)^α) ,    0 < α <= 1
/// E(t) = E₀ + (E₁ - E₀) M(t/τ) ,                 M(x) = E_α(-x^α)
/// J(t) = 1/E₀ - (1/E₀ - 1/E₁) M(t/τ_c) ,         τ_c = τ (E₁/E₀)^{1/α}
/// ```
///
/// with the Mittag-Leffler function E_α. E₀ = E(0) and E₁ = E(∞). The flanks of the loss peak fall
/// as ω^{±α}.
///
/// # Accuracy
/// E(t) and J(t) have absolute errors of a few 1e-15 times E₁ - E₀ and 1/E₀ - 1/E₁, respectively.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FractionalZener {
    step: ModulusStep,
    relaxation_time: f64,
    exponent: f64,
}

impl FractionalZener {
    /// Creates a solid of `relaxed_modulus` E₀ \[Pa\], `unrelaxed_modulus` E₁ > E₀ \[Pa\],
    /// `relaxation_time` τ \[s\] and `exponent` α.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless all are finite and above 0, E₁ exceeds E₀ and α is at
    /// most 1.
    pub fn new(
        relaxed_modulus: f64,
        unrelaxed_modulus: f64,
        relaxation_time: f64,
        exponent: f64,
    ) -> Result<Self, RodwaveError> {
        Ok(Self {
            step: ModulusStep::new(relaxed_modulus, unrelaxed_modulus)?,
            relaxation_time: check_positive("relaxation time [s]", relaxation_time)?,
            exponent: check_exponent("exponent of the relaxation", exponent)?,
        })
    }

    /// Computes (sτ)^α.
    fn power(&self, s: Complex64) -> Complex64 {
        (s * self.relaxation_time).powf(self.exponent)
    }
}

impl ComplexModulus for FractionalZener {
    fn at(&self, omega: f64) -> Complex64 {
        self.at_s(Complex64::new(0.0, omega))
    }

    fn slope(&self, omega: f64) -> Complex64 {
        self.step
            .slope(self.exponent, self.power(Complex64::new(0.0, omega)))
    }
}

impl LaplaceModulus for FractionalZener {
    fn at_s(&self, s: Complex64) -> Complex64 {
        self.step.at(self.power(s))
    }
}

/// Parameters: `ln_relaxed_modulus`, `ln_modulus_increment` (of E₁ - E₀), `ln_relaxation_time`,
/// `exponent`.
impl DifferentiableModulus for FractionalZener {
    fn parameter_names(&self) -> Vec<String> {
        named(&[
            "ln_relaxed_modulus",
            "ln_modulus_increment",
            "ln_relaxation_time",
            "exponent",
        ])
    }

    fn parameters(&self) -> Vec<f64> {
        vec![
            self.step.relaxed.ln(),
            self.step.increment().ln(),
            self.relaxation_time.ln(),
            self.exponent,
        ]
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, RodwaveError> {
        let [relaxed, increment, relaxation_time, exponent] = exactly(parameters)?;
        let (relaxed, increment) = (relaxed.exp(), increment.exp());
        Self::new(
            relaxed,
            relaxed + increment,
            relaxation_time.exp(),
            exponent,
        )
    }

    fn gradient_at_s(
        &self,
        s: Complex64,
        derivatives: &mut [Complex64],
    ) -> Result<Complex64, RodwaveError> {
        let relaxed = Complex64::from(self.step.relaxed);
        let power = self.power(s);
        let slope = self.step.slope(self.exponent, power);
        let by_exponent = times_ln(slope, s * self.relaxation_time) / self.exponent;
        let modulus = self.step.at(power);
        write(
            modulus,
            &[relaxed, modulus - relaxed, slope, by_exponent],
            derivatives,
        )
    }
}

impl TimeDomainModulus for FractionalZener {
    fn relaxation_modulus(&self, time: f64) -> Result<f64, RodwaveError> {
        let decay = fractional_decay(self.exponent, after_step(time)? / self.relaxation_time)?;
        Ok(self.step.relaxed + self.step.increment() * decay)
    }

    fn creep_compliance(&self, time: f64) -> Result<f64, RodwaveError> {
        let ratio = self.step.unrelaxed / self.step.relaxed;
        // (t/τ_c)^α = (t/τ)^α E₀/E₁, without τ_c, which overflows for small α
        let power = (after_step(time)? / self.relaxation_time).powf(self.exponent) / ratio;
        let decay = fractional_decay_of_power(self.exponent, power)?;
        finite_compliance((1.0 - (1.0 - 1.0 / ratio) * decay) / self.step.relaxed)
    }
}

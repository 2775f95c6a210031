//! Modulus of the spring-pot, the element between spring and dashpot.

use num_complex::Complex64;
use statrs::function::gamma::gamma;

use super::differentiable::{exactly, named, write};
use super::time_domain::{after_step, finite_compliance, finite_modulus};
use super::{
    ComplexModulus, DifferentiableModulus, LaplaceModulus, TimeDomainModulus, check_fraction,
};
use crate::RodwaveError;
use crate::error::check_positive;
use crate::quotient::times_ln;

/// Power law of the stiffness over all frequencies: E(s) = Eᵣ (s/ωᵣ)^α, 0 < α < 1.
///
/// ```text
/// |E(ω)| = Eᵣ |ω/ωᵣ|^α ,    E''/E' = tan(πα/2)
/// E(t) = Eᵣ (ωᵣt)^{-α}/Γ(1-α) ,    J(t) = (ωᵣt)^α/(Eᵣ Γ(1+α))
/// ```
///
/// The loss factor is the same at every frequency. The law is parametrised by the magnitude Eᵣ at a
/// reference frequency inside the band of interest and not by K = Eᵣ ωᵣ^{-α}, whose unit depends on
/// α. E(0) = 0. Waves have no front, because E(∞) = ∞.
///
/// ```
/// use rodwave::modulus::{ComplexModulus, SpringPot};
///
/// let modulus = SpringPot::new(3e9, 0.06, 6283.0)?.at(6283.0);
/// assert!((modulus.im / modulus.re - 0.0945).abs() < 1e-4);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpringPot {
    modulus: f64,
    exponent: f64,
    reference_omega: f64,
}

impl SpringPot {
    /// Creates the law whose magnitude is `modulus` Eᵣ \[Pa\] at `reference_omega` ωᵣ [rad/s] and
    /// grows with the power `exponent` α.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless Eᵣ and ωᵣ are finite and above 0 and 0 < α < 1.
    pub fn new(modulus: f64, exponent: f64, reference_omega: f64) -> Result<Self, RodwaveError> {
        Ok(Self {
            modulus: check_positive("modulus at the reference frequency [Pa]", modulus)?,
            exponent: check_fraction("exponent of the modulus", exponent)?,
            reference_omega: check_positive("reference frequency [rad/s]", reference_omega)?,
        })
    }

    /// Magnitude Eᵣ \[Pa\] at the reference frequency.
    #[must_use]
    pub fn reference_modulus(&self) -> f64 {
        self.modulus
    }

    /// Exponent α.
    #[must_use]
    pub fn exponent(&self) -> f64 {
        self.exponent
    }

    /// Reference frequency ωᵣ [rad/s].
    #[must_use]
    pub fn reference_omega(&self) -> f64 {
        self.reference_omega
    }

    /// Derivative E ln(s/ωᵣ) with respect to the exponent; 0 at s = 0.
    pub(super) fn by_exponent(&self, s: Complex64) -> Complex64 {
        times_ln(self.at_s(s), s / self.reference_omega)
    }
}

impl ComplexModulus for SpringPot {
    fn at(&self, omega: f64) -> Complex64 {
        self.at_s(Complex64::new(0.0, omega))
    }

    fn slope(&self, omega: f64) -> Complex64 {
        self.at(omega) * self.exponent
    }
}

impl LaplaceModulus for SpringPot {
    fn at_s(&self, s: Complex64) -> Complex64 {
        self.modulus * (s / self.reference_omega).powf(self.exponent)
    }
}

/// Parameters: `ln_reference_modulus`, `exponent`.
impl DifferentiableModulus for SpringPot {
    fn parameter_names(&self) -> Vec<String> {
        named(&["ln_reference_modulus", "exponent"])
    }

    fn parameters(&self) -> Vec<f64> {
        vec![self.modulus.ln(), self.exponent]
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, RodwaveError> {
        let [modulus, exponent] = exactly(parameters)?;
        Self::new(modulus.exp(), exponent, self.reference_omega)
    }

    fn gradient_at_s(
        &self,
        s: Complex64,
        derivatives: &mut [Complex64],
    ) -> Result<Complex64, RodwaveError> {
        let modulus = self.at_s(s);
        write(modulus, &[modulus, self.by_exponent(s)], derivatives)
    }
}

impl TimeDomainModulus for SpringPot {
    fn relaxation_modulus(&self, time: f64) -> Result<f64, RodwaveError> {
        let decay = (self.reference_omega * after_step(time)?).powf(-self.exponent);
        finite_modulus(self.modulus * decay / gamma(1.0 - self.exponent))
    }

    fn creep_compliance(&self, time: f64) -> Result<f64, RodwaveError> {
        let growth = (self.reference_omega * after_step(time)?).powf(self.exponent);
        finite_compliance(growth / (self.modulus * gamma(1.0 + self.exponent)))
    }
}

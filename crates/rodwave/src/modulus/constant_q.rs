//! Modulus of a material whose loss factor is the same at every frequency.

use std::f64::consts::FRAC_2_PI;

use num_complex::Complex64;

use super::differentiable::{exactly, named, write};
use super::{ComplexModulus, DifferentiableModulus, LaplaceModulus, SpringPot, TimeDomainModulus};
use crate::RodwaveError;
use crate::error::check_positive;

/// Constant loss factor tan δ in its only causal form: E(s) = E₀ (s/ω₀)^{2g}, g = (1/π) atan tan δ
/// (Kjartansson, *J. Geophys. Res.* **84** (1979) 4737).
///
/// The law is the [`SpringPot`] of exponent 2g, parametrised by the loss factor and by the
/// magnitude of the modulus at one frequency. A constant *complex* modulus E₀(1 + i tan δ), which
/// is often used instead, is not causal: losses imply dispersion, here c ∝ ω^g.
///
/// The identification of nonlinear laws uses this law as its linear reference (see
/// `docs/theory/moduli.md`).
///
/// ```
/// use rodwave::modulus::{ComplexModulus, ConstantQ};
///
/// let polypropylene = ConstantQ::new(2.6e9, 0.07, 6283.0)?;
/// for omega in [1.0, 1e3, 1e6] {
///     let modulus = polypropylene.at(omega);
///     assert!((modulus.im / modulus.re - 0.07).abs() < 1e-12);
/// }
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstantQ {
    loss_factor: f64,
    power: SpringPot,
}

impl ConstantQ {
    /// Creates the law with magnitude `modulus` E₀ \[Pa\] at `reference_omega` ω₀ [rad/s] and with
    /// `loss_factor` tan δ.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless all are finite and above 0.
    pub fn new(modulus: f64, loss_factor: f64, reference_omega: f64) -> Result<Self, RodwaveError> {
        let loss_factor = check_positive("loss factor", loss_factor)?;
        Ok(Self {
            loss_factor,
            power: SpringPot::new(modulus, FRAC_2_PI * loss_factor.atan(), reference_omega)?,
        })
    }

    /// Loss factor tan δ = E''/E' = 1/Q.
    #[must_use]
    pub fn loss_factor(&self) -> f64 {
        self.loss_factor
    }

    /// Returns the law as a spring-pot.
    #[must_use]
    pub fn spring_pot(&self) -> SpringPot {
        self.power
    }
}

impl ComplexModulus for ConstantQ {
    fn at(&self, omega: f64) -> Complex64 {
        self.power.at(omega)
    }

    fn slope(&self, omega: f64) -> Complex64 {
        self.power.slope(omega)
    }
}

impl LaplaceModulus for ConstantQ {
    fn at_s(&self, s: Complex64) -> Complex64 {
        self.power.at_s(s)
    }
}

/// Parameters: `ln_reference_modulus`, `ln_loss_factor`.
impl DifferentiableModulus for ConstantQ {
    fn parameter_names(&self) -> Vec<String> {
        named(&["ln_reference_modulus", "ln_loss_factor"])
    }

    fn parameters(&self) -> Vec<f64> {
        vec![self.power.reference_modulus().ln(), self.loss_factor.ln()]
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, RodwaveError> {
        let [modulus, loss_factor] = exactly(parameters)?;
        Self::new(
            modulus.exp(),
            loss_factor.exp(),
            self.power.reference_omega(),
        )
    }

    fn gradient_at_s(
        &self,
        s: Complex64,
        derivatives: &mut [Complex64],
    ) -> Result<Complex64, RodwaveError> {
        // d(2g)/d ln tan δ = (2/π) tan δ/(1 + tan² δ)
        let by_loss_factor = FRAC_2_PI * self.loss_factor / (1.0 + self.loss_factor.powi(2));
        let modulus = self.at_s(s);
        write(
            modulus,
            &[modulus, self.power.by_exponent(s) * by_loss_factor],
            derivatives,
        )
    }
}

impl TimeDomainModulus for ConstantQ {
    fn relaxation_modulus(&self, time: f64) -> Result<f64, RodwaveError> {
        self.power.relaxation_modulus(time)
    }

    fn creep_compliance(&self, time: f64) -> Result<f64, RodwaveError> {
        self.power.creep_compliance(time)
    }
}

//! Modulus of the Maxwell model.

use num_complex::Complex64;

use super::differentiable::{exactly, named, write};
use super::time_domain::{after_step, finite_compliance};
use super::{ComplexModulus, DifferentiableModulus, LaplaceModulus, TimeDomainModulus};
use crate::RodwaveError;
use crate::error::check_positive;
use crate::quotient::quotient;

/// Spring E in series with a dashpot η (Ödeen 1993, survey, eq. 2.5 with F = σ/η).
///
/// ```text
/// E(s) = E sτ/(1 + sτ) ,    τ = η/E ,    E''/E' = 1/(ωτ)
/// ```
///
/// The model is a fluid: E(0) = 0. The loss factor falls as 1/ω; no solid polymer shows this over
/// more than part of a decade.
///
/// ```
/// use rodwave::modulus::{ComplexModulus, Maxwell};
///
/// let modulus = Maxwell::new(2.5e9, 2.5e6)?.at(1e4); // τ = 1 ms
/// assert!((modulus.im / modulus.re - 0.1).abs() < 1e-12);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Maxwell {
    modulus: f64,
    relaxation_time: f64,
}

impl Maxwell {
    /// Creates a spring of `modulus` E \[Pa\] in series with a dashpot of `viscosity` η [Pa s].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless both are finite and above 0.
    pub fn new(modulus: f64, viscosity: f64) -> Result<Self, RodwaveError> {
        let modulus = check_positive("Young's modulus [Pa]", modulus)?;
        let viscosity = check_positive("viscosity [Pa s]", viscosity)?;
        Ok(Self {
            modulus,
            relaxation_time: check_positive("relaxation time [s]", viscosity / modulus)?,
        })
    }

    /// Relaxation time τ = η/E \[s\].
    #[must_use]
    pub fn relaxation_time(&self) -> f64 {
        self.relaxation_time
    }
}

impl Maxwell {
    /// Computes ∂E/∂ln s.
    fn slope_at_s(&self, s: Complex64) -> Complex64 {
        let s_tau = s * self.relaxation_time;
        quotient(quotient(self.modulus * s_tau, 1.0 + s_tau), 1.0 + s_tau)
    }
}

impl ComplexModulus for Maxwell {
    fn at(&self, omega: f64) -> Complex64 {
        self.at_s(Complex64::new(0.0, omega))
    }

    fn slope(&self, omega: f64) -> Complex64 {
        self.slope_at_s(Complex64::new(0.0, omega))
    }
}

impl LaplaceModulus for Maxwell {
    fn at_s(&self, s: Complex64) -> Complex64 {
        let s_tau = s * self.relaxation_time;
        quotient(self.modulus * s_tau, 1.0 + s_tau)
    }
}

/// Parameters: `ln_modulus`, `ln_relaxation_time`. In the derivative with respect to ln E, τ is
/// constant, not the viscosity.
impl DifferentiableModulus for Maxwell {
    fn parameter_names(&self) -> Vec<String> {
        named(&["ln_modulus", "ln_relaxation_time"])
    }

    fn parameters(&self) -> Vec<f64> {
        vec![self.modulus.ln(), self.relaxation_time.ln()]
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, RodwaveError> {
        let [modulus, relaxation_time] = exactly(parameters)?;
        Ok(Self {
            modulus: check_positive("Young's modulus [Pa]", modulus.exp())?,
            relaxation_time: check_positive("relaxation time [s]", relaxation_time.exp())?,
        })
    }

    fn gradient_at_s(
        &self,
        s: Complex64,
        derivatives: &mut [Complex64],
    ) -> Result<Complex64, RodwaveError> {
        let modulus = self.at_s(s);
        write(modulus, &[modulus, self.slope_at_s(s)], derivatives)
    }
}

impl TimeDomainModulus for Maxwell {
    fn relaxation_modulus(&self, time: f64) -> Result<f64, RodwaveError> {
        Ok(self.modulus * (-after_step(time)? / self.relaxation_time).exp())
    }

    fn creep_compliance(&self, time: f64) -> Result<f64, RodwaveError> {
        finite_compliance((1.0 + after_step(time)? / self.relaxation_time) / self.modulus)
    }
}

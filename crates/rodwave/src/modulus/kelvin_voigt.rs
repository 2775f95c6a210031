//! Modulus of the Kelvin-Voigt model.

use num_complex::Complex64;

use super::differentiable::{exactly, named, write};
use super::time_domain::{after_step, finite_compliance};
use super::{ComplexModulus, DifferentiableModulus, LaplaceModulus, TimeDomainModulus};
use crate::RodwaveError;
use crate::error::check_positive;

/// Spring E in parallel with a dashpot η: E(s) = E + sη.
///
/// The loss factor ωη/E and the wave speed grow without bound: the equation of motion is parabolic,
/// and disturbances arrive everywhere at once. E(0) = E. A step of strain requires an infinite
/// force for an instant: the relaxation modulus is E + ηδ(t), which is E after the step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KelvinVoigt {
    modulus: f64,
    viscosity: f64,
}

impl KelvinVoigt {
    /// Creates a spring of `modulus` E \[Pa\] in parallel with a dashpot of `viscosity` η [Pa s].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless both are finite and above 0.
    pub fn new(modulus: f64, viscosity: f64) -> Result<Self, RodwaveError> {
        Ok(Self {
            modulus: check_positive("Young's modulus [Pa]", modulus)?,
            viscosity: check_positive("viscosity [Pa s]", viscosity)?,
        })
    }
}

impl ComplexModulus for KelvinVoigt {
    fn at(&self, omega: f64) -> Complex64 {
        self.at_s(Complex64::new(0.0, omega))
    }

    fn slope(&self, omega: f64) -> Complex64 {
        Complex64::new(0.0, omega * self.viscosity)
    }
}

impl LaplaceModulus for KelvinVoigt {
    fn at_s(&self, s: Complex64) -> Complex64 {
        self.modulus + s * self.viscosity
    }
}

/// Parameters: `ln_modulus`, `ln_viscosity`.
impl DifferentiableModulus for KelvinVoigt {
    fn parameter_names(&self) -> Vec<String> {
        named(&["ln_modulus", "ln_viscosity"])
    }

    fn parameters(&self) -> Vec<f64> {
        vec![self.modulus.ln(), self.viscosity.ln()]
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, RodwaveError> {
        let [modulus, viscosity] = exactly(parameters)?;
        Self::new(modulus.exp(), viscosity.exp())
    }

    fn gradient_at_s(
        &self,
        s: Complex64,
        derivatives: &mut [Complex64],
    ) -> Result<Complex64, RodwaveError> {
        write(
            self.at_s(s),
            &[Complex64::from(self.modulus), s * self.viscosity],
            derivatives,
        )
    }
}

impl TimeDomainModulus for KelvinVoigt {
    fn relaxation_modulus(&self, time: f64) -> Result<f64, RodwaveError> {
        after_step(time)?;
        Ok(self.modulus)
    }

    fn creep_compliance(&self, time: f64) -> Result<f64, RodwaveError> {
        let time = after_step(time)?;
        finite_compliance(-(-time * self.modulus / self.viscosity).exp_m1() / self.modulus)
    }
}

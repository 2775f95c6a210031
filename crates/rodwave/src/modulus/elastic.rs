//! Modulus of a Hookean material.

use num_complex::Complex64;

use super::differentiable::{exactly, named, write};
use super::time_domain::{after_step, finite_compliance};
use super::{ComplexModulus, DifferentiableModulus, LaplaceModulus, TimeDomainModulus};
use crate::RodwaveError;
use crate::error::check_positive;

/// Hookean material: E is real and the same at every frequency.
///
/// This is the limit without losses. γ is then imaginary, α = 0, and a wave does not decay. A
/// *finite free* body of such a material has undamped resonances, and its response has no Fourier
/// transform.
///
/// ```
/// use rodwave::modulus::{ComplexModulus, Elastic};
///
/// assert_eq!(Elastic::new(69e9)?.at(1e4).re, 69e9);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastic {
    modulus: f64,
}

impl Elastic {
    /// Creates a material of Young's modulus `modulus` \[Pa\].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless it is finite and above 0.
    pub fn new(modulus: f64) -> Result<Self, RodwaveError> {
        Ok(Self {
            modulus: check_positive("Young's modulus [Pa]", modulus)?,
        })
    }
}

impl ComplexModulus for Elastic {
    fn at(&self, _omega: f64) -> Complex64 {
        Complex64::new(self.modulus, 0.0)
    }

    fn slope(&self, _omega: f64) -> Complex64 {
        Complex64::ZERO
    }
}

impl LaplaceModulus for Elastic {
    fn at_s(&self, _s: Complex64) -> Complex64 {
        Complex64::new(self.modulus, 0.0)
    }
}

/// Parameters: `ln_modulus`.
impl DifferentiableModulus for Elastic {
    fn parameter_names(&self) -> Vec<String> {
        named(&["ln_modulus"])
    }

    fn parameters(&self) -> Vec<f64> {
        vec![self.modulus.ln()]
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, RodwaveError> {
        let [modulus] = exactly(parameters)?;
        Self::new(modulus.exp())
    }

    fn gradient_at_s(
        &self,
        s: Complex64,
        derivatives: &mut [Complex64],
    ) -> Result<Complex64, RodwaveError> {
        let modulus = self.at_s(s);
        write(modulus, &[modulus], derivatives)
    }
}

impl TimeDomainModulus for Elastic {
    fn relaxation_modulus(&self, time: f64) -> Result<f64, RodwaveError> {
        after_step(time)?;
        Ok(self.modulus)
    }

    fn creep_compliance(&self, time: f64) -> Result<f64, RodwaveError> {
        after_step(time)?;
        finite_compliance(1.0 / self.modulus)
    }
}

//! The modulus of the Kelvin-Voigt model.

use num_complex::Complex64;

use super::{ComplexModulus, LaplaceModulus};
use crate::RodwaveError;
use crate::error::check_positive;

/// A spring E in parallel with a dashpot η: E(s) = E + sη.
///
/// The loss factor ωη/E grows without bound, and so does the wave speed: the equation of motion is parabolic and a
/// front arrives at once everywhere. E(0) = E.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KelvinVoigt {
    modulus: f64,
    viscosity: f64,
}

impl KelvinVoigt {
    /// A spring of `modulus` E \[Pa\] in parallel with a dashpot of `viscosity` η [Pa s].
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
}

impl LaplaceModulus for KelvinVoigt {
    fn at_s(&self, s: Complex64) -> Complex64 {
        self.modulus + s * self.viscosity
    }
}

//! Sensitivity of the parameters to length and density of the specimen, and the errors that their
//! uncertainties cause.
//!
//! For x = Lξ and the stress s = σ/(ρL), the equations of the rod are v̇ = ∂s/∂ξ and ∂v/∂ξ =
//! (ρL²/E) ṡ + L F(ρL s), and the histories at the ends are velocities. Two velocity histories
//! therefore determine only E/(ρL²) and the function L F(ρL s) of s:
//!
//! ```text
//! d ln E = 2 d ln L + d ln ρ ,
//! d ln F(σ) = -d ln L - (d ln F/d ln σ) (d ln L + d ln ρ)   at a given σ
//! ```
//!
//! Stresses such as m are proportional to ρL, viscosities to ρL²; exponents, times and loss factors
//! do not change. The relations are valid for any histories, and for fits with or without
//! nuisances, if all tests were made with one specimen.

use crate::error::{MaxwellidError, check_not_negative};

/// Derivatives of a parameter (of its logarithm if its error is a ratio) with respect to the
/// logarithms of length and density of the specimen, at given histories.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SpecimenSensitivity {
    /// Derivative with respect to ln L.
    pub length: f64,
    /// Derivative with respect to ln ρ.
    pub density: f64,
}

impl SpecimenSensitivity {
    /// Sensitivity of ln E.
    pub const OF_MODULUS: Self = Self {
        length: 2.0,
        density: 1.0,
    };

    /// Sensitivity of the logarithm of an inelastic strain rate at a given stress, where ln F has
    /// the `slope` d ln F/d ln σ.
    #[must_use]
    pub fn of_rate(slope: f64) -> Self {
        Self {
            length: -(1.0 + slope),
            density: -slope,
        }
    }

    /// Sensitivity of a quantity with this `gradient` with respect to parameters that have the
    /// sensitivities `of`.
    pub(crate) fn through(gradient: &[f64], of: &[Self]) -> Self {
        let parts = || gradient.iter().zip(of);
        Self {
            length: parts().map(|(g, of)| g * of.length).sum(),
            density: parts().map(|(g, of)| g * of.density).sum(),
        }
    }

    /// Standard error due to an uncertain specimen, of the parameter or of its logarithm as for the
    /// sensitivity.
    #[must_use]
    pub fn standard_error(&self, specimen: &SpecimenUncertainty) -> f64 {
        (self.length * specimen.length).hypot(self.density * specimen.density)
    }
}

/// Relative standard uncertainties of the specimen, independent of each other and the same in all
/// tests.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SpecimenUncertainty {
    length: f64,
    density: f64,
}

impl SpecimenUncertainty {
    /// Creates the relative standard uncertainties of `length` and `density`; 0 for an exact value.
    ///
    /// # Errors
    /// [`MaxwellidError::Setting`] unless both are finite and not below 0.
    pub fn relative(length: f64, density: f64) -> Result<Self, MaxwellidError> {
        for (setting, value) in [
            ("relative uncertainty of the length", length),
            ("relative uncertainty of the density", density),
        ] {
            check_not_negative(setting, value)?;
        }
        Ok(Self { length, density })
    }

    /// Returns true if both are exact.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.length == 0.0 && self.density == 0.0
    }
}

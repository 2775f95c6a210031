//! Specimen of paper A, a rod with an accelerometer, and its uncertainties.

use std::f64::consts::PI;

use crate::error::{CmodError, check_not_negative, check_positive};

/// Straight cylindrical rod with an accelerometer at the free end. Attachments at the impacted end
/// have no effect on the ratio.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Specimen {
    /// Length L \[m\].
    pub length: f64,
    /// Diameter D \[m\].
    pub diameter: f64,
    /// Density ρ [kg/m³].
    pub density: f64,
    /// Mass m of the accelerometer at the free end, with its connector \[kg\]; 0 for a contactless
    /// transducer.
    pub accelerometer_mass: f64,
}

impl Specimen {
    /// Returns the cross-sectional area A = πD²/4 \[m²\].
    #[must_use]
    pub fn area(&self) -> f64 {
        0.25 * PI * self.diameter * self.diameter
    }

    /// Returns the mass ratio μ = m/(ρAL).
    #[must_use]
    pub fn mass_ratio(&self) -> f64 {
        self.accelerometer_mass / (self.density * self.area() * self.length)
    }

    pub(super) fn check(&self) -> Result<(), CmodError> {
        check_positive("length [m]", self.length)?;
        check_positive("diameter [m]", self.diameter)?;
        check_positive("density [kg/m^3]", self.density)?;
        check_not_negative("accelerometer mass [kg]", self.accelerometer_mass)?;
        check_not_negative("mass ratio", self.mass_ratio())?;
        Ok(())
    }
}

/// Standard uncertainties of a [`Specimen`], each in the unit of its quantity. The value is 0, the
/// default, for exact quantities. The errors are independent of each other and the same on all
/// lines.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SpecimenUncertainty {
    /// Uncertainty of the length \[m\].
    pub length: f64,
    /// Uncertainty of the diameter \[m\]. It acts only through the mass ratio.
    pub diameter: f64,
    /// Uncertainty of the density [kg/m³].
    pub density: f64,
    /// Uncertainty of the mass of the accelerometer \[kg\].
    pub accelerometer_mass: f64,
}

impl SpecimenUncertainty {
    pub(super) fn check(&self) -> Result<(), CmodError> {
        check_not_negative("uncertainty of the length [m]", self.length)?;
        check_not_negative("uncertainty of the diameter [m]", self.diameter)?;
        check_not_negative("uncertainty of the density [kg/m^3]", self.density)?;
        check_not_negative(
            "uncertainty of the accelerometer mass [kg]",
            self.accelerometer_mass,
        )?;
        Ok(())
    }
}

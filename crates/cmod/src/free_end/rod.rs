//! Rod with a free end: its properties, and the variation of quantities along it.

use std::f64::consts::PI;

use num_complex::Complex64;
use rodwave::numerics::Jet;

use crate::error::{CmodError, check_not_negative, check_positive};
use crate::estimate::ErrorSource;
use crate::multi_point::Quantity;
use crate::section_ratio::{Changed, SectionUncertainty};

/// Round rod with one free end, to which a mass may be attached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RodWithFreeEnd {
    /// Diameter D \[m\].
    pub diameter: f64,
    /// Density ρ [kg/m³].
    pub density: f64,
    /// Mass m on the free end \[kg\], such as an accelerometer with its connector; 0 for none.
    pub end_mass: f64,
}

impl RodWithFreeEnd {
    /// Returns the length l = m/(ρA) of rod that has the same mass as the end mass \[m\].
    #[must_use]
    pub fn length_of_end_mass(&self) -> f64 {
        self.end_mass / (self.density * 0.25 * PI * self.diameter * self.diameter)
    }

    /// Returns the arrangements that `with` creates from changed rods: each uncertain quantity that
    /// affects the length of the end mass is increased once and decreased once.
    pub(crate) fn changed<T>(
        &self,
        uncertainty: &SectionUncertainty,
        with: impl Fn(Self) -> T,
    ) -> Vec<Changed<T>> {
        let change = |source, uncertainty, of: fn(&mut Self) -> &mut f64| {
            Changed::of(source, uncertainty, |by| {
                let mut rod = *self;
                *of(&mut rod) += by;
                with(rod)
            })
        };
        [
            change(ErrorSource::Diameter, uncertainty.diameter, |rod| {
                &mut rod.diameter
            }),
            change(ErrorSource::Density, uncertainty.density, |rod| {
                &mut rod.density
            }),
            change(
                ErrorSource::AccelerometerMass,
                uncertainty.end_mass,
                |rod| &mut rod.end_mass,
            ),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    pub(crate) fn check(&self) -> Result<(), CmodError> {
        check_positive("diameter [m]", self.diameter)?;
        check_positive("density [kg/m^3]", self.density)?;
        check_not_negative("mass on the free end [kg]", self.end_mass)?;
        check_not_negative(
            "length of rod as heavy as the mass on its end [m]",
            self.length_of_end_mass(),
        )?;
        Ok(())
    }
}

/// Variation of a quantity with the distance from a free end, except for the factor common to all
/// distances.
pub(crate) struct FreeEndShape {
    pub(crate) quantity: Quantity,
    /// Length l = m/(ρA) \[m\] of rod with the same mass as the end mass.
    pub(crate) length_of_end_mass: f64,
}

impl FreeEndShape {
    /// Returns cosh γd + lγ sinh γd for a motion, or sinh γd + lγ cosh γd for a strain.
    pub(crate) fn at(&self, distance: f64, gamma: Complex64) -> Jet {
        let end = Jet::linear(self.length_of_end_mass * gamma, self.length_of_end_mass);
        let cosh = Jet::cosh(distance, gamma);
        let sinh = Jet::sinh(distance, gamma);
        if self.quantity == Quantity::Strain {
            sinh + end * cosh
        } else {
            cosh + end * sinh
        }
    }
}

//! Rod with a free end: its properties, and the variation of quantities along it.

use std::f64::consts::PI;

use num_complex::Complex64;

use crate::error::{CmodError, check_not_negative, check_positive};
use crate::estimate::ErrorSource;
use crate::multi_point::Quantity;
use crate::section_ratio::{Jet, SectionUncertainty};

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

    /// Returns the rod with each uncertain quantity that affects the length of the end mass increased and decreased.
    pub(crate) fn changed(
        &self,
        uncertainty: &SectionUncertainty,
    ) -> Vec<(ErrorSource, [Self; 2])> {
        type Of = fn(&mut RodWithFreeEnd) -> &mut f64;
        let quantities: [(ErrorSource, Of, f64); 3] = [
            (
                ErrorSource::Diameter,
                |rod| &mut rod.diameter,
                uncertainty.diameter,
            ),
            (
                ErrorSource::Density,
                |rod| &mut rod.density,
                uncertainty.density,
            ),
            (
                ErrorSource::AccelerometerMass,
                |rod| &mut rod.end_mass,
                uncertainty.end_mass,
            ),
        ];
        let change = |of: Of, by: f64| {
            let mut rod = *self;
            *of(&mut rod) += by;
            rod
        };
        quantities
            .into_iter()
            .filter(|(_, _, uncertainty)| *uncertainty > 0.0)
            .map(|(source, of, by)| (source, [change(of, by), change(of, -by)]))
            .collect()
    }

    pub(crate) fn check(&self) -> Result<(), CmodError> {
        check_positive("diameter [m]", self.diameter)?;
        check_positive("density [kg/m^3]", self.density)?;
        check_not_negative("mass on the free end [kg]", self.end_mass)?;
        check_not_negative(
            "length of rod that weighs as the mass on its end [m]",
            self.length_of_end_mass(),
        )?;
        Ok(())
    }
}

/// Variation of a quantity with the distance from a free end, except for the factor common to all distances.
pub(crate) struct FreeEndShape {
    pub(crate) quantity: Quantity,
    /// l = m/(ρA) \[m\].
    pub(crate) length_of_end_mass: f64,
}

impl FreeEndShape {
    /// Returns cosh γd + lγ sinh γd, for a strain sinh γd + lγ cosh γd.
    pub(crate) fn at(&self, distance: f64, gamma: Complex64) -> Jet {
        let end = Jet::linear(0.0, self.length_of_end_mass, gamma);
        let cosh = Jet::cosh(distance, gamma);
        let sinh = Jet::sinh(distance, gamma);
        if self.quantity == Quantity::Strain {
            sinh + end * cosh
        } else {
            cosh + end * sinh
        }
    }
}

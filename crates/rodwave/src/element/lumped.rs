//! Masses, springs and dashpots.

use num_complex::Complex64;

use super::ScaledTransition;
use crate::RodwaveError;
use crate::error::{check_not_negative, check_positive};

/// An element without length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Lumped {
    /// A rigid mass \[kg\] between two faces.
    Mass(f64),
    /// A massless spring of this stiffness [N/m] between two faces.
    Spring(f64),
    /// A massless dashpot of this resistance [kg/s] between two faces.
    Dashpot(f64),
}

impl Lumped {
    pub(crate) fn mass(mass: f64) -> Result<Self, RodwaveError> {
        Ok(Self::Mass(check_not_negative("mass [kg]", mass)?))
    }

    pub(crate) fn spring(stiffness: f64) -> Result<Self, RodwaveError> {
        Ok(Self::Spring(check_positive("stiffness [N/m]", stiffness)?))
    }

    pub(crate) fn dashpot(resistance: f64) -> Result<Self, RodwaveError> {
        Ok(Self::Dashpot(check_positive(
            "resistance of the dashpot [kg/s]",
            resistance,
        )?))
    }

    pub(crate) fn transition(self, s: Complex64) -> ScaledTransition {
        let mut matrix = ScaledTransition::IDENTITY;
        match self {
            Self::Mass(mass) => matrix.p12 = s * mass,
            Self::Spring(stiffness) => matrix.p21 = s / stiffness,
            Self::Dashpot(resistance) => matrix.p21 = resistance.recip().into(),
        }
        matrix
    }
}

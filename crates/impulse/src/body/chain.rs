//! Bodies made of elements, computed with one-dimensional theory.

use num_complex::Complex64;
use rodwave::Chain;
use rodwave::chain::AnalyticChain;

use super::{Domain, ImpactBody};
use crate::ImpulseError;

impl ImpactBody for AnalyticChain {
    fn domain(&self) -> Domain {
        Domain::RightHalfPlane
    }

    fn mobility_at(&self, s: Complex64) -> Result<Complex64, ImpulseError> {
        self.mobility_at_s(s)
            .map_err(|source| ImpulseError::Body { s, source })
    }

    fn free_mass(&self) -> Option<f64> {
        Self::free_mass(self)
    }
}

impl ImpactBody for Chain {
    fn domain(&self) -> Domain {
        Domain::FrequencyAxis
    }

    fn mobility_at(&self, s: Complex64) -> Result<Complex64, ImpulseError> {
        if s.re != 0.0 {
            return Err(ImpulseError::OutsideDomain {
                s,
                expected: "an imaginary s: a law of the body is known on the frequency axis only",
            });
        }
        self.mobility(s.im)
            .map_err(|source| ImpulseError::Body { s, source })
    }

    fn free_mass(&self) -> Option<f64> {
        Self::free_mass(self)
    }
}

//! A body given by a formula.

use std::fmt;

use num_complex::Complex64;

use super::{Domain, ImpactBody};
use crate::ImpulseError;
use crate::error::check_positive;

/// A body whose mobility is a user-defined formula.
///
/// ```
/// use impulse::{ImpactBody, MobilityLaw};
/// use num_complex::Complex64;
///
/// # fn main() -> Result<(), impulse::ImpulseError> {
/// // a rigid mass of 0.5 kg
/// let mass = MobilityLaw::analytic(|s| 1.0 / (0.5 * s)).free(0.5)?;
/// assert_eq!(mass.mobility_at(Complex64::new(4.0, 0.0))?.re, 0.5);
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct MobilityLaw<F> {
    law: F,
    domain: Domain,
    free_mass: Option<f64>,
}

impl<F: Fn(Complex64) -> Complex64> MobilityLaw<F> {
    /// Creates a body from a mobility \[m/(N s)\] that is analytic and passive for
    /// $`\operatorname{Re} s > 0`$; the body is not free.
    #[must_use]
    pub fn analytic(law: F) -> Self {
        Self {
            law,
            domain: Domain::RightHalfPlane,
            free_mass: None,
        }
    }

    /// Creates a body from a mobility \[m/(N s)\] that is known for imaginary $`s = i\omega`$ only;
    /// the body is not free.
    #[must_use]
    pub fn on_axis(law: F) -> Self {
        Self {
            law,
            domain: Domain::FrequencyAxis,
            free_mass: None,
        }
    }

    /// Makes the body free, with the mass `mass` \[kg\]: $`G \to 1/(sM)`$ for $`s \to 0`$.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] unless the mass is finite and above 0.
    pub fn free(self, mass: f64) -> Result<Self, ImpulseError> {
        Ok(Self {
            free_mass: Some(check_positive("mass of the body [kg]", mass)?),
            ..self
        })
    }
}

impl<F> fmt::Debug for MobilityLaw<F> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("MobilityLaw")
            .field("domain", &self.domain)
            .field("free_mass", &self.free_mass)
            .finish_non_exhaustive()
    }
}

impl<F: Fn(Complex64) -> Complex64> ImpactBody for MobilityLaw<F> {
    fn domain(&self) -> Domain {
        self.domain
    }

    fn mobility_at(&self, s: Complex64) -> Result<Complex64, ImpulseError> {
        if self.domain == Domain::FrequencyAxis && s.re != 0.0 {
            return Err(ImpulseError::OutsideDomain {
                s,
                expected: "an imaginary s: the law is known on the frequency axis only",
            });
        }
        Ok((self.law)(s))
    }

    fn free_mass(&self) -> Option<f64> {
        self.free_mass
    }
}

//! A material in which waves propagate.

use std::f64::consts::TAU;
use std::fmt;
use std::sync::Arc;

use num_complex::Complex64;
use rodwave::medium::Medium;
use rodwave::modulus::{ComplexModulus, LaplaceModulus, PowerLawPropagation};

use crate::{InStep, RodlabError};

/// Any law that is analytic in the right half plane.
#[derive(Clone)]
pub struct AnalyticLaw(Arc<dyn LaplaceModulus + Send + Sync>);

impl fmt::Debug for AnalyticLaw {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_tuple("AnalyticLaw").finish_non_exhaustive()
    }
}

impl ComplexModulus for AnalyticLaw {
    fn at(&self, omega: f64) -> Complex64 {
        self.0.at(omega)
    }
}

impl LaplaceModulus for AnalyticLaw {
    fn at_s(&self, s: Complex64) -> Complex64 {
        self.0.at_s(s)
    }
}

/// A material of a body in which waves propagate.
#[derive(Debug, Clone)]
pub enum Material {
    /// Known in the right half plane of the Laplace variable.
    Analytic(Medium<AnalyticLaw>),
    /// Known for real frequencies only.
    OnAxis(Medium<PowerLawPropagation>),
}

impl Material {
    /// Returns a material whose law is known in the right half plane; `field` is its place in the
    /// sheet.
    pub(crate) fn analytic(
        density: f64,
        law: Arc<dyn LaplaceModulus + Send + Sync>,
        field: &str,
    ) -> Result<Self, RodlabError> {
        Medium::new(density, AnalyticLaw(law))
            .map(Self::Analytic)
            .in_step(field)
    }

    /// Propagation coefficient alpha + ik at `frequency_hz`, with the damping coefficient alpha
    /// \[1/m\] and the wave number k \[rad/m\].
    #[must_use]
    pub fn propagation_coefficient(&self, frequency_hz: f64) -> Complex64 {
        match self {
            Self::Analytic(medium) => medium.propagation_coefficient(TAU * frequency_hz),
            Self::OnAxis(medium) => medium.propagation_coefficient(TAU * frequency_hz),
        }
    }
}

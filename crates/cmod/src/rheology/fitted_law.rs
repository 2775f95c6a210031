//! Properties of a fitted law: modulus, response, and the simplest law that is the same function.

use num_complex::Complex64;
use rodwave::modulus::GeneralisedMaxwell;

use super::data::ModulusData;
use super::law::{FittedLaw, Law};
use super::model::Model;
use super::transient::{Reading, respond};
use crate::error::CmodError;

impl FittedLaw {
    /// Returns the complex modulus \[Pa\] at `omega` > 0 [rad/s].
    #[must_use]
    pub fn modulus(&self, omega: f64) -> Complex64 {
        match self {
            Self::PowerLaw(law) => law.modulus(omega),
            own => own
                .at_s(Complex64::new(0.0, omega))
                .unwrap_or(Complex64::new(f64::NAN, 0.0)),
        }
    }

    /// Returns the response of the law \[Pa\] at each line of `data`. For data over frequency it is
    /// E(iω); for data over time it is E(t) or 1/J(t), including the ramp of the test. Power laws
    /// give NaN for data over time.
    #[must_use]
    pub fn response(&self, data: &ModulusData) -> Vec<Complex64> {
        let of = |(omega, reading): (f64, Reading)| match reading {
            Reading::Oscillation => self.modulus(omega),
            _ => respond((omega, reading), &mut [], &mut [], |s, _| self.at_s(s))
                .unwrap_or(Complex64::new(f64::NAN, 0.0)),
        };
        data.lines().iter().map(of).collect()
    }

    /// Returns the Prony series, if the law is a generalised Maxwell model.
    #[must_use]
    pub fn prony_series(&self) -> Option<&GeneralisedMaxwell> {
        match self {
            Self::GeneralisedMaxwell(law) => Some(law),
            _ => None,
        }
    }

    /// Returns the simplest law that is the same function: a generalised Maxwell model with one
    /// branch or none is a simpler law, and the spring-pot is constant Q.
    #[must_use]
    pub fn simplest(&self) -> Law {
        match self {
            Self::GeneralisedMaxwell(law) => {
                match (law.equilibrium_modulus() > 0.0, law.branches().len()) {
                    (true, 0) => Law::Elastic,
                    (true, 1) => Law::Zener,
                    (false, 1) => Law::Maxwell,
                    _ => Law::GeneralisedMaxwell,
                }
            }
            Self::SpringPot(_) => Law::ConstantQ,
            other => other.law(),
        }
    }

    /// Returns the law as a function of its coordinates.
    pub(super) fn model(&self) -> Result<Box<dyn Model>, CmodError> {
        let parameters = match self {
            Self::GeneralisedMaxwell(law) => {
                usize::from(law.equilibrium_modulus() > 0.0) + 2 * law.branches().len()
            }
            _ => 0,
        };
        self.law().model(parameters, self.reference_omega())
    }
}

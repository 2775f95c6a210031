//! The laws that can be fitted, and a law once it is.

use std::fmt;

use num_complex::Complex64;
use rodwave::modulus::{
    ComplexModulus, FractionalZener, GeneralisedMaxwell, HavriliakNegami, KelvinVoigt, Zener,
};

use super::model::{self, Model};
use super::power_law::{PowerLaw, PowerLawModel};
use super::prony::Prony;
use crate::error::CmodError;

/// A law that can be fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Law {
    /// [`KelvinVoigt`]: E + sη.
    KelvinVoigt,
    /// [`Zener`]: E₀ + ΔE sτ/(1 + sτ).
    Zener,
    /// [`FractionalZener`]: E₀ + ΔE (sτ)^α/(1 + (sτ)^α).
    FractionalZener,
    /// [`HavriliakNegami`]: E₀ + ΔE (1 - (1 + (sτ)^α)^{-β}); its second exponent is given as αβ.
    HavriliakNegami,
    /// [`GeneralisedMaxwell`]: E∞ + Σ Eᵢ sτᵢ/(1 + sτᵢ), of the order that the criterion chooses.
    GeneralisedMaxwell,
    /// [`PowerLaw`]: α = a ω^p, k = b ω^q, of a rod of this density ρ [kg/m³].
    PowerLaw {
        /// ρ [kg/m³].
        density: f64,
    },
}

impl fmt::Display for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::KelvinVoigt => "Kelvin-Voigt",
            Self::Zener => "Zener",
            Self::FractionalZener => "fractional Zener",
            Self::HavriliakNegami => "Havriliak-Negami",
            Self::GeneralisedMaxwell => "generalised Maxwell",
            Self::PowerLaw { .. } => "power laws",
        })
    }
}

/// A law with the parameters that were found.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum FittedLaw {
    /// Spring and dashpot in parallel.
    KelvinVoigt(KelvinVoigt),
    /// The standard linear solid.
    Zener(Zener),
    /// Zener's with a spring-pot.
    FractionalZener(FractionalZener),
    /// A broad and skew relaxation.
    HavriliakNegami(HavriliakNegami),
    /// A Prony series; branches in the order of increasing relaxation times.
    GeneralisedMaxwell(GeneralisedMaxwell),
    /// Power laws of damping coefficient and wave number.
    PowerLaw(PowerLaw),
}

impl FittedLaw {
    /// Complex modulus \[Pa\] at `omega` > 0 [rad/s].
    #[must_use]
    pub fn modulus(&self, omega: f64) -> Complex64 {
        match self {
            Self::KelvinVoigt(law) => law.at(omega),
            Self::Zener(law) => law.at(omega),
            Self::FractionalZener(law) => law.at(omega),
            Self::HavriliakNegami(law) => law.at(omega),
            Self::GeneralisedMaxwell(law) => law.at(omega),
            Self::PowerLaw(law) => law.modulus(omega),
        }
    }

    /// Which law it is.
    #[must_use]
    pub fn law(&self) -> Law {
        match self {
            Self::KelvinVoigt(_) => Law::KelvinVoigt,
            Self::Zener(_) => Law::Zener,
            Self::FractionalZener(_) => Law::FractionalZener,
            Self::HavriliakNegami(_) => Law::HavriliakNegami,
            Self::GeneralisedMaxwell(_) => Law::GeneralisedMaxwell,
            Self::PowerLaw(law) => Law::PowerLaw {
                density: law.density,
            },
        }
    }

    /// The Prony series, if it is one.
    #[must_use]
    pub fn prony_series(&self) -> Option<&GeneralisedMaxwell> {
        match self {
            Self::GeneralisedMaxwell(law) => Some(law),
            _ => None,
        }
    }

    /// The law as a function of its coordinates.
    pub(super) fn model(&self) -> Result<Box<dyn Model>, CmodError> {
        Ok(match self {
            Self::KelvinVoigt(_) => Box::new(model::kelvin_voigt()?),
            Self::Zener(_) => Box::new(model::zener()?),
            Self::FractionalZener(_) => Box::new(model::fractional_zener()?),
            Self::HavriliakNegami(_) => Box::new(model::havriliak_negami()?),
            Self::GeneralisedMaxwell(law) => Box::new(Prony::new(
                law.equilibrium_modulus() > 0.0,
                law.branches().len(),
            )),
            Self::PowerLaw(law) => Box::new(PowerLawModel::new(law.density)),
        })
    }
}

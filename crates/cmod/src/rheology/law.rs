//! Laws that can be fitted, and fitted laws.

use std::fmt;

use num_complex::Complex64;
use rodwave::modulus::{
    ComplexModulus, ConstantQ, Elastic, FractionalMaxwell, FractionalZener, GeneralisedMaxwell,
    HavriliakNegami, KelvinVoigt, Maxwell, SpringPot, Zener,
};

use super::model::{self, Model};
use super::power_law::{PowerLaw, PowerLawModel};
use super::prony::Prony;
use crate::error::CmodError;

/// Law that can be fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Law {
    /// [`Elastic`]: E, without loss.
    Elastic,
    /// [`Maxwell`]: E sτ/(1 + sτ).
    Maxwell,
    /// [`FractionalMaxwell`]: E₁ (sτ)^α/(1 + (sτ)^α).
    FractionalMaxwell,
    /// [`ConstantQ`]: E (s/ω₀)^{2g}, described by its loss factor, ω₀ the geometric mean of the ends of the band.
    ConstantQ,
    /// [`SpringPot`]: the same function, described by its exponent.
    SpringPot,
    /// [`KelvinVoigt`]: E + sη.
    KelvinVoigt,
    /// [`Zener`]: E₀ + ΔE sτ/(1 + sτ).
    Zener,
    /// [`FractionalZener`]: E₀ + ΔE (sτ)^α/(1 + (sτ)^α).
    FractionalZener,
    /// [`HavriliakNegami`]: E₀ + ΔE (1 - (1 + (sτ)^α)^{-β}); its second exponent is given as αβ.
    HavriliakNegami,
    /// [`GeneralisedMaxwell`]: E∞ + Σ Eᵢ sτᵢ/(1 + sτᵢ), of the order chosen by the criterion.
    GeneralisedMaxwell,
    /// [`PowerLaw`]: α = a ω^p, k = b ω^q, for a rod of this density ρ [kg/m³].
    PowerLaw {
        /// ρ [kg/m³].
        density: f64,
    },
}

impl fmt::Display for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Elastic => "elastic",
            Self::Maxwell => "Maxwell",
            Self::FractionalMaxwell => "fractional Maxwell",
            Self::ConstantQ => "constant Q",
            Self::SpringPot => "spring-pot",
            Self::KelvinVoigt => "Kelvin-Voigt",
            Self::Zener => "Zener",
            Self::FractionalZener => "fractional Zener",
            Self::HavriliakNegami => "Havriliak-Negami",
            Self::GeneralisedMaxwell => "generalised Maxwell",
            Self::PowerLaw { .. } => "power laws",
        })
    }
}

/// Law with fitted parameters.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum FittedLaw {
    /// Spring.
    Elastic(Elastic),
    /// Spring and dashpot in series.
    Maxwell(Maxwell),
    /// Spring and spring-pot in series.
    FractionalMaxwell(FractionalMaxwell),
    /// Constant loss factor.
    ConstantQ(ConstantQ),
    /// Power of the frequency.
    SpringPot(SpringPot),
    /// Spring and dashpot in parallel.
    KelvinVoigt(KelvinVoigt),
    /// Standard linear solid.
    Zener(Zener),
    /// Zener's model with a spring-pot.
    FractionalZener(FractionalZener),
    /// Broad and skew relaxation.
    HavriliakNegami(HavriliakNegami),
    /// Prony series; branches in the order of increasing relaxation times.
    GeneralisedMaxwell(GeneralisedMaxwell),
    /// Power laws of damping coefficient and wave number.
    PowerLaw(PowerLaw),
}

impl FittedLaw {
    /// Returns the complex modulus \[Pa\] at `omega` > 0 [rad/s].
    #[must_use]
    pub fn modulus(&self, omega: f64) -> Complex64 {
        match self {
            Self::Elastic(law) => law.at(omega),
            Self::Maxwell(law) => law.at(omega),
            Self::FractionalMaxwell(law) => law.at(omega),
            Self::ConstantQ(law) => law.at(omega),
            Self::SpringPot(law) => law.at(omega),
            Self::KelvinVoigt(law) => law.at(omega),
            Self::Zener(law) => law.at(omega),
            Self::FractionalZener(law) => law.at(omega),
            Self::HavriliakNegami(law) => law.at(omega),
            Self::GeneralisedMaxwell(law) => law.at(omega),
            Self::PowerLaw(law) => law.modulus(omega),
        }
    }

    /// Returns the kind of law.
    #[must_use]
    pub fn law(&self) -> Law {
        match self {
            Self::Elastic(_) => Law::Elastic,
            Self::Maxwell(_) => Law::Maxwell,
            Self::FractionalMaxwell(_) => Law::FractionalMaxwell,
            Self::ConstantQ(_) => Law::ConstantQ,
            Self::SpringPot(_) => Law::SpringPot,
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

    /// Returns the Prony series, if the law is one.
    #[must_use]
    pub fn prony_series(&self) -> Option<&GeneralisedMaxwell> {
        match self {
            Self::GeneralisedMaxwell(law) => Some(law),
            _ => None,
        }
    }

    /// Returns the simplest law that is the same function: a generalised Maxwell model of one branch or none is
    /// another law, and the spring-pot is constant Q.
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
        Ok(match self {
            Self::Elastic(_) => Box::new(model::elastic()?),
            Self::Maxwell(_) => Box::new(model::maxwell()?),
            Self::FractionalMaxwell(_) => Box::new(model::fractional_maxwell()?),
            Self::ConstantQ(law) => {
                Box::new(model::constant_q(law.spring_pot().reference_omega())?)
            }
            Self::SpringPot(law) => Box::new(model::spring_pot(law.reference_omega())?),
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

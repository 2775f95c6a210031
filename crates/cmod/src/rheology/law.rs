//! Laws that can be fitted, and fitted laws.

use std::fmt;

use num_complex::Complex64;
use rodwave::modulus::{
    ConstantQ, Elastic, FractionalMaxwell, FractionalZener, GeneralisedMaxwell, HavriliakNegami,
    KelvinVoigt, LaplaceModulus, Maxwell, SpringPot, Zener,
};

use super::data::ModulusData;
use super::model::{self, Model};
use super::power_law::{PowerLaw, PowerLawModel};
use super::prony::Prony;
use super::transient::{Reading, respond};
use crate::error::{CmodError, check_positive};

/// Law that can be fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Law {
    /// [`Elastic`]: E, without losses.
    Elastic,
    /// [`Maxwell`]: E sτ/(1 + sτ).
    Maxwell,
    /// [`FractionalMaxwell`]: E₁ (sτ)^α/(1 + (sτ)^α).
    FractionalMaxwell,
    /// [`ConstantQ`]: E (s/ω₀)^{2g}, parametrised by its loss factor, where ω₀ is the geometric
    /// mean of the ends of the band.
    ConstantQ,
    /// [`SpringPot`]: the same function as `ConstantQ`, parametrised by its exponent.
    SpringPot,
    /// [`KelvinVoigt`]: E + sη.
    KelvinVoigt,
    /// [`Zener`]: E₀ + ΔE sτ/(1 + sτ).
    Zener,
    /// [`FractionalZener`]: E₀ + ΔE (sτ)^α/(1 + (sτ)^α).
    FractionalZener,
    /// [`HavriliakNegami`]: E₀ + ΔE (1 - (1 + (sτ)^α)^{-β}); its second exponent is given as αβ.
    HavriliakNegami,
    /// [`GeneralisedMaxwell`]: E∞ + Σ Eᵢ sτᵢ/(1 + sτᵢ), with the order chosen by the criterion.
    GeneralisedMaxwell,
    /// [`PowerLaw`]: α = a ω^p, k = b ω^q, for a rod of this density ρ [kg/m³].
    PowerLaw {
        /// Density ρ [kg/m³].
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
    /// Prony series; its branches are in order of increasing relaxation time.
    GeneralisedMaxwell(GeneralisedMaxwell),
    /// Power laws of damping coefficient and wave number.
    PowerLaw(PowerLaw),
}

impl Law {
    /// Returns all laws; the power laws are for a rod of this `density` [kg/m³]. The display text
    /// of a law identifies it.
    ///
    /// ```
    /// use cmod::rheology::Law;
    ///
    /// let named = Law::all(1150.0).into_iter().find(|law| law.to_string() == "fractional Zener");
    /// assert_eq!(named, Some(Law::FractionalZener));
    /// ```
    #[must_use]
    pub fn all(density: f64) -> [Self; 11] {
        [
            Self::Elastic,
            Self::Maxwell,
            Self::FractionalMaxwell,
            Self::ConstantQ,
            Self::SpringPot,
            Self::KelvinVoigt,
            Self::Zener,
            Self::FractionalZener,
            Self::HavriliakNegami,
            Self::GeneralisedMaxwell,
            Self::PowerLaw { density },
        ]
    }

    /// Returns true if the law has a response at all lines, and the response depends on the
    /// parameters of the law. Power laws have no response over time, and the relaxation after a
    /// step of strain does not depend on a parallel dashpot.
    pub(super) fn is_defined_on(self, data: &ModulusData) -> bool {
        let is_relaxation = |reading: &Reading| matches!(reading, Reading::Relaxation { .. });
        match self {
            Self::PowerLaw { .. } => !data.has_times(),
            Self::KelvinVoigt => !data.readings.iter().all(is_relaxation),
            _ => true,
        }
    }

    /// Returns the law with the parameters `values` in SI units, in the order of
    /// [`RheologicalFit::parameters`](super::RheologicalFit); `reference_omega` [rad/s] is the
    /// reference of constant Q and of the spring-pot.
    ///
    /// # Errors
    /// [`CmodError::ChangedResult`] for a wrong number of values; [`CmodError::NonPhysical`] and
    /// the errors of the law for values out of their range.
    pub fn with_parameters(
        self,
        values: &[f64],
        reference_omega: Option<f64>,
    ) -> Result<FittedLaw, CmodError> {
        let model = self.model(values.len(), reference_omega)?;
        let kinds = model.kinds();
        if kinds.len() != values.len() {
            return Err(CmodError::ChangedResult {
                what: "parameters of a law",
                found: values.len(),
                expected: kinds.len(),
            });
        }
        let at: Vec<f64> = kinds
            .iter()
            .zip(values)
            .map(|(kind, value)| kind.scale.coordinate(*value))
            .collect();
        if let Some((value, _)) = values.iter().zip(&at).find(|(_, at)| !at.is_finite()) {
            return Err(CmodError::NonPhysical {
                quantity: "parameter of a law",
                value: *value,
                expected: "a number in the range of the parameter",
            });
        }
        self.at_coordinates(&at, reference_omega)
    }

    /// Returns the law as a function of `parameters` coordinates.
    pub(super) fn model(
        self,
        parameters: usize,
        reference_omega: Option<f64>,
    ) -> Result<Box<dyn Model>, CmodError> {
        Ok(match self {
            Self::Elastic => Box::new(model::elastic()?),
            Self::Maxwell => Box::new(model::maxwell()?),
            Self::FractionalMaxwell => Box::new(model::fractional_maxwell()?),
            Self::ConstantQ => Box::new(model::constant_q(reference(reference_omega)?)?),
            Self::SpringPot => Box::new(model::spring_pot(reference(reference_omega)?)?),
            Self::KelvinVoigt => Box::new(model::kelvin_voigt()?),
            Self::Zener => Box::new(model::zener()?),
            Self::FractionalZener => Box::new(model::fractional_zener()?),
            Self::HavriliakNegami => Box::new(model::havriliak_negami()?),
            Self::GeneralisedMaxwell => Box::new(series(parameters)),
            Self::PowerLaw { density } => Box::new(PowerLawModel::new(density)),
        })
    }

    /// Returns the fitted law for the coordinates `at` of its model.
    pub(super) fn at_coordinates(
        self,
        at: &[f64],
        reference_omega: Option<f64>,
    ) -> Result<FittedLaw, CmodError> {
        Ok(match self {
            Self::Elastic => FittedLaw::Elastic(model::elastic()?.law_at(at)?),
            Self::Maxwell => FittedLaw::Maxwell(model::maxwell()?.law_at(at)?),
            Self::FractionalMaxwell => {
                FittedLaw::FractionalMaxwell(model::fractional_maxwell()?.law_at(at)?)
            }
            Self::ConstantQ => {
                let model = model::constant_q(reference(reference_omega)?)?;
                FittedLaw::ConstantQ(model.law_at(at)?)
            }
            Self::SpringPot => {
                let model = model::spring_pot(reference(reference_omega)?)?;
                FittedLaw::SpringPot(model.law_at(at)?)
            }
            Self::KelvinVoigt => FittedLaw::KelvinVoigt(model::kelvin_voigt()?.law_at(at)?),
            Self::Zener => FittedLaw::Zener(model::zener()?.law_at(at)?),
            Self::FractionalZener => {
                FittedLaw::FractionalZener(model::fractional_zener()?.law_at(at)?)
            }
            Self::HavriliakNegami => {
                FittedLaw::HavriliakNegami(model::havriliak_negami()?.law_at(at)?)
            }
            Self::GeneralisedMaxwell => FittedLaw::GeneralisedMaxwell(series(at.len()).law_at(at)?),
            Self::PowerLaw { density } => {
                FittedLaw::PowerLaw(PowerLawModel::new(density).law_at(at))
            }
        })
    }
}

/// Returns the series with this number of parameters. It has an equilibrium modulus if the number
/// is odd.
fn series(parameters: usize) -> Prony {
    Prony::new(parameters % 2 == 1, parameters / 2)
}

fn reference(omega: Option<f64>) -> Result<f64, CmodError> {
    check_positive(
        "reference angular frequency of a law [rad/s]",
        omega.unwrap_or(f64::NAN),
    )
}

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

    /// Returns the modulus \[Pa\] at the Laplace variable `s` [1/s]; `None` for power laws.
    fn at_s(&self, s: Complex64) -> Option<Complex64> {
        Some(match self {
            Self::Elastic(law) => law.at_s(s),
            Self::Maxwell(law) => law.at_s(s),
            Self::FractionalMaxwell(law) => law.at_s(s),
            Self::ConstantQ(law) => law.at_s(s),
            Self::SpringPot(law) => law.at_s(s),
            Self::KelvinVoigt(law) => law.at_s(s),
            Self::Zener(law) => law.at_s(s),
            Self::FractionalZener(law) => law.at_s(s),
            Self::HavriliakNegami(law) => law.at_s(s),
            Self::GeneralisedMaxwell(law) => law.at_s(s),
            Self::PowerLaw(_) => return None,
        })
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

    /// Returns the angular frequency [rad/s] to which constant Q and the spring-pot refer.
    #[must_use]
    pub fn reference_omega(&self) -> Option<f64> {
        match self {
            Self::ConstantQ(law) => Some(law.spring_pot().reference_omega()),
            Self::SpringPot(law) => Some(law.reference_omega()),
            _ => None,
        }
    }

    /// Returns the coordinates of the law in its model.
    pub(super) fn coordinates(&self) -> Result<Vec<f64>, CmodError> {
        let reference = || reference(self.reference_omega());
        Ok(match self {
            Self::Elastic(own) => model::elastic()?.coordinates_of(own),
            Self::Maxwell(own) => model::maxwell()?.coordinates_of(own),
            Self::FractionalMaxwell(own) => model::fractional_maxwell()?.coordinates_of(own),
            Self::ConstantQ(own) => model::constant_q(reference()?)?.coordinates_of(own),
            Self::SpringPot(own) => model::spring_pot(reference()?)?.coordinates_of(own),
            Self::KelvinVoigt(own) => model::kelvin_voigt()?.coordinates_of(own),
            Self::Zener(own) => model::zener()?.coordinates_of(own),
            Self::FractionalZener(own) => model::fractional_zener()?.coordinates_of(own),
            Self::HavriliakNegami(own) => model::havriliak_negami()?.coordinates_of(own),
            Self::GeneralisedMaxwell(own) => {
                Prony::coordinates(own.equilibrium_modulus(), own.branches())
            }
            Self::PowerLaw(own) => vec![
                own.damping_factor.ln(),
                own.damping_exponent,
                own.wave_number_factor.ln(),
                own.wave_number_exponent,
            ],
        })
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

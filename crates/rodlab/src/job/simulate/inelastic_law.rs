//! Inelastic laws of virtual tests: their sheets, and identified laws in planned tests.

use maxwellid::Law;
use rodwave::RodwaveError;
use rodwave::inelastic::{Elastic, Eyring, InelasticLaw, MaxwellGurevichRabinovich, MaxwellNorton};
use serde::Deserialize;

use crate::sheet::{Exact, Frequency, Pressure, Ratio, Viscosity};

/// An inelastic law.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum InelasticLawSheet {
    /// No inelastic strain.
    Elastic,
    /// Strain rate proportional to stress.
    Maxwell {
        /// Viscosity, such as `"4 MPa s"`.
        viscosity: Exact<Viscosity>,
    },
    /// Strain rate as a power of the stress.
    Norton {
        /// Exponent, such as `"1.8"`.
        exponent: Exact<Ratio>,
        /// Strain rate at 10 MPa, such as `"8 1/s"`.
        rate_at_10_mpa: Exact<Frequency>,
    },
    /// Strain rate exponential in the stress.
    GurevichRabinovich {
        /// Viscosity at vanishing stress.
        viscosity: Exact<Viscosity>,
        /// Activation stress, such as `"8 MPa"`.
        activation_stress: Exact<Pressure>,
    },
    /// Strain rate proportional to the hyperbolic sine of the stress.
    Eyring {
        /// Activation stress, such as `"2.5 MPa"`.
        activation_stress: Exact<Pressure>,
        /// Strain rate at 10 MPa, such as `"8 1/s"`.
        rate_at_10_mpa: Exact<Frequency>,
    },
}

/// Evaluates `$use` with the law of the sheet; errors name the `FIELD` of the caller. A macro is
/// needed because each law has a different type.
macro_rules! with_law {
    ($sheet:expr, |$law:ident| $use:expr) => {{
        let refused = |error| RodlabError::step(format!("{FIELD}.law"), error);
        match &$sheet.law {
            InelasticLawSheet::Elastic => {
                let $law = ::rodwave::inelastic::Elastic;
                $use
            }
            InelasticLawSheet::Maxwell { viscosity } => {
                let $law = ::rodwave::inelastic::Maxwell::new(viscosity.si()).map_err(refused)?;
                $use
            }
            InelasticLawSheet::Norton {
                exponent,
                rate_at_10_mpa,
            } => {
                let rate = rate_at_10_mpa.si();
                let $law = ::rodwave::inelastic::MaxwellNorton::from_reference_rate(
                    exponent.si(),
                    rate,
                    10e6,
                )
                .map_err(refused)?;
                $use
            }
            InelasticLawSheet::GurevichRabinovich {
                viscosity,
                activation_stress,
            } => {
                let $law = ::rodwave::inelastic::MaxwellGurevichRabinovich::new(
                    viscosity.si(),
                    activation_stress.si(),
                )
                .map_err(refused)?;
                $use
            }
            InelasticLawSheet::Eyring {
                activation_stress,
                rate_at_10_mpa,
            } => {
                let (sharpness, rate) = (10e6 / activation_stress.si(), rate_at_10_mpa.si());
                let $law = ::rodwave::inelastic::Eyring::from_reference_rate(sharpness, rate, 10e6)
                    .map_err(refused)?;
                $use
            }
        }
    }};
}
pub(super) use with_law;

impl InelasticLawSheet {
    /// Returns the parameters as true values: name, value and unit of each.
    pub(super) fn in_numbers(&self) -> Vec<(&'static str, f64, &'static str)> {
        match self {
            Self::Elastic => Vec::new(),
            Self::Maxwell { viscosity } => {
                vec![("viscosity", viscosity.si(), "Pa s")]
            }
            Self::Norton {
                exponent,
                rate_at_10_mpa,
            } => vec![
                ("exponent", exponent.si(), ""),
                (
                    "inelastic strain rate at 10 MPa",
                    rate_at_10_mpa.si(),
                    "1/s",
                ),
            ],
            Self::GurevichRabinovich {
                viscosity,
                activation_stress,
            } => vec![
                ("viscosity at vanishing stress", viscosity.si(), "Pa s"),
                ("activation stress", activation_stress.si(), "Pa"),
            ],
            Self::Eyring {
                activation_stress,
                rate_at_10_mpa,
            } => vec![
                ("activation stress", activation_stress.si(), "Pa"),
                (
                    "inelastic strain rate at 10 MPa",
                    rate_at_10_mpa.si(),
                    "1/s",
                ),
            ],
        }
    }
}

/// A computation for an inelastic law of any type.
pub(crate) trait LawVisitor {
    type Result;

    fn on<L: InelasticLaw>(self, law: L) -> Self::Result;
}

/// Calls `visitor` with an identified law for the plan of a further test; `parameters` are those of
/// the law, without ln E.
pub(crate) fn planned<V: LawVisitor>(
    law: Law,
    parameters: &[f64],
    visitor: V,
) -> Result<V::Result, RodwaveError> {
    Ok(match law {
        Law::Norton => {
            let norton = MaxwellNorton::from_reference_rate(2.0, 1.0, 10e6)?;
            visitor.on(norton.with_parameters(parameters)?)
        }
        Law::GurevichRabinovich => {
            let gurevich = MaxwellGurevichRabinovich::new(1e6, 1e7)?;
            visitor.on(gurevich.with_parameters(parameters)?)
        }
        Law::Eyring => {
            let eyring = Eyring::from_reference_rate(2.0, 1.0, 10e6)?;
            visitor.on(eyring.with_parameters(parameters)?)
        }
        // the law matters only between the struck end and the section of excitation, where the
        // other laws damp the wave little
        _ => visitor.on(Elastic),
    })
}

/// Returns an identified law as a sheet states it; `None` if virtual tests do not offer the law.
/// `stated` gives the value of the parameter with a name.
pub(crate) fn in_ron(law: Law, stated: impl Fn(&str) -> Option<f64>) -> Option<String> {
    Some(match law {
        Law::Elastic => "Elastic".to_owned(),
        Law::Norton => format!(
            "Norton(exponent: \"{}\", rate_at_10_mpa: \"{} 1/s\")",
            stated("exponent")?,
            stated("inelastic strain rate at 10 MPa")?
        ),
        Law::GurevichRabinovich => format!(
            "GurevichRabinovich(viscosity: \"{} Pa s\", activation_stress: \"{} Pa\")",
            stated("viscosity")?,
            stated("activation stress")?
        ),
        Law::Eyring => format!(
            "Eyring(activation_stress: \"{} Pa\", rate_at_10_mpa: \"{} 1/s\")",
            stated("activation stress")?,
            stated("inelastic strain rate at 10 MPa")?
        ),
        // `Law` is non-exhaustive
        _ => return None,
    })
}

//! Laws that can be fitted, and fitted laws.

use std::fmt;
use std::sync::Arc;

use num_complex::Complex64;
use rodwave::modulus::{
    ConstantQ, DifferentiableModulus, Elastic, FractionalMaxwell, FractionalZener,
    GeneralisedMaxwell, HavriliakNegami, KelvinVoigt, LaplaceModulus, Maxwell, SpringPot, Zener,
};

use super::closed_law::{ClosedLaw, Link, Linked};
use super::data::ModulusData;
use super::model::{Model, ParameterKind};
use super::parameter::Scale;
use super::power_law::{PowerLaw, PowerLawModel};
use super::prony::Prony;
use super::start::{self, Shape};
use super::transient::Reading;
use crate::error::{CmodError, check_positive};

/// Defines [`Law`] and [`FittedLaw`] with their functions that have one arm per law. Each row is a
/// law of `rodwave`: its documentation, its variant, which has the name of its type, and its
/// displayed name. The coordinates and starting points for its fit are in its [`ClosedLaw`].
/// `$count` is the number of all laws, including the generalised Maxwell model and the power laws,
/// which have no row.
macro_rules! laws {
    ($count:literal laws: $($(#[$doc:meta])+ $kind:ident $name:literal;)+) => {
        /// Law that can be fitted.
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[non_exhaustive]
        pub enum Law {
            $($(#[$doc])+ $kind,)+
            /// [`GeneralisedMaxwell`]: E∞ + Σ Eᵢ sτᵢ/(1 + sτᵢ), with the order chosen by the
            /// criterion.
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
                    $(Self::$kind => $name,)+
                    Self::GeneralisedMaxwell => "generalised Maxwell",
                    Self::PowerLaw { .. } => "power laws",
                })
            }
        }

        /// Law with fitted parameters.
        #[derive(Debug, Clone, PartialEq)]
        #[non_exhaustive]
        pub enum FittedLaw {
            $($(#[$doc])+ $kind($kind),)+
            /// [`GeneralisedMaxwell`]: its branches are in order of increasing relaxation time.
            GeneralisedMaxwell(GeneralisedMaxwell),
            /// [`PowerLaw`]: damping coefficient and wave number.
            PowerLaw(PowerLaw),
        }

        /// Reads the name alone. The density of power laws is then NaN, which a fit refuses.
        #[cfg(feature = "serde")]
        impl<'de> serde::Deserialize<'de> for Law {
            fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                #[derive(serde::Deserialize)]
                enum Name {
                    $($kind,)+
                    GeneralisedMaxwell,
                    PowerLaw,
                }
                Ok(match Name::deserialize(from)? {
                    $(Name::$kind => Self::$kind,)+
                    Name::GeneralisedMaxwell => Self::GeneralisedMaxwell,
                    Name::PowerLaw => Self::PowerLaw { density: f64::NAN },
                })
            }
        }

        impl Law {
            /// Returns all laws; the power laws are for a rod of this `density` [kg/m³]. The display
            /// text of a law identifies it.
            ///
            /// ```
            /// use cmod::rheology::Law;
            ///
            /// let named = Law::all(1150.0).into_iter().find(|law| law.to_string() == "fractional Zener");
            /// assert_eq!(named, Some(Law::FractionalZener));
            /// ```
            #[must_use]
            pub fn all(density: f64) -> [Self; $count] {
                [$(Self::$kind,)+ Self::GeneralisedMaxwell, Self::PowerLaw { density }]
            }

            /// Returns the law as a function of `parameters` coordinates.
            pub(super) fn model(
                self,
                parameters: usize,
                reference_omega: Option<f64>,
            ) -> Result<Box<dyn Model>, CmodError> {
                Ok(match self {
                    $(Self::$kind => Box::new(Linked::<$kind>::new(reference_omega)?),)+
                    Self::GeneralisedMaxwell => Box::new(Prony::of_parameters(parameters)),
                    Self::PowerLaw { density } => {
                        let density = check_positive("density [kg/m^3]", density)?;
                        Box::new(PowerLawModel::new(density))
                    }
                })
            }

            /// Returns the fitted law for the coordinates `at` of its model.
            pub(super) fn at_coordinates(
                self,
                at: &[f64],
                reference_omega: Option<f64>,
            ) -> Result<FittedLaw, CmodError> {
                Ok(match self {
                    $(Self::$kind => {
                        FittedLaw::$kind(Linked::<$kind>::new(reference_omega)?.law_at(at)?)
                    })+
                    Self::GeneralisedMaxwell => {
                        FittedLaw::GeneralisedMaxwell(Prony::of_parameters(at.len()).law_at(at)?)
                    }
                    Self::PowerLaw { density } => {
                        FittedLaw::PowerLaw(PowerLawModel::new(density).law_at(at))
                    }
                })
            }

            /// Returns coordinates to start from; none for a Prony series, whose order is not known.
            pub(super) fn starts(self, data: &ModulusData) -> Vec<Vec<f64>> {
                match self {
                    $(Self::$kind => $kind::starts(data),)+
                    Self::GeneralisedMaxwell => Vec::new(),
                    Self::PowerLaw { density } => {
                        PowerLawModel::new(density).start(data).into_iter().collect()
                    }
                }
            }

            /// Returns coordinates at limits of the law, near which profiles look for lower minima.
            pub(super) fn limits(self, data: &ModulusData) -> Vec<Vec<f64>> {
                match self {
                    $(Self::$kind => $kind::limits(data),)+
                    Self::GeneralisedMaxwell | Self::PowerLaw { .. } => Vec::new(),
                }
            }
        }

        impl FittedLaw {
            /// Returns the modulus \[Pa\] at the Laplace variable `s` [1/s]; `None` for power laws.
            pub(super) fn at_s(&self, s: Complex64) -> Option<Complex64> {
                Some(match self {
                    $(Self::$kind(law) => law.at_s(s),)+
                    Self::GeneralisedMaxwell(law) => law.at_s(s),
                    Self::PowerLaw(_) => return None,
                })
            }

            /// Returns the law as a modulus that is analytic in the right half plane of s.
            ///
            /// # Errors
            /// The power laws, which are defined on the frequency axis only.
            pub fn into_analytic(self) -> Result<Arc<dyn LaplaceModulus + Send + Sync>, PowerLaw> {
                Ok(match self {
                    $(Self::$kind(law) => Arc::new(law),)+
                    Self::GeneralisedMaxwell(law) => Arc::new(law),
                    Self::PowerLaw(law) => return Err(law),
                })
            }

            /// Returns the kind of law.
            #[must_use]
            pub fn law(&self) -> Law {
                match self {
                    $(Self::$kind(_) => Law::$kind,)+
                    Self::GeneralisedMaxwell(_) => Law::GeneralisedMaxwell,
                    Self::PowerLaw(law) => Law::PowerLaw {
                        density: law.density,
                    },
                }
            }

            /// Returns the angular frequency [rad/s] to which constant Q and the spring-pot refer.
            #[must_use]
            pub fn reference_omega(&self) -> Option<f64> {
                match self {
                    $(Self::$kind(law) => law.reference(),)+
                    Self::GeneralisedMaxwell(_) | Self::PowerLaw(_) => None,
                }
            }

            /// Returns the coordinates of the law in its model.
            pub(super) fn coordinates(&self) -> Vec<f64> {
                match self {
                    $(Self::$kind(law) => $kind::LINK.coordinates(law.parameters()),)+
                    Self::GeneralisedMaxwell(law) => {
                        Prony::coordinates(law.equilibrium_modulus(), law.branches())
                    }
                    Self::PowerLaw(law) => vec![
                        law.damping_factor.ln(),
                        law.damping_exponent,
                        law.wave_number_factor.ln(),
                        law.wave_number_exponent,
                    ],
                }
            }
        }
    };
}

laws! {
    11 laws:
    /// [`Elastic`]: E, without losses.
    Elastic "elastic";
    /// [`Maxwell`]: E sτ/(1 + sτ).
    Maxwell "Maxwell";
    /// [`FractionalMaxwell`]: E₁ (sτ)^α/(1 + (sτ)^α).
    FractionalMaxwell "fractional Maxwell";
    /// [`ConstantQ`]: E (s/ω₀)^{2g}, parametrised by its loss factor, where ω₀ is the geometric
    /// mean of the ends of the band.
    ConstantQ "constant Q";
    /// [`SpringPot`]: the same function as `ConstantQ`, parametrised by its exponent.
    SpringPot "spring-pot";
    /// [`KelvinVoigt`]: E + sη.
    KelvinVoigt "Kelvin-Voigt";
    /// [`Zener`]: E₀ + ΔE sτ/(1 + sτ).
    Zener "Zener";
    /// [`FractionalZener`]: E₀ + ΔE (sτ)^α/(1 + (sτ)^α).
    FractionalZener "fractional Zener";
    /// [`HavriliakNegami`]: E₀ + ΔE (1 - (1 + (sτ)^α)^{-β}); its second exponent is given as αβ.
    HavriliakNegami "Havriliak-Negami";
}

impl Law {
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
}

fn checked(reference_omega: Option<f64>) -> Result<f64, CmodError> {
    check_positive(
        "reference angular frequency of a law [rad/s]",
        reference_omega.unwrap_or(f64::NAN),
    )
}

impl ClosedLaw for Elastic {
    fn any(_: Option<f64>) -> Result<Self, CmodError> {
        Ok(Self::new(1.0)?)
    }

    fn kinds() -> Vec<ParameterKind> {
        vec![ParameterKind::new("modulus", "Pa", Scale::Ratio)]
    }

    fn starts(data: &ModulusData) -> Vec<Vec<f64>> {
        start::of_elastic(data)
    }
}

impl ClosedLaw for KelvinVoigt {
    fn any(_: Option<f64>) -> Result<Self, CmodError> {
        Ok(Self::new(1.0, 1.0)?)
    }

    fn kinds() -> Vec<ParameterKind> {
        vec![
            ParameterKind::new("modulus", "Pa", Scale::Ratio),
            ParameterKind::new("viscosity", "Pa s", Scale::Ratio).of_loss(1),
        ]
    }

    fn starts(data: &ModulusData) -> Vec<Vec<f64>> {
        vec![start::of_kelvin_voigt(data)]
    }
}

fn reference_kind() -> ParameterKind {
    ParameterKind::new("modulus in the middle of the band", "Pa", Scale::Ratio)
}

impl ClosedLaw for ConstantQ {
    fn any(reference_omega: Option<f64>) -> Result<Self, CmodError> {
        Ok(Self::new(1.0, 0.1, checked(reference_omega)?)?)
    }

    fn kinds() -> Vec<ParameterKind> {
        vec![
            reference_kind(),
            ParameterKind::new("loss factor", "1", Scale::Ratio).of_loss(1),
        ]
    }

    fn starts(data: &ModulusData) -> Vec<Vec<f64>> {
        vec![start::of_constant_q(data)]
    }

    fn reference(&self) -> Option<f64> {
        Some(self.spring_pot().reference_omega())
    }
}

impl ClosedLaw for SpringPot {
    const LINK: Link = Link::Exponent;

    fn any(reference_omega: Option<f64>) -> Result<Self, CmodError> {
        Ok(Self::new(1.0, 0.5, checked(reference_omega)?)?)
    }

    fn kinds() -> Vec<ParameterKind> {
        vec![
            reference_kind(),
            ParameterKind::new("exponent", "1", Scale::LogOdds).of_loss(1),
        ]
    }

    fn starts(data: &ModulusData) -> Vec<Vec<f64>> {
        vec![start::of_spring_pot(data)]
    }

    fn reference(&self) -> Option<f64> {
        Some(self.reference_omega())
    }
}

fn fluid_kinds() -> Vec<ParameterKind> {
    vec![
        ParameterKind::new("unrelaxed modulus", "Pa", Scale::Ratio),
        ParameterKind::new("relaxation time", "s", Scale::Ratio)
            .of_relaxation(1)
            .of_loss_towards(1, 1.0),
    ]
}

impl ClosedLaw for Maxwell {
    fn any(_: Option<f64>) -> Result<Self, CmodError> {
        Ok(Self::new(1.0, 1.0)?)
    }

    fn kinds() -> Vec<ParameterKind> {
        fluid_kinds()
    }

    fn starts(data: &ModulusData) -> Vec<Vec<f64>> {
        start::of_fluid(data, &[1.0])
    }
}

impl ClosedLaw for FractionalMaxwell {
    const LINK: Link = Link::Exponent;

    fn any(_: Option<f64>) -> Result<Self, CmodError> {
        Ok(Self::new(1.0, 1.0, 0.5)?)
    }

    fn kinds() -> Vec<ParameterKind> {
        let mut kinds = fluid_kinds();
        kinds.push(ParameterKind::new("exponent", "1", Scale::LogOdds).of_loss_towards(1, 1.0));
        kinds
    }

    fn starts(data: &ModulusData) -> Vec<Vec<f64>> {
        start::of_fluid(data, &[0.1, 0.3, 0.6, 0.9])
    }
}

/// Returns the coordinates of a relaxation from one modulus to another with these exponents.
fn step_kinds(exponents: &[&str]) -> Vec<ParameterKind> {
    let mut kinds = vec![
        ParameterKind::new("relaxed modulus", "Pa", Scale::Ratio),
        ParameterKind::new("modulus increment", "Pa", Scale::Ratio)
            .of_relaxation(2)
            .of_loss(1),
        ParameterKind::new("relaxation time", "s", Scale::Ratio)
            .of_relaxation(2)
            .of_loss(1),
    ];
    let exponent = |name: &&str| ParameterKind::new(*name, "1", Scale::LogOdds).of_loss(1);
    kinds.extend(exponents.iter().map(exponent));
    kinds
}

impl ClosedLaw for Zener {
    fn any(_: Option<f64>) -> Result<Self, CmodError> {
        Ok(Self::new(1.0, 2.0, 1.0)?)
    }

    fn kinds() -> Vec<ParameterKind> {
        step_kinds(&[])
    }

    fn starts(data: &ModulusData) -> Vec<Vec<f64>> {
        start::of_one_relaxation(data, &ZENER, 1)
    }

    fn limits(data: &ModulusData) -> Vec<Vec<f64>> {
        start::at_the_limits(data, &ZENER)
    }
}

const ZENER: Shape = Shape {
    exponents: 0,
    grid: &[(1.0, 1.0)],
    at_the_limits: (1.0, 1.0),
};

impl ClosedLaw for FractionalZener {
    const LINK: Link = Link::Exponent;

    fn any(_: Option<f64>) -> Result<Self, CmodError> {
        Ok(Self::new(1.0, 2.0, 1.0, 0.5)?)
    }

    fn kinds() -> Vec<ParameterKind> {
        step_kinds(&["exponent"])
    }

    fn starts(data: &ModulusData) -> Vec<Vec<f64>> {
        start::of_one_relaxation(data, &FRACTIONAL_ZENER, 2)
    }

    fn limits(data: &ModulusData) -> Vec<Vec<f64>> {
        start::at_the_limits(data, &FRACTIONAL_ZENER)
    }
}

const FRACTIONAL_ZENER: Shape = Shape {
    exponents: 1,
    grid: &[(0.2, 0.2), (0.4, 0.4), (0.6, 0.6), (0.85, 0.85)],
    at_the_limits: (0.5, 0.5),
};

impl ClosedLaw for HavriliakNegami {
    const LINK: Link = Link::TwoExponents;

    fn any(_: Option<f64>) -> Result<Self, CmodError> {
        Ok(Self::new(1.0, 2.0, 1.0, 0.5, 0.5)?)
    }

    fn kinds() -> Vec<ParameterKind> {
        step_kinds(&["low-frequency exponent", "high-frequency exponent"])
    }

    fn starts(data: &ModulusData) -> Vec<Vec<f64>> {
        start::of_one_relaxation(data, &HAVRILIAK_NEGAMI, 3)
    }

    fn limits(data: &ModulusData) -> Vec<Vec<f64>> {
        start::at_the_limits(data, &HAVRILIAK_NEGAMI)
    }
}

const HAVRILIAK_NEGAMI: Shape = Shape {
    exponents: 2,
    grid: &[
        (0.2, 0.2),
        (0.4, 0.4),
        (0.4, 0.15),
        (0.7, 0.7),
        (0.7, 0.3),
        (0.7, 0.1),
        (0.95, 0.9),
        (0.95, 0.3),
    ],
    at_the_limits: (0.6, 0.3),
};

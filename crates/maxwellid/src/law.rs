//! Data of an inelastic law that an identification needs in addition to its physics: names, limits,
//! and printed parameters.

use crate::specimen::SpecimenSensitivity;
use rodwave::inelastic::InelasticLaw;

/// A law whose parameters can be identified.
pub trait IdentifiableLaw: InelasticLaw {
    /// Name of the model.
    const NAME: &'static str;

    /// Largest change of each parameter in one iteration: about the range over which the response
    /// is nearly linear in it.
    const STEP_LIMITS: &'static [f64];

    /// True if F is proportional to σ for all values of the parameters.
    const LINEAR: bool = false;

    /// Lower and upper bound of each parameter; unbounded by default.
    fn parameter_bounds(&self) -> Vec<(f64, f64)> {
        vec![(f64::NEG_INFINITY, f64::INFINITY); Self::PARAMETERS.len()]
    }

    /// The parameters as stated in the literature, at the present values.
    fn stated(&self) -> Vec<StatedParameter>;

    /// Sensitivity of each parameter to length and density of the specimen, at the present values.
    fn specimen_sensitivities(&self) -> Vec<SpecimenSensitivity>;

    /// Returns the law with the reference rate `rate` [1/s] and the present values of the other
    /// parameters, for a scan over rates. `None` for a law without rate.
    fn at_rate(&self, rate: f64) -> Option<Self>;

    /// Rate [1/s] at the reference stress if the present parameters make the law linear; 0 for an
    /// elastic law, `None` for a nonlinear one.
    fn linear_rate(&self) -> Option<f64> {
        None
    }

    /// Linear limit of this law with the reference rate `rate` [1/s], and the limit in words;
    /// `None` if there is none.
    fn at_linear_limit(&self, _rate: f64) -> Option<(Self, &'static str)> {
        None
    }
}

/// A parameter in the form used in the literature.
#[derive(Debug, Clone, PartialEq)]
pub struct StatedParameter {
    /// Name of the quantity.
    pub name: &'static str,
    /// Symbol of the quantity.
    pub symbol: &'static str,
    /// SI unit of the quantity.
    pub unit: &'static str,
    /// Value, in SI units.
    pub value: f64,
    /// Scale of the error: ratio or difference.
    pub scale: Scale,
    /// Derivative of ln(value) (ratio) or value (difference) with respect to each parameter of the
    /// law (to all of θ in a [`crate::RodModel`]).
    pub gradient: Vec<f64>,
    /// Role: well-conditioned coordinate of the identification, or derived from coordinates.
    pub role: Role,
}

impl StatedParameter {
    /// Creates a coordinate whose error is a ratio, from its name, symbol and unit.
    pub(crate) fn ratio(
        [name, symbol, unit]: [&'static str; 3],
        value: f64,
        gradient: Vec<f64>,
    ) -> Self {
        Self {
            name,
            symbol,
            unit,
            value,
            scale: Scale::Ratio,
            gradient,
            role: Role::Coordinate,
        }
    }

    /// Returns the parameter with the role of a quantity derived from coordinates.
    pub(crate) fn derived(self) -> Self {
        Self {
            role: Role::Derived,
            ..self
        }
    }
}

/// Scale of the error of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Ratio to the value: moduli, viscosities, rates.
    Ratio,
    /// Difference: exponents.
    Difference,
}

/// Role of a parameter: assessed or only shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// A coordinate of the identification, with a verdict.
    Coordinate,
    /// Derived from the coordinates, with their correlated errors. For example, B [Pa^κ s] changes
    /// by tens of per cent with an error of 0.03 in κ, because B extrapolates the law from 10 MPa
    /// to 1 Pa.
    Derived,
}

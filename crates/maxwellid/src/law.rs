//! Data of an inelastic law that an identification needs in addition to its physics: names, limits,
//! and printed parameters.

use crate::specimen::SpecimenSensitivity;
use rodwave::inelastic::{
    Elastic, Eyring, InelasticLaw, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton,
};

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
    /// Derived from the coordinates, with their correlated errors. B [Pa^κ s] changes by tens of
    /// per cent with an error of 0.03 in κ, because it extrapolates from 10 MPa to 1 Pa.
    Derived,
}

/// Bounds of the logarithm of a rate in 1/s: from the age of the universe to the period of an atom.
const LOG_RATE_BOUNDS: (f64, f64) = (-50.0, 50.0);

fn rate_at_reference(law: &impl InelasticLaw, gradient: Vec<f64>) -> StatedParameter {
    StatedParameter {
        name: "inelastic strain rate at 10 MPa",
        symbol: "F(10 MPa)",
        unit: "1/s",
        value: law.inelastic_strain_rate(law.reference_stress()),
        scale: Scale::Ratio,
        gradient,
        role: Role::Coordinate,
    }
}

impl IdentifiableLaw for Elastic {
    const NAME: &'static str = "elastic";
    const STEP_LIMITS: &'static [f64] = &[];
    const LINEAR: bool = true;

    fn stated(&self) -> Vec<StatedParameter> {
        Vec::new()
    }

    fn specimen_sensitivities(&self) -> Vec<SpecimenSensitivity> {
        Vec::new()
    }

    fn at_rate(&self, _rate: f64) -> Option<Self> {
        None
    }

    fn linear_rate(&self) -> Option<f64> {
        Some(0.0)
    }
}

impl IdentifiableLaw for Maxwell {
    const NAME: &'static str = "Maxwell";
    const STEP_LIMITS: &'static [f64] = &[2.0];
    const LINEAR: bool = true;

    fn parameter_bounds(&self) -> Vec<(f64, f64)> {
        vec![LOG_RATE_BOUNDS]
    }

    fn stated(&self) -> Vec<StatedParameter> {
        vec![StatedParameter {
            name: "viscosity",
            symbol: "eta",
            unit: "Pa s",
            value: self.viscosity(),
            scale: Scale::Ratio,
            gradient: vec![-1.0],
            role: Role::Coordinate,
        }]
    }

    fn specimen_sensitivities(&self) -> Vec<SpecimenSensitivity> {
        vec![SpecimenSensitivity::of_rate(1.0)]
    }

    fn at_rate(&self, rate: f64) -> Option<Self> {
        Self::from_reference_rate(rate, self.reference_stress()).ok()
    }

    fn linear_rate(&self) -> Option<f64> {
        Some(self.reference_stress() / self.viscosity())
    }

    fn at_linear_limit(&self, rate: f64) -> Option<(Self, &'static str)> {
        Some((self.at_rate(rate)?, "of the same viscosity"))
    }
}

impl IdentifiableLaw for MaxwellNorton {
    const NAME: &'static str = "Maxwell-Norton";
    const STEP_LIMITS: &'static [f64] = &[0.5, 2.0];

    /// Returns the bounds of κ, from 0.05 (inelastic strain rate nearly independent of the stress)
    /// to 50 (nearly perfect plasticity), and of ln r. The linear law, κ = 1, is inside.
    fn parameter_bounds(&self) -> Vec<(f64, f64)> {
        vec![(0.05, 50.0), LOG_RATE_BOUNDS]
    }

    fn stated(&self) -> Vec<StatedParameter> {
        vec![
            StatedParameter {
                name: "exponent",
                symbol: "kappa",
                unit: "1",
                value: self.exponent(),
                scale: Scale::Difference,
                gradient: vec![1.0, 0.0],
                role: Role::Coordinate,
            },
            rate_at_reference(self, vec![0.0, 1.0]),
            StatedParameter {
                name: "coefficient",
                symbol: "B",
                unit: "Pa^kappa s",
                value: self.coefficient(),
                scale: Scale::Ratio,
                // ln B = κ ln σ_ref - ln r
                gradient: vec![self.reference_stress().ln(), -1.0],
                role: Role::Derived,
            },
        ]
    }

    fn specimen_sensitivities(&self) -> Vec<SpecimenSensitivity> {
        vec![
            SpecimenSensitivity::default(),
            SpecimenSensitivity::of_rate(self.exponent()),
        ]
    }

    fn at_rate(&self, rate: f64) -> Option<Self> {
        Self::from_reference_rate(self.exponent(), rate, self.reference_stress()).ok()
    }

    fn at_linear_limit(&self, rate: f64) -> Option<(Self, &'static str)> {
        let law = Self::from_reference_rate(1.0, rate, self.reference_stress()).ok()?;
        Some((law, "with kappa = 1"))
    }
}

impl IdentifiableLaw for Eyring {
    const NAME: &'static str = "Maxwell-Eyring";
    const STEP_LIMITS: &'static [f64] = &[0.5, 2.0];

    /// Returns bounds of ln β for β from 1e-3, the linear law, to 50.
    fn parameter_bounds(&self) -> Vec<(f64, f64)> {
        vec![(LINEAR_SHARPNESS.ln(), 50_f64.ln()), LOG_RATE_BOUNDS]
    }

    fn stated(&self) -> Vec<StatedParameter> {
        vec![
            rate_at_reference(self, vec![0.0, 1.0]),
            StatedParameter {
                name: "activation stress",
                symbol: "sigma*",
                unit: "Pa",
                value: self.activation_stress(),
                scale: Scale::Ratio,
                // ln σ* = ln σ_ref - ln β
                gradient: vec![-1.0, 0.0],
                role: Role::Coordinate,
            },
            StatedParameter {
                name: "rate factor",
                symbol: "rate_0",
                unit: "1/s",
                value: self.rate_factor(),
                scale: Scale::Ratio,
                // ln ε̇₀ = ln r - ln sinh β
                gradient: vec![-self.exponent_at_reference(), 1.0],
                role: Role::Derived,
            },
        ]
    }

    /// ln F has the slope β coth β at σ_ref, and β = σ_ref/σ*.
    fn specimen_sensitivities(&self) -> Vec<SpecimenSensitivity> {
        vec![
            SpecimenSensitivity {
                length: -1.0,
                density: -1.0,
            },
            SpecimenSensitivity::of_rate(self.exponent_at_reference()),
        ]
    }

    fn at_rate(&self, rate: f64) -> Option<Self> {
        let sharpness = self.reference_stress() / self.activation_stress();
        Self::from_reference_rate(sharpness, rate, self.reference_stress()).ok()
    }

    fn at_linear_limit(&self, rate: f64) -> Option<(Self, &'static str)> {
        let law =
            Self::from_reference_rate(LINEAR_SHARPNESS, rate, self.reference_stress()).ok()?;
        Some((law, "with 1/sigma* = 0"))
    }
}

/// Sharpness at which Eyring's law is linear: the rate differs by β²/6 (σ²/σ_ref² - 1), 1e-5 at a
/// stress of 8 σ_ref.
const LINEAR_SHARPNESS: f64 = 1e-3;

/// β = σ_ref/m.
#[allow(clippy::indexing_slicing, reason = "the law has two parameters")]
fn sharpness(law: &MaxwellGurevichRabinovich) -> f64 {
    InelasticLaw::parameters(law)[0]
}

impl IdentifiableLaw for MaxwellGurevichRabinovich {
    const NAME: &'static str = "Maxwell-Gurevich-Rabinovich";
    const STEP_LIMITS: &'static [f64] = &[0.5, 2.0];

    /// Returns β from -50 to 50; the linear law β = 0 is inside.
    fn parameter_bounds(&self) -> Vec<(f64, f64)> {
        vec![(-50.0, 50.0), LOG_RATE_BOUNDS]
    }

    fn stated(&self) -> Vec<StatedParameter> {
        let sharpness = sharpness(self);
        vec![
            rate_at_reference(self, vec![0.0, 1.0]),
            StatedParameter {
                name: "activation stress",
                symbol: "m",
                unit: "Pa",
                value: self.activation_stress(),
                scale: Scale::Ratio,
                // ln m = ln σ_ref - ln β
                gradient: vec![-1.0 / sharpness, 0.0],
                role: Role::Coordinate,
            },
            StatedParameter {
                name: "viscosity",
                symbol: "eta",
                unit: "Pa s",
                value: self.viscosity(),
                scale: Scale::Ratio,
                // ln η = ln σ_ref + β - ln r
                gradient: vec![1.0, -1.0],
                role: Role::Derived,
            },
        ]
    }

    /// ln F = ln r + ln(σ/σ_ref) + β (σ/σ_ref - 1) has the slope 1 + β at σ_ref, and β = σ_ref/m.
    fn specimen_sensitivities(&self) -> Vec<SpecimenSensitivity> {
        let sharpness = sharpness(self);
        vec![
            SpecimenSensitivity {
                length: -sharpness,
                density: -sharpness,
            },
            SpecimenSensitivity::of_rate(1.0 + sharpness),
        ]
    }

    fn at_rate(&self, rate: f64) -> Option<Self> {
        Self::from_reference_rate(sharpness(self), rate, self.reference_stress()).ok()
    }

    fn at_linear_limit(&self, rate: f64) -> Option<(Self, &'static str)> {
        let law = Self::from_reference_rate(0.0, rate, self.reference_stress()).ok()?;
        Some((law, "with 1/m = 0"))
    }
}

//! Laws of Table 1 and their parameters in SI.

use super::super::error::FixtureError;

/// Laws of Table 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModelKind {
    /// `M_1`, F = σ/η.
    Maxwell,
    /// `M_2`, F = |σ|^κ sgn(σ)/B.
    MaxwellNorton,
    /// `M_3`, F = σ exp(|σ|/m)/η.
    MaxwellGurevichRabinovich,
}

impl ModelKind {
    /// Returns the printed symbol of the model.
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Maxwell => "M_1",
            Self::MaxwellNorton => "M_2",
            Self::MaxwellGurevichRabinovich => "M_3",
        }
    }

    pub fn of_symbol(symbol: &str) -> Option<Self> {
        [
            Self::Maxwell,
            Self::MaxwellNorton,
            Self::MaxwellGurevichRabinovich,
        ]
        .into_iter()
        .find(|model| model.symbol() == symbol)
    }

    /// Returns the printed symbols of the parameters of the model, in the order of
    /// [`LawParameters`].
    pub const fn parameters(self) -> &'static [&'static str] {
        match self {
            Self::Maxwell => &["E", "eta"],
            Self::MaxwellNorton => &["E", "kappa", "B"],
            Self::MaxwellGurevichRabinovich => &["E", "eta", "m"],
        }
    }
}

/// Parameters of one law in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LawParameters {
    Maxwell {
        /// E in Pa
        modulus: f64,
        /// η in Pa s
        viscosity: f64,
    },
    MaxwellNorton {
        /// E in Pa
        modulus: f64,
        /// κ
        exponent: f64,
        /// B in Pa^κ s
        coefficient: f64,
    },
    MaxwellGurevichRabinovich {
        /// E in Pa
        modulus: f64,
        /// η in Pa s
        viscosity: f64,
        /// m in Pa
        activation_stress: f64,
    },
}

impl LawParameters {
    pub fn of(
        model: ModelKind,
        parameter: impl Fn(&str) -> Result<f64, FixtureError>,
    ) -> Result<Self, FixtureError> {
        let modulus = parameter("E")?;
        Ok(match model {
            ModelKind::Maxwell => Self::Maxwell {
                modulus,
                viscosity: parameter("eta")?,
            },
            ModelKind::MaxwellNorton => Self::MaxwellNorton {
                modulus,
                exponent: parameter("kappa")?,
                coefficient: parameter("B")?,
            },
            ModelKind::MaxwellGurevichRabinovich => Self::MaxwellGurevichRabinovich {
                modulus,
                viscosity: parameter("eta")?,
                activation_stress: parameter("m")?,
            },
        })
    }
}

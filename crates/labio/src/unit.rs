//! Units as they are written in files and sheets, and what they are in SI.

use std::fmt;

use crate::{LabioError, Quantity};

/// Exponents of the SI base units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Dimension {
    /// Metre.
    pub length: i8,
    /// Kilogram.
    pub mass: i8,
    /// Second.
    pub time: i8,
    /// Ampere.
    pub current: i8,
    /// Kelvin.
    pub temperature: i8,
}

/// A unit that was read: its text, its dimension and the SI value of one of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    symbol: String,
    dimension: Dimension,
    scale: f64,
    offset: f64,
}

impl Unit {
    /// The SI unit of `quantity`.
    #[must_use]
    pub fn si(quantity: Quantity) -> Self {
        Self {
            symbol: quantity.unit().to_owned(),
            dimension: quantity.dimension(),
            scale: 1.0,
            offset: 0.0,
        }
    }

    /// The unit that `text` says.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownUnit`].
    pub fn parse(text: &str) -> Result<Self, LabioError> {
        Err(LabioError::UnknownUnit {
            found: text.to_owned(),
        })
    }

    /// The text of the unit.
    #[must_use]
    pub fn symbol(&self) -> &str {
        &self.symbol
    }

    /// Exponents of the base units.
    #[must_use]
    pub fn dimension(&self) -> Dimension {
        self.dimension
    }

    /// The SI value of `value` of this unit.
    #[must_use]
    pub fn to_si(&self, value: f64) -> f64 {
        value * self.scale + self.offset
    }

    /// How many of this unit the SI value is.
    #[must_use]
    pub fn of_si(&self, si: f64) -> f64 {
        (si - self.offset) / self.scale
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.symbol)
    }
}

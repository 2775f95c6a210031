//! Values from data sheets.

use crate::error::{check_finite, check_not_negative, unit_mismatch};
use crate::{LabioError, Quantity, Unit};

/// A value from a data sheet or a certificate, with its unit and standard uncertainty.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "RatingSheet"))]
pub struct Rating {
    value: f64,
    unit: Unit,
    #[cfg_attr(feature = "serde", serde(rename = "standard_uncertainty"))]
    uncertainty: f64,
}

impl Rating {
    /// Creates a rating of `value` in `unit`, without uncertainty.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownUnit`], or [`LabioError::NonPhysical`] if the value is not finite.
    pub fn new(value: f64, unit: &str) -> Result<Self, LabioError> {
        let rating = Self {
            value: check_finite("rated value", value)?,
            unit: Unit::parse(unit)?,
            uncertainty: 0.0,
        };
        check_finite("rated value in SI", rating.si())?;
        Ok(rating)
    }

    /// Sets the standard uncertainty, in the unit of the value.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if it is negative or not finite.
    pub fn with_uncertainty(mut self, standard_uncertainty: f64) -> Result<Self, LabioError> {
        self.uncertainty = check_not_negative("standard uncertainty", standard_uncertainty)?;
        Ok(self)
    }

    /// The number 1.
    pub(super) fn one() -> Self {
        Self {
            value: 1.0,
            unit: Unit::si(Quantity::Strain),
            uncertainty: 0.0,
        }
    }

    /// The value, in [`Self::unit`].
    #[must_use]
    pub fn value(&self) -> f64 {
        self.value
    }

    /// The unit.
    #[must_use]
    pub fn unit(&self) -> &Unit {
        &self.unit
    }

    /// Standard uncertainty in the unit of the value.
    #[must_use]
    pub fn standard_uncertainty(&self) -> f64 {
        self.uncertainty
    }

    /// The value in the SI unit.
    #[must_use]
    pub fn si(&self) -> f64 {
        self.unit.to_si(self.value)
    }

    pub(super) fn relative_uncertainty(&self) -> f64 {
        self.uncertainty / self.value.abs()
    }

    pub(super) fn expect_quantity(
        &self,
        what: &'static str,
        expected: Quantity,
    ) -> Result<(), LabioError> {
        if self.unit.dimension() == expected.dimension() {
            Ok(())
        } else {
            let expected = format!("a unit of {}", expected.unit());
            unit_mismatch(what, self.unit.to_string(), expected)
        }
    }
}

#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct RatingSheet {
    value: f64,
    unit: String,
    #[serde(default)]
    standard_uncertainty: f64,
}

#[cfg(feature = "serde")]
impl TryFrom<RatingSheet> for Rating {
    type Error = LabioError;

    fn try_from(sheet: RatingSheet) -> Result<Self, LabioError> {
        Self::new(sheet.value, &sheet.unit)?.with_uncertainty(sheet.standard_uncertainty)
    }
}

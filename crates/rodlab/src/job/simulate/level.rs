//! Levels of noise and converters, as fractions of the largest value of a channel or in the unit of
//! the channel.

use labio::{Channel, Dimension};
use serde::Deserialize;

use crate::RodlabError;
use crate::sheet::number_and_unit;

/// A level as written in the sheet.
#[derive(Debug, Clone, Deserialize)]
#[serde(try_from = "String")]
pub struct LevelText {
    text: String,
    si: f64,
    /// Dimension of an absolute level; `None` for a ratio to the largest value of the channel.
    dimension: Option<Dimension>,
}

impl TryFrom<String> for LevelText {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let expected = "expected a part of the largest value, such as \"0.02 %\", or a level in the unit of the channel";
        let (number, unit) =
            number_and_unit(&text).map_err(|why| format!("`{text}` {why}, {expected}"))?;
        let si = unit.to_si(number);
        if !(si.is_finite() && si > 0.0) {
            return Err(format!("`{text}` is not above 0, {expected}"));
        }
        let dimension = (unit.symbol() != "%").then(|| unit.dimension());
        Ok(Self {
            text,
            si,
            dimension,
        })
    }
}

impl LevelText {
    /// Returns the level in SI units for a `channel` with this `peak`; `field` is the place of the
    /// level in the sheet.
    pub(super) fn of(&self, channel: &Channel, peak: f64, field: &str) -> Result<f64, RodlabError> {
        let quantity = channel.quantity();
        match self.dimension {
            None => Ok(self.si * peak),
            Some(dimension) if dimension == quantity.dimension() => Ok(self.si),
            Some(_) => Err(RodlabError::request(
                field,
                format!("`{}`", self.text),
                format!(
                    "a part of the largest value in % or a level of `{}`, which is {} [{}]",
                    channel.name(),
                    quantity.name(),
                    quantity.unit()
                ),
            )),
        }
    }
}

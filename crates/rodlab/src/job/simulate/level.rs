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
    pub(super) text: String,
    pub(super) level: Level,
}

/// A level of a channel.
#[derive(Debug, Clone, Copy)]
pub(super) enum Level {
    /// Ratio to the largest value of the channel.
    OfPeak(f64),
    /// Absolute value in SI units.
    Absolute(f64, Dimension),
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
        let level = if unit.symbol() == "%" {
            Level::OfPeak(si)
        } else {
            Level::Absolute(si, unit.dimension())
        };
        Ok(Self { text, level })
    }
}

impl Level {
    /// Returns the level in SI units for a `channel` with this `peak`; `text` is the text of the
    /// level at `field`.
    pub(super) fn of(
        self,
        channel: &Channel,
        peak: f64,
        text: &str,
        field: &str,
    ) -> Result<f64, RodlabError> {
        match self {
            Self::OfPeak(part) => Ok(part * peak),
            Self::Absolute(si, dimension) if dimension == channel.quantity().dimension() => Ok(si),
            Self::Absolute(..) => Err(RodlabError::request(
                field,
                format!("`{text}`"),
                format!(
                    "a part of the largest value in % or a level of `{}`, which is {} [{}]",
                    channel.name(),
                    channel.quantity().name(),
                    channel.quantity().unit()
                ),
            )),
        }
    }
}

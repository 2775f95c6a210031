//! Levels and lengths of a sheet, whose meaning depends on the channel or on the sampling rate.

use std::fmt;

use labio::hits::Extent;
use labio::{Channel, Dimension};
use serde::Deserialize;

use crate::RodlabError;
use crate::sheet::{self, Duration, Exact};

/// A level of a channel, such as `"20 N"`; its dimension must be that of the channel.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "String")]
pub struct Reading {
    si: f64,
    dimension: Dimension,
    text: String,
}

impl TryFrom<String> for Reading {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let (number, unit) = sheet::number_and_unit(&text)
            .map_err(|why| format!("`{text}` {why}, expected a level, such as \"20 N\""))?;
        Ok(Self {
            si: unit.to_si(number),
            dimension: unit.dimension(),
            text,
        })
    }
}

impl fmt::Display for Reading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Reading {
    /// Returns the level in the SI unit of `channel`; `field` is the place of the level in the
    /// sheet.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Request`] if the dimension of the level is not that of the channel.
    pub fn of(&self, channel: &Channel, field: &str) -> Result<f64, RodlabError> {
        let quantity = channel.quantity();
        if self.dimension == quantity.dimension() {
            Ok(self.si)
        } else {
            Err(RodlabError::request(
                field,
                format!("`{}`", self.text),
                format!(
                    "a level of `{}`, which is {} [{}]",
                    channel.name(),
                    quantity.name(),
                    quantity.unit()
                ),
            ))
        }
    }
}

/// Length of a part of a record: a duration such as `"0.5 s"`, or a number of samples such as
/// `"4096 samples"`.
#[derive(Debug, Clone, Deserialize)]
#[serde(try_from = "String")]
pub struct Stretch {
    extent: Extent,
    text: String,
}

impl TryFrom<String> for Stretch {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let trimmed = text.trim();
        let number = trimmed
            .strip_suffix("samples")
            .or_else(|| trimmed.strip_suffix("sample"));
        let extent = match number {
            Some(number) => Extent::Samples(number.trim().parse().map_err(|_| {
                format!("`{text}` is not a whole number of samples, such as \"4096 samples\"")
            })?),
            None => {
                let duration: Exact<Duration> = trimmed
                    .parse()
                    .map_err(|error| format!("{error}, or \"4096 samples\""))?;
                Extent::Seconds(duration.si())
            }
        };
        Ok(Self {
            extent,
            text: trimmed.to_owned(),
        })
    }
}

impl fmt::Display for Stretch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Stretch {
    /// Returns the length in the form used by the trigger.
    #[must_use]
    pub fn extent(&self) -> Extent {
        self.extent
    }
}

//! Channel of a sheet, with its sensor chain.

use std::fmt;

use labio::{BridgeLayout, LabioError, Polarity, Position, Rating, SensorChain, StrainBridge};
use serde::Deserialize;

use crate::sheet::{self, Coordinate, NotFollowed, Stated, Time, quoted};
use crate::{InStep, RodlabError};

/// A channel of the files, with its sensor.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChannelSheet {
    /// Name of the channel, by which the rest of the sheet refers to it.
    pub name: String,
    /// Names or patterns of the files that contain this channel, if the channels of a hit are in
    /// separate files; every channel then states its files.
    #[serde(default)]
    pub files: Vec<String>,
    /// Channel of the file.
    pub from: Selector,
    /// Unit of the samples, such as `"V"`, if the file does not record it.
    pub unit: Option<String>,
    /// Sensitivity of the sensor, such as `"10.2 mV/g"` or `"4 pC/N ± 1 %"`; not stated if the file
    /// contains the quantity itself.
    pub sensitivity: Option<Sensitivity>,
    /// Bridge of strain gauges, stated instead of a sensitivity.
    pub bridge: Option<BridgeSheet>,
    /// Gain of an amplifier after the sensor, such as `"100"` or `"10 mV/pC"`.
    pub gain: Option<Sensitivity>,
    /// True for a sensor that is wired or mounted in the opposite direction.
    #[serde(default)]
    pub inverted: bool,
    /// Value at rest, in the unit of the file, which is subtracted.
    #[serde(default)]
    pub offset: f64,
    /// Delay of the samples of this channel relative to the other channels: `"5 us"` or `"0 us ± 2
    /// us"`, for example. With a positive delay, the uncorrected signal appears too early.
    pub time_skew: Option<Stated<Time>>,
    /// Coordinate of the sensor along the rod.
    pub position: Option<NotFollowed<Coordinate>>,
    /// Serial number of the sensor.
    pub serial: Option<String>,
}

/// A bridge of strain gauges, such as `(layout: Quarter, gauge_factor: "2.1 ± 0.5 %", excitation:
/// "10 V")`.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BridgeSheet {
    /// Arms of the bridge that carry gauges.
    pub layout: BridgeLayout,
    /// Gauge factor.
    pub gauge_factor: Sensitivity,
    /// Supply voltage of the bridge.
    pub excitation: Sensitivity,
}

impl BridgeSheet {
    fn bridge(&self) -> Result<StrainBridge, LabioError> {
        StrainBridge::new(
            self.layout,
            self.gauge_factor.0.clone(),
            self.excitation.0.clone(),
        )
    }
}

/// A channel of a file.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(
    untagged,
    expecting = "found neither a channel nor a column, expected its number from 1 or its name in quotes"
)]
pub enum Selector {
    /// Number, from 1; a column of times is not counted.
    Number(usize),
    /// Name.
    Name(String),
}

impl fmt::Display for Selector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.as_asked("channel"))
    }
}

impl Selector {
    /// Returns the request for an element of this `kind`, such as `column 3`, or its name.
    pub(crate) fn as_asked(&self, kind: &str) -> String {
        match self {
            Self::Number(number) => format!("{kind} {number}"),
            Self::Name(name) => format!("`{name}`"),
        }
    }

    /// Returns the elements of `all` with this number or this name. Several elements may have the
    /// same name.
    pub(crate) fn matching<'a, T>(&self, all: &'a [T], name: impl Fn(&T) -> &str) -> Vec<&'a T> {
        match self {
            Self::Number(number) => {
                let found = number.checked_sub(1).and_then(|at| all.get(at));
                found.into_iter().collect()
            }
            Self::Name(wanted) => all
                .iter()
                .filter(|one| name(one).trim() == wanted.trim())
                .collect(),
        }
    }

    /// Returns the column of `all` with the number or the name; `place` is that of the selector.
    pub(crate) fn column<'a, T>(
        &self,
        all: &'a [T],
        name: impl Fn(&T) -> &str,
        place: &str,
    ) -> Result<&'a T, RodlabError> {
        let asked = self.as_asked("column");
        match self.matching(all, &name).as_slice() {
            [only] => Ok(only),
            [] => {
                let expected = format!("one of the columns {}", quoted(all.iter().map(name)));
                Err(RodlabError::request(place, asked, expected))
            }
            _ => Err(RodlabError::request(
                place,
                format!("{asked}, the name of several columns"),
                "the number of the column, from 1",
            )),
        }
    }
}

/// A sensitivity or a gain: number, unit and standard uncertainty.
#[derive(Debug, Clone, Deserialize)]
#[serde(try_from = "String")]
pub struct Sensitivity(Rating);

impl TryFrom<String> for Sensitivity {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let refused = |why: String| {
            format!(
                "`{text}` {why}, expected a sensitivity or a gain, such as \"10.2 mV/g ± 1 %\" or \"100\""
            )
        };
        let (rating, uncertainty) = sheet::value_and_uncertainty(&text);
        let (value, unit) = sheet::number_and_unit(&rating).map_err(refused)?;
        let mut rating = Rating::new(value, unit.symbol())
            .map_err(|error| refused(format!("is refused: {error}")))?;
        if let Some(uncertainty) = uncertainty {
            let (percent, unit) = sheet::number_and_unit(&uncertainty).map_err(refused)?;
            if unit.symbol() != "%" {
                return Err(refused("has an uncertainty that is not in %".to_owned()));
            }
            rating = rating
                .with_uncertainty(value.abs() * percent / 100.0)
                .map_err(|error| refused(format!("is refused: {error}")))?;
        }
        Ok(Self(rating))
    }
}

impl ChannelSheet {
    /// Returns the sensor chain of the channel; `None` if the file contains the quantity itself and
    /// needs no correction.
    pub(super) fn chain(&self, field: &str) -> Result<Option<SensorChain>, RodlabError> {
        if let Some(Sensitivity(rating)) = &self.sensitivity
            && rating.value() < 0.0
        {
            return Err(RodlabError::request(
                format!("{field}.sensitivity"),
                format!("{} {}", rating.value(), rating.unit()),
                "a value above 0: state `inverted` as true for a sensor that points the other way",
            ));
        }
        let mut chain = match (&self.sensitivity, &self.bridge) {
            (Some(_), Some(_)) => {
                return Err(RodlabError::request(
                    format!("{field}.bridge"),
                    "stated in addition to a sensitivity",
                    "one of the two",
                ));
            }
            (Some(sensitivity), None) => {
                SensorChain::of_sensitivity(sensitivity.0.clone()).in_step(field)?
            }
            (None, Some(bridge)) => SensorChain::of_bridge(bridge.bridge().in_step(field)?),
            (None, None) => {
                let plain = self.gain.is_none() && !self.inverted && self.offset == 0.0;
                if plain && self.time_skew.is_none() && self.position.is_none() {
                    return Ok(None);
                }
                let one = Rating::new(1.0, "1").in_step(field)?;
                SensorChain::of_sensitivity(one).in_step(field)?
            }
        };
        if let Some(gain) = &self.gain {
            chain = chain.with_gain(gain.0.clone()).in_step(field)?;
        }
        if let Some(position) = &self.position {
            let position = Position {
                x: position.si(),
                standard_uncertainty: 0.0,
            };
            chain = chain.with_position(position).in_step(field)?;
        }
        if let Some(serial) = &self.serial {
            chain = chain.with_serial(serial);
        }
        let polarity = if self.inverted {
            Polarity::Inverted
        } else {
            Polarity::default()
        };
        let chain = chain.with_polarity(polarity).with_offset(self.offset);
        let skew = self.time_skew.as_ref().map(Stated::with_uncertainty);
        chain
            .and_then(|chain| match skew {
                Some(skew) => chain
                    .with_time_skew(skew.value)?
                    .with_time_skew_uncertainty(skew.uncertainty()),
                None => Ok(chain),
            })
            .map(Some)
            .in_step(field)
    }
}

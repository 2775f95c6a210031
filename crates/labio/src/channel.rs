//! Name and quantity of a row of samples.

use std::collections::HashMap;
use std::fmt;

use crate::{Dimension, LabioError};

/// The physical quantity of a channel, which fixes its SI unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Quantity {
    /// Force \[N\]; a contact force is positive in compression.
    Force,
    /// Displacement \[m\].
    Displacement,
    /// Velocity \[m/s\].
    Velocity,
    /// Acceleration \[m/s^2\].
    Acceleration,
    /// Normal strain \[-\], positive in tension.
    Strain,
    /// Voltage \[V\]: a sensor's signal before calibration.
    Voltage,
    /// Charge \[C\]: the signal of a piezoelectric sensor without electronics.
    Charge,
    /// Pressure or stress \[Pa\].
    Pressure,
    /// Temperature \[K\].
    Temperature,
}

impl Quantity {
    /// All quantities.
    pub const ALL: [Self; 9] = [
        Self::Force,
        Self::Displacement,
        Self::Velocity,
        Self::Acceleration,
        Self::Strain,
        Self::Voltage,
        Self::Charge,
        Self::Pressure,
        Self::Temperature,
    ];

    /// Returns the quantity of this dimension, if there is one; a pure number counts as strain.
    #[must_use]
    pub fn of_dimension(dimension: Dimension) -> Option<Self> {
        Self::ALL.into_iter().find(|q| q.dimension() == dimension)
    }

    /// Returns true for a force, and for the signal of an uncalibrated sensor.
    pub(crate) fn may_be_force(self) -> bool {
        matches!(self, Self::Force | Self::Voltage | Self::Charge)
    }

    /// Name, SI unit, and exponents of length, mass, time, current and temperature in the unit.
    const fn properties(self) -> (&'static str, &'static str, [i8; 5]) {
        match self {
            Self::Force => ("force", "N", [1, 1, -2, 0, 0]),
            Self::Displacement => ("displacement", "m", [1, 0, 0, 0, 0]),
            Self::Velocity => ("velocity", "m/s", [1, 0, -1, 0, 0]),
            Self::Acceleration => ("acceleration", "m/s^2", [1, 0, -2, 0, 0]),
            Self::Strain => ("strain", "1", [0, 0, 0, 0, 0]),
            Self::Voltage => ("voltage", "V", [2, 1, -3, -1, 0]),
            Self::Charge => ("charge", "C", [0, 0, 1, 1, 0]),
            Self::Pressure => ("pressure", "Pa", [-1, 1, -2, 0, 0]),
            Self::Temperature => ("temperature", "K", [0, 0, 0, 0, 1]),
        }
    }

    /// The quantity in words.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.properties().0
    }

    /// The SI unit of the samples, in ASCII.
    #[must_use]
    pub fn unit(self) -> &'static str {
        self.properties().1
    }

    /// Exponents of the base units in the quantity's unit.
    #[must_use]
    pub fn dimension(self) -> Dimension {
        Dimension::of(self.properties().2)
    }
}

/// Name and quantity of one row of a [`Record`](crate::Record).
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Channel {
    name: String,
    quantity: Quantity,
}

impl Channel {
    /// Creates a channel called `name`; a record looks up its channels by name.
    ///
    /// # Errors
    ///
    /// [`LabioError::EmptyChannelName`] if the name is empty or blank.
    pub fn new(name: impl Into<String>, quantity: Quantity) -> Result<Self, LabioError> {
        let name = name.into();
        if name.trim().is_empty() {
            return Err(LabioError::EmptyChannelName {
                quantity: quantity.name(),
            });
        }
        Ok(Self { name, quantity })
    }

    /// Name of the channel.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Quantity of the samples.
    #[must_use]
    pub fn quantity(&self) -> Quantity {
        self.quantity
    }
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` [{}]", self.name, self.quantity.unit())
    }
}

/// Finds the channel called `name` and its row.
pub(crate) fn find<'a>(
    channels: &'a [Channel],
    name: &str,
) -> Result<(usize, &'a Channel), LabioError> {
    channels
        .iter()
        .enumerate()
        .find(|(_, channel)| channel.name == name)
        .ok_or_else(|| LabioError::UnknownChannel {
            name: name.to_owned(),
            known: channels.iter().map(|c| c.name.clone()).collect(),
        })
}

/// Rejects a list in which a name occurs twice.
pub(crate) fn check_distinct(channels: &[Channel]) -> Result<(), LabioError> {
    let mut seen = HashMap::with_capacity(channels.len());
    for (second, channel) in channels.iter().enumerate() {
        let first = *seen.entry(channel.name.as_str()).or_insert(second);
        if first < second {
            return Err(LabioError::DuplicateChannel {
                name: channel.name.clone(),
                first,
                second,
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blank_name_is_refused() {
        let error = Channel::new("  ", Quantity::Force).unwrap_err();
        assert_eq!(error.to_string(), "a channel of force has an empty name");
    }

    #[test]
    fn an_unknown_name_is_answered_with_the_known_ones() {
        let channels = [
            Channel::new("hammer", Quantity::Force).unwrap(),
            Channel::new("end A", Quantity::Acceleration).unwrap(),
        ];
        assert_eq!(find(&channels, "end A").unwrap(), (1, &channels[1]));
        assert_eq!(
            find(&channels, "end B").unwrap_err().to_string(),
            "there is no channel `end B`, only `hammer`, `end A`"
        );
    }

    #[test]
    fn forces_and_signals_without_calibration_may_be_forces() {
        let tested = Quantity::ALL.into_iter().filter(|of| of.may_be_force());
        let expected = [Quantity::Force, Quantity::Voltage, Quantity::Charge];
        assert_eq!(tested.collect::<Vec<_>>(), expected);
    }
}

//! Units of the columns of a table.

use labio::format::csv::TableColumn;
use labio::{Dimension, Unit};
use serde::Deserialize;

use crate::sheet::{Frequency, Kind, Pressure, Temperature};
use crate::{InStep, RodlabError};

/// Units of columns for which the file contains none.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct UnitsSheet {
    /// Unit of frequencies, such as `"Hz"` or `"rad/s"`.
    pub frequency: Option<String>,
    /// Unit of times, such as `"s"` or `"min"`.
    pub time: Option<String>,
    /// Unit of compliances, such as `"1/MPa"`.
    pub compliance: Option<String>,
    /// Unit of moduli, such as `"MPa"`.
    pub modulus: Option<String>,
    /// Unit of phases, such as `"deg"`.
    pub phase: Option<String>,
    /// Unit of temperatures, such as `"degC"`.
    pub temperature: Option<String>,
}

/// Quantity that a column must have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wanted {
    Frequency,
    AngularFrequency,
    Time,
    Modulus,
    Compliance,
    /// A pure number without a unit of its own.
    Number,
    Phase,
    Temperature,
}

impl Wanted {
    fn dimension(self) -> Dimension {
        match self {
            Self::Frequency | Self::AngularFrequency => Frequency::DIMENSION,
            Self::Time => Dimension::TIME,
            Self::Modulus => Pressure::DIMENSION,
            Self::Compliance => Dimension {
                length: 1,
                mass: -1,
                time: 2,
                ..Dimension::NONE
            },
            Self::Number | Self::Phase => Dimension::NONE,
            Self::Temperature => Temperature::DIMENSION,
        }
    }

    fn in_words(self) -> &'static str {
        match self {
            Self::Frequency => "a frequency, for example in Hz",
            Self::AngularFrequency => "an angular frequency, for example in rad/s",
            Self::Time => "a time, for example in s",
            Self::Modulus => "a modulus, for example in MPa",
            Self::Compliance => "a compliance, for example in 1/MPa",
            Self::Number => "a pure number",
            Self::Phase => "an angle, in rad or deg",
            Self::Temperature => "a temperature, for example in degC",
        }
    }

    /// Returns the field of `units` for this quantity, and the unit stated there.
    fn stated(self, units: &UnitsSheet) -> (&'static str, Option<&String>) {
        match self {
            Self::Frequency | Self::AngularFrequency => {
                ("units.frequency", units.frequency.as_ref())
            }
            Self::Time => ("units.time", units.time.as_ref()),
            Self::Modulus => ("units.modulus", units.modulus.as_ref()),
            Self::Compliance => ("units.compliance", units.compliance.as_ref()),
            Self::Number => ("units.phase", None),
            Self::Phase => ("units.phase", units.phase.as_ref()),
            Self::Temperature => ("units.temperature", units.temperature.as_ref()),
        }
    }

    /// Returns true if a unit with this text measures this quantity. Hz and rad/s have the same
    /// dimension and differ by 2π.
    fn takes(self, text: &str, unit: &Unit) -> bool {
        unit.dimension() == self.dimension()
            && match self {
                Self::Frequency => !text.contains("rad"),
                Self::AngularFrequency => !text.contains("Hz"),
                _ => true,
            }
    }

    /// Parses a unit. A `C` alone is the coulomb, but in a column of temperatures the degree
    /// Celsius.
    fn parse(self, text: &str) -> Option<Unit> {
        let text = match (self, text) {
            (Self::Temperature, "C" | "c" | "\u{ba}C" | "deg C") => "degC",
            (Self::Temperature, "F") => "degF",
            _ => text,
        };
        Unit::parse(text).ok()
    }
}

/// Returns the unit of `column`, from the file or from the sheet; `place` is the place of the
/// column in the sheet.
pub(super) fn of(
    column: &TableColumn,
    wanted: Wanted,
    units: &UnitsSheet,
    (table, place): (&str, &str),
) -> Result<Unit, RodlabError> {
    let name = &column.name;
    let written = match column.unit_text.as_str() {
        "-" | "[]" | "()" => "",
        text => text,
    };
    let (field, stated) = wanted.stated(units);
    let stated = match stated {
        None => None,
        Some(text) => {
            let unit = wanted.parse(text).filter(|unit| wanted.takes(text, unit));
            let refused = || {
                RodlabError::request(
                    format!("{table}.{field}"),
                    format!("`{text}`"),
                    format!("the unit of {}", wanted.in_words()),
                )
            };
            Some(unit.ok_or_else(refused)?)
        }
    };
    let in_file = wanted.parse(written).filter(|_| !written.is_empty());
    match (in_file, stated) {
        (Some(unit), _) if !wanted.takes(written, &unit) => Err(RodlabError::request(
            place,
            format!("`{name}`, a column in [{written}]"),
            wanted.in_words(),
        )),
        (Some(unit), Some(stated)) if !is_same(&unit, &stated) => Err(RodlabError::request(
            format!("{table}.{field}"),
            format!(
                "`{}`, and `{name}` of {place} is in [{written}]",
                stated.symbol()
            ),
            "the unit of the file, or the field left out",
        )),
        (Some(unit), _) => Ok(unit),
        (None, Some(stated)) => Ok(stated),
        (None, None) if wanted == Wanted::Number && written.is_empty() => {
            Unit::parse("1").in_step(place)
        }
        (None, None) => {
            let found = if written.is_empty() {
                format!("`{name}`, a column without a unit")
            } else {
                format!("`{name}`, a column in [{written}], which is not a known unit")
            };
            Err(RodlabError::request(
                place,
                found,
                format!("{}: state it as `{field}`", wanted.in_words()),
            ))
        }
    }
}

fn is_same(a: &Unit, b: &Unit) -> bool {
    let near = |x: f64, y: f64| (x - y).abs() <= 1e-12 * x.abs().max(y.abs());
    near(a.to_si(0.0), b.to_si(0.0)) && near(a.to_si(1.0), b.to_si(1.0))
}

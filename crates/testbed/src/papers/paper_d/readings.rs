//! Interpretations ("readings") of the units of Tables 4 and A1 of paper D, and their application
//! to the printed values.
#![expect(
    dead_code,
    reason = "some fields are for the reader of the file; here they must only be there"
)]

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::super::decimal::Decimal;
use super::super::error::FixtureError;
use super::super::printed_table::{read_ron, read_value};
use super::super::si_table::SiValue;

/// Interpretation of the units of Tables 4 and A1 (Ödeen 1993, paper D). No interpretation of the
/// printed units is physically consistent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnitReading {
    /// Units as printed: the rods are then elastic over the record.
    Literal,
    /// Units of time in the viscosity and in Norton's coefficient interpreted as ms, a factor of
    /// 1e-3.
    Milliseconds,
    /// E and κ as printed; η, B and m replaced by values for significant damping that are not from
    /// the paper.
    Realistic,
}

impl UnitReading {
    pub const ALL: [Self; 3] = [Self::Literal, Self::Milliseconds, Self::Realistic];

    /// Returns the first line of every result that is computed with this reading.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Literal => "literal: units as printed; the rods are elastic over the record",
            Self::Milliseconds => {
                "milliseconds: every unit of time in eta and B read as ms (factor 1e-3), m as printed"
            }
            Self::Realistic => {
                "realistic: E and kappa as printed, eta, B and m our own values for materials with significant damping"
            }
        }
    }
}

/// File of readings, with its path.
#[derive(Debug)]
pub(super) struct Readings {
    path: PathBuf,
    file: ReadingsFile,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ReadingsFile {
    no_consistent_reading: String,
    prefix_of_a_power: String,
    literal: UnitOfTime,
    milliseconds: UnitOfTime,
    realistic: Realistic,
}

/// Reading that multiplies the unit of time by a factor.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct UnitOfTime {
    time_factor: String,
    reason: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Realistic {
    reason: String,
    values: Vec<RealisticValue>,
    appendix: Vec<AppendixFactor>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RealisticValue {
    material: String,
    parameter: String,
    value: String,
    reason: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct AppendixFactor {
    model: String,
    parameter: String,
    factor: String,
    reason: String,
}

impl Readings {
    pub(super) fn load(path: &Path) -> Result<Self, FixtureError> {
        Ok(Self {
            path: path.to_path_buf(),
            file: read_ron(path)?,
        })
    }

    /// Returns the explanation that no reading of the units is consistent.
    pub(super) fn no_consistent_reading(&self) -> &str {
        &self.file.no_consistent_reading
    }

    /// Returns a value of Table 4 in SI.
    pub(super) fn table_4(
        &self,
        reading: UnitReading,
        material: &str,
        parameter: &str,
        printed: &SiValue,
    ) -> Result<Decimal, FixtureError> {
        self.read(reading, parameter, printed, || {
            let mut values = self.file.realistic.values.iter();
            let ours = values
                .find(|ours| ours.material == material && ours.parameter == parameter)
                .ok_or_else(|| self.missing(material, parameter))?;
            let value = read_value(&self.path, material, parameter, &ours.value, None)?;
            if value.unit == printed.unit {
                Ok(value.value)
            } else {
                Err(self.cell(
                    material,
                    parameter,
                    &ours.value,
                    "the kind of unit that is printed",
                ))
            }
        })
    }

    /// Returns a value of Table A1 in SI.
    pub(super) fn table_a1(
        &self,
        reading: UnitReading,
        model: &str,
        parameter: &str,
        printed: &SiValue,
    ) -> Result<Decimal, FixtureError> {
        self.read(reading, parameter, printed, || {
            let mut factors = self.file.realistic.appendix.iter();
            let ours = factors
                .find(|ours| ours.model == model && ours.parameter == parameter)
                .ok_or_else(|| self.missing(model, parameter))?;
            self.product(printed, &ours.factor, model, parameter)
        })
    }

    /// Returns a printed value in SI; `ours` computes the value of the realistic reading.
    fn read(
        &self,
        reading: UnitReading,
        parameter: &str,
        printed: &SiValue,
        ours: impl FnOnce() -> Result<Decimal, FixtureError>,
    ) -> Result<Decimal, FixtureError> {
        match reading {
            UnitReading::Literal => self.with_time_factor(&self.file.literal, parameter, printed),
            UnitReading::Milliseconds => {
                self.with_time_factor(&self.file.milliseconds, parameter, printed)
            }
            UnitReading::Realistic if is_elastic_or_exponent(parameter) => Ok(printed.value),
            UnitReading::Realistic => ours(),
        }
    }

    /// Applies the factor to the viscosity η and to Norton's coefficient B, which contain one unit
    /// of time; the other parameters contain none.
    fn with_time_factor(
        &self,
        unit: &UnitOfTime,
        parameter: &str,
        printed: &SiValue,
    ) -> Result<Decimal, FixtureError> {
        match parameter {
            "eta" | "B" => self.product(printed, &unit.time_factor, "time_factor", parameter),
            _ => Ok(printed.value),
        }
    }

    fn product(
        &self,
        printed: &SiValue,
        factor: &str,
        row: &str,
        column: &str,
    ) -> Result<Decimal, FixtureError> {
        Decimal::parse(factor)
            .and_then(|factor| printed.value.times(factor))
            .ok_or_else(|| self.cell(row, column, factor, "a factor such as 1e-3"))
    }

    fn missing(&self, row: &str, column: &str) -> FixtureError {
        FixtureError::Missing {
            path: self.path.clone(),
            row: row.to_owned(),
            column: column.to_owned(),
        }
    }

    fn cell(&self, row: &str, column: &str, found: &str, expected: &'static str) -> FixtureError {
        FixtureError::Cell {
            path: self.path.clone(),
            row: row.to_owned(),
            column: column.to_owned(),
            found: found.to_owned(),
            expected,
        }
    }
}

/// Returns true for Young's modulus and the exponent, which are the same in every reading.
fn is_elastic_or_exponent(parameter: &str) -> bool {
    matches!(parameter, "E" | "kappa")
}

//! Readings of a loss factor, in the sheet or in a separate file.

use cmod::recovery::{LossFactorReadings, RecoveryTest};
use labio::{Dimension, Unit};
use serde::Deserialize;

use super::{ReadingsAre, RecoverySheet, TestSheet, load};
use crate::job::JobContext;
use crate::number_file::NumberFile;
use crate::outcome::InputFile;
use crate::records::Selector;
use crate::sheet::{Exact, NotFollowed, Time};
use crate::{InStep, RodlabError};

/// The readings of a test.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ReadingsSheet {
    /// Readings in the sheet.
    Here(
        /// The readings, in order of time.
        Vec<Reading>,
    ),
    /// Readings in a separate file, over a column of times with its unit.
    File {
        /// Name of the file, relative to the sheet.
        path: String,
        /// Column of the readings, by name or by number from 1, not counting the column of times.
        readings: Selector,
        /// Column of the standard errors of the readings.
        standard_errors: Option<Selector>,
    },
}

/// A reading.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reading {
    /// Time after unloading, such as `"1 min"`.
    pub at: NotFollowed<Time>,
    /// The loss factor, or its change; a pure number.
    pub value: f64,
    /// Standard error of the reading, if it differs from that of the sheet.
    pub standard_error: Option<f64>,
}

struct Columns {
    time: Vec<f64>,
    value: Vec<f64>,
    standard_error: Vec<f64>,
}

/// A test, the standard errors of its readings, and the file from which they were read, with a
/// warning about the file.
pub(super) struct Read {
    pub(super) test: RecoveryTest,
    pub(super) standard_error: Vec<f64>,
    /// Largest reading, as it was stated.
    pub(super) largest: f64,
    pub(super) input: Option<InputFile>,
    pub(super) warning: Option<String>,
}

/// Reads the test at `field` of the sheet.
pub(super) fn test(
    sheet: &RecoverySheet,
    test: &TestSheet,
    field: &str,
    context: &JobContext<'_>,
) -> Result<Read, RodlabError> {
    let (columns, file) = columns(sheet, test, field, context)?;
    let virgin = virgin(sheet)?;
    let mut change: Vec<f64> = columns.value.iter().map(|value| value - virgin).collect();
    if let Some(draw) = &context.draw {
        for (change, error) in change.iter_mut().zip(&columns.standard_error) {
            *change += error * draw.standard();
        }
    }
    let virgin_standard_error = sheet
        .virgin_loss_factor
        .as_ref()
        .map_or(0.0, |virgin| virgin.with_uncertainty().uncertainty());
    let frequency = test.frequency.as_ref().unwrap_or(&sheet.frequency);
    let readings = LossFactorReadings {
        time: &columns.time,
        change: &change,
        standard_error: &columns.standard_error,
        virgin_standard_error,
    };
    let load = load::history(&test.load, &format!("{field}.load"))?;
    let test =
        RecoveryTest::new(test.name.as_str(), load, frequency.si(), readings).in_step(field)?;
    Ok(Read {
        test,
        largest: columns.value.iter().copied().fold(0.0, f64::max),
        standard_error: columns.standard_error,
        warning: file.as_ref().and_then(|file| file.warning.clone()),
        input: file.map(|file| file.input),
    })
}

/// Returns the value that is subtracted from the readings.
fn virgin(sheet: &RecoverySheet) -> Result<f64, RodlabError> {
    let are = sheet.readings_are.unwrap_or(ReadingsAre::LossFactors);
    match (are, &sheet.virgin_loss_factor) {
        (ReadingsAre::Changes, _) => Ok(0.0),
        (ReadingsAre::LossFactors, Some(virgin)) => Ok(virgin.with_uncertainty().value),
        (ReadingsAre::LossFactors, None) => Err(RodlabError::request(
            "virgin_loss_factor",
            "missing",
            "the loss factor before any load, or `readings_are` as `changes` (in RON `Changes`)",
        )),
    }
}

fn columns(
    sheet: &RecoverySheet,
    test: &TestSheet,
    field: &str,
    context: &JobContext<'_>,
) -> Result<(Columns, Option<NumberFile>), RodlabError> {
    let common = sheet.standard_error.as_ref().map(Exact::si);
    let missing = |place: String| {
        RodlabError::request(
            place,
            "without a standard error",
            "a standard error of these readings, or `standard_error` of the sheet for all readings",
        )
    };
    match &test.readings {
        ReadingsSheet::Here(readings) => {
            let mut standard_error = Vec::with_capacity(readings.len());
            for (index, reading) in readings.iter().enumerate() {
                let stated = reading.standard_error.or(common);
                let place = || missing(format!("{field}.readings[{index}]"));
                standard_error.push(stated.ok_or_else(place)?);
            }
            let columns = Columns {
                time: readings.iter().map(|reading| reading.at.si()).collect(),
                value: readings.iter().map(|reading| reading.value).collect(),
                standard_error,
            };
            Ok((columns, None))
        }
        ReadingsSheet::File {
            path,
            readings,
            standard_errors,
        } => {
            let file = NumberFile::read(path, context.folder, &format!("{field}.readings.path"))?;
            let column = file.column(readings, &format!("{field}.readings.readings"))?;
            let value = column.pure_numbers()?;
            let second = Unit::parse("s").map_or(Dimension::NONE, |unit| unit.dimension());
            let time = column.abscissa(second, "times")?;
            let standard_error = match standard_errors {
                Some(errors) => file
                    .column(errors, &format!("{field}.readings.standard_errors"))?
                    .pure_numbers()?,
                None => {
                    let common = common.ok_or_else(|| missing(format!("{field}.readings")))?;
                    vec![common; value.len()]
                }
            };
            let columns = Columns {
                time,
                value,
                standard_error,
            };
            Ok((columns, Some(file)))
        }
    }
}

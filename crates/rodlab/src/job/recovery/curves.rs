//! Predictions of the model between and beyond the readings, and all tables.

use cmod::CmodError;
use cmod::recovery::fit::PredictedChange;
use cmod::recovery::{LoadHistory, LossFactorReadings, RecoveryTest, SingleTestFit};

use super::Found;
use crate::outcome::{Rows, Table};

/// Number of points of a curve.
const POINTS: u32 = 121;

/// Returns the times \[s\] of the curves, evenly spaced on a logarithmic scale from 2/3 of the time
/// of the first reading to 1.5 times that of the last reading.
pub(super) fn times(tests: &[RecoveryTest]) -> Vec<f64> {
    let readings = || tests.iter().flat_map(|test| test.time().iter().copied());
    let latest = 1.5 * readings().fold(0.0, f64::max);
    let earliest = readings()
        .filter(|time| *time > 0.0)
        .fold(f64::INFINITY, f64::min)
        / 1.5;
    if !(earliest.is_finite() && latest > earliest) {
        // the only readings are at the moment of unloading
        return vec![0.0, 1.0];
    }
    (0..POINTS)
        .map(|i| earliest * (latest / earliest).powf(f64::from(i) / f64::from(POINTS - 1)))
        .collect()
}

/// Returns a test for predictions at these `times`. It has no readings and is never fitted.
pub(super) fn at_times(
    name: &str,
    load: LoadHistory,
    frequency_hz: f64,
    times: &[f64],
) -> Result<RecoveryTest, CmodError> {
    let readings = LossFactorReadings {
        time: times,
        change: &vec![0.0; times.len()],
        standard_error: &vec![1.0; times.len()],
        virgin_standard_error: 0.0,
    };
    RecoveryTest::new(name, load, frequency_hz, readings)
}

impl Found<'_> {
    /// Returns the prediction at the times of `test`, with its standard error.
    pub(super) fn predicted(&self, test: &RecoveryTest) -> Result<Vec<PredictedChange>, CmodError> {
        let mut predicted = self.fit.prediction(test)?;
        for point in &mut predicted {
            point.standard_error *= self.error_factor;
        }
        Ok(predicted)
    }

    /// Returns the prediction at `times` after the load of `test`.
    pub(super) fn curve(
        &self,
        test: &RecoveryTest,
        times: &[f64],
    ) -> Result<Vec<PredictedChange>, CmodError> {
        let dense = at_times(test.name(), test.load().clone(), test.frequency_hz(), times)?;
        self.predicted(&dense)
    }
}

pub(super) fn tables(found: &Found<'_>) -> Result<Vec<Table>, CmodError> {
    Ok(vec![readings(found)?, curves(found)?, tests(found)])
}

/// Returns the table of all readings with the values of the model.
fn readings(found: &Found<'_>) -> Result<Table, CmodError> {
    let mut rows: Vec<(&str, [f64; 6])> = Vec::new();
    for (test, errors) in found.tests.iter().zip(&found.standard_errors) {
        let predicted = found.predicted(test)?;
        let read = test.time().iter().zip(test.change());
        for (((time, change), error), model) in read.zip(errors).zip(&predicted) {
            let residual = (change - model.change) / error;
            let (model, of_model) = (model.change, model.standard_error);
            rows.push((
                test.name(),
                [*time, *change, *error, model, of_model, residual],
            ));
        }
    }
    let rows = Rows::of(&rows, "readings", "Readings and model")
        .word("test", |(name, _)| *name)
        .number("time after unloading", "s", |(_, row)| row[0])
        .number("change of the loss factor", "", |(_, row)| row[1])
        .number("standard error", "", |(_, row)| row[2])
        .number("change of the model", "", |(_, row)| row[3])
        .number("standard error of the model", "", |(_, row)| row[4])
        .number("residual by standard error", "", |(_, row)| row[5]);
    Ok(rows.table)
}

/// Returns the table of the model over time, with one column per load.
fn curves(found: &Found<'_>) -> Result<Table, CmodError> {
    let times = times(&found.tests);
    let title = "Change of the loss factor by the model";
    let mut table = Table::new("curves", title).numbers("time after unloading", "s", &times);
    let predictions = found.predictions.iter().map(|(_, test)| test);
    for test in found.tests.iter().chain(predictions) {
        let curve = found.curve(test, &times)?;
        let (changes, errors) = (
            curve.iter().map(|point| point.change),
            curve.iter().map(|point| point.standard_error),
        );
        let name = test.name();
        table = table
            .numbers(format!("change, {name}"), "", changes)
            .numbers(format!("standard error, {name}"), "", errors);
    }
    Ok(table)
}

/// Returns the table of the results of each test alone (equation 4), and the recovery time of the
/// common model.
fn tests(found: &Found<'_>) -> Table {
    let single = |pick: fn(&SingleTestFit) -> f64| {
        let fits = found.singles.iter();
        fits.map(move |fit| fit.as_ref().map_or(f64::NAN, pick))
    };
    let error_of = |name: &str| format!("standard error of the logarithm of the {name}");
    let (change, time) = ("initial change", "recovery time");
    let by_model = &found.fit.recovery_times;
    let title = "Each test by itself, and by the common model";
    Rows::of(&found.tests, "tests", title)
        .word("test", |test| test.name())
        .number("largest stress", "MPa", |test| {
            1e-6 * test.load().largest_stress()
        })
        .number("duration of the load", "s", |test| test.load().duration())
        .table
        .numbers(change, "", single(|fit| fit.initial_change))
        .numbers(error_of(change), "", single(|fit| fit.initial_change_error))
        .numbers(time, "s", single(|fit| fit.recovery_time))
        .numbers(error_of(time), "", single(|fit| fit.recovery_time_error))
        .numbers("chi-square", "", single(|fit| fit.chi_squared))
        .numbers("recovery time by the common model", "s", by_model)
}

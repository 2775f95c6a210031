//! Predictions of the model between and beyond the readings, and all tables.

use cmod::CmodError;
use cmod::recovery::fit::PredictedChange;
use cmod::recovery::{LoadHistory, LossFactorReadings, RecoveryTest};

use super::Found;
use crate::outcome::{Column, Table};

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
    let mut names = Vec::new();
    let mut columns: [Vec<f64>; 6] = Default::default();
    for (test, errors) in found.tests.iter().zip(&found.standard_errors) {
        let predicted = found.predicted(test)?;
        for (((time, change), error), model) in test
            .time()
            .iter()
            .zip(test.change())
            .zip(errors)
            .zip(&predicted)
        {
            names.push(test.name().to_owned());
            let row = [
                *time,
                *change,
                *error,
                model.change,
                model.standard_error,
                (change - model.change) / error,
            ];
            for (column, value) in columns.iter_mut().zip(row) {
                column.push(value);
            }
        }
    }
    let [time, change, error, model, model_error, residual] = columns;
    Ok(Table {
        name: "readings".to_owned(),
        title: "Readings and model".to_owned(),
        columns: vec![
            Column::words("test", names),
            Column::numbers("time after unloading", "s", time),
            Column::numbers("change of the loss factor", "", change),
            Column::numbers("standard error", "", error),
            Column::numbers("change of the model", "", model),
            Column::numbers("standard error of the model", "", model_error),
            Column::numbers("residual by standard error", "", residual),
        ],
    })
}

/// Returns the table of the model over time, with one column per load.
fn curves(found: &Found<'_>) -> Result<Table, CmodError> {
    let times = times(&found.tests);
    let mut columns = vec![Column::numbers("time after unloading", "s", times.clone())];
    let predictions = found.predictions.iter().map(|(_, test)| test);
    for test in found.tests.iter().chain(predictions) {
        let curve = found.curve(test, &times)?;
        let (change, error) = curve
            .iter()
            .map(|point| (point.change, point.standard_error))
            .unzip();
        let name = test.name();
        columns.push(Column::numbers(format!("change, {name}"), "", change));
        columns.push(Column::numbers(
            format!("standard error, {name}"),
            "",
            error,
        ));
    }
    Ok(Table::of(
        "curves",
        "Change of the loss factor by the model",
        columns,
    ))
}

/// Returns the table of the results of each test alone (equation 4), and the recovery time of the
/// common model.
fn tests(found: &Found<'_>) -> Table {
    let single = |pick: &dyn Fn(&cmod::recovery::SingleTestFit) -> f64| -> Vec<f64> {
        let of = |fit: &Result<cmod::recovery::SingleTestFit, CmodError>| {
            fit.as_ref().map_or(f64::NAN, pick)
        };
        found.singles.iter().map(of).collect()
    };
    let of_tests = |pick: &dyn Fn(&RecoveryTest) -> f64| -> Vec<f64> {
        found.tests.iter().map(pick).collect()
    };
    Table {
        name: "tests".to_owned(),
        title: "Each test by itself, and by the common model".to_owned(),
        columns: vec![
            Column::words(
                "test",
                found.tests.iter().map(|t| t.name().to_owned()).collect(),
            ),
            Column::numbers(
                "largest stress",
                "MPa",
                of_tests(&|test| 1e-6 * test.load().largest_stress()),
            ),
            Column::numbers(
                "duration of the load",
                "s",
                of_tests(&|test| test.load().duration()),
            ),
            Column::numbers("initial change", "", single(&|fit| fit.initial_change)),
            Column::numbers(
                "standard error of the logarithm of the initial change",
                "",
                single(&|fit| fit.initial_change_error),
            ),
            Column::numbers("recovery time", "s", single(&|fit| fit.recovery_time)),
            Column::numbers(
                "standard error of the logarithm of the recovery time",
                "",
                single(&|fit| fit.recovery_time_error),
            ),
            Column::numbers("chi-square", "", single(&|fit| fit.chi_squared)),
            Column::numbers(
                "recovery time by the common model",
                "s",
                found.fit.recovery_times.clone(),
            ),
        ],
    }
}

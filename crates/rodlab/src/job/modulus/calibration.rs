//! What was found of the errors of the sensors, in words and numbers.

use cmod::estimate::ErrorSource;
use cmod::self_calibration::{CalibratedSource, SelfCalibration};

use super::measured::Measured;
use crate::Outcome;
use crate::digits::significant;
use crate::outcome::Quantity;

/// A size by its standard deviation beyond which the record contradicts what was stated: one in a thousand of right records.
const CONTRADICTS: f64 = 3.29;

/// States what was found of every source that the sheet gives a standard uncertainty.
pub(super) fn state(outcome: &mut Outcome, measured: &Measured, found: &SelfCalibration) {
    for source in found.sources() {
        let Some(of_sensors) = OfSensors::of(source.source, measured) else {
            continue;
        };
        let OfSensors { name, unit, stated } = &of_sensors;
        let (size, error) = (stated * source.size, stated * source.standard_error);
        outcome.quantities.push(Quantity {
            name: format!("{name}, found"),
            unit: (*unit).to_owned(),
            value: Some(size),
            standard_error: Some(error),
            valid: !contradicts(source),
            verdict: if contradicts(source) {
                "contradicts the sheet".to_owned()
            } else if source.standard_error < 0.5 {
                "found from the lines".to_owned()
            } else {
                "as stated: the lines tell little".to_owned()
            },
        });
        let numbers = format!(
            "{} {unit} ± {} {unit}, stated 0 {unit} ± {} {unit}",
            significant(size, 3),
            significant(error, 2),
            significant(*stated, 3)
        );
        if contradicts(source) {
            outcome.doubt(format!(
                "the lines ask for a {name} of {numbers}: more than its stated uncertainty explains"
            ));
        } else if source.standard_error < 0.5 {
            outcome.summary.push(format!(
                "The lines tell the {name}: {numbers}. It is taken out of the modulus."
            ));
        }
    }
}

fn contradicts(source: &CalibratedSource) -> bool {
    source.discrepancy().abs() > CONTRADICTS
}

/// A source of the sensors with its stated standard uncertainty.
struct OfSensors {
    name: String,
    unit: &'static str,
    stated: f64,
}

impl OfSensors {
    /// `None` for what is not of the sensors.
    fn of(source: ErrorSource, measured: &Measured) -> Option<Self> {
        let (name, unit, stated) = match source {
            ErrorSource::GainRatio => (
                "error of the ratio of the sensitivities",
                "%",
                100.0 * measured.calibration_error,
            ),
            ErrorSource::Delay => (
                "delay between the channels",
                "us",
                1e6 * measured.delay_error,
            ),
            _ => return None,
        };
        Some(Self {
            name: name.to_owned(),
            unit,
            stated,
        })
    }
}

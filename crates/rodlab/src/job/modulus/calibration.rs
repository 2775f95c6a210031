//! Results for the errors of the sensors, in words and numbers.

use cmod::estimate::{ErrorSource, ModulusEstimate};
use cmod::self_calibration::{CalibratedSource, SelfCalibration};

use super::measured::{Measured, Spectra};
use super::{ModulusSheet, SourceSheet};
use crate::Outcome;
use crate::digits::{short, significant, with_unit};
use crate::median::upper_median;
use crate::outcome::{Quantity, sentence};

/// Discrepancy, in standard deviations, beyond which the lines contradict a stated value. By chance
/// this happens in one of a thousand correct records.
const CONTRADICTS: f64 = 3.29;

/// Ratio of the unexplained mean square to the mean square of noise above which the unexplained
/// part is reported.
const UNEXPLAINED: f64 = 1.5;

/// Ratio of the unexplained part to the noise above which the result is in doubt. In correct
/// virtual records the ratio was at most 1.3; in records with hum, drift or bending, the loss
/// factor was wrong by six standard errors at a ratio of 3.5.
const DOUBTED: f64 = 2.5;

/// Unexplained part, relative to the modulus, up to which the result is never in doubt: records
/// without noise, such as simulated ones, differ from the model by numerical errors.
const NEVER_DOUBTED: f64 = 1e-4;

/// Reports that the errors of the sensors are included as stated because the lines do not determine
/// them, or that none are stated.
pub(super) fn state_none(outcome: &mut Outcome, sheet: &ModulusSheet, measured: &Measured) {
    let of_gauges = measured.of_gauges();
    if measured.of_ratio().is_uncertain() || of_gauges.iter().any(|of| of.is_uncertain()) {
        outcome.warn(
            "The lines do not determine the errors of the sensors: the stated uncertainties are included in the errors. Calibrate the sensors against each other.",
        );
    } else if matches!(
        measured.spectra,
        Some(Spectra::Ratio(_) | Spectra::Gauges(_))
    ) && sheet.method.channels().len() > 1
    {
        let advice = match &sheet.source {
            SourceSheet::Hits { .. } => {
                " State it as the ± of the channels, such as `gain` \"1 ± 1 %\" and `time_skew` \"0 us ± 5 us\"."
            }
            SourceSheet::Ratio(_) => "",
        };
        outcome.warn(format!(
            "No uncertainty of the sensors is stated: the errors include neither deviations of their sensitivities nor delays between the channels.{advice}"
        ));
    }
}

/// Reports the results for every source with a standard uncertainty in the sheet.
pub(super) fn state(
    outcome: &mut Outcome,
    sheet: &ModulusSheet,
    measured: &Measured,
    found: &SelfCalibration,
) {
    let ratio = found.mean_square().sqrt();
    let unexplained = format!(
        "the part of the lines that neither a smooth modulus nor the stated errors explain is {} times as large as the noise",
        significant(ratio, 2)
    );
    let is_doubted = ratio > DOUBTED && ratio * noise(found.estimate()) > NEVER_DOUBTED;
    if found.mean_square() > UNEXPLAINED && !is_doubted {
        outcome.warn(sentence(&format!(
            "{unexplained}: the lines determine the errors of the sensors less accurately by this factor"
        )));
    }
    for source in found.sources() {
        let Some(of_sensors) = OfSensors::of(source.source, sheet, measured) else {
            continue;
        };
        // the lines usually determine the mass, and the result for it is reported only if it
        // contradicts the sheet
        if source.source == ErrorSource::AccelerometerMass && !contradicts(source) {
            continue;
        }
        let OfSensors { name, unit, stated } = &of_sensors;
        let (size, error) = (stated * source.size, stated * source.standard_error);
        let verdict = if contradicts(source) {
            "contradicts the sheet"
        } else if source.standard_error < 0.5 {
            "found from the lines"
        } else {
            "as stated: the lines do not determine it well"
        };
        let quantity = Quantity::of(format!("{name}, found"), *unit, size, verdict);
        let quantity = quantity.with_error(error).valid_if(!contradicts(source));
        outcome.quantities.push(quantity);
        let against_stated = |size: f64, error: f64| {
            let found = with_unit(size, Some(error), unit);
            format!("{found}, stated (0 ± {}) {unit}", short(*stated))
        };
        let numbers = against_stated(size, error);
        if contradicts(source) {
            let (size, error) = source
                .by_lines_alone()
                .unwrap_or((source.size, source.standard_error));
            let numbers = against_stated(stated * size, stated * error);
            let advice = match source.source {
                ErrorSource::Delay | ErrorSource::GaugeDelay(_) => {
                    "; state it as `time_skew` of a channel, such as \"5 us ± 1 us\" if its signal is early, \"-5 us ± 1 us\" if it is late"
                }
                _ => "",
            };
            outcome.doubt(format!(
                "according to the lines, the {name} is {numbers}: more than its stated uncertainty explains{advice}"
            ));
        } else if source.standard_error < 0.5 {
            outcome.say(format!(
                "The lines determine the {name}: {numbers}; the modulus is corrected for it."
            ));
        }
    }
    // this doubt comes after the doubts about contradicted statements, because those name the cause
    if is_doubted {
        outcome.doubt(format!(
            "{unexplained}: hum, a drift or bending in the records, a wave that the model lacks, or an error of a sensor that is not stated changes the modulus, mostly in the lowest lines"
        ));
    }
}

/// Returns the median of the random errors of the valid lines, relative to the modulus; 0 without
/// valid lines.
fn noise(estimate: &ModulusEstimate) -> f64 {
    let valid = estimate
        .lines()
        .iter()
        .filter(|line| line.validity.is_valid());
    let errors = valid
        .map(|line| line.uncertainty.random.modulus.mean_square().sqrt() / line.modulus.norm());
    upper_median(errors).unwrap_or(0.0)
}

fn contradicts(source: &CalibratedSource) -> bool {
    source.discrepancy().abs() > CONTRADICTS
}

/// Error source of the sensors, or of the mass of one of them, with its stated standard
/// uncertainty.
struct OfSensors {
    name: String,
    unit: &'static str,
    stated: f64,
}

impl OfSensors {
    /// Returns the entry for `source` if it is an error of the sensors or of the mass on the free
    /// end; `None` for other sources.
    fn of(source: ErrorSource, sheet: &ModulusSheet, measured: &Measured) -> Option<Self> {
        let of_ratio = measured.of_ratio();
        let gauge = |index: usize| measured.of_gauges().get(index).copied();
        let (name, unit, stated) = match source {
            ErrorSource::GainRatio => (
                "error of the ratio of the sensitivities".to_owned(),
                "%",
                100.0 * of_ratio.gain,
            ),
            ErrorSource::AccelerometerMass => (
                "error of the mass on the free end".to_owned(),
                "gram",
                1e3 * sheet
                    .specimen
                    .accelerometer_mass
                    .as_ref()?
                    .with_uncertainty()
                    .uncertainty(),
            ),
            ErrorSource::Delay => (
                "delay between the channels".to_owned(),
                "us",
                1e6 * of_ratio.delay,
            ),
            ErrorSource::GaugeFactor(index) => (
                format!("error of the sensitivity of gauge {}", index + 1),
                "%",
                100.0 * gauge(index)?.gain,
            ),
            ErrorSource::GaugeDelay(index) => (
                format!("delay of gauge {}", index + 1),
                "us",
                1e6 * gauge(index)?.delay,
            ),
            ErrorSource::GaugePosition(index) => (
                format!("error of the position of gauge {}", index + 1),
                "mm",
                1e3 * position(sheet, index)?,
            ),
            ErrorSource::FreeEnd => (
                "error of the position of the free end".to_owned(),
                "mm",
                1e3 * sheet
                    .method
                    .used_free_end()?
                    .with_uncertainty()
                    .uncertainty(),
            ),
            _ => return None,
        };
        Some(Self { name, unit, stated })
    }
}

/// Returns the standard uncertainty of the position of a gauge \[m\].
fn position(sheet: &ModulusSheet, index: usize) -> Option<f64> {
    let gauge = sheet.method.gauges()?.get(index)?;
    Some(gauge.at.with_uncertainty().uncertainty())
}

//! Errors of the moduli: stated in the sheet, or estimated from the scatter if their size is
//! unknown.

use cmod::checks::relaxation;
use cmod::estimate::{ComplexCovariance, ErrorSource};
use cmod::rheology::{
    CommonError, ErrorScale, ModulusData, ModulusPoint, PolarScatter, TransientPoint,
};
use num_complex::Complex64;
use serde::Deserialize;

use super::FitSheet;
use super::columns::{ModulusColumns, Row, TableSheet};
use super::steps::Step;
use super::table_file::TableFile;
use crate::digits::hertz;
use crate::draw::Draw;
use crate::sheet::{Exact, Ratio};
use crate::{InStep, Outcome, RodlabError};

/// Relative standard error assumed for the weights of rows without stated errors: the same fraction
/// of |E| for E' and for E'', as for an instrument that measures absolute value and phase. The
/// errors of the results, and the ratio of the errors of |E| and of the phase, are computed from
/// the scatter; the assumed size only decides which temperatures agree where they overlap.
pub(super) const ASSUMED: f64 = 0.01;
/// Multiples of [`ASSUMED`] that are tried until all temperatures are joined.
const MULTIPLES: [f64; 4] = [1.0, 2.0, 4.0, 8.0];
/// Number of standard errors below 0 from which a loss modulus counts as negative, not as noise.
const NEGATIVE: f64 = 3.0;
/// Probability of a false alarm for a modulus that rises with time only by chance; 3e-5 is the
/// probability that a normal error exceeds four standard deviations on one side.
const RISING: f64 = 3e-5;

/// Standard errors of the moduli.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ErrorsSheet {
    /// Columns of standard errors, in the same form as the columns of the moduli.
    Columns(ModulusColumns),
    /// Relative standard errors of E' and of E''.
    Parts {
        /// Error of E', such as `"1 %"`.
        storage: Exact<Ratio>,
        /// Error of E'', such as `"3 %"`.
        loss: Exact<Ratio>,
    },
    /// Relative standard error of E', and standard error of tan δ.
    StorageAndLossFactor {
        /// Error of E', such as `"1 %"`.
        storage: Exact<Ratio>,
        /// Error of tan δ itself, such as `"0.002"`.
        loss_factor: Exact<Ratio>,
    },
    /// Relative standard error of |E|, and standard error of the phase.
    MagnitudeAndPhase {
        /// Error of |E|, such as `"1 %"`.
        magnitude: Exact<Ratio>,
        /// Error of δ itself, such as `"0.1 deg"`.
        phase: Exact<Ratio>,
    },
    /// Relative standard error of a modulus, or a compliance, over time, such as `"1 %"`.
    OverTime(Exact<Ratio>),
}

/// Returns the basis of the errors of a sheet, in which either all tables state errors or none
/// does.
pub(super) fn scale(sheet: &FitSheet) -> ErrorScale {
    if sheet.tables.iter().all(|table| table.errors.is_some()) {
        ErrorScale::Stated
    } else {
        ErrorScale::FromResidual
    }
}

/// Returns the covariances of the moduli of a table.
pub(super) fn covariances(
    table: &TableSheet,
    file: &TableFile,
    moduli: &[Complex64],
) -> Result<Vec<ComplexCovariance>, RodlabError> {
    let Some(asked) = &table.errors else {
        let of = |modulus: &Complex64| {
            ComplexCovariance::of_magnitude_and_phase(*modulus, ASSUMED, ASSUMED)
        };
        return Ok(moduli.iter().map(of).collect());
    };
    let of_test = match asked {
        ErrorsSheet::Columns(columns) => columns.test().is_some(),
        ErrorsSheet::OverTime(_) => true,
        _ => false,
    };
    if of_test != table.modulus.test().is_some() {
        let (found, expected) = if of_test {
            (
                "of a modulus over time",
                "errors of both parts of the modulus",
            )
        } else {
            (
                "of a complex modulus",
                "`over_time` (in RON `OverTime`), such as \"1 %\", or `columns` (in RON `Columns`) in the form of the modulus",
            )
        };
        return Err(RodlabError::request(file.place("errors"), found, expected));
    }
    let absolute = |ratio: &Exact<Ratio>, field: &str, example: &str| {
        if ratio.to_string().contains('%') {
            return Err(RodlabError::request(
                file.place(&format!("errors.{field}")),
                format!("`{ratio}`, which may be relative or absolute"),
                format!("an absolute value, such as {example}"),
            ));
        }
        Ok(ratio.si())
    };
    let all = |of: &dyn Fn(Complex64) -> ComplexCovariance| {
        Ok(moduli.iter().map(|modulus| of(*modulus)).collect())
    };
    match asked {
        ErrorsSheet::Columns(columns) => of_columns(table, columns, file, moduli),
        ErrorsSheet::Parts { storage, loss } => {
            let (storage, loss) = (storage.si(), loss.si());
            all(&|modulus| ComplexCovariance::of_parts(storage * modulus.re, loss * modulus.im))
        }
        ErrorsSheet::StorageAndLossFactor {
            storage,
            loss_factor,
        } => {
            let factor = absolute(loss_factor, "loss_factor", "\"0.002\"")?;
            let storage = storage.si();
            all(&|modulus| ComplexCovariance::of_loss_factor(modulus, storage * modulus.re, factor))
        }
        ErrorsSheet::MagnitudeAndPhase { magnitude, phase } => {
            let phase = absolute(phase, "phase", "\"0.1 deg\" or \"0.002\"")?;
            let magnitude = magnitude.si();
            all(&|modulus| ComplexCovariance::of_magnitude_and_phase(modulus, magnitude, phase))
        }
        ErrorsSheet::OverTime(relative) => {
            let relative = relative.si();
            all(&|modulus| ComplexCovariance::of_parts(relative * modulus.re, 0.0))
        }
    }
}

fn of_columns(
    table: &TableSheet,
    columns: &ModulusColumns,
    file: &TableFile,
    moduli: &[Complex64],
) -> Result<Vec<ComplexCovariance>, RodlabError> {
    let values = columns.values(|(column, wanted, field)| {
        let field = format!("errors.{field}");
        let values = file.values(column, wanted, &table.units, &field)?;
        let mut of_rows = values.iter();
        match of_rows.position(|value| value.is_nan() || *value <= 0.0) {
            None => Ok(values),
            Some(row) => Err(RodlabError::request(
                file.place_of(&field, row),
                "a standard error that is not above 0",
                "a standard error above 0, because the fit weights the rows by it",
            )),
        }
    })?;
    let of = |(modulus, (first, second)): (&Complex64, (f64, f64))| match columns {
        ModulusColumns::Parts { .. }
        | ModulusColumns::Relaxation { .. }
        | ModulusColumns::CreepModulus { .. } => ComplexCovariance::of_parts(first, second),
        ModulusColumns::StorageAndLossFactor { .. } => {
            ComplexCovariance::of_loss_factor(*modulus, first, second)
        }
        ModulusColumns::MagnitudeAndPhase { .. } => {
            let relative = first / modulus.norm();
            ComplexCovariance::of_magnitude_and_phase(*modulus, relative, second)
        }
        ModulusColumns::Creep { .. } => {
            ComplexCovariance::of_parts(first * modulus.re * modulus.re, 0.0)
        }
    };
    Ok(moduli.iter().zip(values).map(of).collect())
}

/// Temperature \[K\] and data of a step.
pub(super) type OfStep = (f64, ModulusData);

/// Returns the data of all steps with their temperatures and, if no errors are stated, the assumed
/// relative error. This is the smallest of the [`MULTIPLES`] with which the largest number of
/// temperatures is joined. `weights` are the errors of |E| and of the phase before this
/// multiplication.
pub(super) fn data_of_all(
    sheet: &FitSheet,
    steps: &[Step],
    weights: PolarScatter,
) -> Result<(Vec<OfStep>, Option<f64>), RodlabError> {
    let with = |assumed: Option<PolarScatter>| -> Result<Vec<OfStep>, RodlabError> {
        let of = |step: &Step| Ok((step.temperature, data(sheet, step, assumed)?));
        steps.iter().map(of).collect()
    };
    if scale(sheet) == ErrorScale::Stated {
        return Ok((with(None)?, None));
    }
    let mut best: Option<(usize, f64, Vec<OfStep>)> = None;
    for multiple in MULTIPLES {
        let data = with(Some(PolarScatter {
            magnitude: multiple * weights.magnitude,
            phase: multiple * weights.phase,
        }))?;
        let joined = match super::master::joined(sheet, &data)? {
            Some(joined) => joined,
            // there is only one temperature, and nothing to join
            None => return Ok((data, Some(multiple * ASSUMED))),
        };
        if best.as_ref().is_none_or(|(most, ..)| joined > *most) {
            best = Some((joined, multiple, data));
        }
        if joined == steps.len() {
            break;
        }
    }
    Ok(best.map_or((Vec::new(), None), |(_, multiple, data)| {
        (data, Some(multiple * ASSUMED))
    }))
}

/// Adds a drawn error to every row, and to the common scale. The covariances are doubled, because
/// each row then contains its own error and the drawn one. The relative weights, and every decision
/// based on the agreement of rows, are thus the same as without draws.
pub(super) fn draw(sheet: &FitSheet, steps: &mut [Step], draw: &Draw) {
    let error = sheet.scale_uncertainty.as_ref().map_or(0.0, Exact::si);
    let scale = 1.0 + error * draw.standard();
    for row in steps.iter_mut().flat_map(|step| &mut step.rows) {
        row.modulus =
            scale * (row.modulus + draw.with_random(|random| row.covariance.draw(random)));
        row.covariance = row.covariance + row.covariance;
    }
}

/// Returns the data of a step for a fit, with the errors of its rows or the `assumed` errors.
fn data(
    sheet: &FitSheet,
    step: &Step,
    assumed: Option<PolarScatter>,
) -> Result<ModulusData, RodlabError> {
    let point = |row: &Row| ModulusPoint {
        frequency_hz: row.frequency_hz,
        modulus: row.modulus,
        covariance: assumed.map_or(row.covariance, |of| {
            ComplexCovariance::of_magnitude_and_phase(row.modulus, of.magnitude, of.phase)
        }),
    };
    let at_time = |row: &Row| {
        let time = row.time()?;
        Some(TransientPoint {
            time,
            modulus: row.modulus.re,
            standard_error: assumed.map_or(row.covariance.real.sqrt(), |of| {
                of.magnitude * row.modulus.re
            }),
        })
    };
    let refused = |error| RodlabError::step(format!("tables, at {}", step.in_words()), error);
    let mut parts = Vec::new();
    for rows in step.by_test() {
        let part = match rows.first().and_then(|row| row.over_time) {
            None => ModulusData::new(&rows.iter().map(point).collect::<Vec<_>>()),
            Some((test, ramp)) => {
                // the rows are in the order of increasing frequency, so their times decrease
                let points: Vec<TransientPoint> = rows.iter().rev().filter_map(at_time).collect();
                ModulusData::over_time(test, ramp, &points)
            }
        };
        parts.push(part.map_err(refused)?);
    }
    let data = match <[ModulusData; 1]>::try_from(parts) {
        Ok([data]) => data,
        Err(parts) => ModulusData::together(&parts).map_err(refused)?,
    };
    let Some(scale) = &sheet.scale_uncertainty else {
        return Ok(data);
    };
    let moduli = data.modulus().iter();
    let shift = moduli.map(|modulus| scale.si() * modulus).collect();
    data.with_common_errors(vec![CommonError {
        source: ErrorSource::ModulusScale,
        shift,
    }])
    .map_err(refused)
}

/// Puts the result in doubt for loss moduli that are more than three standard errors below 0 or, if
/// no errors are stated, for any loss modulus below 0.
pub(super) fn judge_losses(outcome: &mut Outcome, steps: &[Step]) {
    let mut negative = Vec::new();
    for step in steps {
        for row in &step.rows {
            let error = row.covariance.imaginary.sqrt();
            if row.modulus.im < -NEGATIVE * error {
                negative.push(format!(
                    "{} ({} at {})",
                    row.place,
                    hertz(row.frequency_hz),
                    step.in_words()
                ));
            } else if row.modulus.im < 0.0 {
                let remark = "loss modulus below 0 within its errors";
                outcome.accept(row.place.as_str(), [remark]);
            }
        }
    }
    if let Some(first) = negative.first() {
        outcome.doubt(format!(
            "the loss modulus is negative in {} row(s), first in {first}, which is impossible for a passive material",
            negative.len()
        ));
    }
}

/// Puts the result in doubt if a modulus rises with time.
///
/// # Errors
///
/// [`RodlabError::Step`] for impossible times or moduli.
pub(super) fn judge_rises(outcome: &mut Outcome, steps: &[Step]) -> Result<(), RodlabError> {
    let mut rising = Vec::new();
    for step in steps {
        for rows in step.by_test() {
            let points = rows
                .iter()
                .filter_map(|row| Some((row.time()?, row.modulus.re)));
            let (times, moduli): (Vec<f64>, Vec<f64>) = points.unzip();
            let check = relaxation(&times, &moduli, RISING);
            let check = check.in_step(format!("tables, at {}", step.in_words()))?;
            if check.has_failed() {
                rising.push(step.in_words());
            }
        }
    }
    if let Some(first) = rising.first() {
        outcome.doubt(format!(
            "the modulus rises with time in {} test(s), first at {first}, which is impossible for a relaxing material",
            rising.len()
        ));
    }
    Ok(())
}

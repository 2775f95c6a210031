//! Lines of a master curve as data for a law.

use num_complex::Complex64;

use super::super::data::{CommonError, ModulusData};
use super::super::sweep::TemperatureSweep;
use super::{MasterCurve, shifts_of};
use crate::error::CmodError;
use crate::estimate::ErrorSource;
use crate::vectors::dot;

/// Half the step of ln ω for the slope of the series.
const STEP: f64 = 1e-3;

impl MasterCurve {
    /// Returns the lines of `sweep` at their reduced frequencies, in increasing order, with moduli
    /// divided by b_T.
    ///
    /// The shifts and factors are results with errors, and a law fitted to the reduced lines
    /// depends on them. Let L Lᵀ be the covariance of all ln b_T and ln a_T. Each column of L is
    /// one [common error](ModulusData::with_common_errors), which shifts a line by -E δ ln b -
    /// (dE/d ln ω) δ ln a. The temperature of the reference is a further common error, if its
    /// uncertainty is [stated](Self::with_temperature_uncertainty). The covariance of the
    /// parameters of the law is then, to first order, the covariance from a joint fit of law and
    /// shifts, provided that the law explains the data as well as the series does.
    ///
    /// # Errors
    /// [`CmodError::ChangedResult`] if lists of this result were changed, or if `sweep` is not the
    /// sweep of this master curve.
    pub fn reduced(&self, sweep: &TemperatureSweep) -> Result<ModulusData, CmodError> {
        let mut columns: Vec<Columns> = Vec::with_capacity(self.shifts.len());
        let (mut factors, mut shifts) = (0, 0);
        let has_factors = self
            .shifts
            .iter()
            .any(|shift| shift.vertical_standard_error > 0.0);
        let reference = self.reference_temperature;
        for shift in &self.shifts {
            let is_reference = shift.temperature.total_cmp(&reference).is_eq();
            let factor = (has_factors && !is_reference).then_some(factors);
            factors += usize::from(factor.is_some());
            let own = (!is_reference && !shift.is_stated).then_some(shifts);
            shifts += usize::from(own.is_some());
            columns.push(Columns { factor, shift: own });
        }
        let count = factors + shifts;
        if count > self.fit.parameters.len() {
            return Err(CmodError::ChangedResult {
                what: "parameters, including the shifts",
                found: self.fit.parameters.len(),
                expected: count,
            });
        }
        // A wrong temperature changes the temperature assigned to a shift, but not the lines. The
        // choice of the factors changes lines and shifts together.
        let counted =
            |source| source != ErrorSource::Temperature && source != ErrorSource::VerticalFactors;
        let covariance = shifts_of(&self.fit, count, &counted).covariance;
        let root = root_of(&covariance);

        let mut parts = Vec::with_capacity(self.shifts.len());
        let mut step_of_line = Vec::new();
        for (place, shift) in self.shifts.iter().enumerate() {
            let step = sweep
                .temperatures
                .iter()
                .position(|temperature| temperature.total_cmp(&shift.temperature).is_eq());
            let Some(data) = step.and_then(|step| sweep.data.get(step)) else {
                return Err(CmodError::ChangedResult {
                    what: "temperatures of the sweep that belong to the master curve",
                    found: parts.len(),
                    expected: self.shifts.len(),
                });
            };
            let mut own = data.clone();
            for omega in &mut own.omega {
                *omega *= shift.log_shift.exp();
            }
            step_of_line.extend(std::iter::repeat_n(place, own.len()));
            parts.push((own, shift.vertical));
        }
        let joined = ModulusData::joined(parts.iter().map(|(data, factor)| (data, *factor)));
        let moved = |step: f64| {
            let mut moved = joined.clone();
            for omega in &mut moved.omega {
                *omega *= step.exp();
            }
            self.fit.law.response(&moved)
        };
        let slopes: Vec<Complex64> = moved(STEP)
            .into_iter()
            .zip(moved(-STEP))
            .map(|(above, below)| (above - below) / (2.0 * STEP))
            .collect();
        let mut data = joined.clone();
        // adds an error of ln b and ln a of all temperatures
        let mut add = |source, errors: Vec<(f64, f64)>| {
            let lines = step_of_line.iter().zip(slopes.iter().zip(&joined.modulus));
            let shift = lines
                .map(|(place, (slope, modulus))| {
                    let (of_factor, of_shift) = errors.get(*place).copied().unwrap_or_default();
                    -(modulus * of_factor + slope * of_shift)
                })
                .collect();
            data.common.push(CommonError { source, shift });
        };
        for index in 0..count {
            let error_of = |column: Option<usize>, of_shift: usize| -> f64 {
                let row = column.and_then(|column| root.get(of_shift + column));
                row.and_then(|row| row.get(index)).copied().unwrap_or(0.0)
            };
            let steps = columns.iter();
            let errors = steps.map(|own| (error_of(own.factor, 0), error_of(own.shift, factors)));
            add(ErrorSource::MasterCurve(index), errors.collect());
        }
        let mut common = self.fit.common_errors.iter();
        let of_choice = common.find(|error| error.source == ErrorSource::VerticalFactors);
        if let (Some(choice), Some(error)) = (&self.factor_choice, of_choice) {
            let first = error.shift.len().saturating_sub(shifts);
            let of_shift = |own: &Columns| {
                let change = own.shift.and_then(|column| error.shift.get(first + column));
                change.copied().unwrap_or(0.0)
            };
            let steps = self.shifts.iter().zip(&columns);
            let errors = steps.map(|(shift, own)| {
                let of_factor = choice.log_error(shift.temperature, reference);
                (of_factor, of_shift(own))
            });
            add(ErrorSource::VerticalFactors, errors.collect());
        }
        let by_reference = self.change_by_reference();
        if by_reference > 0.0 {
            data.common.push(CommonError {
                source: ErrorSource::Temperature,
                shift: slopes.iter().map(|slope| slope * by_reference).collect(),
            });
        }
        Ok(data.in_order())
    }
}

/// Indices of the factor and of the shift of a temperature among the fitted parameters.
#[derive(Debug, Clone, Copy)]
struct Columns {
    factor: Option<usize>,
    shift: Option<usize>,
}

/// Returns the rows of the lower triangular matrix L with LLᵀ = C. A column whose pivot is at the
/// level of rounding is set to 0.
fn root_of(covariance: &[Vec<f64>]) -> Vec<Vec<f64>> {
    const ROUNDING: f64 = 1e-12;
    let mut rows: Vec<Vec<f64>> = Vec::with_capacity(covariance.len());
    for (i, entries) in covariance.iter().enumerate() {
        let mut row: Vec<f64> = Vec::with_capacity(i + 1);
        for (entry, other) in entries.iter().zip(&rows) {
            let known: f64 = dot(&row, other);
            let pivot = other.last().copied().unwrap_or(0.0);
            row.push(if pivot > 0.0 {
                (entry - known) / pivot
            } else {
                0.0
            });
        }
        let own = entries.get(i).copied().unwrap_or(0.0);
        let left = own - row.iter().map(|l| l * l).sum::<f64>();
        row.push(if left > ROUNDING * own {
            left.sqrt()
        } else {
            0.0
        });
        rows.push(row);
    }
    rows
}

//! Master curve of the steps.

use std::f64::consts::LN_10;

use cmod::CmodError;
use cmod::rheology::{
    ErrorScale, FitOptions, GAS_CONSTANT, MasterCurve, ModulusData, TemperatureSweep,
};
use serde::Deserialize;

use super::{FitSheet, Sweep};
use crate::sheet::{Exact, Temperature};
use crate::{InStep, RodlabError};

use super::steps::celsius;

/// Probability of χ² below which the temperatures do not form a single curve, or a law does not fit
/// the shifts.
pub(super) const CHANCE: f64 = 0.01;
/// Largest distance of a stated shift from the temperature of its step \[K\].
const NEAR: f64 = 1.0;

/// Stated shifts, which connect temperatures whose curves do not overlap; where curves overlap, the
/// shifts are fitted.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum StatedShiftsSheet {
    /// log a_T = -C₁ (T - Tᵣ)/(C₂ + T - Tᵣ).
    Wlf {
        /// C₁.
        c1: f64,
        /// C₂ \[K\].
        c2: f64,
        /// Reference temperature Tᵣ of the constants, such as `"100 degC"`.
        at: Exact<Temperature>,
    },
    /// ln a_T = (E_a/R)(1/T - 1/Tᵣ).
    Arrhenius {
        /// E_a [kJ/mol].
        activation_energy_kj_mol: f64,
    },
    /// Values of log a_T at temperatures, up to a constant.
    Table(
        /// One shift for each step.
        Vec<StatedShift>,
    ),
}

/// A stated shift.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StatedShift {
    /// Temperature, within 1 K of the temperature of a step.
    pub at: Exact<Temperature>,
    /// log₁₀ a_T.
    pub log10_shift: f64,
}

/// Factors b_T of the modulus.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum VerticalSheet {
    /// 1, or estimated if the curves contradict this.
    AsNeeded,
    /// 1 at all temperatures.
    Unity,
    /// ρT/(ρᵣTᵣ).
    RubberElasticity {
        /// Thermal expansion of the volume [1/K], 0 by default.
        #[serde(default)]
        volume_expansion_per_kelvin: f64,
    },
}

/// Returns the settings of the fit of a master curve.
pub(super) fn options(sheet: &FitSheet, error_scale: ErrorScale) -> FitOptions {
    let options = match &sheet.laws {
        Some(laws) => laws.options(error_scale),
        None => FitOptions::default().with_error_scale(error_scale),
    };
    options.with_series_profiles(false)
}

/// Largest distance \[K\] of a reference temperature from the temperatures of the table; beyond it
/// the reference is refused.
const FAR_REFERENCE: f64 = 10.0;

/// Returns the number of temperatures that are joined with the reference by overlapping curves or
/// stated shifts; `None` for fewer than two temperatures.
pub(super) fn joined(
    sheet: &FitSheet,
    data: &[(f64, ModulusData)],
) -> Result<Option<usize>, RodlabError> {
    if data.len() < 2 {
        return Ok(None);
    }
    let sweep = TemperatureSweep::new(data.to_vec()).in_step("tables")?;
    let (sweep, reference) = stated(sheet, sweep)?;
    let joined = sweep.connected(reference).in_step("tables")?;
    Ok(Some(joined.len()))
}

/// Fits the master curve. The inner error is due to the data, the outer error to the sheet.
pub(super) fn of(
    sheet: &FitSheet,
    sweep: TemperatureSweep,
    error_scale: ErrorScale,
) -> Result<Result<Sweep, CmodError>, RodlabError> {
    let (sweep, reference) = stated(sheet, sweep)?;
    let options = options(sheet, error_scale);
    Ok(
        MasterCurve::new(&sweep, reference, &options).and_then(|curve| {
            let curve = match &sheet.temperature_uncertainty {
                Some(stated) => curve.with_temperature_uncertainty(stated.si())?,
                None => curve,
            };
            let shift_laws = curve.shift_laws();
            Ok(Sweep {
                by_scatter: match &shift_laws {
                    Ok(laws) if laws.wlf_p_value() < CHANCE => curve.shift_laws_by_scatter().ok(),
                    _ => None,
                },
                shift_laws,
                reduced: curve.reduced(&sweep)?,
                curve,
            })
        }),
    )
}

/// Adds the statements of the sheet to a sweep, and returns it with the index of its reference
/// temperature.
fn stated(
    sheet: &FitSheet,
    mut sweep: TemperatureSweep,
) -> Result<(TemperatureSweep, usize), RodlabError> {
    let temperatures = sweep.temperatures().to_vec();
    if let Some(stated) = &sheet.stated_shifts {
        let shifts = temperatures.iter().map(|t| stated.log_shift(*t));
        let shifts: Vec<f64> = shifts.collect::<Result<_, _>>()?;
        sweep = sweep.with_stated_shifts(&shifts).in_step("stated_shifts")?;
    }
    sweep = match sheet.vertical_shifts {
        None | Some(VerticalSheet::AsNeeded) => sweep,
        Some(VerticalSheet::Unity) => sweep.without_factors(),
        Some(VerticalSheet::RubberElasticity {
            volume_expansion_per_kelvin: expansion,
        }) => {
            let first = temperatures.first().copied().unwrap_or(0.0);
            let density = |t: &f64| (-expansion * (t - first)).exp();
            let densities: Vec<f64> = temperatures.iter().map(density).collect();
            sweep
                .with_rubber_elasticity(&densities)
                .in_step("vertical_shifts")?
        }
    };
    if let Some(stated) = &sheet.reference_temperature {
        let coldest = temperatures.iter().copied().fold(f64::INFINITY, f64::min);
        let warmest = temperatures
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max);
        if !(coldest - FAR_REFERENCE..=warmest + FAR_REFERENCE).contains(&stated.si()) {
            return Err(RodlabError::request(
                "reference_temperature",
                stated.to_string(),
                format!(
                    "a temperature of the table, {} to {}",
                    celsius(coldest),
                    celsius(warmest)
                ),
            ));
        }
    }
    let wanted = sheet.reference_temperature.as_ref().map_or(0.0, Exact::si);
    let distance = |index: &usize| {
        temperatures
            .get(*index)
            .map_or(f64::INFINITY, |t| (t - wanted).abs())
    };
    let reference = (0..temperatures.len())
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .unwrap_or(0);
    Ok((sweep, reference))
}

impl StatedShiftsSheet {
    /// Returns ln a_T at `kelvin`, up to a constant.
    fn log_shift(&self, kelvin: f64) -> Result<f64, RodlabError> {
        match self {
            Self::Wlf { c1, c2, at } => {
                let d = kelvin - at.si();
                let pole = c2 + d;
                if pole.is_nan() || pole <= 0.0 {
                    return Err(RodlabError::request(
                        "stated_shifts.Wlf",
                        format!("without a value at {}", celsius(kelvin)),
                        "constants whose pole, at the temperature `at` minus C2, is below all steps",
                    ));
                }
                Ok(-LN_10 * c1 * d / pole)
            }
            Self::Arrhenius {
                activation_energy_kj_mol,
            } => Ok(1e3 * activation_energy_kj_mol / GAS_CONSTANT / kelvin),
            Self::Table(shifts) => {
                let near = shifts
                    .iter()
                    .find(|shift| (shift.at.si() - kelvin).abs() <= NEAR);
                near.map(|shift| LN_10 * shift.log10_shift).ok_or_else(|| {
                    RodlabError::request(
                        "stated_shifts.Table",
                        format!("without a shift for the step at {}", celsius(kelvin)),
                        "a shift within 1 K of every step",
                    )
                })
            }
        }
    }
}

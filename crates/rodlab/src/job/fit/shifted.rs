//! Curve of all steps of temperature, with the weights of their rows.

use cmod::CmodError;
use cmod::rheology::{
    ErrorScale, FitOptions, MasterPoint, ModulusData, PolarScatter, PronyFit, TemperatureSweep,
};

use super::errors;
use super::master;
use super::steps::Step;
use super::{FitSheet, Sweep};
use crate::{InStep, RodlabError};

/// Curve of all steps and the weights of its rows; several temperatures form a master curve.
pub(super) struct Shifted {
    pub(super) curve: Curve,
    error_scale: ErrorScale,
    /// Relative error that was assumed to join temperatures, if the sheet states no errors.
    pub(super) assumed: Option<f64>,
    pub(super) weights: PolarScatter,
}

/// Curve of one step, or master curve of several.
pub(super) enum Curve {
    Single(ModulusData),
    Several(Result<Box<Sweep>, CmodError>),
}

impl Shifted {
    pub(super) fn of(
        sheet: &FitSheet,
        steps: &[Step],
        error_scale: ErrorScale,
        weights: PolarScatter,
    ) -> Result<Self, RodlabError> {
        let (data, assumed) = errors::data_of_all(sheet, steps, weights)?;
        let curve = match <[(f64, ModulusData); 1]>::try_from(data) {
            Ok([(_, single)]) => Curve::Single(single),
            Err(data) => {
                let sweep = TemperatureSweep::new(data).in_step("tables")?;
                Curve::Several(master::of(sheet, sweep, error_scale)?.map(Box::new))
            }
        };
        Ok(Self {
            curve,
            error_scale,
            assumed,
            weights,
        })
    }

    /// Returns the scatter of the rows over frequency about a Prony series; `None` without a series.
    pub(super) fn scatter(&self) -> Option<PolarScatter> {
        match &self.curve {
            Curve::Single(data) => {
                let options = FitOptions::default().with_error_scale(self.error_scale);
                let options = options.with_series_profiles(false).with_profiles(false);
                let series = PronyFit::new(data, &options).ok()?.fit.law;
                let rows = data.modulus().iter().copied().zip(series.response(data));
                let rows = rows.enumerate();
                let over_frequency = rows.filter(|(line, _)| data.time(*line).is_none());
                PolarScatter::about(over_frequency.map(|(_, moduli)| moduli))
            }
            Curve::Several(Ok(sweep)) => {
                let points = sweep.curve.points.iter();
                let over_frequency =
                    points.filter(|point: &&MasterPoint| point.reduced_time.is_none());
                PolarScatter::about(over_frequency.map(|point| (point.modulus, point.fitted)))
            }
            Curve::Several(Err(_)) => None,
        }
    }
}

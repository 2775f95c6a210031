//! Data and initial values of the joint fit of a sweep.

use super::super::data::ModulusData;
use super::super::fit::{FitOptions, enough};
use super::super::sweep::TemperatureSweep;
use super::joint::Joint;
use super::links::{Link, Starts, connected, links};
use crate::error::CmodError;

/// Temperatures of a sweep that are connected with the reference, joined with their factors b_T.
pub(super) struct Prepared {
    pub(super) sweep: TemperatureSweep,
    /// Index of the reference among the connected temperatures.
    pub(super) reference: usize,
    /// Temperatures that are not connected \[K\].
    pub(super) unconnected: Vec<f64>,
    pub(super) links: Vec<Option<Link>>,
    pub(super) factors: Vec<f64>,
    pub(super) starts: Starts,
    /// All lines, with stated shifts included in the frequencies.
    pub(super) joined: ModulusData,
}

#[allow(
    clippy::indexing_slicing,
    reason = "indices of temperatures are below their number, of which all lists have one element each"
)]
impl Prepared {
    pub(super) fn of(
        sweep: &TemperatureSweep,
        reference: usize,
        options: &FitOptions,
    ) -> Result<Self, CmodError> {
        let count = sweep.temperatures.len();
        if reference >= count {
            return Err(CmodError::ReferenceTest {
                index: reference,
                count,
            });
        }
        let links = links(sweep, &sweep.factors(reference));
        let connected = connected(&links, reference);
        let unconnected: Vec<f64> = (0..count)
            .filter(|step| !connected.contains(step))
            .map(|step| sweep.temperatures[step])
            .collect();
        let sweep = sweep.part(connected.clone());
        let links = links[connected.clone()].to_vec();
        let reference = reference - connected.start();
        let factors = sweep.factors(reference);
        let starts = Starts::of(&sweep, &links, reference);
        let mut joined = ModulusData::joined(sweep.data.iter().zip(factors.iter().copied()));
        enough(&joined, sweep.temperatures.len(), options.error_scale)?;
        // a stated shift is included in the frequencies
        let stated = of_lines(&sweep, &|step| starts.is_stated[step].then_some(step));
        for (omega, step) in joined.omega.iter_mut().zip(stated) {
            *omega *= step.map_or(1.0, |step| starts.log_shifts[step].exp());
        }
        Ok(Self {
            sweep,
            reference,
            unconnected,
            links,
            factors,
            starts,
            joined,
        })
    }

    /// Returns the problem of the joint fit of a series, the shifts and, if needed, the factors.
    pub(super) fn joint(&self, options: FitOptions) -> Joint<'_> {
        let count = self.sweep.temperatures.len();
        let steps = (0..count).filter(|step| *step != self.reference);
        let others: Vec<usize> = steps
            .clone()
            .filter(|step| !self.starts.is_stated[*step])
            .collect();
        let scaled: Vec<usize> = steps.collect();
        let kelvin = |steps: &[usize]| -> Vec<f64> {
            let each = steps.iter();
            each.map(|step| self.sweep.temperatures[*step]).collect()
        };
        let places = |steps: &[usize]| {
            of_lines(&self.sweep, &|step| {
                steps.iter().position(|own| *own == step)
            })
        };
        Joint {
            sweep: &self.sweep,
            joined: &self.joined,
            options,
            shift_of_line: places(&others),
            factor_of_line: places(&scaled),
            temperatures: kelvin(&others),
            scaled_temperatures: kelvin(&scaled),
            others,
            scaled,
        }
    }
}

/// Returns, for each line, the value of its temperature step.
fn of_lines(
    sweep: &TemperatureSweep,
    of_step: &dyn Fn(usize) -> Option<usize>,
) -> Vec<Option<usize>> {
    let steps = sweep.data.iter().enumerate();
    steps
        .flat_map(|(step, data)| std::iter::repeat_n(of_step(step), data.len()))
        .collect()
}

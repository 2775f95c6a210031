//! Joint fit of a series, the shifts of all temperatures and, if needed, their vertical factors.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::super::count;
use super::super::data::ModulusData;
use super::super::fit::{Alternative, ErrorScale, FitOptions, Scores};
use super::super::least_squares::{Effort, Minimum, minimise};
use super::super::order::{Order, Refined, Series, choose, no_law, weighted};
use super::super::prony::Prony;
use super::super::sweep::TemperatureSweep;
use super::links::Starts;
use crate::error::CmodError;

/// Maximum number of rounds, in each of which an order is chosen and fitted together with the
/// shifts; usually two rounds suffice.
const MOST_ROUNDS: usize = 5;

/// Problem of the joint fit: series, shifts and factors are fitted together to all lines.
pub(super) struct Joint<'a> {
    pub(super) sweep: &'a TemperatureSweep,
    pub(super) joined: &'a ModulusData,
    pub(super) options: FitOptions,
    pub(super) shift_of_line: Vec<Option<usize>>,
    pub(super) factor_of_line: Vec<Option<usize>>,
    /// Temperature steps whose shifts (`others`) and whose factors (`scaled`) are fitted, with the
    /// temperatures.
    pub(super) others: Vec<usize>,
    pub(super) scaled: Vec<usize>,
    pub(super) temperatures: Vec<f64>,
    pub(super) scaled_temperatures: Vec<f64>,
}

/// Minimum of the joint fit after the last round.
pub(super) struct Settled {
    pub(super) model: Prony,
    pub(super) minimum: Minimum,
    pub(super) orders: Vec<Order>,
    pub(super) alternatives: Vec<Alternative>,
    /// Logarithms of the factors by which the frequencies of each step must still be multiplied.
    pub(super) log_shifts: Vec<f64>,
    pub(super) log_factors: Option<Vec<f64>>,
}

impl Settled {
    pub(super) fn bic(&self, joint: &Joint<'_>) -> f64 {
        joint.scores(&self.minimum).bic
    }

    /// Returns true if χ² is too large to be due to chance, and also if the errors follow from the
    /// residual, because χ² is then no test.
    pub(super) fn is_refused(&self, joint: &Joint<'_>) -> bool {
        const LEVEL: f64 = 0.01;
        let freedom = joint.joined.values().saturating_sub(self.minimum.at.len());
        let dispersion = joint.joined.scatter.of_chi_squared;
        joint.options.error_scale == ErrorScale::FromResidual
            || ChiSquared::new(count(freedom) / dispersion)
                .is_ok_and(|chi| chi.sf(self.minimum.chi_squared / dispersion) < LEVEL)
    }
}

#[allow(
    clippy::indexing_slicing,
    reason = "lists of steps contain indices of temperatures, `log_shifts` and `log_factors` have one element per temperature, and the last coordinates are factors and shifts"
)]
impl Joint<'_> {
    fn scores(&self, minimum: &Minimum) -> Scores {
        let values = self.joined.values();
        let scale = self.options.error_scale;
        Scores::of(scale, minimum.chi_squared, values, minimum.at.len())
    }

    fn model(&self, series: &Series, with_factors: bool) -> Prony {
        let model = Prony::shifted(
            series.equilibrium > 0.0,
            series.branches.len(),
            self.shift_of_line.clone(),
            &self.temperatures,
        );
        if with_factors {
            model.with_factors(self.factor_of_line.clone(), &self.scaled_temperatures)
        } else {
            model
        }
    }

    pub(super) fn settle(&self, starts: &Starts, with_factors: bool) -> Result<Settled, CmodError> {
        let mut log_shifts = starts.log_shifts.clone();
        for (shift, is_stated) in log_shifts.iter_mut().zip(&starts.is_stated) {
            if *is_stated {
                *shift = 0.0; // included in the frequencies
            }
        }
        let mut log_factors = vec![0.0; log_shifts.len()];
        if with_factors {
            log_factors.clone_from(&starts.log_factors);
        }
        let mut best: Option<((usize, bool), Settled)> = None;
        for _ in 0..MOST_ROUNDS {
            let shifted = shifted(self.sweep, self.joined, &log_shifts, &log_factors);
            let chosen = choose(&shifted, &self.options)?;
            let series = &chosen.best.series;
            let model = self.model(series, with_factors);
            let mut behind: Vec<f64> = Vec::new();
            if with_factors {
                behind.extend(self.scaled.iter().map(|step| log_factors[*step]));
            }
            behind.extend(self.others.iter().map(|step| log_shifts[*step]));
            let start = [chosen.best.minimum.at.as_slice(), behind.as_slice()].concat();
            let minimum =
                minimise(&model, self.joined, &start, None, Effort::Full).ok_or_else(no_law)?;
            let found = &minimum.at[minimum.at.len() - behind.len()..];
            let (factors, shifts) = found.split_at(behind.len() - self.others.len());
            for (step, factor) in self.scaled.iter().zip(factors) {
                log_factors[*step] = *factor;
            }
            for (step, shift) in self.others.iter().zip(shifts) {
                log_shifts[*step] = *shift;
            }
            let of_order = |(_, tried): (f64, &Refined)| {
                let model = self.model(&tried.series, with_factors);
                let start = [tried.minimum.at.as_slice(), found].concat();
                let minimum = minimise(&model, self.joined, &start, None, Effort::Comparison)?;
                let score = self.scores(&minimum).prediction;
                Some((score, Alternative::of(&tried.series, &minimum)?))
            };
            let of_orders = chosen.candidates().into_iter().filter_map(of_order);
            let alternatives = weighted(of_orders.collect());
            let key = (series.branches.len(), series.equilibrium > 0.0);
            let is_last = best.as_ref().is_some_and(|(before, _)| *before == key);
            let settled = Settled {
                model,
                minimum,
                orders: chosen.orders,
                alternatives,
                log_shifts: log_shifts.clone(),
                log_factors: with_factors.then(|| log_factors.clone()),
            };
            best = Some((key, settled));
            if is_last {
                break;
            }
        }
        best.map(|(_, settled)| settled).ok_or_else(no_law)
    }
}

/// Returns all lines at their reduced frequencies, with moduli divided by the factors.
pub(super) fn shifted(
    sweep: &TemperatureSweep,
    joined: &ModulusData,
    log_shifts: &[f64],
    log_factors: &[f64],
) -> ModulusData {
    let of_lines = |of_steps: &[f64]| -> Vec<f64> {
        let steps = sweep.data.iter().zip(of_steps);
        steps
            .flat_map(|(data, log)| std::iter::repeat_n(log.exp(), data.len()))
            .collect()
    };
    let (shifts, factors) = (of_lines(log_shifts), of_lines(log_factors));
    let of = |line: usize| factors.get(line).copied().unwrap_or(1.0);
    let moduli = joined.modulus.iter().enumerate();
    let whitening = joined.whitening.iter().enumerate();
    ModulusData {
        omega: joined
            .omega
            .iter()
            .zip(shifts)
            .map(|(omega, a)| omega * a)
            .collect(),
        modulus: moduli.map(|(line, modulus)| modulus / of(line)).collect(),
        whitening: whitening
            .map(|(line, w)| w.scaled(of(line).recip()))
            .collect(),
        ..joined.clone()
    }
}

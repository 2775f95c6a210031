//! One curve from moduli at several temperatures.

use std::fmt;

use num_complex::Complex64;
use rodwave::modulus::GeneralisedMaxwell;

use super::data::ModulusData;
use super::fit::{Alternative, FitOptions, RheologicalFit, Scores, enough};
use super::information::Information;
use super::judgement::Scene;
use super::law::{FittedLaw, Law};
use super::least_squares::{Effort, minimise};
use super::order::{Order, Refined, choose, weighted};
use super::overlap;
use super::parameter::{Interval, IntervalMethod, Verdict};
use super::prony::Prony;
use super::shift_law::ShiftLaws;
use super::sweep::TemperatureSweep;
use crate::error::CmodError;

/// Rounds of choosing an order and fitting it with the shifts; two are the rule.
const MOST_ROUNDS: usize = 5;

/// A master curve: one Prony series for all temperatures, with a shift factor for each.
///
/// ```text
/// E(ω, T) = b_T E_ref(ω a_T) ,    a = 1 at the reference
/// ```
///
/// Neighbouring temperatures are first shifted onto each other where they overlap. Then series and all shifts are fitted together to
/// all lines, so that the shifts come with their covariance, and whether the material can be shifted to one curve at all is told by χ²
/// and the whiteness of the residuals.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct MasterCurve {
    /// The series at the reference temperature, with all shift factors but that of the reference as its last parameters.
    /// Its `aicc` and `bic` count them.
    pub fit: RheologicalFit,
    /// Orders that were tried in the last round.
    pub orders: Vec<Order>,
    /// Tᵣ \[K\].
    pub reference_temperature: f64,
    /// One for each temperature.
    pub shifts: Vec<Shift>,
    /// All lines at their reduced frequencies, in the order of the sweep.
    pub points: Vec<MasterPoint>,
}

/// The shift at one temperature.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Shift {
    /// T \[K\].
    pub temperature: f64,
    /// ln a_T, the mean over the orders of the series by their weights, as in [`RheologicalFit::prediction`].
    pub log_shift: f64,
    /// Standard error of ln a_T, with the scatter between the orders; 0 at the reference.
    pub standard_error: f64,
    /// Interval of ln a_T at the level of the fit.
    pub interval: Interval,
    /// Whether the data determine it, with the series that was chosen.
    pub verdict: Verdict,
    /// b_T as given.
    pub vertical: f64,
    /// ln (a_T/a_{T-1}) from the overlap with the temperature before; `None` for the first, and where they do not overlap. Then the
    /// iteration began with no shift between the two.
    pub overlap: Option<f64>,
}

/// A line of a master curve.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct MasterPoint {
    /// T \[K\].
    pub temperature: f64,
    /// Frequency times a_T \[Hz\].
    pub reduced_frequency_hz: f64,
    /// Modulus divided by b_T \[Pa\].
    pub modulus: Complex64,
}

impl MasterCurve {
    /// From `sweep`, at the temperature of index `reference`.
    ///
    /// # Errors
    /// [`CmodError::ReferenceTest`] for an index beyond the temperatures; otherwise as [`RheologicalFit::new`].
    #[allow(
        clippy::indexing_slicing,
        reason = "`reference` is below the number of temperatures, of which all lists have one element each; `others` are some of \
                  them, and the shifts of these are the last parameters"
    )]
    pub fn new(
        sweep: &TemperatureSweep,
        reference: usize,
        options: &FitOptions,
    ) -> Result<Self, CmodError> {
        let options = options.checked()?;
        let count = sweep.temperatures.len();
        if reference >= count {
            return Err(CmodError::ReferenceTest {
                index: reference,
                count,
            });
        }
        let factors = sweep.factors(reference);
        let overlaps = overlaps(sweep, &factors);
        let mut log_shifts = accumulated(&overlaps, reference);
        let joined = ModulusData::joined(sweep.data.iter().zip(factors.iter().copied()));
        enough(&joined, count, options.error_scale)?;

        let others: Vec<usize> = (0..count).filter(|step| *step != reference).collect();
        let temperatures: Vec<f64> = others
            .iter()
            .map(|step| sweep.temperatures[*step])
            .collect();
        let shift_of_line: Vec<Option<usize>> = sweep
            .data
            .iter()
            .enumerate()
            .flat_map(|(step, data)| {
                let shift = others.iter().position(|other| *other == step);
                std::iter::repeat_n(shift, data.len())
            })
            .collect();

        let no_law = || CmodError::NoLaw {
            law: Law::GeneralisedMaxwell.to_string(),
        };
        let mut best = None;
        let mut alternatives = Vec::new();
        for _ in 0..MOST_ROUNDS {
            let shifted = shifted(sweep, &joined, &log_shifts);
            let chosen = choose(&shifted, &options)?;
            let series = &chosen.best.series;
            let solid = series.equilibrium > 0.0;
            let model = Prony::shifted(
                solid,
                series.branches.len(),
                shift_of_line.clone(),
                &temperatures,
            );
            let mut start = chosen.best.minimum.at.clone();
            start.extend(others.iter().map(|step| log_shifts[*step]));
            let minimum =
                minimise(&model, &joined, &start, None, Effort::Full).ok_or_else(no_law)?;
            let own_shifts = minimum.at[minimum.at.len() - others.len()..].to_vec();
            let joint = |(_, tried): (f64, &Refined)| {
                let solid = tried.series.equilibrium > 0.0;
                let branches = tried.series.branches.len();
                let shifts = shift_of_line.clone();
                let model = Prony::shifted(solid, branches, shifts, &temperatures);
                let start = [tried.minimum.at.as_slice(), own_shifts.as_slice()].concat();
                let minimum = minimise(&model, &joined, &start, None, Effort::Comparison)?;
                let values = 2 * joined.len();
                let scores = Scores::of(
                    options.error_scale,
                    minimum.chi_squared,
                    values,
                    minimum.at.len(),
                );
                let information = Information::of(&minimum.linearised, minimum.at.len())?;
                let alternative = Alternative {
                    weight: 0.0,
                    model: Prony::new(solid, branches),
                    coordinates: minimum.at,
                    information,
                };
                Some((scores.aicc, alternative))
            };
            alternatives = weighted(chosen.candidates().into_iter().filter_map(joint).collect());
            let first = minimum.at.len() - others.len();
            for (step, found) in others.iter().zip(&minimum.at[first..]) {
                log_shifts[*step] = *found;
            }
            let key = (series.branches.len(), solid);
            let settled = matches!(&best, Some((before, _, _, _)) if *before == key);
            best = Some((key, model, minimum, chosen.orders));
            if settled {
                break;
            }
        }
        let (_, model, minimum, orders) = best.ok_or_else(no_law)?;

        let shifted = shifted(sweep, &joined, &log_shifts);
        let mut begin = 0;
        let sequences: Vec<_> = sweep
            .data
            .iter()
            .map(|data| {
                let sequence = begin..begin + data.len();
                begin = sequence.end;
                sequence
            })
            .collect();
        let scene = Scene {
            model: &model,
            data: &joined,
            band: shifted.band(),
            sequences: &sequences,
            options,
            elsewhere: Vec::new(),
        };
        let wrap = |at: &[f64]| Ok(FittedLaw::GeneralisedMaxwell(model.law_at(at)?));
        let mut fit = scene.judge(minimum, Law::GeneralisedMaxwell, wrap)?;
        fit.alternatives = alternatives;
        let first = fit.parameters.len() - others.len();
        let found = &fit.parameters[first..];
        let (means, covariance) = shifts_of(&fit, others.len());
        let quantile = options.quantile(fit.degrees_of_freedom);
        let shifts: Vec<Shift> = (0..count)
            .map(|step| {
                let own = others.iter().position(|other| *other == step);
                let log_shift = own.map_or(0.0, |k| means[k]);
                let standard_error = own.map_or(0.0, |k| covariance[k][k].sqrt());
                let linear = Interval {
                    lower: log_shift - quantile * standard_error,
                    upper: log_shift + quantile * standard_error,
                    method: IntervalMethod::Linear,
                };
                // of a profile the wider end of the two
                let profile = own.map(|k| found[k].interval);
                let interval = match profile.filter(|of| of.method == IntervalMethod::Profile) {
                    Some(of) => Interval {
                        lower: linear.lower.min(of.lower.ln()),
                        upper: linear.upper.max(of.upper.ln()),
                        method: IntervalMethod::Profile,
                    },
                    None => linear,
                };
                Shift {
                    temperature: sweep.temperatures[step],
                    log_shift,
                    standard_error,
                    interval,
                    verdict: own.map_or(Verdict::Identified, |k| found[k].verdict.clone()),
                    vertical: factors[step],
                    overlap: overlaps[step],
                }
            })
            .collect();
        let points = sequences
            .iter()
            .zip(&shifts)
            .flat_map(|(sequence, shift)| sequence.clone().map(move |line| (line, shift)))
            .map(|(line, shift)| MasterPoint {
                temperature: shift.temperature,
                reduced_frequency_hz: joined.omega[line] * shift.log_shift.exp()
                    / std::f64::consts::TAU,
                modulus: joined.modulus[line],
            })
            .collect();
        Ok(Self {
            fit,
            orders,
            reference_temperature: sweep.temperatures[reference],
            shifts,
            points,
        })
    }

    /// The series at the reference temperature.
    #[must_use]
    pub fn series(&self) -> Option<&GeneralisedMaxwell> {
        self.fit.law.prony_series()
    }

    /// The laws of Williams, Landel & Ferry and of Arrhenius fitted to the shifts that are identified.
    ///
    /// # Errors
    /// [`CmodError::TooFewReadings`] below three temperatures whose shifts are identified; [`CmodError::ShiftsUndetermined`] if the data leave a
    /// combination of the shifts open; [`CmodError::ChangedResult`] if lists of this result have been changed and there are more
    /// shifts than parameters.
    pub fn shift_laws(&self) -> Result<ShiftLaws, CmodError> {
        let reference = self.reference_temperature;
        let others: Vec<&Shift> = self
            .shifts
            .iter()
            .filter(|shift| shift.temperature.total_cmp(&reference).is_ne())
            .collect();
        let parameters = self.fit.parameters.len();
        let Some(first) = parameters.checked_sub(others.len()) else {
            return Err(CmodError::ChangedResult {
                what: "parameters, the shifts among them",
                found: parameters,
                expected: others.len(),
            });
        };
        // a shift that the data leave open, at one end or both, says nothing of the law
        let identified: Vec<usize> = (0..others.len())
            .filter(|k| others.get(*k).is_some_and(|shift| shift.verdict.is_identified()))
            .collect();
        let (_, all) = shifts_of(&self.fit, parameters - first);
        let covariance: Vec<Vec<f64>> = identified
            .iter()
            .filter_map(|row| all.get(*row))
            .map(|row| identified.iter().filter_map(|k| row.get(*k).copied()).collect())
            .collect();
        let others: Vec<&Shift> = identified.iter().filter_map(|k| others.get(*k).copied()).collect();
        let differences: Vec<f64> = others.iter().map(|s| s.temperature - reference).collect();
        let log_shifts: Vec<f64> = others.iter().map(|s| s.log_shift).collect();
        ShiftLaws::new(reference, &differences, &log_shifts, &covariance)
    }
}

/// The last `count` coordinates, which are shifts, as means over the orders, with their covariance by random and common errors and by the
/// scatter between the orders.
fn shifts_of(fit: &RheologicalFit, count: usize) -> (Vec<f64>, Vec<Vec<f64>>) {
    let own = (1.0, &fit.coordinates, &fit.information);
    let mut all: Vec<(f64, &Vec<f64>, &Information)> = fit
        .alternatives
        .iter()
        .map(|other| (other.weight, &other.coordinates, &other.information))
        .collect();
    if all.is_empty() {
        all.push(own);
    }
    let last = |values: &[f64]| values.iter().skip(values.len().saturating_sub(count)).copied().collect::<Vec<f64>>();
    let shifts: Vec<(f64, Vec<f64>, &Information)> = all
        .into_iter()
        .map(|(weight, at, information)| (weight, last(at), information))
        .collect();
    let mean: Vec<f64> = (0..count)
        .map(|k| {
            let of = |(weight, at, _): &(f64, Vec<f64>, &Information)| Some(weight * at.get(k)?);
            shifts.iter().filter_map(of).sum()
        })
        .collect();
    let mut sum = vec![vec![0.0; count]; count];
    let mut add = |weight: f64, vector: &[f64]| {
        for (row, own) in sum.iter_mut().zip(vector) {
            for (entry, other) in row.iter_mut().zip(vector) {
                *entry += weight * own * other;
            }
        }
    };
    for (weight, at, _) in &shifts {
        let difference: Vec<f64> = at.iter().zip(&mean).map(|(a, m)| a - m).collect();
        add(*weight, &difference);
    }
    for error in &fit.common_errors {
        add(1.0, &last(&error.shift));
    }
    for (weight, _, information) in &shifts {
        let random = information.of_last(count);
        for (row, own) in sum.iter_mut().zip(random) {
            for (entry, own) in row.iter_mut().zip(own) {
                *entry += weight * fit.variance_factor * own;
            }
        }
    }
    (mean, sum)
}

/// The relative shift of each temperature to the one before.
fn overlaps(sweep: &TemperatureSweep, factors: &[f64]) -> Vec<Option<f64>> {
    let reduced: Vec<ModulusData> = sweep
        .data
        .iter()
        .zip(factors)
        .map(|(data, factor)| ModulusData::joined(std::iter::once((data, *factor))))
        .collect();
    std::iter::once(None)
        .chain(reduced.windows(2).map(|pair| match pair {
            [colder, warmer] => overlap::shift(colder, warmer),
            _ => None,
        }))
        .collect()
}

/// ln a_T with 0 at the reference.
#[allow(
    clippy::indexing_slicing,
    reason = "there is one entry for each temperature, and `reference` is below their number"
)]
fn accumulated(overlaps: &[Option<f64>], reference: usize) -> Vec<f64> {
    let mut sum = 0.0;
    let all: Vec<f64> = overlaps
        .iter()
        .map(|overlap| {
            sum += overlap.unwrap_or(0.0);
            sum
        })
        .collect();
    all.iter().map(|shift| shift - all[reference]).collect()
}

/// All lines at their reduced frequencies.
fn shifted(sweep: &TemperatureSweep, joined: &ModulusData, log_shifts: &[f64]) -> ModulusData {
    let factors = sweep
        .data
        .iter()
        .zip(log_shifts)
        .flat_map(|(data, shift)| std::iter::repeat_n(shift.exp(), data.len()));
    ModulusData {
        omega: joined
            .omega
            .iter()
            .zip(factors)
            .map(|(omega, a)| omega * a)
            .collect(),
        ..joined.clone()
    }
}

impl fmt::Display for MasterCurve {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "reference {} K", self.reference_temperature)?;
        for shift in &self.shifts {
            writeln!(
                f,
                "{:>8.2} K  ln a = {:>8.3} +- {:.3}",
                shift.temperature, shift.log_shift, shift.standard_error
            )?;
        }
        write!(f, "{}", self.fit)
    }
}

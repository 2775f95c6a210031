//! Master curve from moduli at several temperatures.

mod factor_choice;
mod factors;
mod joint;
mod links;
mod prepared;
mod reduced;
mod temperature;

use std::fmt;

use num_complex::Complex64;
use rodwave::modulus::GeneralisedMaxwell;

pub use self::factor_choice::FactorChoice;
pub use self::factors::ReferenceDeparture;
use self::joint::{Joint, Settled, shifted};
use self::prepared::Prepared;
use super::data::ModulusData;
use super::fit::{ErrorScale, FitOptions, RheologicalFit};
use super::judgement::Scene;
use super::law::{FittedLaw, Law};
use super::order::Order;
use super::parameter::{Interval, IntervalMethod, Parameter, Verdict};
use super::shift_law::ShiftLaws;
use super::support::Support;
use super::sweep::TemperatureSweep;
use crate::directions::Directions;
use crate::error::CmodError;
use crate::estimate::ErrorSource;
use crate::vectors::{add_square, subtract};

/// Master curve: one Prony series for all temperatures, with a shift factor for each temperature.
///
/// ```text
/// E(ω, T) = b_T E_ref(ω a_T) ,    a = 1 at the reference
/// ```
///
/// Curves of neighbouring temperatures are first shifted onto each other where they overlap, if
/// they then differ by no more than their errors. Temperatures that are not connected with the
/// reference by such overlaps, or by [stated shifts](TemperatureSweep::with_stated_shifts), are
/// omitted. Then the series and all shifts are fitted together to all lines, so that the shifts
/// have a covariance; χ² and the whiteness of the residuals test whether the material has a master
/// curve.
///
/// b_T is 1 unless stated. If the overlaps or χ² (p < 0.01) reject this value, all b_T are also
/// fitted, and the fit with b_T is kept if BIC prefers it. The factors of rubber elasticity, b_T =
/// T/Tᵣ, are used instead if they lower BIC by more than 2. If the data do not exclude either of 1
/// and T/Tᵣ, the difference is a common error of all results ([`ErrorSource::VerticalFactors`]).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct MasterCurve {
    /// Series at the reference temperature, with all shift factors, except that of the reference,
    /// as its last parameters. Its `aicc` and `bic` include these parameters.
    pub fit: RheologicalFit,
    /// Orders tried in the last round.
    pub orders: Vec<Order>,
    /// Reference temperature Tᵣ \[K\].
    pub reference_temperature: f64,
    /// Shifts, one per temperature that is connected with the reference.
    pub shifts: Vec<Shift>,
    /// Temperatures that neither an overlap within the errors nor a stated shift connects with the
    /// reference. They are not part of the curve.
    pub unconnected: Vec<f64>,
    /// Choice between factors b_T of 1 and T/Tᵣ; `None` if the factors are stated, if they are
    /// estimated, or if fewer temperatures are connected with one of the two choices.
    pub factor_choice: Option<FactorChoice>,
    /// All lines at their reduced frequencies, in the order of the sweep.
    pub points: Vec<MasterPoint>,
    options: FitOptions,
}

/// Shift at one temperature.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Shift {
    /// Temperature T \[K\].
    pub temperature: f64,
    /// Logarithm ln a_T of the shift factor: the mean over the orders of the series with their
    /// weights, as in [`RheologicalFit::prediction`].
    pub log_shift: f64,
    /// Standard error of ln a_T, including the scatter between the orders; 0 at the reference.
    pub standard_error: f64,
    /// Part of the standard error due to the choice of the order: the scatter between the orders.
    pub order_error: f64,
    /// Interval of ln a_T at the level of the fit.
    pub interval: Interval,
    /// Identifiability by the data, with the chosen series.
    pub verdict: Verdict,
    /// True if ln a_T is the stated value, because the curves do not overlap; it then has no error.
    pub is_stated: bool,
    /// Vertical shift factor b_T, as stated or estimated.
    pub vertical: f64,
    /// Standard error of ln b_T; 0 if b_T was stated, or if it is 1 because the data do not require
    /// another value.
    pub vertical_standard_error: f64,
    /// ln (a_T/a_{T-1}) from the overlap with the previous temperature; `None` for the first
    /// temperature, or if the curves do not overlap.
    pub overlap: Option<f64>,
}

/// Line of a master curve.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct MasterPoint {
    /// Temperature T \[K\].
    pub temperature: f64,
    /// Frequency times a_T \[Hz\]; for a line over time, 1/(2πt) times a_T.
    pub reduced_frequency_hz: f64,
    /// Time divided by a_T \[s\], for a line over time.
    pub reduced_time: Option<f64>,
    /// Modulus divided by b_T \[Pa\].
    pub modulus: Complex64,
    /// Modulus of the series at the reduced frequency or time \[Pa\].
    pub fitted: Complex64,
}

impl MasterCurve {
    /// Fits the curve to `sweep`, with the temperature of index `reference` as reference.
    ///
    /// # Errors
    /// [`CmodError::ReferenceTest`] for an index beyond the temperatures; otherwise the errors of
    /// [`RheologicalFit::new`].
    pub fn new(
        sweep: &TemperatureSweep,
        reference: usize,
        options: &FitOptions,
    ) -> Result<Self, CmodError> {
        let options = options.checked()?;
        let mut prepared = Prepared::of(sweep, reference, &options)?;
        let joint = prepared.joint(options);
        let (starts, is_free) = (&prepared.starts, !sweep.vertical_is_stated);
        let mut settled = joint.settle(starts, false)?;
        if is_free && (starts.demand_factors() || settled.is_refused(&joint)) {
            let with_factors = joint.settle(starts, true)?;
            if with_factors.bic(&joint) < settled.bic(&joint) {
                settled = with_factors;
            }
        }
        let mut factor_choice = None;
        if is_free {
            let entropic = Prepared::of(&sweep.clone().entropic(), reference, &options)?;
            let joint_entropic = entropic.joint(options);
            let other = joint_entropic.settle(&entropic.starts, false)?;
            let fall = settled.bic(&joint) - other.bic(&joint_entropic);
            let are_estimated = settled.log_factors.is_some();
            let choice = FactorChoice::new(fall, are_estimated);
            if entropic.unconnected == prepared.unconnected
                && (choice.is_entropic || !are_estimated)
            {
                if choice.is_entropic {
                    (prepared, settled) = (entropic, other);
                }
                choice.add_to(&mut prepared);
                factor_choice = Some(choice);
            }
        }
        let joint = prepared.joint(options);
        Ok(Self {
            factor_choice,
            ..Self::concluded(&prepared, &joint, settled)?
        })
    }

    /// Judges the parameters at the minimum of the joint fit.
    #[allow(
        clippy::indexing_slicing,
        reason = "`reference` is below the number of temperatures, of which all lists have one element each; `others` are some of \
                  them, and the shifts of these are the last parameters"
    )]
    fn concluded(
        prepared: &Prepared,
        joint: &Joint<'_>,
        settled: Settled,
    ) -> Result<Self, CmodError> {
        let Prepared {
            sweep,
            reference,
            unconnected,
            links,
            factors,
            starts,
            joined,
        } = prepared;
        let (reference, options) = (*reference, joint.options);
        let count = sweep.temperatures.len();
        let place = |steps: &[usize], step: usize| steps.iter().position(|own| *own == step);
        let Settled {
            model,
            minimum,
            orders,
            alternatives,
            log_shifts,
            log_factors,
        } = settled;
        let has_factors = log_factors.is_some();
        let none = vec![0.0; count];
        let shifted = shifted(
            sweep,
            joined,
            &log_shifts,
            log_factors.as_ref().unwrap_or(&none),
        );
        let others = &joint.others;
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
            band: shifted.band(),
            sequences: sequences.clone(),
            profiled_from: if options.series_profiles {
                0
            } else {
                minimum.at.len() - others.len()
            },
            ..Scene::new(&model, joined, options)
        };
        let wrap = |at: &[f64]| Ok(FittedLaw::GeneralisedMaxwell(model.law_at(at)?));
        let mut fit = scene.judge(minimum, Law::GeneralisedMaxwell, wrap)?;
        fit.alternatives = alternatives;
        let first = fit.parameters.len() - others.len();
        let found = &fit.parameters[first..];
        let of_all = shifts_of(&fit, others.len(), &|_| true);
        let vertical: Vec<&Parameter> = if has_factors {
            let before = first - joint.scaled.len();
            fit.parameters[before..first].iter().collect()
        } else {
            Vec::new()
        };
        let quantile = options.quantile(fit.degrees_of_freedom);
        let shifts: Vec<Shift> = (0..count)
            .map(|step| {
                let own = others.iter().position(|other| *other == step);
                let stated = starts.is_stated[step].then(|| starts.log_shifts[step]);
                let log_shift = own.map_or(stated.unwrap_or(0.0), |k| of_all.means[k]);
                let factor = place(&joint.scaled, step).and_then(|k| vertical.get(k).copied());
                let standard_error = own.map_or(0.0, |k| of_all.covariance[k][k].sqrt());
                let linear = Interval {
                    lower: log_shift - quantile * standard_error,
                    upper: log_shift + quantile * standard_error,
                    method: IntervalMethod::Linear,
                };
                // on each side, the wider of the two intervals is used
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
                    order_error: own.map_or(0.0, |k| of_all.order_errors[k]),
                    interval,
                    verdict: own.map_or(Verdict::Identified, |k| found[k].verdict.clone()),
                    is_stated: stated.is_some(),
                    vertical: factors[step] * factor.map_or(1.0, |factor| factor.value),
                    vertical_standard_error: factor.map_or(0.0, |factor| factor.standard_error),
                    overlap: links[step].and_then(|link| link.overlap),
                }
            })
            .collect();
        let mut placed = joined.clone();
        for (sequence, shift) in sequences.iter().zip(&shifts) {
            for omega in &mut placed.omega[sequence.clone()] {
                *omega *= if shift.is_stated {
                    1.0
                } else {
                    shift.log_shift.exp()
                };
            }
        }
        // the data at the frequencies shifted by the fitted shifts
        let shifted = ModulusData {
            omega: placed.omega.clone(),
            ..shifted
        };
        fit.band = shifted.band();
        fit.support = Support::of(&shifted);
        let fitted = fit.law.response(&placed);
        let points = sequences
            .iter()
            .zip(&shifts)
            .flat_map(|(sequence, shift)| sequence.clone().map(move |line| (line, shift)))
            .map(|(line, shift)| MasterPoint {
                temperature: shift.temperature,
                reduced_frequency_hz: placed.omega[line] / std::f64::consts::TAU,
                reduced_time: placed.time(line),
                modulus: shifted.modulus[line],
                fitted: fitted[line],
            })
            .collect();
        Ok(Self {
            fit,
            orders,
            reference_temperature: sweep.temperatures[reference],
            shifts,
            unconnected: unconnected.clone(),
            factor_choice: None,
            points,
            options,
        })
    }

    /// Returns the series at the reference temperature; `None` if the fitted law was replaced by
    /// another law.
    #[must_use]
    pub fn series(&self) -> Option<&GeneralisedMaxwell> {
        self.fit.law.prony_series()
    }

    /// Fits the laws of Williams, Landel & Ferry and of Arrhenius to the shifts that are
    /// identified.
    ///
    /// # Errors
    /// [`CmodError::TooFewReadings`] for fewer than three temperatures whose shifts are identified;
    /// [`CmodError::ShiftsUndetermined`] if the data do not determine a combination of the shifts;
    /// [`CmodError::ChangedResult`] if lists of this result were changed, so that there are more
    /// shifts than parameters.
    pub fn shift_laws(&self) -> Result<ShiftLaws, CmodError> {
        self.shift_laws_with(None)
    }

    /// Fits the same laws as [`Self::shift_laws`], but with equal and independent errors of all
    /// identified shifts. The size of these errors is the scatter of the shifts about WLF.
    ///
    /// The errors of the shifts of a master curve are correlated. Therefore [`Self::shift_laws`]
    /// gives the differences between neighbouring shifts far more weight than the shifts
    /// themselves. If the shifts differ from WLF by more than these errors, the fitted law may miss
    /// all shifts. The laws fitted by scatter then describe the shifts.
    ///
    /// # Errors
    /// The errors of [`Self::shift_laws`]; [`CmodError::TooFewReadings`] for fewer than four
    /// temperatures whose shifts are identified.
    pub fn shift_laws_by_scatter(&self) -> Result<ShiftLaws, CmodError> {
        let equal = self.shift_laws_with(Some(1.0))?.wlf;
        if equal.degrees_of_freedom == 0 {
            return Err(CmodError::TooFewReadings {
                found: 3,
                expected: 4,
            });
        }
        let scatter = equal.chi_squared / super::count(equal.degrees_of_freedom);
        self.shift_laws_with(Some(scatter))
    }

    /// Fits both laws with the covariance of the shifts, or with `variance` for each of them.
    fn shift_laws_with(&self, variance: Option<f64>) -> Result<ShiftLaws, CmodError> {
        let reference = self.reference_temperature;
        let others: Vec<&Shift> = self
            .shifts
            .iter()
            .filter(|shift| shift.temperature.total_cmp(&reference).is_ne() && !shift.is_stated)
            .collect();
        let parameters = self.fit.parameters.len();
        let Some(first) = parameters.checked_sub(others.len()) else {
            return Err(CmodError::ChangedResult {
                what: "parameters, including the shifts",
                found: parameters,
                expected: others.len(),
            });
        };
        // a shift whose interval is unbounded at one or both ends contains no information about the
        // law
        let identified: Vec<usize> = (0..others.len())
            .filter(|k| {
                others
                    .get(*k)
                    .is_some_and(|shift| shift.verdict.is_identified())
            })
            .collect();
        let all = shifts_of(&self.fit, parameters - first, &|_| true).covariance;
        let covariance: Vec<Vec<f64>> = identified
            .iter()
            .filter_map(|row| all.get(*row))
            .map(|row| {
                identified
                    .iter()
                    .filter_map(|k| row.get(*k).copied())
                    .collect()
            })
            .collect();
        let covariance = match variance {
            None => covariance,
            Some(variance) => (0..identified.len())
                .map(|row| {
                    let own = |column| if row == column { variance } else { 0.0 };
                    (0..identified.len()).map(own).collect()
                })
                .collect(),
        };
        let others: Vec<&Shift> = identified
            .iter()
            .filter_map(|k| others.get(*k).copied())
            .collect();
        let differences: Vec<f64> = others.iter().map(|s| s.temperature - reference).collect();
        let log_shifts: Vec<f64> = others.iter().map(|s| s.log_shift).collect();
        let quantile = match variance {
            None => self.options.quantile(self.fit.degrees_of_freedom),
            // the variance follows from the residual of WLF
            Some(_) => {
                let options = self.options.with_error_scale(ErrorScale::FromResidual);
                options.quantile(identified.len().saturating_sub(2))
            }
        };
        ShiftLaws::new(reference, &differences, &log_shifts, &covariance, quantile)
    }
}

/// Logarithms of the fitted shifts, as means over the orders of the series.
struct OfShifts {
    means: Vec<f64>,
    covariance: Vec<Vec<f64>>,
    /// Scatter between the orders, a part of the standard errors.
    order_errors: Vec<f64>,
}

/// Returns the last `count` coordinates, which are shifts, as means over the orders, with their
/// covariance. The covariance is due to the random errors, to the common errors selected by
/// `counted`, and to the scatter between the orders.
fn shifts_of(
    fit: &RheologicalFit,
    count: usize,
    counted: &dyn Fn(ErrorSource) -> bool,
) -> OfShifts {
    let own = (1.0, &fit.coordinates, &fit.information);
    let mut all: Vec<(f64, &Vec<f64>, &Directions)> = fit
        .alternatives
        .iter()
        .map(|other| (other.weight, &other.coordinates, &other.information))
        .collect();
    if all.is_empty() {
        all.push(own);
    }
    let last = |values: &[f64]| {
        values
            .iter()
            .skip(values.len().saturating_sub(count))
            .copied()
            .collect::<Vec<f64>>()
    };
    let shifts: Vec<(f64, Vec<f64>, &Directions)> = all
        .into_iter()
        .map(|(weight, at, information)| (weight, last(at), information))
        .collect();
    let mean: Vec<f64> = (0..count)
        .map(|k| {
            let of = |(weight, at, _): &(f64, Vec<f64>, &Directions)| Some(weight * at.get(k)?);
            shifts.iter().filter_map(of).sum()
        })
        .collect();
    let mut sum = vec![vec![0.0; count]; count];
    for (weight, at, _) in &shifts {
        let difference: Vec<f64> = at.iter().zip(&mean).map(|(a, m)| a - m).collect();
        add_square(&mut sum, *weight, &difference);
    }
    for error in fit.common_errors.iter().filter(|e| counted(e.source)) {
        add_square(&mut sum, 1.0, &last(&error.shift));
    }
    let order_errors = (0..count)
        .map(|k| {
            let square = |(weight, at, _): &(f64, Vec<f64>, &Directions)| {
                Some(weight * (at.get(k)? - mean.get(k)?).powi(2))
            };
            shifts.iter().filter_map(square).sum::<f64>().sqrt()
        })
        .collect();
    for (weight, _, information) in &shifts {
        let random = information.of_last(count);
        for (row, own) in sum.iter_mut().zip(random) {
            subtract(row, -weight * fit.variance_factor, &own);
        }
    }
    OfShifts {
        means: mean,
        covariance: sum,
        order_errors,
    }
}

impl fmt::Display for MasterCurve {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "reference {} K", self.reference_temperature)?;
        for shift in &self.shifts {
            writeln!(
                f,
                "{:>8.2} K  ln a = {:>8.3} +- {:.3}{}",
                shift.temperature,
                shift.log_shift,
                shift.standard_error,
                if shift.is_stated { ", as stated" } else { "" }
            )?;
        }
        for temperature in &self.unconnected {
            writeln!(
                f,
                "{temperature:>8.2} K  not connected: overlaps no other curve"
            )?;
        }
        write!(f, "{}", self.fit)
    }
}

//! Prony series of a card, with relaxation times only within the band of the data.
//!
//! A branch with ωτ >= 1 at the highest line ω₂ adds at most as much to E(∞) - E'(ω₂) as to
//! E''(ω₂). A branch with ωτ <= 1 at the lowest line ω₁ adds at most as much to E'(ω₁) - E(0) as to
//! E''(ω₁). Therefore, with 1/ω₂ <= τᵢ <= 1/ω₁,
//!
//! ```text
//! E(∞) <= E'(ω₂) + E''(ω₂) ,    E(0) >= E'(ω₁) - E''(ω₁)
//! ```
//!
//! The stiffness of the card beyond the band is thus bounded by the measured modulus. A relaxation
//! outside the band, of which only a flank affects the data, becomes a part of the spring, or a
//! branch at the end of the band.

use rodwave::modulus::{GeneralisedMaxwell, MaxwellBranch};

use super::super::data::ModulusData;
use super::super::fit::{FitOptions, RheologicalFit};
use super::super::judgement::Scene;
use super::super::law::{FittedLaw, Law};
use super::super::least_squares::{Effort, minimise};
use super::super::model::Partial;
use super::super::order::{Series, no_law};
use super::super::parameter::Parameter;
use crate::error::CmodError;

/// Returns the series nearest to the data with relaxation times within the band, starting from the
/// times of `series`. All its parameters are identified, and every branch improves Schwarz's
/// criterion.
pub(super) fn in_band(
    data: &ModulusData,
    series: &GeneralisedMaxwell,
    options: FitOptions,
) -> Result<RheologicalFit, CmodError> {
    let (lowest, highest) = data.band();
    let ends = (highest.recip(), lowest.recip());
    let mut times: Vec<f64> = series
        .branches()
        .iter()
        .map(|b| b.relaxation_time)
        .collect();
    times.extend([ends.0, ends.1]);
    let mut known: Option<(Series, RheologicalFit)> = None;
    loop {
        let (found, fit) = match known.take() {
            Some(known) => known,
            None => fitted(data, times, ends, options)?,
        };
        let within = fit.law.prony_series().is_some_and(|series| {
            let mut times = series.branches().iter().map(|b| b.relaxation_time);
            times.all(|time| is_within(time, ends))
        });
        let open = |parameter: &Parameter| !parameter.verdict.is_identified();
        let shorter = without_the_cheapest(data, &found);
        if within && !fit.parameters.iter().skip(1).any(open) {
            // an identified branch may still describe only the common errors of the data
            if found.branches.len() > 1
                && let Ok(simpler) = fitted(data, shorter, ends, options)
                && simpler.1.bic <= fit.bic
            {
                times = Vec::new();
                known = Some(simpler);
                continue;
            }
            return match fit.parameters.first().filter(|spring| open(spring)) {
                Some(spring) => Err(not_solid(spring.value)),
                None => Ok(fit),
            };
        }
        times = shorter;
    }
}

/// Returns the relaxation times of the series without the branch whose removal increases χ² least.
fn without_the_cheapest(data: &ModulusData, found: &Series) -> Vec<f64> {
    let without = |left_out: usize| {
        let kept = found.branches.iter().enumerate();
        let kept = kept.filter(|(k, _)| *k != left_out);
        let shorter = Series {
            equilibrium: found.equilibrium,
            branches: kept.map(|(_, branch)| *branch).collect(),
        };
        shorter.with_best_moduli(data)
    };
    let best = (0..found.branches.len())
        .map(without)
        .min_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or_else(Vec::new, |(_, series)| times_of(&series))
}

fn fitted(
    data: &ModulusData,
    times: Vec<f64>,
    ends: (f64, f64),
    options: FitOptions,
) -> Result<(Series, RheologicalFit), CmodError> {
    let found = refined(data, times, ends)?;
    let fit = judged(data, &found, ends, options)?;
    Ok((found, fit))
}

fn is_within(time: f64, ends: (f64, f64)) -> bool {
    time >= ends.0 * (1.0 - 1e-9) && time <= ends.1 * (1.0 + 1e-9)
}

fn times_of(series: &Series) -> Vec<f64> {
    series.branches.iter().map(|b| b.relaxation_time).collect()
}

fn not_solid(value: f64) -> CmodError {
    CmodError::CardUndetermined {
        what: "long-term modulus of the card [Pa]",
        value,
        expected: "a loss modulus below the storage modulus at the lowest lines, as in a solid",
    }
}

/// Returns the free coordinates of a series: all except the times at the ends of the band.
fn free(at: &[f64], ends: (f64, f64)) -> Vec<usize> {
    let at_end = |time: f64| {
        [ends.0, ends.1]
            .iter()
            .any(|end| (time - end.ln()).abs() < 1e-9)
    };
    (0..at.len())
        .filter(|index| {
            let is_time = *index > 0 && index % 2 == 0;
            !(is_time && at.get(*index).is_some_and(|time| at_end(*time)))
        })
        .collect()
}

/// Returns moduli and times at the minimum of χ², with times clamped to the ends of the band.
fn refined(data: &ModulusData, mut times: Vec<f64>, ends: (f64, f64)) -> Result<Series, CmodError> {
    loop {
        for time in &mut times {
            *time = time.clamp(ends.0, ends.1);
        }
        times.sort_by(f64::total_cmp);
        times.dedup_by(|a, b| (*a / *b).ln().abs() < 1e-6);
        let branches = times.iter().map(|time| MaxwellBranch {
            modulus: 1.0,
            relaxation_time: *time,
        });
        let start = Series {
            equilibrium: 1.0,
            branches: branches.collect(),
        };
        let (_, start) = start.with_best_moduli(data);
        if start.equilibrium <= 0.0 {
            return Err(not_solid(0.0));
        }
        if start.branches.is_empty() {
            return Err(CmodError::CardUndetermined {
                what: "number of relaxations of the card",
                value: 0.0,
                expected: "at least one branch, whose loss modulus exceeds its error",
            });
        }
        let model = start.model();
        let at = start.coordinates();
        let free = free(&at, ends);
        let partial = Partial::new(&model, at, free);
        let minimum =
            minimise(&partial, data, &partial.start(), None, Effort::Full).ok_or_else(no_law)?;
        let mut series = Series::of_coordinates(&partial.whole_at(&minimum.at), true);
        series
            .branches
            .sort_by(|a, b| a.relaxation_time.total_cmp(&b.relaxation_time));
        times = times_of(&series);
        if times.iter().all(|time| is_within(*time, ends)) {
            return Ok(series);
        }
    }
}

fn judged(
    data: &ModulusData,
    found: &Series,
    ends: (f64, f64),
    options: FitOptions,
) -> Result<RheologicalFit, CmodError> {
    let model = found.model();
    let at = found.coordinates();
    let free = free(&at, ends);
    let partial = Partial::new(&model, at, free);
    let scene = Scene {
        ends_at_open: true,
        ..Scene::new(&partial, data, options)
    };
    let minimum =
        minimise(&partial, data, &partial.start(), None, Effort::Full).ok_or_else(no_law)?;
    let wrap = |at: &[f64]| {
        Ok(FittedLaw::GeneralisedMaxwell(
            model.law_at(&partial.whole_at(at))?,
        ))
    };
    scene.judge(minimum, Law::GeneralisedMaxwell, wrap)
}

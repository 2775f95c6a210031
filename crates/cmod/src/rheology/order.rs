//! Choice of the number of branches of a Prony series.
//!
//! χ² is a convex function of the relaxation spectrum, a distribution E(τ) >= 0, and the best
//! spectrum consists of discrete spectral lines. The spectral lines are found by non-negative least
//! squares on a grid of relaxation times, neighbouring spectral lines are merged into branches, and
//! all parameters of the series are refined. Further branches are added as long as they lower χ².
//! No series with more branches fits better, so only shorter series are tried. Branches are merged
//! or removed one at a time, choosing the change that increases χ² least, and the remaining series
//! is refined again. The criterion chooses among the orders.

mod refined;
mod series;

pub(super) use refined::Refined;
pub(super) use series::Series;

use super::count;
use super::data::ModulusData;
use super::fit::{Alternative, ErrorScale, FitOptions, RheologicalFit, enough};
use super::judgement::Scene;
use super::law::{FittedLaw, Law};
use super::least_squares::Minimum;
use super::profile::{Elsewhere, End, Profile};
use super::support::Support;
use crate::directions::Directions;
use crate::error::CmodError;

/// Weight relative to the best order below which an order does not contribute to a prediction.
const LEAST_WEIGHT: f64 = 1e-3;
/// Amount by which the criterion exceeds its best value at two successive orders when the search
/// ends.
const HOPELESS: f64 = 30.0;

/// Generalised Maxwell model of a chosen or given order.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct PronyFit {
    /// Fit of the model.
    pub fit: RheologicalFit,
    /// Orders tried, from the most branches to the fewest.
    pub orders: Vec<Order>,
}

/// Order of a Prony series that was tried.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Order {
    /// Number of branches.
    pub branches: usize,
    /// True if there is a parallel spring, E∞ > 0.
    pub solid: bool,
    /// χ² with the stated errors.
    pub chi_squared: f64,
    /// Corrected Akaike information criterion.
    pub aicc: f64,
    /// Bayesian information criterion.
    pub bic: f64,
    /// Criterion for predictions.
    prediction: f64,
}

impl PronyFit {
    /// Fits a series of the order that the criterion of `options` chooses.
    ///
    /// # Errors
    /// The errors of [`RheologicalFit::new`].
    pub fn new(data: &ModulusData, options: &FitOptions) -> Result<Self, CmodError> {
        let options = options.checked()?;
        enough(data, 1, options.error_scale)?;
        let chosen = choose(data, &options)?;
        Self::judged(data, options, chosen)
    }

    /// Fits a series of `branches` branches, even if the data do not resolve them; the verdicts
    /// then report this.
    ///
    /// # Errors
    /// The errors of [`RheologicalFit::new`].
    pub fn with_order(
        data: &ModulusData,
        branches: usize,
        options: &FitOptions,
    ) -> Result<Self, CmodError> {
        let options = options.checked()?;
        let parameters = branches.saturating_mul(2).saturating_add(1);
        enough(data, parameters, options.error_scale)?;
        let mut here = Refined::of(data, Series::best(data)).ok_or_else(no_law)?;
        while here.series.branches.len() > branches {
            let most = here.series.branches.len() - branches;
            here = here.shorter(data, most).ok_or_else(no_law)?;
        }
        while here.series.branches.len() < branches {
            let longer = here.series.split(data);
            here = Refined::of(data, longer).ok_or_else(no_law)?;
        }
        if let Some(stiffened) = here.with_spring(data)
            && score(&stiffened, data, &options) < score(&here, data, &options)
        {
            here = stiffened;
        }
        let here = here.settled(data).ok_or_else(no_law)?;
        let order = here.order(data, &options);
        let chosen = Chosen {
            best: here,
            orders: vec![order],
            tried: Vec::new(),
        };
        Self::judged(data, options, chosen)
    }

    fn judged(data: &ModulusData, options: FitOptions, chosen: Chosen) -> Result<Self, CmodError> {
        let series = &chosen.best.series;
        let model = series.model();
        let scene = Scene {
            profiled_from: if options.series_profiles {
                0
            } else {
                usize::MAX
            },
            elsewhere: Elsewhere::new(data, series.elsewhere(data)),
            ..Scene::new(&model, data, options)
        };
        let wrap = |at: &[f64]| Ok(FittedLaw::GeneralisedMaxwell(model.law_at(at)?));
        let alternatives = chosen.alternatives();
        let equilibrium_limit = chosen.equilibrium_limit(data, &options);
        let mut fit = scene.judge(chosen.best.minimum, Law::GeneralisedMaxwell, wrap)?;
        fit.alternatives = alternatives;
        fit.support = Support::of(data);
        fit.equilibrium_limit = equilibrium_limit;
        Ok(Self {
            fit,
            orders: chosen.orders,
        })
    }
}

/// Returns the value of the criterion of `options` for a series.
fn score(refined: &Refined, data: &ModulusData, options: &FitOptions) -> f64 {
    let order = refined.order(data, options);
    options.criterion.of(order.aicc, order.bic)
}

pub(super) fn no_law() -> CmodError {
    CmodError::NoLaw {
        law: Law::GeneralisedMaxwell.to_string(),
    }
}

/// Series that the criterion prefers, with the orders that were tried.
pub(super) struct Chosen {
    pub(super) best: Refined,
    pub(super) orders: Vec<Order>,
    /// Series of the orders that were tried; empty if the order was given.
    tried: Vec<Refined>,
}

impl Chosen {
    /// Returns the series that may contribute to a prediction, each with its value of the criterion
    /// for predictions.
    pub(super) fn candidates(&self) -> Vec<(f64, &Refined)> {
        let score = |order: &Order| order.prediction;
        let least = self.orders.iter().map(score).fold(f64::INFINITY, f64::min);
        let all = self.orders.iter().map(score).zip(&self.tried);
        all.filter(|(score, _)| 0.5 * (score - least) < -LEAST_WEIGHT.ln())
            .collect()
    }

    /// Returns the upper limit of E∞ for a spring that is added to a series without a spring.
    fn equilibrium_limit(&self, data: &ModulusData, options: &FitOptions) -> Option<f64> {
        let solid = self.best.with_spring(data).filter(|_| options.profiles)?;
        let model = solid.series.model();
        let freedom = data.values().saturating_sub(solid.minimum.at.len());
        let chi_squared = solid.minimum.chi_squared.min(self.best.minimum.chi_squared);
        let factor = match options.error_scale {
            ErrorScale::FromResidual => chi_squared / count(freedom.max(1)),
            _ => 1.0,
        };
        let profile = Profile {
            model: &model,
            data,
            at: &solid.minimum.at,
            chi_squared,
            elsewhere: &Elsewhere::default(),
            index: 0,
            threshold: factor * options.quantile(freedom).powi(2),
        };
        match profile.end(0.7) {
            End::At(limit) => Some(limit.exp()),
            End::Open | End::LowerMinimum(_) => Some(f64::INFINITY),
        }
    }

    fn alternatives(&self) -> Vec<Alternative> {
        let of = |(score, tried): (f64, &Refined)| {
            Some((score, Alternative::of(&tried.series, &tried.minimum)?))
        };
        weighted(self.candidates().into_iter().filter_map(of).collect())
    }
}

impl Alternative {
    /// Creates an alternative whose weight is not yet known.
    pub(super) fn of(series: &Series, minimum: &Minimum) -> Option<Self> {
        Some(Self {
            weight: 0.0,
            model: series.model(),
            coordinates: minimum.at.clone(),
            information: Directions::of_law(&minimum.linearised, minimum.at.len())?,
        })
    }
}

/// Returns the alternatives with their normalised weights exp(-A/2), where A is the criterion for
/// predictions of the alternative.
pub(super) fn weighted(mut all: Vec<(f64, Alternative)>) -> Vec<Alternative> {
    let least = all
        .iter()
        .map(|(score, _)| *score)
        .fold(f64::INFINITY, f64::min);
    let weight = |score: f64| (0.5 * (least - score)).exp();
    let sum: f64 = all.iter().map(|(score, _)| weight(*score)).sum();
    for (score, alternative) in &mut all {
        alternative.weight = weight(*score) / sum;
    }
    all.into_iter()
        .map(|(_, alternative)| alternative)
        .collect()
}

pub(super) fn choose(data: &ModulusData, options: &FitOptions) -> Result<Chosen, CmodError> {
    let here = Refined::of(data, Series::best(data)).ok_or_else(no_law)?;
    let mut here = here.with_further_lines(data, options);
    let mut orders: Vec<Order> = Vec::new();
    let mut tried: Vec<Refined> = Vec::new();
    let mut best: Option<(f64, Refined)> = None;
    let mut hopeless = 0;
    loop {
        let mut candidates = vec![here.clone()];
        candidates.extend(here.without_spring(data));
        candidates.extend(here.with_spring(data));
        let most = options.most_branches.unwrap_or(usize::MAX);
        candidates.retain(|candidate| candidate.series.branches.len() <= most);
        let mut of_level = f64::INFINITY;
        for candidate in candidates {
            let order = candidate.order(data, options);
            let value = options.criterion.of(order.aicc, order.bic);
            of_level = of_level.min(value);
            orders.push(order);
            tried.push(candidate.clone());
            if best.as_ref().is_none_or(|(least, _)| value < *least) {
                best = Some((value, candidate));
            }
        }
        let least = best.as_ref().map_or(f64::INFINITY, |(least, _)| *least);
        hopeless = if of_level > least + HOPELESS {
            hopeless + 1
        } else {
            0
        };
        let next = if hopeless < 2 {
            here.shorter(data, usize::MAX)
        } else {
            None
        };
        match next {
            Some(shorter) => here = shorter,
            None => break,
        }
    }
    let (_, best) = best.ok_or_else(no_law)?;
    let best = best.settled(data).ok_or_else(no_law)?;
    Ok(Chosen {
        best,
        orders,
        tried,
    })
}

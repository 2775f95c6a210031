//! Number of branches of a Prony series, and the series with them.
//!
//! χ² is a convex function of the relaxation spectrum, a distribution E(τ) >= 0, and the best
//! spectrum consists of lines. They are found by non-negative least squares on a grid of relaxation
//! times, neighbours are merged, and all parameters of the series are refined; while a further line
//! still lowers χ², it is added. No series with more branches fits better, so only shorter ones are
//! tried: branches are merged or removed one at a time, each time the one of least cost, and all is
//! refined again. The criterion chooses among the orders.

use rodwave::modulus::MaxwellBranch;

use super::count;
use super::data::ModulusData;
use super::explained::Explained;
use super::fit::{Alternative, ErrorScale, FitOptions, RheologicalFit, Scores, enough};
use super::judgement::Scene;
use super::law::{FittedLaw, Law};
use super::least_squares::{Effort, Minimum, minimise};
use super::non_negative::{NonNegative, dot};
use super::profile::{End, Profile};
use super::prony::{Prony, share};
use crate::directions::Directions;
use crate::error::CmodError;

/// Relaxation times per decade of the grid.
const TIMES_A_DECADE: f64 = 6.0;
/// Decades of the grid beyond the band: at two decades a flank is a straight line, at any distance.
const DECADES_BEYOND: f64 = 1.5;
/// Predicted decrease of χ² for which a further branch is added; a criterion requires 4 or more.
const WORTHWHILE: f64 = 1.0;
/// Increase of χ², with moduli refitted, below which branches are removed without evaluating the
/// orders between: no criterion would keep them.
const FREE_OF_COST: f64 = 0.5;
const MOST_FURTHER_LINES: usize = 12;
/// Weight relative to the best order below which an order does not contribute to a prediction.
const LEAST_WEIGHT: f64 = 1e-3;
/// Excess of the criterion over its best value at which the search ends, twice in a row.
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

/// Order tried.
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
    /// Criterion of predictions.
    prediction: f64,
}

impl PronyFit {
    /// Fits a series of the order that the criterion of `options` chooses.
    ///
    /// # Errors
    /// Those of [`RheologicalFit::new`].
    pub fn new(data: &ModulusData, options: &FitOptions) -> Result<Self, CmodError> {
        let options = options.checked()?;
        enough(data, 1, options.error_scale)?;
        let chosen = choose(data, &options)?;
        Self::judged(data, options, chosen)
    }

    /// Fits a series of `branches` branches, also where the data do not resolve them, which the
    /// verdicts report.
    ///
    /// # Errors
    /// Those of [`RheologicalFit::new`].
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
        let model = Prony::new(series.equilibrium > 0.0, series.branches.len());
        let sequence = 0..data.len();
        let scene = Scene {
            model: &model,
            data,
            band: data.band(),
            sequences: std::slice::from_ref(&sequence),
            options,
            profiled_from: if options.series_profiles {
                0
            } else {
                usize::MAX
            },
            ends_at_open: false,
            elsewhere: series.elsewhere(data),
        };
        let wrap = |at: &[f64]| Ok(FittedLaw::GeneralisedMaxwell(model.law_at(at)?));
        let alternatives = chosen.alternatives();
        let equilibrium_limit = chosen.equilibrium_limit(data, &options);
        let mut fit = scene.judge(chosen.best.minimum, Law::GeneralisedMaxwell, wrap)?;
        fit.alternatives = alternatives;
        fit.equilibrium_limit = equilibrium_limit;
        Ok(Self {
            fit,
            orders: chosen.orders,
        })
    }
}

/// Returns the value of the criterion.
fn score(refined: &Refined, data: &ModulusData, options: &FitOptions) -> f64 {
    let order = refined.order(data, options);
    options.criterion.of(order.aicc, order.bic)
}

fn no_law() -> CmodError {
    CmodError::NoLaw {
        law: Law::GeneralisedMaxwell.to_string(),
    }
}

/// Series preferred by the criterion.
pub(super) struct Chosen {
    pub(super) best: Refined,
    pub(super) orders: Vec<Order>,
    /// Series of these orders; none where the order was given.
    tried: Vec<Refined>,
}

impl Chosen {
    /// Returns the series that may contribute to a prediction, each with the value of its
    /// criterion.
    pub(super) fn candidates(&self) -> Vec<(f64, &Refined)> {
        let score = |order: &Order| order.prediction;
        let least = self.orders.iter().map(score).fold(f64::INFINITY, f64::min);
        let all = self.orders.iter().map(score).zip(&self.tried);
        all.filter(|(score, _)| 0.5 * (score - least) < -LEAST_WEIGHT.ln())
            .collect()
    }

    /// Returns the greatest E∞ that the data do not exclude in addition to the branches of a series
    /// without one.
    fn equilibrium_limit(&self, data: &ModulusData, options: &FitOptions) -> Option<f64> {
        let solid = self.best.with_spring(data).filter(|_| options.profiles)?;
        let model = Prony::new(true, solid.series.branches.len());
        let freedom = (2 * data.len()).saturating_sub(solid.minimum.at.len());
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
            elsewhere: &[],
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
            let coordinates = tried.minimum.at.clone();
            let alternative = Alternative {
                weight: 0.0,
                model: Prony::new(tried.series.equilibrium > 0.0, tried.series.branches.len()),
                information: Directions::of_law(&tried.minimum.linearised, coordinates.len())?,
                coordinates,
            };
            Some((score, alternative))
        };
        weighted(self.candidates().into_iter().filter_map(of).collect())
    }
}

/// Returns the alternatives with their weights exp(-A/2), normalised, from their criterion A of
/// predictions.
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

/// E∞ and branches in the order of increasing relaxation times.
#[derive(Debug, Clone)]
pub(super) struct Series {
    pub(super) equilibrium: f64,
    pub(super) branches: Vec<MaxwellBranch>,
}

impl Series {
    /// Returns the lines of the best spectrum on a grid, with neighbours merged.
    fn best(data: &ModulusData) -> Self {
        let times = grid(data);
        let mut columns = vec![constant(data)];
        columns.extend(times.iter().map(|time| column(data, *time)));
        let optimum = NonNegative::new(&columns, &target(data)).solve();
        let (equilibrium, moduli) = optimum.coefficients.split_at(1);
        let mut branches: Vec<MaxwellBranch> = Vec::new();
        let mut previous = false;
        for (relaxation_time, modulus) in times.iter().zip(moduli) {
            if *modulus > 0.0 {
                let line = MaxwellBranch {
                    modulus: *modulus,
                    relaxation_time: *relaxation_time,
                };
                match branches.last_mut() {
                    Some(last) if previous => *last = merged(last, &line),
                    _ => branches.push(line),
                }
            }
            previous = *modulus > 0.0;
        }
        Self {
            equilibrium: equilibrium.first().copied().unwrap_or(0.0),
            branches,
        }
    }

    pub(super) fn coordinates(&self) -> Vec<f64> {
        Prony::coordinates(self.equilibrium, &self.branches)
    }

    pub(super) fn of_coordinates(at: &[f64], solid: bool) -> Self {
        let (equilibrium, rest) = at.split_at(usize::from(solid));
        let branches = rest.as_chunks().0;
        Self {
            equilibrium: equilibrium.first().map_or(0.0, |e| e.exp()),
            branches: branches
                .iter()
                .map(|[modulus, time]| MaxwellBranch {
                    modulus: modulus.exp(),
                    relaxation_time: time.exp(),
                })
                .collect(),
        }
    }

    /// Returns series with the same number of parameters from which the law may fit as well: the
    /// spring as a slow relaxation, and the first and the last branch out of the band.
    fn elsewhere(&self, data: &ModulusData) -> Vec<Vec<f64>> {
        const FAR: f64 = 30.0;
        let (lowest, highest) = data.band();
        let mut all = Vec::new();
        let mut with = |change: &dyn Fn(&mut Self) -> Option<()>| {
            let mut other = self.clone();
            if change(&mut other).is_some() {
                all.push(other.coordinates());
            }
        };
        if self.equilibrium > 0.0 {
            with(&|other| {
                let slowest = other.branches.last_mut()?;
                slowest.modulus += other.equilibrium;
                slowest.relaxation_time = FAR / lowest;
                other.equilibrium *= 1e-3;
                Some(())
            });
        }
        with(&|other| {
            let slowest = other.branches.last_mut()?;
            slowest.relaxation_time = slowest.relaxation_time.max(FAR / lowest);
            Some(())
        });
        with(&|other| {
            let fastest = other.branches.first_mut()?;
            let time = fastest.relaxation_time.min((FAR * highest).recip());
            fastest.modulus *= fastest.relaxation_time / time;
            fastest.relaxation_time = time;
            Some(())
        });
        all
    }

    /// Returns the series with the largest, or the first, branch split into two.
    fn split(&self, data: &ModulusData) -> Self {
        let mut longer = self.clone();
        let branches = self.branches.iter().enumerate();
        let largest = branches.max_by(|(_, a), (_, b)| a.modulus.total_cmp(&b.modulus));
        if let Some((at, whole)) = largest {
            let half = |factor: f64| MaxwellBranch {
                modulus: 0.5 * whole.modulus,
                relaxation_time: whole.relaxation_time * factor,
            };
            longer.branches.splice(at..=at, [half(0.7), half(1.4)]);
        } else {
            let (lowest, highest) = data.band();
            longer.branches.push(MaxwellBranch {
                modulus: 0.01 * self.equilibrium,
                relaxation_time: (lowest * highest).sqrt().recip(),
            });
        }
        longer
    }

    /// Returns the same relaxation times with the best moduli, and χ²; branches without a modulus
    /// are removed.
    pub(super) fn with_best_moduli(mut self, data: &ModulusData) -> (f64, Self) {
        let solid = self.equilibrium > 0.0;
        let mut columns: Vec<Vec<f64>> = Vec::with_capacity(1 + self.branches.len());
        if solid {
            columns.push(constant(data));
        }
        columns.extend(
            self.branches
                .iter()
                .map(|b| column(data, b.relaxation_time)),
        );
        let optimum = NonNegative::new(&columns, &target(data)).solve();
        let (equilibrium, moduli) = optimum.coefficients.split_at(usize::from(solid));
        self.equilibrium = equilibrium.first().copied().unwrap_or(0.0);
        for (branch, modulus) in self.branches.iter_mut().zip(moduli) {
            branch.modulus = *modulus;
        }
        self.branches.retain(|branch| branch.modulus > 0.0);
        (optimum.square, self)
    }

    fn is_empty(&self) -> bool {
        self.branches.is_empty() && self.equilibrium <= 0.0
    }
}

/// Merges two branches into one: the sum of the moduli, and the mean logarithm of the times with
/// these as weights.
fn merged(a: &MaxwellBranch, b: &MaxwellBranch) -> MaxwellBranch {
    let modulus = a.modulus + b.modulus;
    let share = b.modulus / modulus;
    MaxwellBranch {
        modulus,
        relaxation_time: a.relaxation_time * (b.relaxation_time / a.relaxation_time).powf(share),
    }
}

/// Series at the minimum of χ² for its order.
#[derive(Debug, Clone)]
pub(super) struct Refined {
    pub(super) series: Series,
    pub(super) minimum: Minimum,
}

impl Refined {
    /// Refines `series` in all its parameters.
    fn of(data: &ModulusData, series: Series) -> Option<Self> {
        Self::with_effort(data, series, Effort::Search)
    }

    /// Moves to the minimum itself.
    fn settled(self, data: &ModulusData) -> Option<Self> {
        Self::with_effort(data, self.series, Effort::Full)
    }

    fn with_effort(data: &ModulusData, series: Series, effort: Effort) -> Option<Self> {
        if series.is_empty() {
            return None;
        }
        let solid = series.equilibrium > 0.0;
        let model = Prony::new(solid, series.branches.len());
        let mut minimum = minimise(&model, data, &series.coordinates(), None, effort)?;
        let mut series = Series::of_coordinates(&minimum.at, solid);
        let by_time =
            |a: &MaxwellBranch, b: &MaxwellBranch| a.relaxation_time.total_cmp(&b.relaxation_time);
        if !series.branches.is_sorted_by(|a, b| by_time(a, b).is_le()) {
            series.branches.sort_by(by_time);
            minimum = minimise(&model, data, &series.coordinates(), None, effort)?;
            series = Series::of_coordinates(&minimum.at, solid);
        }
        Some(Self { series, minimum })
    }

    /// Adds the lines with the largest predicted decrease of χ², as long as one is [`WORTHWHILE`].
    fn with_further_lines(mut self, data: &ModulusData, options: &FitOptions) -> Self {
        let grid = grid(data);
        for _ in 0..MOST_FURTHER_LINES {
            let residual = &self.minimum.linearised.residual;
            let scale = match options.error_scale {
                ErrorScale::FromResidual => self.minimum.chi_squared / count(residual.len()),
                _ => 1.0,
            };
            let best = grid
                .iter()
                .map(|time| {
                    let column = column(data, *time);
                    let slope = -dot(&column, residual);
                    let square = dot(&column, &column);
                    let line = MaxwellBranch {
                        modulus: slope / square,
                        relaxation_time: *time,
                    };
                    (slope.max(0.0).powi(2) / square, line)
                })
                .max_by(|a, b| a.0.total_cmp(&b.0));
            let Some((gain, line)) = best.filter(|(gain, _)| *gain > WORTHWHILE * scale) else {
                break;
            };
            let mut longer = self.series.clone();
            let place = longer
                .branches
                .partition_point(|branch| branch.relaxation_time < line.relaxation_time);
            longer.branches.insert(place, line);
            match Self::of(data, longer) {
                Some(refined)
                    if refined.minimum.chi_squared < self.minimum.chi_squared - 0.1 * gain =>
                {
                    self = refined;
                }
                _ => break,
            }
        }
        self
    }

    fn order(&self, data: &ModulusData, options: &FitOptions) -> Order {
        let linearised = &self.minimum.linearised;
        let information = Directions::of_law(linearised, self.minimum.at.len());
        let chi_squared = information.map_or(self.minimum.chi_squared, |information| {
            Explained::of(data, linearised, &information, options.error_scale).chi_squared
        });
        let scores = Scores::of(
            options.error_scale,
            chi_squared,
            2 * data.len(),
            self.minimum.at.len(),
        );
        Order {
            branches: self.series.branches.len(),
            solid: self.series.equilibrium > 0.0,
            chi_squared,
            aicc: scores.aicc,
            bic: scores.bic,
            prediction: scores.prediction,
        }
    }

    /// Returns the best series with one branch less: the two best of all mergers and removals, by
    /// their χ² with the best moduli, are refined. As long as the cost is negligible, up to
    /// `most` branches are removed at once.
    fn shorter(&self, data: &ModulusData, most: usize) -> Option<Self> {
        let mut series = self.series.clone();
        let start = self.minimum.chi_squared;
        let freedom = count(2 * data.len());
        let free = FREE_OF_COST * (start / freedom).min(1.0);
        let mut gone = 0;
        let mut candidates = shorter_by_one(&series, data);
        while gone < most
            && let Some((chi_squared, best)) = candidates.first()
            && *chi_squared <= start + free
            && !best.branches.is_empty()
        {
            series = best.clone();
            gone += 1;
            candidates = shorter_by_one(&series, data);
        }
        // for many branches a wrong choice costs little and is corrected at lower orders
        let most_refined = if series.branches.len() > 8 { 1 } else { 2 };
        if gone > 0 {
            return Self::of(data, series);
        }
        let refined = candidates
            .into_iter()
            .take(most_refined)
            .filter_map(|(_, series)| Self::of(data, series));
        refined.min_by(|a, b| a.minimum.chi_squared.total_cmp(&b.minimum.chi_squared))
    }

    /// Returns the series of a fluid with a spring, which initially has half of the modulus of its
    /// slowest branch.
    fn with_spring(&self, data: &ModulusData) -> Option<Self> {
        if self.series.equilibrium > 0.0 {
            return None;
        }
        let mut solid = self.series.clone();
        let slowest = solid.branches.last_mut()?;
        slowest.modulus *= 0.5;
        solid.equilibrium = slowest.modulus;
        Self::of(data, solid)
    }

    /// Returns the series without E∞, if that does not cost too much.
    fn without_spring(&self, data: &ModulusData) -> Option<Self> {
        if self.series.equilibrium <= 0.0 || self.series.branches.is_empty() {
            return None;
        }
        let mut fluid = self.series.clone();
        fluid.equilibrium = 0.0;
        // the slowest branch can replace the spring
        let slowest = fluid.branches.last_mut()?;
        slowest.modulus += self.series.equilibrium;
        let mut carried = fluid.clone();
        carried.branches.last_mut()?.relaxation_time = 100.0 / data.band().0;
        let least = fluid
            .clone()
            .with_best_moduli(data)
            .0
            .min(carried.with_best_moduli(data).0);
        if least > self.minimum.chi_squared + 10.0 * HOPELESS {
            return None;
        }
        let refined = Self::of(data, fluid)?;
        (refined.minimum.chi_squared < self.minimum.chi_squared + HOPELESS).then_some(refined)
    }
}

/// Returns all series with one branch less, by merger or removal, with their best moduli and χ²,
/// the best first.
fn shorter_by_one(series: &Series, data: &ModulusData) -> Vec<(f64, Series)> {
    let branches = &series.branches;
    let n = branches.len();
    let solid = series.equilibrium > 0.0;
    let joined: Vec<MaxwellBranch> = branches
        .windows(2)
        .filter_map(|pair| match pair {
            [a, b] => Some(merged(a, b)),
            _ => None,
        })
        .collect();
    // the spring, the branches, the mergers
    let mut columns = vec![constant(data)];
    columns.extend(
        branches
            .iter()
            .chain(&joined)
            .map(|b| column(data, b.relaxation_time)),
    );
    let problem = NonNegative::new(&columns, &target(data));
    let evaluate = |chosen: Vec<usize>| {
        let optimum = problem.of_columns(&chosen).solve();
        let mut found = Series {
            equilibrium: 0.0,
            branches: Vec::with_capacity(n),
        };
        for (place, modulus) in chosen.iter().zip(optimum.coefficients) {
            let branch = place
                .checked_sub(1)
                .and_then(|i| branches.iter().chain(&joined).nth(i));
            match branch {
                None => found.equilibrium = modulus,
                Some(branch) if modulus > 0.0 => found.branches.push(MaxwellBranch {
                    modulus,
                    relaxation_time: branch.relaxation_time,
                }),
                Some(_) => {}
            }
        }
        (optimum.square, found)
    };
    let spring = if solid { vec![0] } else { Vec::new() };
    let mut candidates = Vec::with_capacity(2 * n);
    for i in 0..n {
        let rest = (0..n).filter(|other| *other != i);
        candidates.push(evaluate(
            spring.iter().copied().chain(rest.map(|k| k + 1)).collect(),
        ));
        if i > 0 {
            // the merger in place of the two, in the order of times
            let merger = (0..n)
                .filter(|k| *k != i)
                .map(|k| if k + 1 == i { n + i } else { k + 1 });
            candidates.push(evaluate(spring.iter().copied().chain(merger).collect()));
        }
    }
    if !solid && n > 0 {
        // a relaxation far below the band may be a spring
        candidates.push(evaluate((0..n).collect()));
    }
    candidates.retain(|(_, series)| !series.is_empty());
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
    candidates
}

/// Returns the relaxation times of the band and [`DECADES_BEYOND`].
fn grid(data: &ModulusData) -> Vec<f64> {
    let (lowest, highest) = data.band();
    let decade = std::f64::consts::LN_10;
    let first = -highest.ln() - DECADES_BEYOND * decade;
    let span = (highest / lowest).ln() + 2.0 * DECADES_BEYOND * decade;
    let spacing = decade / TIMES_A_DECADE;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positive, and the decades of a float times six are few"
    )]
    let steps = (span / spacing).ceil() as u32;
    (0..=steps)
        .map(|step| (first + f64::from(step) * spacing).exp())
        .collect()
}

/// Returns whitened values of 1.
fn constant(data: &ModulusData) -> Vec<f64> {
    data.whitening
        .iter()
        .flat_map(|w| w.apply(1.0.into()))
        .collect()
}

/// Returns whitened values of a branch of modulus 1.
fn column(data: &ModulusData, relaxation_time: f64) -> Vec<f64> {
    data.omega
        .iter()
        .zip(&data.whitening)
        .flat_map(|(omega, w)| w.apply(share(omega * relaxation_time)))
        .collect()
}

/// Returns the whitened measured moduli.
fn target(data: &ModulusData) -> Vec<f64> {
    data.modulus
        .iter()
        .zip(&data.whitening)
        .flat_map(|(modulus, w)| w.apply(*modulus))
        .collect()
}

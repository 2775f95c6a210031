//! Series at the minimum of χ² for its order, and the search for shorter series.

use rodwave::modulus::MaxwellBranch;

use super::super::count;
use super::super::data::ModulusData;
use super::super::explained::Explained;
use super::super::fit::{ErrorScale, FitOptions, Scores};
use super::super::least_squares::{Effort, Minimum, minimise};
use super::super::non_negative::NonNegative;
use super::series::{Series, column, constant, grid, merged, target};
use super::{HOPELESS, Order};
use crate::directions::Directions;
use crate::vectors::dot;

/// Predicted decrease of χ² for which a further branch is added; the criteria require a decrease of
/// 4 or more.
const WORTHWHILE: f64 = 1.0;
/// Increase of χ², with moduli refitted, below which branches are removed without evaluating the
/// intermediate orders, because no criterion would keep these branches.
const FREE_OF_COST: f64 = 0.5;
const MOST_FURTHER_LINES: usize = 12;

/// Series at the minimum of χ² for its order.
#[derive(Debug, Clone)]
pub(in super::super) struct Refined {
    pub(in super::super) series: Series,
    pub(in super::super) minimum: Minimum,
}

impl Refined {
    /// Refines `series` in all its parameters.
    pub(super) fn of(data: &ModulusData, series: Series) -> Option<Self> {
        Self::with_effort(data, series, Effort::Search)
    }

    /// Refines the series to the full accuracy of the minimum.
    pub(super) fn settled(self, data: &ModulusData) -> Option<Self> {
        Self::with_effort(data, self.series, Effort::Full)
    }

    pub(super) fn with_effort(data: &ModulusData, series: Series, effort: Effort) -> Option<Self> {
        if series.is_empty() {
            return None;
        }
        let solid = series.equilibrium > 0.0;
        let model = series.model();
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

    /// Adds the spectral lines with the largest predicted decrease of χ², as long as this decrease
    /// is above [`WORTHWHILE`].
    pub(super) fn with_further_lines(mut self, data: &ModulusData, options: &FitOptions) -> Self {
        let grid = grid(data);
        for _ in 0..MOST_FURTHER_LINES {
            let residual = &self.minimum.linearised.residual;
            let scale = match options.error_scale {
                ErrorScale::FromResidual => self.minimum.chi_squared / count(data.values()),
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

    pub(super) fn order(&self, data: &ModulusData, options: &FitOptions) -> Order {
        let linearised = &self.minimum.linearised;
        let explains = Explained::can_explain(data, options.error_scale);
        let information = explains
            .then(|| Directions::of_law(linearised, self.minimum.at.len()))
            .flatten();
        let chi_squared = information.map_or_else(
            || linearised.residual.iter().map(|x| x * x).sum(),
            |information| {
                Explained::of(data, linearised, &information, options.error_scale).chi_squared
            },
        );
        let scores = Scores::of(
            options.error_scale,
            chi_squared,
            data.values(),
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

    /// Returns the best series with fewer branches. While χ² rises negligibly, up to `most`
    /// branches are removed at once, and the remaining series is refined. Otherwise one branch is
    /// removed: of all mergers and removals the two with the lowest χ² (only one if there are more
    /// than eight branches) are refined, and the better series is returned.
    pub(super) fn shorter(&self, data: &ModulusData, most: usize) -> Option<Self> {
        let mut series = self.series.clone();
        let start = self.minimum.chi_squared;
        let freedom = count(data.values());
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

    /// Adds a spring to a series without a spring and refines the series; the spring starts with
    /// half of the modulus of the slowest branch. Returns `None` if there is a spring already.
    pub(super) fn with_spring(&self, data: &ModulusData) -> Option<Self> {
        if self.series.equilibrium > 0.0 {
            return None;
        }
        let mut solid = self.series.clone();
        let slowest = solid.branches.last_mut()?;
        slowest.modulus *= 0.5;
        solid.equilibrium = slowest.modulus;
        Self::of(data, solid)
    }

    /// Returns the series without E∞, unless χ² rises by `HOPELESS` or more.
    pub(super) fn without_spring(&self, data: &ModulusData) -> Option<Self> {
        if self.series.equilibrium <= 0.0 || self.series.branches.is_empty() {
            return None;
        }
        let mut fluid = self.series.clone();
        fluid.equilibrium = 0.0;
        // the modulus of the spring is moved to the slowest branch, which can replace the spring
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

/// Returns all series with one branch fewer, by merger or removal, with their best moduli and χ²,
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
    // columns of the spring, of the branches and of the mergers
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
            // the merged branch replaces the two, in the order of relaxation times
            let merger = (0..n)
                .filter(|k| *k != i)
                .map(|k| if k + 1 == i { n + i } else { k + 1 });
            candidates.push(evaluate(spring.iter().copied().chain(merger).collect()));
        }
    }
    if !solid && n > 0 {
        // a relaxation far below the band may be replaced by a spring
        candidates.push(evaluate((0..n).collect()));
    }
    candidates.retain(|(_, series)| !series.is_empty());
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
    candidates
}

//! Profile likelihood: intervals that need not be symmetric or bounded.
//!
//! ```text
//! PL(θ_j) = min over the other parameters of χ² ,    95 %: PL(θ_j) - χ²_min <= 3.84
//! ```
//!
//! If the linearised error of a parameter is as large as the parameter, the interval of its profile
//! still gives the excluded values, for example that κ is below 1.4. Its coverage does not depend
//! on the coordinate, and the linear limits κ = 1 and σ_ref/m = 0 are inside the searched range, so
//! that an interval may contain them.
//!
//! # Validity
//! χ² is that of [`crate::Fit`] in the same problem: known noise of both histories, and the most
//! probable excitation, which is kept constant along the profile. Like the errors, the threshold is
//! scaled by the variance of the residual.
//!
//! Theory: `docs/theory/model-identification.md#profiles`.

mod widened;

use std::sync::Arc;

use crate::error::MaxwellidError;
use crate::fit::{Fit, Lowest, value};
use crate::identifiability::Verdict;
use crate::identification::Identification;
use crate::least_squares::{
    LeastSquares, Linearisation, ScaledDecomposition, minimise_to, sum_of_squares,
};
use crate::model::{RodModel, check_cell};
use crate::noise::{quiet_degrees, residual_variance};
use crate::selection::{Candidate, Contest, Ground, Prior};
use crate::specimen::SpecimenSensitivity;
use crate::test::RodTest;
use crate::vectors::dot;

/// Quantile of chi-square of one degree of freedom at 95 %.
pub(crate) const THRESHOLD: f64 = 3.841_458_820_694_124;

/// Width of the searched range divided by that of the range of the candidate, before the bounds of
/// the model limit it.
const WIDER: f64 = 3.0;

/// Profile of one parameter.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Profile {
    /// Name of the parameter.
    pub parameter: String,
    /// Value of the parameter at the minimum.
    pub value: f64,
    /// Lower end of the 95 % interval, if within the searched range.
    pub lower: Option<f64>,
    /// Upper end of the 95 % interval, if within the searched range.
    pub upper: Option<f64>,
    /// The searched range.
    pub range: (f64, f64),
    /// Verdict: identified, bounded on one side, or not identifiable.
    pub verdict: Verdict,
    /// Points of the profile, their values ascending.
    pub curve: Vec<ProfilePoint>,
    /// Sensitivity to length and density of the specimen.
    pub sensitivity: SpecimenSensitivity,
}

/// A point of a profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfilePoint {
    /// Value θ_j of the parameter.
    pub value: f64,
    /// PL(θ_j) - χ²_min; infinite where the model does not exist.
    pub rise: f64,
    /// Derivative of the profile with respect to θ_j. As the other parameters are at their minimum,
    /// it is ∂χ²/∂θ_j with the others constant.
    pub slope: f64,
}

impl Profile {
    /// Returns true if the interval contains `value`.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        self.lower.is_none_or(|lower| value >= lower)
            && self.upper.is_none_or(|upper| value <= upper)
    }

    /// The verdict with its reason.
    #[must_use]
    pub fn reason(&self) -> String {
        let (low, high) = self.range;
        match (self.lower, self.upper) {
            (Some(lower), Some(upper)) => {
                format!("values below {lower:.4} and above {upper:.4} are excluded at 95 %")
            }
            (Some(lower), None) => {
                format!(
                    "values below {lower:.4} are excluded at 95 %, but no value from there up to {high:.4} is"
                )
            }
            (None, Some(upper)) => {
                format!(
                    "values above {upper:.4} are excluded at 95 %, but no value from there down to {low:.4} is"
                )
            }
            (None, None) => {
                format!("no value from {low:.4} to {high:.4} is excluded at 95 %")
            }
        }
    }
}

/// Computes the profiles of all parameters of `candidate`, ln E first, at the lowest minimum found
/// from starts, special cases and the profiles themselves.
///
/// # Errors
/// [`MaxwellidError`], as for [`crate::selection::Selection::compare`].
pub fn profiles(
    candidate: &Candidate,
    tests: &[RodTest],
    cell: f64,
) -> Result<Vec<Profile>, MaxwellidError> {
    for test in tests {
        check_cell(cell, test.length)?;
    }
    let ground = Ground::of(tests)?;
    candidate.check(&ground)?;
    let prior = candidate.prior(ground.modulus, ground.duration);
    let contest = Contest::of(candidate, &prior, (tests, &ground.times), cell);
    let start = contest
        .search(ground.modulus, ground.duration, &[])?
        .ok_or(MaxwellidError::NoCandidate)?
        .probable;
    // a profile makes no statement about a solver, so that data of any solver are accepted
    let fit = Fit::of(Arc::clone(candidate.model()))
        .with_cell(cell)
        .round_trip()
        .also_from(start.minimum.parameters);
    Ok(fit.with_profiles(candidate, tests)?.1)
}

impl<M: RodModel + Clone> Fit<M> {
    /// Identifies the model from all `tests` together, with the profiles of its parameters over the
    /// ranges of `candidate`, in one and the same problem. If a profile finds a lower point, the
    /// fit continues from there. A point that is lower only with the excitation of the minimum, and
    /// by less than the rise at the ends of the intervals, is counted as part of the intervals. A
    /// parameter counts as identified if its interval is closed; its standard error is at least
    /// that of the longer half of the interval.
    ///
    /// # Errors
    /// The errors of [`Fit::to`]; [`MaxwellidError::InconsistentModel`] for a candidate with
    /// another number of parameters; [`MaxwellidError::NoiseUnknown`] without stated noise.
    pub fn with_profiles(
        &self,
        candidate: &Candidate,
        tests: &[RodTest],
    ) -> Result<(Identification<M>, Vec<Profile>), MaxwellidError> {
        let modulus = self.check_all(tests)?;
        let ground = Ground::of(tests)?;
        candidate.check(&ground)?;
        if let Some(test) = tests.iter().find(|test| test.noise().is_none()) {
            return Err(MaxwellidError::NoiseUnknown {
                test: test.name().to_owned(),
            });
        }
        let prior = candidate.prior(ground.modulus, ground.duration);
        let mut lowest = self.lowest(tests, modulus)?;
        let expected = lowest.problem.of_model();
        if prior.mean.len() != expected {
            return Err(MaxwellidError::InconsistentModel {
                model: candidate.name().to_owned(),
                what: "ranges including that of ln E",
                found: prior.mean.len(),
                expected,
            });
        }
        for _ in 0..RESTARTS {
            let found = walked(&lowest, candidate, &prior)?;
            let next = match &found.below {
                None => None,
                Some((_, below)) => {
                    let of_model = below.get(..expected).unwrap_or_default();
                    let next = self.lowest_from(tests, of_model, lowest.course.clone())?;
                    // a settled fit is preferred to an unsettled one within its interval
                    let allowance = match (lowest.has_settled(), next.has_settled()) {
                        (true, false) => found.threshold,
                        (false, true) => -found.threshold,
                        _ => 0.0,
                    };
                    let gain = value(&lowest.minimum) - value(&next.minimum);
                    (gain > allowance).then_some(next)
                }
            };
            match next {
                Some(next) => lowest = next,
                None => {
                    let concluded = self.concluded(lowest);
                    let identification = if found.is_lowest_within_interval() {
                        concluded.judged_by(&found.profiles)
                    } else {
                        concluded.unsettled()
                    };
                    return Ok((identification, found.profiles));
                }
            }
        }
        let found = walked(&lowest, candidate, &prior)?;
        Ok((self.concluded(lowest).unsettled(), found.profiles))
    }
}

/// Largest number of fits that continue from a lower point of a profile.
const RESTARTS: usize = 6;

/// χ² by which a point of a profile must be below the minimum to exceed rounding: about a fortieth
/// of the threshold.
const LOWER: f64 = 0.1;

/// A point below the minimum: its χ² relative to that of the minimum, and its parameters.
type Below = (f64, Vec<f64>);

/// Profiles at one minimum.
struct Walked {
    profiles: Vec<Profile>,
    /// The lowest point below the minimum.
    below: Option<Below>,
    /// Rise of χ² at the ends of the intervals.
    threshold: f64,
}

impl Walked {
    /// Returns true if no point is below the minimum by more than the intervals allow. A lower
    /// point that a fit with renewed excitation leaves again is counted as part of the intervals,
    /// which contain it.
    fn is_lowest_within_interval(&self) -> bool {
        let below = self.below.as_ref();
        below.is_none_or(|(rise, _)| *rise > -self.threshold)
    }
}

#[allow(
    clippy::indexing_slicing,
    reason = "prior, bounds, errors and names have an entry for each parameter, by `Candidate::check` and `check_counts`"
)]
fn walked<M: RodModel>(
    lowest: &Lowest<'_, M>,
    candidate: &Candidate,
    prior: &Prior,
) -> Result<Walked, MaxwellidError> {
    let Lowest {
        problem, minimum, ..
    } = lowest;
    let least = sum_of_squares(&minimum.linearisation.residual);
    let degrees = minimum
        .linearisation
        .residual
        .len()
        .saturating_sub(minimum.parameters.len())
        .max(1) as f64;
    let threshold = THRESHOLD * residual_variance(least, degrees, quiet_degrees(problem.tests));
    let wide = vec![f64::INFINITY; minimum.parameters.len() - prior.mean.len()];
    let deviations: Vec<f64> = prior.deviation.iter().copied().chain(wide).collect();
    let errors = standard_errors(&minimum.linearisation, &deviations);
    let names = candidate.model().parameter_names();
    let bounds = candidate.model().bounds();
    let of_model = &minimum.parameters[..names.len()];
    let specimen = candidate.model().specimen_sensitivities(of_model);
    let mut profiles = Vec::with_capacity(names.len());
    let mut below: Option<Below> = None;
    for (index, name) in names.iter().enumerate() {
        let (mean, deviation) = (prior.mean[index], prior.deviation[index]);
        let at = minimum.parameters[index];
        let walk = Walk {
            problem,
            index,
            least,
            threshold,
            minimum: &minimum.parameters,
            slope: slope(&minimum.linearisation, index),
            range: (
                (mean - 2.0 * WIDER * deviation)
                    .max(bounds[index].0)
                    .min(at),
                (mean + 2.0 * WIDER * deviation)
                    .min(bounds[index].1)
                    .max(at),
            ),
            step: (2.0 * errors[index]).min(deviation),
        };
        let (profile, lower) = walk.profile(name)?;
        profiles.push(Profile {
            sensitivity: specimen[index],
            ..profile
        });
        if let Some((rise, parameters)) = lower
            && below.as_ref().is_none_or(|(lowest, _)| rise < *lowest)
        {
            below = Some((rise, parameters));
        }
    }
    Ok(Walked {
        profiles,
        below,
        threshold,
    })
}

/// Standard errors from the linearised problem; those of the prior for undetermined parameters.
#[allow(
    clippy::indexing_slicing,
    reason = "a right singular vector has an entry for each deviation"
)]
fn standard_errors(linearisation: &Linearisation, deviations: &[f64]) -> Vec<f64> {
    let Some(svd) = ScaledDecomposition::new(linearisation, deviations) else {
        return deviations.to_vec();
    };
    deviations
        .iter()
        .enumerate()
        .map(|(index, deviation)| {
            let variance: f64 = svd
                .right
                .iter()
                .zip(&svd.singular_values)
                .map(|(vector, s)| (vector[index] / s.max(1.0)).powi(2))
                .sum();
            deviation * variance.sqrt()
        })
        .collect()
}

/// A least-squares problem in which one parameter is held: both of its bounds are the held value.
pub(crate) struct Held<'a> {
    pub(crate) problem: &'a dyn LeastSquares,
    pub(crate) index: usize,
    pub(crate) value: f64,
}

impl LeastSquares for Held<'_> {
    fn residual(&self, parameters: &[f64]) -> Option<Vec<f64>> {
        self.problem.residual(parameters)
    }

    fn linearisation(&self, parameters: &[f64]) -> Option<Linearisation> {
        self.problem.linearisation(parameters)
    }

    fn step_limits(&self) -> Vec<f64> {
        self.problem.step_limits()
    }

    fn bounds(&self) -> Vec<(f64, f64)> {
        let mut bounds = self.problem.bounds();
        if let Some(held) = bounds.get_mut(self.index) {
            *held = (self.value, self.value);
        }
        bounds
    }
}

struct Walk<'a> {
    problem: &'a dyn LeastSquares,
    index: usize,
    least: f64,
    /// Rise of χ² at the ends of the interval.
    threshold: f64,
    minimum: &'a [f64],
    /// Derivative of χ² at the minimum.
    slope: f64,
    range: (f64, f64),
    step: f64,
}

/// Derivative of the sum of squares with respect to the parameter at `index`.
fn slope(linearisation: &Linearisation, index: usize) -> f64 {
    let column = linearisation.jacobian.get(index);
    column.map_or(f64::NAN, |column| {
        2.0 * dot(column, &linearisation.residual)
    })
}

/// Largest number of steps to the end of an interval: secants of the root of the profile, which is
/// nearly linear, and a bisection at every third step.
const REFINEMENTS: usize = 24;

/// Remaining relative reduction of χ² at a point of the profile; in absolute terms this is less
/// than a thousandth if χ² is some hundreds.
const REDUCTION: f64 = 1e-6;

/// Tolerance of the profile about the threshold at an end: 0.02 of 3.84 are 0.0025 of a standard
/// error.
const NEAR: f64 = 0.02;

#[allow(
    clippy::indexing_slicing,
    reason = "`index` is that of one of the parameters at the minimum"
)]
impl Walk<'_> {
    /// Computes the profile, and the lowest of its points below the minimum with its rise.
    fn profile(&self, name: &str) -> Result<(Profile, Option<Below>), MaxwellidError> {
        let mut curve = vec![ProfilePoint {
            value: self.minimum[self.index],
            rise: 0.0,
            slope: self.slope,
        }];
        let mut below = None;
        let lower = self.end(-1.0, &mut curve, &mut below)?;
        let upper = self.end(1.0, &mut curve, &mut below)?;
        curve.sort_by(|a, b| a.value.total_cmp(&b.value));
        let profile = Profile {
            parameter: name.to_owned(),
            value: self.minimum[self.index],
            lower,
            upper,
            range: self.range,
            verdict: match (lower, upper) {
                (Some(_), Some(_)) => Verdict::Identified,
                (Some(lower), None) => Verdict::BoundedBelow(lower),
                (None, Some(upper)) => Verdict::BoundedAbove(upper),
                (None, None) => Verdict::NotIdentifiable,
            },
            curve,
            sensitivity: SpecimenSensitivity::default(),
        };
        Ok((profile, below))
    }

    /// The point of the profile at `value`, and the parameters there, found from the parameters
    /// `near`.
    fn at(
        &self,
        value: f64,
        near: &[f64],
    ) -> Result<(ProfilePoint, Option<Vec<f64>>), MaxwellidError> {
        let held = Held {
            problem: self.problem,
            index: self.index,
            value,
        };
        let found = minimise_to(&held, near, 0.0, REDUCTION)?;
        let point = found.as_ref().map_or(
            ProfilePoint {
                value,
                rise: f64::INFINITY,
                slope: f64::NAN,
            },
            |found| ProfilePoint {
                value,
                rise: sum_of_squares(&found.linearisation.residual) - self.least,
                slope: slope(&found.linearisation, self.index),
            },
        );
        Ok((point, found.map(|found| found.parameters)))
    }

    fn end(
        &self,
        sign: f64,
        curve: &mut Vec<ProfilePoint>,
        below: &mut Option<Below>,
    ) -> Result<Option<f64>, MaxwellidError> {
        let mut near = self.minimum.to_vec();
        let limit = if sign < 0.0 {
            self.range.0
        } else {
            self.range.1
        };
        let (mut inside, mut step) = ((self.minimum[self.index], 0.0_f64), self.step);
        loop {
            let next = inside.0 + sign * step;
            let is_last = (next - limit) * sign >= 0.0;
            let value = if is_last { limit } else { next };
            if (value - inside.0) * sign <= 0.0 {
                return Ok(None);
            }
            let (point, found) = self.at(value, &near)?;
            let rise = point.rise;
            curve.push(point);
            if rise < -LOWER
                && below.as_ref().is_none_or(|(least, _)| rise < *least)
                && let Some(all) = &found
            {
                *below = Some((rise, all.clone()));
            }
            if rise > self.threshold {
                return self.refine(inside, (value, rise), &near, curve).map(Some);
            }
            if is_last {
                return Ok(None);
            }
            inside = (value, rise);
            near = found.unwrap_or(near);
            step *= 1.5;
        }
    }

    /// Finds the crossing of the threshold between a point inside and one outside.
    fn refine(
        &self,
        mut inside: (f64, f64),
        mut outside: (f64, f64),
        near: &[f64],
        curve: &mut Vec<ProfilePoint>,
    ) -> Result<f64, MaxwellidError> {
        let root = |rise: f64| rise.clamp(0.0, 1e6).sqrt();
        let mut value = outside.0;
        for refinement in 1..=REFINEMENTS {
            let (low, high) = (root(inside.1), root(outside.1));
            let share = if refinement % 3 == 0 {
                0.5
            } else {
                (self.threshold.sqrt() - low) / (high - low)
            };
            value = inside.0 + share * (outside.0 - inside.0);
            let (point, _) = self.at(value, near)?;
            let rise = point.rise;
            curve.push(point);
            if (rise - self.threshold).abs() < NEAR {
                break;
            }
            if rise > self.threshold {
                outside = (value, rise);
            } else {
                inside = (value, rise);
            }
        }
        Ok(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// r = (a - 1, a e^b/2).
    struct Product;

    impl LeastSquares for Product {
        fn residual(&self, t: &[f64]) -> Option<Vec<f64>> {
            Some(vec![t[0] - 1.0, 0.5 * (t[0] * t[1].exp())])
        }

        fn linearisation(&self, t: &[f64]) -> Option<Linearisation> {
            Some(Linearisation {
                residual: self.residual(t)?,
                jacobian: vec![
                    vec![1.0, 0.5 * t[1].exp()],
                    vec![0.0, 0.5 * t[0] * t[1].exp()],
                ],
            })
        }

        fn step_limits(&self) -> Vec<f64> {
            vec![1.0, 1.0]
        }
    }

    /// min over a of (a-1)² + a² g², g = e^b/2, is g²/(1+g²) < 1: no b is excluded. With ten times
    /// the weights, values above the b with 100 g²/(1+g²) = 3.84 are excluded.
    #[test]
    fn a_logarithm_is_bounded_above_or_not_at_all() {
        struct Weighted(f64);
        impl LeastSquares for Weighted {
            fn residual(&self, t: &[f64]) -> Option<Vec<f64>> {
                Some(Product.residual(t)?.iter().map(|r| self.0 * r).collect())
            }
            fn linearisation(&self, t: &[f64]) -> Option<Linearisation> {
                let mut found = Product.linearisation(t)?;
                found.residual = self.residual(t)?;
                for value in found.jacobian.iter_mut().flatten() {
                    *value *= self.0;
                }
                Some(found)
            }
            fn step_limits(&self) -> Vec<f64> {
                vec![1.0, 1.0]
            }
        }
        let walk = |problem: &dyn LeastSquares| {
            Walk {
                problem,
                index: 1,
                least: 0.0,
                threshold: THRESHOLD,
                minimum: &[1.0, -12.0],
                slope: 0.0,
                range: (-14.0, 4.0),
                step: 1.0,
            }
            .profile("b")
            .unwrap()
            .0
        };
        assert_eq!(walk(&Weighted(1.0)).verdict, Verdict::NotIdentifiable);
        let bounded = walk(&Weighted(10.0));
        let g = (THRESHOLD / (100.0 - THRESHOLD)).sqrt();
        let expected = (2.0 * g).ln();
        let Verdict::BoundedAbove(upper) = bounded.verdict else {
            panic!("{:?}", bounded.verdict)
        };
        // a tolerance of 0.02 of 3.84 in the profile, which is 0.005 in b
        assert!((upper - expected).abs() < 0.006, "{upper} {expected}");
        assert!(bounded.contains(-13.0) && !bounded.contains(0.0));
        let closed = |b: f64| 100.0 / (1.0 + 4.0 * (-2.0 * b).exp());
        let curve = bounded.smooth_curve();
        assert!(curve.len() > 25);
        // the curve that figures show; its points are up to two units of b apart
        for (b, rise) in curve.into_iter().filter(|(b, _)| closed(*b) < 12.0) {
            let tolerance = 0.025 * closed(b).max(1.0);
            assert!(
                (rise - closed(b)).abs() < tolerance,
                "{b}: {rise} {}",
                closed(b)
            );
        }
    }
}

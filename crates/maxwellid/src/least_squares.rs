//! Damped least squares (Levenberg-Marquardt) for a few parameters and many residuals.
//!
//! Each iteration computes one singular value decomposition of the scaled Jacobian J D = U S Vᵀ; a
//! step for any damping λ is then D V S (S² + λ)⁻¹ Uᵀ (-r). The scales D are the largest changes of
//! each parameter in one iteration. In these units a poorly determined direction needs little
//! damping to stay within its limit, so that this damping does not slow the well-determined
//! directions; scaling by column norms would slow them. Termination is a value with a reason, never
//! an error.

use faer::Mat;

use crate::error::MaxwellidError;

/// Residuals and their Jacobian at one point.
#[derive(Debug, Clone)]
pub(crate) struct Linearisation {
    /// r, length n.
    pub(crate) residual: Vec<f64>,
    /// ∂r/∂θ, one column of length n for each parameter.
    pub(crate) jacobian: Vec<Vec<f64>>,
}

/// A nonlinear least-squares problem; its methods return `None` where the model does not exist.
pub(crate) trait LeastSquares {
    fn residual(&self, parameters: &[f64]) -> Option<Vec<f64>>;
    fn linearisation(&self, parameters: &[f64]) -> Option<Linearisation>;
    /// Largest change of each parameter in one iteration.
    fn step_limits(&self) -> Vec<f64>;
    /// Lower and upper bound of each parameter.
    fn bounds(&self) -> Vec<(f64, f64)> {
        vec![(f64::NEG_INFINITY, f64::INFINITY); self.step_limits().len()]
    }
}

/// Numbers of solutions of the direct problems of all tests.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Evaluations {
    /// Solutions without derivatives.
    pub residuals: usize,
    /// Solutions with derivatives with respect to all parameters.
    pub linearisations: usize,
}

impl std::ops::AddAssign for Evaluations {
    fn add_assign(&mut self, other: Self) {
        self.residuals += other.residuals;
        self.linearisations += other.linearisations;
    }
}

/// Reason for the end of an iteration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Termination {
    /// A step within the limits would reduce the sum of squares by less than a fraction of it:
    /// 1e-10, or 1e-5 for a whitened residual, at which no parameter changes by more than some
    /// hundredths of its standard error.
    NoReductionLeft,
    /// The step is below 1e-9 of its limit in every parameter.
    StepNegligible,
    /// The residual is at the level of rounding.
    ResidualIsRounding,
    /// No step, however short, reduces the sum of squares.
    NoDescent,
    /// End as [`Self::NoReductionLeft`], but with a parameter at a bound beyond which the sum of
    /// squares still falls.
    AtBound,
    /// The improvement of the parameters is below the pre-assigned tolerance; only with
    /// [`crate::Method::Historical`].
    ImprovementBelowTolerance,
    /// The limit of iterations was reached.
    OutOfIterations,
}

impl Termination {
    /// Returns true if the parameters are a minimum within the stated tolerances.
    #[must_use]
    pub fn was_successful(self) -> bool {
        !matches!(self, Self::AtBound | Self::OutOfIterations)
    }
}

impl std::fmt::Display for Termination {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::NoReductionLeft => "converged: the sum of squares cannot be reduced further",
            Self::StepNegligible => "converged: the step is negligible",
            Self::ResidualIsRounding => "converged: the residual is at the level of rounding",
            Self::NoDescent => "converged: no shorter step reduces the sum of squares",
            Self::ImprovementBelowTolerance => "converged: the improvement is below the tolerance",
            Self::AtBound => "stopped at a bound: the sum of squares still falls beyond it",
            Self::OutOfIterations => "not converged: out of iterations",
        })
    }
}

/// Result of an iteration.
#[derive(Debug, Clone)]
pub(crate) struct Minimum {
    pub(crate) parameters: Vec<f64>,
    pub(crate) linearisation: Linearisation,
    pub(crate) iterations: usize,
    pub(crate) evaluations: Evaluations,
    pub(crate) termination: Termination,
}

/// Distance of a start from a minimum, in standard errors, below which a search from this start is
/// assumed to lead to the same minimum.
const OF_ONE_MINIMUM: f64 = 1.0;

impl Minimum {
    /// Largest change of the parameters of a white problem from `before`, in standard errors, along
    /// its singular directions.
    pub(crate) fn movement(&self, before: &[f64]) -> f64 {
        let ones = vec![1.0; before.len()];
        let Some(svd) = ScaledDecomposition::new(&self.linearisation, &ones) else {
            return f64::INFINITY;
        };
        let change: Vec<f64> = self
            .parameters
            .iter()
            .zip(before)
            .map(|(a, b)| a - b)
            .collect();
        svd.right
            .iter()
            .zip(&svd.singular_values)
            .map(|(vector, s)| {
                let along: f64 = vector.iter().zip(&change).map(|(v, c)| v * c).sum();
                (along * s).abs()
            })
            .fold(0.0, f64::max)
    }

    /// Change of the residual for a `change` of the parameters, from its Jacobian.
    pub(crate) fn seen_by_residual(&self, change: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.linearisation.residual.len()];
        for (column, change) in self.linearisation.jacobian.iter().zip(change) {
            for (sum, entry) in sum.iter_mut().zip(column) {
                *sum += change * entry;
            }
        }
        sum
    }

    /// Next start of an iteration in which the problem is re-estimated after every minimisation:
    /// the parameters at which start and minimum would coincide, by the secant through this
    /// minimisation, from `start`, and the `last` one, given by its start and its minimum. Lengths
    /// are in standard errors (Anderson 1965, of depth one). Returns the minimum if there is no
    /// `last` minimisation.
    pub(crate) fn meeting(&self, start: &[f64], last: Option<(&[f64], &[f64])>) -> Vec<f64> {
        let end = &self.parameters;
        let Some((last_start, last_end)) = last else {
            return end.clone();
        };
        let change = |from: &[f64], to: &[f64]| -> Vec<f64> {
            to.iter().zip(from).map(|(to, from)| to - from).collect()
        };
        let step = change(start, end);
        let bend = change(&change(last_start, last_end), &step);
        let [step, bend] = [step, bend].map(|change| self.seen_by_residual(&change));
        let product: f64 = step.iter().zip(&bend).map(|(s, b)| s * b).sum();
        let square = sum_of_squares(&bend);
        if square <= 0.0 {
            return end.clone();
        }
        let factor = (product / square).clamp(SECANT.0, SECANT.1);
        end.iter()
            .zip(last_end)
            .map(|(e, b)| e - factor * (e - b))
            .collect()
    }

    /// Returns true if a search from `start` would lead to this minimum, judged by the distance of
    /// `start`.
    pub(crate) fn is_reached_from(&self, start: &[f64]) -> bool {
        self.movement(start) < OF_ONE_MINIMUM
    }
}

/// Limits of the factor on the change between two minima in [`Minimum::meeting`]. An iteration
/// whose error falls to three quarters in each step has a factor of -3, one whose error changes
/// sign and grows beyond all limits has a factor of 1.
const SECANT: (f64, f64) = (-3.0, 1.0);

pub(crate) fn sum_of_squares(residual: &[f64]) -> f64 {
    residual.iter().map(|r| r * r).sum()
}

/// Singular value decomposition of a Jacobian whose columns are multiplied by `scales`.
pub(crate) struct ScaledDecomposition {
    /// Singular values, descending.
    pub(crate) singular_values: Vec<f64>,
    /// Right singular vectors: `right[i]` belongs to `singular_values[i]`.
    pub(crate) right: Vec<Vec<f64>>,
    /// Uᵀ r.
    pub(crate) projected: Vec<f64>,
}

impl ScaledDecomposition {
    #[allow(
        clippy::indexing_slicing,
        reason = "the Jacobian has a column for each scale, as long as the residual"
    )]
    pub(crate) fn new(linearisation: &Linearisation, scales: &[f64]) -> Option<Self> {
        let rows = linearisation.residual.len();
        let columns = scales.len();
        let directions = rows.min(columns);
        let scaled = Mat::from_fn(rows, columns, |i, j| {
            linearisation.jacobian[j][i] * scales[j]
        });
        let svd = scaled.thin_svd().ok()?;
        let values = svd.S().column_vector();
        let (left, right) = (svd.U(), svd.V());
        Some(Self {
            singular_values: (0..directions).map(|k| values[k]).collect(),
            right: (0..directions)
                .map(|k| (0..columns).map(|j| right[(j, k)]).collect())
                .collect(),
            projected: (0..directions)
                .map(|k| {
                    linearisation
                        .residual
                        .iter()
                        .enumerate()
                        .map(|(i, r)| left[(i, k)] * r)
                        .sum()
                })
                .collect(),
        })
    }
}

const ITERATIONS: usize = 200;
/// Predicted relative reduction of the sum of squares below which an iteration ends.
const REDUCTION: f64 = 1e-10;
/// Multiple of the `reduction` of [`minimise_to`] below which no shorter step is tried, because the
/// grid makes the sum of squares rough by this amount.
const OF_ROUGHNESS: f64 = 10.0;
/// Multiple of the `reduction` of [`minimise_to`] below which a rejected step is assumed to be near
/// a minimum.
const NEAR: f64 = 100.0;
/// Smallest damping that has an effect, as a share of the smallest square of a singular value.
const LEAST_EFFECT: f64 = 0.01;
const STEP: f64 = 1e-9;
const SMALLEST_DAMPING: f64 = 1e-12;

/// Minimises from `start`. `rounding` is the sum of squares due to rounding alone.
pub(crate) fn minimise(
    problem: &dyn LeastSquares,
    start: &[f64],
    rounding: f64,
) -> Result<Option<Minimum>, MaxwellidError> {
    minimise_to(problem, start, rounding, REDUCTION)
}

/// Minimises as [`minimise`] does, until the remaining relative reduction of the sum of squares is
/// below `reduction`.
pub(crate) fn minimise_to(
    problem: &dyn LeastSquares,
    start: &[f64],
    rounding: f64,
    reduction: f64,
) -> Result<Option<Minimum>, MaxwellidError> {
    let limits = problem.step_limits();
    let bounds = problem.bounds();
    let mut parameters = within(start, &bounds);
    let Some(mut here) = problem.linearisation(&parameters) else {
        return Ok(None);
    };
    let mut evaluations = Evaluations {
        residuals: 0,
        linearisations: 1,
    };
    let mut damping = 0.0_f64;
    let mut value = sum_of_squares(&here.residual);
    let mut termination = Termination::OutOfIterations;
    let mut iterations = 0;
    'outer: while iterations < ITERATIONS {
        iterations += 1;
        if value <= rounding {
            termination = Termination::ResidualIsRounding;
            break;
        }
        let (free, held) = free_directions(&here, &parameters, &limits, &bounds);
        let Some(svd) = ScaledDecomposition::new(&here, &free) else {
            return Err(MaxwellidError::Decomposition {
                iteration: iterations,
            });
        };
        // the smallest damping that is significant for the best-determined direction
        let largest = svd.singular_values.first().copied().unwrap_or(0.0);
        let no_reduction = if held {
            Termination::AtBound
        } else {
            Termination::NoReductionLeft
        };
        let smallest_damping = SMALLEST_DAMPING * largest * largest;
        if largest <= 0.0 {
            termination = no_reduction;
            break;
        }
        damping = damping.max(smallest_damping);
        let mut rejected = false;
        // fraction of the damped step that is tried
        let mut part = 1.0;
        loop {
            let step: Vec<f64> = damped_step(&svd, &free, damping)
                .into_iter()
                .map(|p| part * p)
                .collect();
            let within_limits = step.iter().zip(&limits).all(|(p, limit)| p.abs() <= *limit);
            if !within_limits {
                damping *= 4.0;
                continue;
            }
            // exact for a quadratic function
            let predicted = svd.predicted_reduction(damping) * part * (2.0 - part);
            if !rejected && predicted < reduction * value {
                termination = no_reduction;
                break 'outer;
            }
            let shortest = step
                .iter()
                .zip(&limits)
                .all(|(p, limit)| p.abs() < STEP * limit);
            if shortest || part < 1.0 && predicted < OF_ROUGHNESS * reduction * value {
                termination = if rejected {
                    Termination::NoDescent
                } else {
                    Termination::StepNegligible
                };
                break 'outer;
            }
            let beyond: Vec<f64> = parameters.iter().zip(&step).map(|(t, p)| t + p).collect();
            let trial = within(&beyond, &bounds);
            // the first trial mostly succeeds, so its residual is computed together with the
            // derivatives
            let of_residual = rejected
                .then(|| {
                    evaluations.residuals += 1;
                    problem.residual(&trial)
                })
                .map(|residual| residual.map(|r| sum_of_squares(&r)));
            let may_succeed =
                of_residual.is_none_or(|reached| reached.is_some_and(|reached| reached < value));
            evaluations.linearisations += usize::from(may_succeed);
            let next = may_succeed.then(|| problem.linearisation(&trial)).flatten();
            let of_next = next.as_ref().map(|next| sum_of_squares(&next.residual));
            let reached = of_next.or(of_residual.flatten());
            let is_better = reached.is_some_and(|reached| reached < value);
            let Some(next) = next.filter(|_| is_better) else {
                match reached {
                    // if little reduction was predicted, the direction is right but the step is too
                    // long: the next one ends at the minimum of the parabola through both values
                    // and the slope
                    Some(reached) if part < 1.0 || predicted < NEAR * reduction * value => {
                        let shorter = predicted / (reached - value + 2.0 * predicted);
                        part *= shorter.clamp(0.1, 0.5);
                    }
                    // a damping far below the square of the smallest singular value has no effect
                    _ => damping = (8.0 * damping).max(LEAST_EFFECT * svd.smallest_square()),
                }
                rejected = true;
                continue;
            };
            let reached = sum_of_squares(&next.residual);
            let gain = (value - reached) / predicted;
            if gain > 0.75 {
                damping /= 10.0;
            } else if gain < 0.25 {
                damping *= 3.0;
            }
            parameters = trial;
            value = reached;
            here = next;
            break;
        }
    }
    Ok(Some(Minimum {
        parameters,
        linearisation: here,
        iterations,
        evaluations,
        termination,
    }))
}

pub(crate) fn within(parameters: &[f64], bounds: &[(f64, f64)]) -> Vec<f64> {
    parameters
        .iter()
        .zip(bounds)
        .map(|(t, (low, high))| t.clamp(*low, *high))
        .collect()
}

/// Step limits, 0 for a parameter at a bound beyond which the sum of squares falls; and true if the
/// lower and the upper bound of such a parameter differ.
fn free_directions(
    here: &Linearisation,
    parameters: &[f64],
    limits: &[f64],
    bounds: &[(f64, f64)],
) -> (Vec<f64>, bool) {
    let mut held = false;
    let free = limits
        .iter()
        .zip(parameters.iter().zip(bounds))
        .zip(&here.jacobian)
        .map(|((limit, (t, (low, high))), column)| {
            if t > low && t < high {
                return *limit;
            }
            let gradient: f64 = column.iter().zip(&here.residual).map(|(j, r)| j * r).sum();
            if (t <= low && gradient > 0.0) || (t >= high && gradient < 0.0) {
                held |= low < high;
                0.0
            } else {
                *limit
            }
        })
        .collect();
    (free, held)
}

impl ScaledDecomposition {
    /// Square of the smallest singular value above 0.
    fn smallest_square(&self) -> f64 {
        let above = self.singular_values.iter().filter(|s| **s > 0.0);
        above.fold(f64::INFINITY, |least, s| least.min(s * s))
    }

    /// Reduction of |r|² predicted by the linear model for the step with damping λ.
    fn predicted_reduction(&self, damping: f64) -> f64 {
        self.singular_values
            .iter()
            .zip(&self.projected)
            .map(|(s, u)| {
                let kept = damping / (s * s + damping);
                u * u * (1.0 - kept * kept)
            })
            .sum()
    }
}

#[allow(
    clippy::indexing_slicing,
    reason = "a right singular vector has an entry for each scale of the decomposition"
)]
fn damped_step(svd: &ScaledDecomposition, scales: &[f64], damping: f64) -> Vec<f64> {
    let weights: Vec<f64> = svd
        .singular_values
        .iter()
        .zip(&svd.projected)
        .map(|(s, u)| -s / (s * s + damping) * u)
        .collect();
    scales
        .iter()
        .enumerate()
        .map(|(j, scale)| {
            svd.right
                .iter()
                .zip(&weights)
                .map(|(vector, weight)| vector[j] * weight)
                .sum::<f64>()
                * scale
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// r = (10 (θ₂ - θ₁²), 1 - θ₁), Rosenbrock's valley, with a third parameter that has no effect.
    struct Valley;

    impl LeastSquares for Valley {
        fn residual(&self, t: &[f64]) -> Option<Vec<f64>> {
            (t[0].abs() < 50.0).then(|| vec![10.0 * (t[1] - t[0] * t[0]), 1.0 - t[0]])
        }

        fn linearisation(&self, t: &[f64]) -> Option<Linearisation> {
            Some(Linearisation {
                residual: self.residual(t)?,
                jacobian: vec![vec![-20.0 * t[0], -1.0], vec![10.0, 0.0], vec![0.0, 0.0]],
            })
        }

        fn step_limits(&self) -> Vec<f64> {
            vec![1.0, 1.0, 1.0]
        }
    }

    #[test]
    fn finds_the_bottom_of_the_valley_and_leaves_a_dead_parameter_alone() {
        let minimum = minimise(&Valley, &[-1.2, 1.0, 7.0], 1e-28)
            .unwrap()
            .unwrap();
        assert!(
            minimum.termination.was_successful(),
            "{:?}",
            minimum.termination
        );
        // the iteration ends where the residual is at the rounding level of 1e-14
        assert!((minimum.parameters[0] - 1.0).abs() < 1e-12);
        assert!((minimum.parameters[1] - 1.0).abs() < 1e-12);
        assert!((minimum.parameters[2] - 7.0).abs() < 1e-12);
    }

    #[test]
    fn a_start_outside_the_model_is_no_minimum() {
        assert!(minimise(&Valley, &[60.0, 0.0, 0.0], 0.0).unwrap().is_none());
    }

    /// Rosenbrock's valley with a bound at θ₁ = 0.5.
    struct Walled;

    impl LeastSquares for Walled {
        fn residual(&self, t: &[f64]) -> Option<Vec<f64>> {
            Valley.residual(t)
        }

        fn linearisation(&self, t: &[f64]) -> Option<Linearisation> {
            Valley.linearisation(t)
        }

        fn step_limits(&self) -> Vec<f64> {
            Valley.step_limits()
        }

        fn bounds(&self) -> Vec<(f64, f64)> {
            vec![(-2.0, 0.5), (-9.0, 9.0), (-9.0, 9.0)]
        }
    }

    #[test]
    fn a_bound_is_reached_and_named() {
        let minimum = minimise(&Walled, &[-1.2, 1.0, 7.0], 1e-28)
            .unwrap()
            .unwrap();
        assert_eq!(minimum.termination, Termination::AtBound);
        assert!(!minimum.termination.was_successful());
        // at the bound the minimum is at the bottom of the valley, θ₂ = θ₁²; tolerance: the
        // iteration ends when the predicted relative reduction is below 1e-10
        assert!((minimum.parameters[0] - 0.5).abs() < 1e-15);
        assert!((minimum.parameters[1] - 0.25).abs() < 1e-5);
    }

    /// A line through noisy data: the minimum is that of the normal equations.
    struct Line;

    impl LeastSquares for Line {
        fn residual(&self, t: &[f64]) -> Option<Vec<f64>> {
            let data = [0.1, 0.9, 2.2, 2.8];
            Some(
                data.iter()
                    .zip([0.0, 1.0, 2.0, 3.0])
                    .map(|(y, x)| y - t[0] - t[1] * x)
                    .collect(),
            )
        }

        fn linearisation(&self, t: &[f64]) -> Option<Linearisation> {
            Some(Linearisation {
                residual: self.residual(t)?,
                jacobian: vec![vec![-1.0; 4], vec![0.0, -1.0, -2.0, -3.0]],
            })
        }

        fn step_limits(&self) -> Vec<f64> {
            vec![100.0, 100.0]
        }
    }

    #[test]
    fn a_linear_problem_is_solved_as_by_the_normal_equations() {
        let minimum = minimise(&Line, &[50.0, -3.0], 0.0).unwrap().unwrap();
        // slope Σ(x - 1.5)(y - 1.5)/Σ(x - 1.5)² = 4.7/5, intercept 1.5 - 1.5 slope
        assert!(
            (minimum.parameters[1] - 0.94).abs() < 1e-9,
            "{:?}",
            minimum.parameters
        );
        assert!((minimum.parameters[0] - 0.09).abs() < 1e-9);
        assert_eq!(minimum.termination, Termination::NoReductionLeft);
    }

    /// Checks, for the iteration x -> a x + 1, that the secant through the steps from 0 to 1 and
    /// from 1 to a + 1 gives the fixed point 1/(1 - a), unless the limit of the factor is reached.
    #[test]
    fn two_renewals_tell_where_an_iteration_of_straight_steps_ends() {
        let meeting = |end: f64, last: Option<(&[f64], &[f64])>| {
            let minimum = Minimum {
                parameters: vec![end],
                // a standard error of one
                linearisation: Linearisation {
                    residual: vec![0.0],
                    jacobian: vec![vec![1.0]],
                },
                iterations: 1,
                evaluations: Evaluations::default(),
                termination: Termination::NoReductionLeft,
            };
            minimum.meeting(&[1.0], last)[0]
        };
        let last = Some((&[0.0][..], &[1.0][..]));
        for (slope, expected) in [
            (0.5, 2.0),
            (-1.0, 0.5),
            (-0.5, 2.0 / 3.0),
            (0.7, 10.0 / 3.0),
            // at the limit: the last change, 0.9, is continued three times instead of nine times
            (0.9, 4.6),
        ] {
            let found = meeting(slope + 1.0, last);
            assert!((found - expected).abs() < 1e-12, "{slope}: {found}");
        }
        // there is no secant after a single step or after two equal steps
        assert!((meeting(1.9, None) - 1.9).abs() < 1e-15);
        assert!((meeting(2.0, last) - 2.0).abs() < 1e-15);
    }
}

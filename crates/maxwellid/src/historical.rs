//! Minimisation of the paper: three iterations of Robbins and Monro, then Davidon, Fletcher and
//! Powell (Ödeen 1993, paper D, eq. 14 and what follows it; the paper prints
//! "Davidon-Power-Fletcher").
//!
//! As printed, p ← p - (1/m) ∂H/∂p on the printed parameters, the first stage diverges or
//! stagnates: the curvatures of H span 33 decades. Here it uses the coordinates of
//! [`crate::least_squares`], each divided by its largest change per iteration, and the
//! gain a/m with a such that the first step is half of that change. This makes it applicable for
//! comparison; it is slower than damped least squares because it uses a gradient instead of a
//! Jacobian.
//!
//! Theory: `docs/theory/identification.md#minimisation`.

use crate::error::MaxwellidError;
use crate::least_squares::{
    Evaluations, LeastSquares, Linearisation, Minimum, Termination, sum_of_squares, within,
};

/// Number of Robbins-Monro iterations before the change of method.
const ROBBINS_MONRO: u32 = 3;

/// Length of the first step divided by the largest change of the parameters.
const FIRST_STEP: f64 = 0.5;

/// Pre-assigned tolerance of the rate of improvement: largest change of a parameter in one
/// iteration divided by its limit.
const TOLERANCE: f64 = 1e-7;

const ITERATIONS: usize = 300;

/// Fraction of the predicted descent that a step must achieve.
const SUFFICIENT_DESCENT: f64 = 1e-4;

/// Number of halvings of a step before the line search is given up.
const HALVINGS: u32 = 40;

/// Minimises from `start`; `None` if the model does not exist at `start`.
pub(crate) fn minimise(
    problem: &dyn LeastSquares,
    start: &[f64],
    rounding: f64,
) -> Result<Option<Minimum>, MaxwellidError> {
    let Some(mut search) = Search::new(problem, start) else {
        return Ok(None);
    };
    let mut iterations = 0;
    let first_gain = FIRST_STEP / norm(&search.gradient);
    for m in 1..=ROBBINS_MONRO {
        iterations += 1;
        let mut gain = first_gain / f64::from(m);
        // damping: a step is halved if it leaves the domain of the model or does not reduce the sum
        // of squares
        for _ in 0..HALVINGS {
            let step: Vec<f64> = search.gradient.iter().map(|g| -gain * g).collect();
            if gain.is_finite() && search.moved(&step, search.value) {
                break;
            }
            gain *= 0.5;
        }
    }
    let mut inverse = Inverse::unit(search.gradient.len(), FIRST_STEP / norm(&search.gradient));
    let termination = loop {
        if search.value <= rounding {
            break Termination::ResidualIsRounding;
        }
        if iterations >= ITERATIONS {
            break Termination::OutOfIterations;
        }
        iterations += 1;
        let mut step: Vec<f64> = inverse.times(&search.gradient).iter().map(|d| -d).collect();
        let longest = step.iter().fold(0.0_f64, |top, s| top.max(s.abs()));
        if longest > 1.0 {
            step.iter_mut().for_each(|s| *s /= longest);
        }
        if longest < TOLERANCE {
            break Termination::ImprovementBelowTolerance;
        }
        let (before, gradient) = (search.position.clone(), search.gradient.clone());
        let slope: f64 = gradient.iter().zip(&step).map(|(g, s)| g * s).sum();
        let mut found = false;
        for _ in 0..HALVINGS {
            let share = step.iter().zip(&gradient).map(|(s, g)| s * g).sum::<f64>() / slope;
            if search.moved(&step, search.value + SUFFICIENT_DESCENT * share * slope) {
                found = true;
                break;
            }
            step.iter_mut().for_each(|s| *s *= 0.5);
        }
        if !found {
            break Termination::NoDescent;
        }
        let made: Vec<f64> = search
            .position
            .iter()
            .zip(&before)
            .map(|(a, b)| a - b)
            .collect();
        if made.iter().all(|s| s.abs() < TOLERANCE) {
            break Termination::ImprovementBelowTolerance;
        }
        let bend: Vec<f64> = search
            .gradient
            .iter()
            .zip(&gradient)
            .map(|(a, b)| a - b)
            .collect();
        inverse.update(&made, &bend);
    };
    Ok(Some(Minimum {
        parameters: search.parameters(),
        linearisation: search.here,
        iterations,
        evaluations: search.evaluations,
        termination,
    }))
}

/// A point of the scaled space with its gradient.
struct Search<'a> {
    problem: &'a dyn LeastSquares,
    limits: Vec<f64>,
    bounds: Vec<(f64, f64)>,
    /// θ divided by the step limits
    position: Vec<f64>,
    here: Linearisation,
    value: f64,
    /// ∂H/∂(θ/limit)
    gradient: Vec<f64>,
    evaluations: Evaluations,
}

impl<'a> Search<'a> {
    fn new(problem: &'a dyn LeastSquares, start: &[f64]) -> Option<Self> {
        let limits = problem.step_limits();
        let bounds = problem.bounds();
        let start = within(start, &bounds);
        let here = problem.linearisation(&start)?;
        Some(Self {
            problem,
            position: start.iter().zip(&limits).map(|(t, l)| t / l).collect(),
            value: sum_of_squares(&here.residual),
            gradient: gradient(&here, &limits),
            limits,
            bounds,
            here,
            evaluations: Evaluations {
                residuals: 0,
                linearisations: 1,
            },
        })
    }

    fn parameters(&self) -> Vec<f64> {
        self.position
            .iter()
            .zip(&self.limits)
            .map(|(x, l)| x * l)
            .collect()
    }

    /// Makes the step if the sum of squares after it is below `ceiling`.
    fn moved(&mut self, step: &[f64], ceiling: f64) -> bool {
        let beyond: Vec<f64> = self
            .position
            .iter()
            .zip(step)
            .zip(&self.limits)
            .map(|((x, s), l)| (x + s) * l)
            .collect();
        let trial = within(&beyond, &self.bounds);
        self.evaluations.residuals += 1;
        let lower = self
            .problem
            .residual(&trial)
            .is_some_and(|r| sum_of_squares(&r) < ceiling);
        if !lower {
            return false;
        }
        self.evaluations.linearisations += 1;
        let Some(next) = self.problem.linearisation(&trial) else {
            return false;
        };
        self.position = trial.iter().zip(&self.limits).map(|(t, l)| t / l).collect();
        self.value = sum_of_squares(&next.residual);
        self.gradient = gradient(&next, &self.limits);
        self.here = next;
        true
    }
}

fn gradient(here: &Linearisation, limits: &[f64]) -> Vec<f64> {
    here.jacobian
        .iter()
        .zip(limits)
        .map(|(column, limit)| {
            let product: f64 = column.iter().zip(&here.residual).map(|(j, r)| j * r).sum();
            2.0 * limit * product
        })
        .collect()
}

fn norm(vector: &[f64]) -> f64 {
    sum_of_squares(vector).sqrt()
}

/// Inverse of the Hessian by the update of Davidon, Fletcher and Powell.
struct Inverse {
    rows: Vec<Vec<f64>>,
}

impl Inverse {
    fn unit(size: usize, scale: f64) -> Self {
        Self {
            rows: (0..size)
                .map(|i| {
                    (0..size)
                        .map(|j| if i == j { scale } else { 0.0 })
                        .collect()
                })
                .collect(),
        }
    }

    fn times(&self, vector: &[f64]) -> Vec<f64> {
        self.rows
            .iter()
            .map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum())
            .collect()
    }

    /// Updates G ← G + s sᵀ/(sᵀy) - (G y)(G y)ᵀ/(yᵀG y); unchanged if the curvature sᵀy along the
    /// step is not positive.
    fn update(&mut self, step: &[f64], bend: &[f64]) {
        let curvature: f64 = step.iter().zip(bend).map(|(s, y)| s * y).sum();
        let through = self.times(bend);
        let length: f64 = bend.iter().zip(&through).map(|(y, g)| y * g).sum();
        if !(curvature > 0.0 && length > 0.0) {
            return;
        }
        for (row, (s, g)) in self.rows.iter_mut().zip(step.iter().zip(&through)) {
            for (entry, (s_column, g_column)) in row.iter_mut().zip(step.iter().zip(&through)) {
                *entry += s * s_column / curvature - g * g_column / length;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quadratic bowl with axes of curvature 1 and 100, rotated.
    struct Bowl;

    impl LeastSquares for Bowl {
        fn residual(&self, t: &[f64]) -> Option<Vec<f64>> {
            Some(vec![t[0] + t[1] - 3.0, 10.0 * (t[0] - t[1] + 1.0)])
        }

        fn linearisation(&self, t: &[f64]) -> Option<Linearisation> {
            Some(Linearisation {
                residual: self.residual(t)?,
                jacobian: vec![vec![1.0, 10.0], vec![1.0, -10.0]],
            })
        }

        fn step_limits(&self) -> Vec<f64> {
            vec![1.0, 1.0]
        }
    }

    /// Checks that the method of (Ödeen 1993, paper D, eq. 14) finds the minimum of a quadratic
    /// function.
    #[test]
    fn the_bottom_of_a_bowl_is_found() {
        let minimum = minimise(&Bowl, &[-4.0, 6.0], 1e-24).unwrap().unwrap();
        assert!(
            minimum.termination.was_successful(),
            "{:?}",
            minimum.termination
        );
        // tolerance: ten times the one of the search, 1e-7 of the step limit 1
        assert!((minimum.parameters[0] - 1.0).abs() < 1e-6, "{minimum:?}");
        assert!((minimum.parameters[1] - 2.0).abs() < 1e-6, "{minimum:?}");
        assert!(minimum.evaluations.linearisations > 4);
    }

    #[test]
    fn two_exact_line_minima_of_a_quadratic_make_the_inverse() {
        // H = x² + 2 y²: after steps along both axes G is the inverse of diag(2, 4)
        let mut inverse = Inverse::unit(2, 1.0);
        inverse.update(&[1.0, 0.0], &[2.0, 0.0]);
        inverse.update(&[0.0, -3.0], &[0.0, -12.0]);
        assert!((inverse.rows[0][0] - 0.5).abs() < 1e-15);
        assert!((inverse.rows[1][1] - 0.25).abs() < 1e-15);
        assert!(inverse.rows[0][1].abs() < 1e-15);
    }
}

//! Damped least squares for a few parameters.
//!
//! Residuals have unit variance and parameters are logarithms, so no further scaling is needed.
//! Each iteration computes the singular values of the Jacobian, J = U S Vᵀ; the step for a damping
//! μ is -V S (S² + μ)⁻¹ Uᵀ r. Along a direction on which the data do not depend, the singular value
//! is 0 and the parameters are not changed.

use crate::directions::Directions;
use crate::vectors::{dot, subtract};

/// Fraction of the largest singular value below which a singular value counts as rounding.
const RANK: f64 = 1e-9;
const MOST_ITERATIONS: usize = 200;
/// Maximum change of a parameter in one iteration: a change of a logarithm by 1 is a factor of e.
const LONGEST_STEP: f64 = 1.0;

/// Residuals and their derivatives, one column per parameter.
#[derive(Debug, Clone)]
pub(super) struct Linearised {
    pub(super) residual: Vec<f64>,
    pub(super) jacobian: Vec<Vec<f64>>,
}

impl Linearised {
    /// Returns a placeholder for a point where the problem has no value.
    pub(super) fn not_finite() -> Self {
        Self {
            residual: vec![f64::INFINITY],
            jacobian: Vec::new(),
        }
    }

    pub(super) fn sum_of_squares(&self) -> f64 {
        dot(&self.residual, &self.residual)
    }
}

impl Directions {
    /// Decomposes the Jacobian; `None` if it is not finite.
    fn of_linearised(linearised: &Linearised) -> Option<Self> {
        let entry = |i: usize, j: usize| linearised.jacobian.get(j)?.get(i).copied();
        let parameters = linearised.jacobian.len();
        Self::of(&linearised.residual, parameters, entry, RANK)
    }

    fn step(&self, damping: f64) -> Vec<f64> {
        let mut step = vec![0.0; self.vectors.len()];
        for ((s, u), vector) in self
            .singular_values
            .iter()
            .zip(&self.projected)
            .zip(&self.vectors)
        {
            if *s > 0.0 {
                let weight = -s * u / (s * s + damping);
                subtract(&mut step, -weight, vector);
            }
        }
        step
    }

    /// Returns the reduction of the sum of squares that the linear model predicts for the step with
    /// this `damping`.
    fn promised_reduction(&self, damping: f64) -> f64 {
        self.singular_values
            .iter()
            .zip(&self.projected)
            .filter(|(s, _)| **s > 0.0)
            .map(|(s, u)| {
                let kept = damping / (s * s + damping);
                u * u * (1.0 - kept * kept)
            })
            .sum()
    }
}

/// Reason why the iteration ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Ending {
    /// The predicted reduction of χ² is below 1e-9 of the effect of one standard deviation, or
    /// below the rounding error of χ² itself.
    Converged,
    /// No step, however short, reduces χ².
    NoDescent,
    /// The limit of iterations was reached; the parameters are not a minimum.
    OutOfIterations,
}

pub(super) struct Minimum {
    pub(super) parameters: Vec<f64>,
    pub(super) linearised: Linearised,
    pub(super) directions: Directions,
    pub(super) ending: Ending,
}

/// Minimises |r|² from `start`; returns `Ok(None)` if the residuals at the start are not finite.
/// Errors of `problem` are returned.
pub(super) fn minimise<E>(
    start: &[f64],
    problem: impl Fn(&[f64]) -> Result<Linearised, E>,
) -> Result<Option<Minimum>, E> {
    let mut parameters = start.to_vec();
    let mut here = problem(start)?;
    let mut value = here.sum_of_squares();
    let mut damping = 0.0_f64;
    let Some(mut directions) = Directions::of_linearised(&here).filter(|_| value.is_finite())
    else {
        return Ok(None);
    };
    let mut ending = Ending::OutOfIterations;
    let mut rejected = 0;
    for _ in 0..MOST_ITERATIONS {
        let largest = directions.singular_values.first().copied().unwrap_or(0.0);
        let promised = directions.promised_reduction(damping);
        if rejected == 0 && promised <= 1e-9 + 1e-14 * value && damping == 0.0 || largest == 0.0 {
            ending = Ending::Converged;
            break;
        }
        if rejected > 60 {
            ending = Ending::NoDescent;
            break;
        }
        let mut step = directions.step(damping);
        let longest = step.iter().fold(0.0, |l: f64, p| l.max(p.abs()));
        let shortening = (LONGEST_STEP / longest).min(1.0);
        for p in &mut step {
            *p *= shortening;
        }
        let trial: Vec<f64> = parameters.iter().zip(&step).map(|(t, p)| t + p).collect();
        let next = problem(&trial)?;
        let reached = next.sum_of_squares();
        let decomposed = if reached < value {
            Directions::of_linearised(&next)
        } else {
            None
        };
        let Some(decomposed) = decomposed else {
            // the rounding error of the sum of squares exceeds the remaining reduction
            if promised <= 1e-12 * value.max(1e-12) {
                ending = Ending::Converged;
                break;
            }
            rejected += 1;
            damping = (damping * 6.0).max(1e-6 * largest * largest);
            continue;
        };
        rejected = 0;
        damping *= 0.1;
        if damping < 1e-10 * largest * largest {
            damping = 0.0;
        }
        parameters = trial;
        value = reached;
        here = next;
        directions = decomposed;
    }
    Ok(Some(Minimum {
        parameters,
        linearised: here,
        directions,
        ending,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_start_that_is_no_number_is_no_minimum() {
        let no_number = |_: &[f64]| Linearised {
            residual: vec![f64::NAN],
            jacobian: vec![vec![f64::NAN]],
        };
        let Ok(minimum) = minimise(&[1.0], |t| Ok::<_, std::convert::Infallible>(no_number(t)));
        assert!(minimum.is_none());
    }
}

//! Least squares without tension, by block principal pivoting.

#![allow(
    clippy::indexing_slicing,
    reason = "the matrix is square, its size is the length of the right side and of every list, and all indices are below it"
)]

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

use super::outcome::{NonNegativity, PivotingEnd};

/// Number of block exchanges without a reduction of violations before violations are exchanged one
/// by one.
const PATIENCE: u32 = 3;
/// Largest number of pivoting steps per unknown; single exchanges are known to terminate, and
/// rarely need one step per unknown.
const STEPS_PER_UNKNOWN: usize = 3;
/// Fraction of the largest element below which a violation is rounding.
const ROUNDING: f64 = 1e-12;

/// Finds the minimum of $`\frac12 f^T A f - b^T f`$ with $`f \ge 0`$, starting from the signs of
/// `start` (block principal pivoting of L. F. Portugal, J. J. Júdice and L. N. Vicente, with its
/// rule of single exchanges, which prevents cycling). A must be positive definite.
///
/// The conditions of the minimum are $`f \ge 0`$, $`y = Af - b \ge 0`$ and $`f_i y_i = 0`$.
pub(super) fn minimise(
    matrix: &Mat<f64>,
    right_side: &[f64],
    start: &[f64],
) -> (Vec<f64>, NonNegativity) {
    let n = right_side.len();
    let mut is_free: Vec<bool> = start.iter().map(|f| *f > 0.0).collect();
    let largest = right_side.iter().fold(0.0_f64, |m, b| m.max(b.abs()));
    let mut fewest = n + 1;
    let mut patience = PATIENCE;
    let mut steps = 0;
    let (mut force, mut slope) = (vec![0.0; n], right_side.iter().map(|b| -b).collect());
    let end = loop {
        if steps > STEPS_PER_UNKNOWN * n {
            break PivotingEnd::StepLimit;
        }
        steps += 1;
        let Some((f, y)) = solve(matrix, right_side, &is_free) else {
            break PivotingEnd::NotPositiveDefinite;
        };
        let scale = f.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        let violations: Vec<usize> = (0..n)
            .filter(|&i| {
                if is_free[i] {
                    f[i] < -ROUNDING * scale
                } else {
                    y[i] < -ROUNDING * largest
                }
            })
            .collect();
        (force, slope) = (f, y);
        if violations.is_empty() {
            break PivotingEnd::Converged;
        }
        let exchanged = if violations.len() < fewest {
            fewest = violations.len();
            patience = PATIENCE;
            violations.as_slice()
        } else if patience > 0 {
            patience -= 1;
            violations.as_slice()
        } else {
            violations
                .split_last()
                .map_or(&[][..], |(last, _)| std::slice::from_ref(last))
        };
        for &index in exchanged {
            is_free[index] = !is_free[index];
        }
    };
    for f in &mut force {
        // for a converged solution this removes rounding, otherwise the violations that `end`
        // reports
        *f = f.max(0.0);
    }
    let worst = (0..n)
        .map(|i| {
            let excess = if is_free[i] {
                slope[i].abs()
            } else {
                (-slope[i]).max(0.0)
            };
            excess / largest
        })
        .fold(0.0, f64::max);
    let report = NonNegativity {
        end,
        steps,
        n_at_zero: is_free.iter().filter(|free| !**free).count(),
        relative_violation: if largest > 0.0 { worst } else { 0.0 },
    };
    (force, report)
}

/// Returns the solution with the samples that are not free at zero, and $`Af - b`$.
fn solve(matrix: &Mat<f64>, right_side: &[f64], is_free: &[bool]) -> Option<(Vec<f64>, Vec<f64>)> {
    let free: Vec<usize> = (0..is_free.len()).filter(|i| is_free[*i]).collect();
    let mut force = vec![0.0; is_free.len()];
    if !free.is_empty() {
        let part = Mat::from_fn(free.len(), free.len(), |i, j| matrix[(free[i], free[j])]);
        let rhs = Mat::from_fn(free.len(), 1, |i, _| right_side[free[i]]);
        let solution = part.llt(Side::Lower).ok()?.solve(&rhs);
        for (position, &index) in free.iter().enumerate() {
            force[index] = solution[(position, 0)];
        }
    }
    let slope = (0..is_free.len())
        .map(|i| {
            let product: f64 = free.iter().map(|&j| matrix[(i, j)] * force[j]).sum();
            product - right_side[i]
        })
        .collect();
    let is_finite = force.iter().all(|f: &f64| f.is_finite());
    is_finite.then_some((force, slope))
}

//! E' and E'' are one function of a relaxing material.

use std::f64::consts::TAU;

use rodwave::kramers_kronig::KramersKronig;

use super::{Check, CheckOutcome, CheckVerdict, check_level, chi_square_tail, telling};
use crate::error::CmodError;
use crate::estimate::ModulusEstimate;

/// Whether the modulus of an `estimate` can be that of a relaxing material, with a false alarm at most with the probability
/// `level`.
///
/// The nearest relaxing material is sought in units of the random errors of the lines
/// ([`KramersKronig::of_measured_modulus`]). The statistic is the root mean square of what is left, and noise alone gives 1: with
/// n lines, n times its square is at most half of a chi-square variable with 2n degrees of freedom, because the truth is one
/// of the materials among which the nearest was chosen. For the same reason false alarms are rarer than the level. What the grid of
/// relaxation times cannot do is taken off first; if only that decides, the check is undecided.
///
/// The lines of [`passivity`](super::passivity) take part, at least three.
///
/// # Errors
/// [`CmodError::NonPhysical`] for the level, [`CmodError::NoLines`] if fewer than three lines take part,
/// [`CmodError::NoNoise`] if a standard error is 0.
pub fn kramers_kronig(estimate: &ModulusEstimate, level: f64) -> Result<CheckOutcome, CmodError> {
    kramers_kronig_on(estimate, usize::MAX, level)
}

/// The same on at most `most_lines` of the lines, evenly chosen: the effort grows with their number, and what is wrong with a modulus
/// is seldom wrong on one line of thousands only. What is seen beside the noise grows with the root of the number.
///
/// # Errors
/// As [`kramers_kronig`].
pub fn kramers_kronig_on(
    estimate: &ModulusEstimate,
    most_lines: usize,
    level: f64,
) -> Result<CheckOutcome, CmodError> {
    let level = check_level(level)?;
    let stride = telling(estimate).count().div_ceil(most_lines.max(1)).max(1);
    let (mut omega, mut modulus, mut errors) = (Vec::new(), Vec::new(), Vec::new());
    let mut index = Vec::new();
    for line in telling(estimate).step_by(stride) {
        let error = line.random_error();
        let error = error.storage_modulus.hypot(error.loss_modulus);
        if error <= 0.0 {
            return Err(CmodError::NoNoise {
                what: "standard error of the modulus at line",
                index: line.index,
            });
        }
        omega.push(TAU * line.frequency_hz);
        modulus.push(line.modulus);
        errors.push(error);
        index.push(line.index);
    }
    if omega.len() < 3 {
        return Err(CmodError::NoLines);
    }
    let nearest = KramersKronig::of_measured_modulus(&omega, &modulus, &errors)
        .map_err(|_| CmodError::NoLines)?;
    let n = omega.len() as f64;
    // The threshold contains the scatter of the lines as mean and three standard deviations; the rest is the grid.
    let grid = nearest.threshold - (1.0 + 1.5 / n.sqrt());
    let p_of = |residual: f64| {
        let beyond_grid = (residual - grid).max(0.0);
        chi_square_tail(2.0 * n * beyond_grid * beyond_grid, 2.0 * n)
    };
    // The optimum lies between the two; the smaller residual must be too large already.
    let p_value = p_of(nearest.residual_lower_bound);
    let outcome = CheckOutcome::judged(
        Check::KramersKronig,
        (nearest.residual, 1.0),
        p_value,
        level,
    );
    let is_open = outcome.verdict == CheckVerdict::Passed && p_of(nearest.residual) < level;
    let by_error = |position: &usize| -> f64 {
        let line = nearest.lines.get(*position);
        let error = errors.get(*position).copied().unwrap_or(f64::INFINITY);
        line.map_or(0.0, |line| {
            (line.modulus - line.causal_modulus).norm() / error
        })
    };
    let worst = (0..index.len()).max_by(|a, b| by_error(a).total_cmp(&by_error(b)));
    Ok(CheckOutcome {
        verdict: if is_open {
            CheckVerdict::Undecided
        } else {
            outcome.verdict
        },
        ..outcome
    }
    .at(worst.and_then(|position| index.get(position).copied())))
}

//! Consistency of E' and E'' with one relaxing material.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rodwave::kramers_kronig::KramersKronig;

use super::{Check, CheckOutcome, CheckVerdict, check_level, chi_square_tail};
use crate::error::CmodError;
use crate::estimate::{ErrorSource, ModulusEstimate, ModulusLine};
use crate::self_calibration::{shift_of, stride_of_independent_lines};

/// Maximum number of fits of the nearest material, each with weights from the previous fit.
const MOST_ROUNDS: u32 = 4;

/// Checks that a relaxing material can have the modulus of an `estimate`. `level` is the largest
/// probability of a false alarm.
///
/// The nearest relaxing material is fitted in units of the random errors of the lines, with the
/// common errors of the specimen free within their uncertainties
/// ([`KramersKronig::of_modulus_with_common_errors`]). With known variances the residual sum of
/// squares F = |δE|²/σ², including the squares of the common errors, is the residual of a
/// projection onto a cone. The nearest material lies on a face of the cone of p dimensions, the
/// number of its parameters above 0. For records that are projected onto this face, twice the
/// residual sum exceeds any given value at most as often as a chi-square variable with 2n - p
/// degrees of freedom for n lines: the residual is perpendicular to the face, and a true
/// material outside of the face can only shorten the residual, because this material lies in the
/// cone (Wollan & Dykstra, *Conditional tests with an order restriction as a null hypothesis*,
/// 1986).
///
/// With an estimated variance of ν degrees of freedom, F of a line follows Fisher's distribution,
/// P(F > x) = (1 + 2x/ν)^{-ν/2}. Therefore
///
/// ```text
/// u = (ν/2) ln(1 + 2F/ν)
/// ```
///
/// has, for any ν, the distribution that F has with a known variance. Σu replaces ΣF, and the
/// nearest material minimises Σu; outlying lines then have less weight. Σu is -ν/(ν + 2) times the
/// logarithm of a likelihood, of which each parameter absorbs half of a chi-square variable.
/// Therefore the number of parameters p in 2n - p is multiplied by ν/(ν + 2). If neighbouring lines
/// share their variances, the values of u of these lines are correlated. With D degrees of freedom
/// of all lines together, the variance of Σu is larger by the factor 1 + n (2/D - 2/Σν), and
/// chi-square is scaled to this variance.
///
/// Σu is insensitive to an error common to all losses. The second statistic is the decrease of the
/// residual due to a common factor on all losses
/// ([`LossError`](rodwave::kramers_kronig::LossError)), with one degree of freedom; the p-value is
/// twice the smaller of the two p-values.
///
/// The reported statistic is the root mean square residual; noise alone gives 1. The error of the
/// grid of relaxation times is subtracted first; if the verdict depends on the accuracy of the
/// optimum, the check is undecided.
///
/// The check uses the same lines as [`passivity`](super::passivity), and needs at least three of
/// them.
///
/// # Errors
/// [`CmodError::NonPhysical`] for the level, [`CmodError::NoLines`] if fewer than three lines can
/// be used, [`CmodError::NoNoise`] if a standard error is 0.
pub fn kramers_kronig(estimate: &ModulusEstimate, level: f64) -> Result<CheckOutcome, CmodError> {
    kramers_kronig_on(estimate, usize::MAX, 1.0, level)
}

/// Performs the check of [`kramers_kronig`] on at most `most_lines` evenly spaced lines, of which
/// any two are at least `lines_per_independent_line` lines apart. The computing time grows with the
/// number of lines, and an error of a modulus seldom affects only one line of thousands. The
/// detectable error decreases with the square root of the number of lines.
///
/// # Errors
/// The errors of [`kramers_kronig`].
pub fn kramers_kronig_on(
    estimate: &ModulusEstimate,
    most_lines: usize,
    lines_per_independent_line: f64,
    level: f64,
) -> Result<CheckOutcome, CmodError> {
    let level = check_level(level)?;
    let stride = stride_of_independent_lines(
        estimate.telling().count(),
        most_lines,
        lines_per_independent_line,
    );
    let lines: Vec<Tested<'_>> = estimate
        .telling()
        .step_by(stride)
        .map(Tested::new)
        .collect::<Result<_, _>>()?;
    if lines.len() < 3 {
        return Err(CmodError::NoLines);
    }
    let omega: Vec<f64> = lines
        .iter()
        .map(|line| TAU * line.line.frequency_hz)
        .collect();
    let modulus: Vec<Complex64> = lines.iter().map(|line| line.line.modulus).collect();
    let common = common_errors(&lines);
    let known = lines.iter().all(|line| line.freedom.is_none());
    let errors: Vec<f64> = lines.iter().map(|line| line.error).collect();
    let nearest_by = |scale: &[f64], is_last: bool| {
        if is_last {
            KramersKronig::of_modulus_with_common_errors(&omega, &modulus, scale, &common)
        } else {
            KramersKronig::without_loss_error(&omega, &modulus, scale, &common)
        }
        .map_err(|_| CmodError::NoLines)
    };
    let mut nearest = nearest_by(&errors, known)?;
    let mut squares = squares(&nearest, &lines);
    if !known {
        for round in 1..MOST_ROUNDS {
            let scale = lines.iter().zip(&squares).map(|(line, f)| line.scale(*f));
            nearest = nearest_by(&scale.collect::<Vec<_>>(), round + 1 == MOST_ROUNDS)?;
            squares = self::squares(&nearest, &lines);
        }
    }
    let n = lines.len() as f64;
    let by_common: f64 = nearest.common_errors.iter().map(|xi| 0.5 * xi * xi).sum();
    // the sum for residuals whose squares are multiplied by `factor`²
    let sum = |factor: f64| -> f64 {
        let of_line = |(line, f): (&Tested<'_>, &f64)| line.like_chi_square(factor * factor * f);
        let of_lines: f64 = lines.iter().zip(&squares).map(of_line).sum();
        of_lines + factor * factor * by_common
    };
    let freedom = 2.0 * n - taken_up(&nearest, &lines);
    let spread = 1.0 + n * shared(estimate, &lines);
    let p_of = |residual: f64| {
        let beyond_grid = (residual - nearest.grid_error).max(0.0);
        let factor = if nearest.residual > 0.0 {
            beyond_grid / nearest.residual
        } else {
            0.0
        };
        if freedom <= 0.0 {
            // the material fits all values
            return 1.0;
        }
        chi_square_tail(2.0 * sum(factor) / spread, freedom / spread)
    };
    // The residual of the optimum lies between its lower bound and the residual that was found. The
    // check fails only if even the lower bound is too large.
    let all_lines = p_of(nearest.residual_lower_bound);
    // the decrease is that of the weighted squares, and Σu decreases by at least as much, because u
    // is concave
    let loss_alone = nearest
        .loss_error
        .map_or(1.0, |error| chi_square_tail(error.decrease / spread, 1.0));
    let p_value = (2.0 * all_lines.min(loss_alone)).min(1.0);
    let statistic = if freedom > 0.0 {
        (2.0 * sum(1.0) / freedom).sqrt()
    } else {
        0.0
    };
    let outcome = CheckOutcome::judged(Check::KramersKronig, (statistic, 1.0), p_value, level);
    let is_open = outcome.verdict == CheckVerdict::Passed && 2.0 * p_of(nearest.residual) < level;
    let worst = lines
        .iter()
        .zip(&squares)
        .max_by(|a, b| a.1.total_cmp(b.1))
        .map(|(line, _)| line.line.index);
    Ok(outcome.undecided_if(is_open).at(worst))
}

/// Line that is checked.
struct Tested<'a> {
    line: &'a ModulusLine,
    /// (E|δE|²)^½ due to noise [Pa].
    error: f64,
    /// Degrees of freedom of the square of `error`, if it was estimated.
    freedom: Option<f64>,
}

impl<'a> Tested<'a> {
    fn new(line: &'a ModulusLine) -> Result<Self, CmodError> {
        let error = line.random_error();
        let error = error.storage_modulus.hypot(error.loss_modulus);
        if error <= 0.0 {
            return Err(CmodError::NoNoise {
                what: "standard error of the modulus at line",
                index: line.index,
            });
        }
        Ok(Self {
            line,
            error,
            freedom: line.uncertainty.degrees_of_freedom,
        })
    }

    /// Returns u for F = `square`, which is half of a chi-square variable with two degrees of
    /// freedom.
    fn like_chi_square(&self, square: f64) -> f64 {
        self.freedom.map_or(square, |freedom| {
            0.5 * freedom * (2.0 * square / freedom).ln_1p()
        })
    }

    /// Returns σ divided by the root of du/dF: a least-squares fit with these weights decreases Σu.
    fn scale(&self, square: f64) -> f64 {
        self.freedom.map_or(self.error, |freedom| {
            self.error * (1.0 + 2.0 * square / freedom).sqrt()
        })
    }
}

/// Returns the degrees of freedom absorbed by the parameters of the `nearest` material. Each common
/// error absorbs the one degree of freedom that it adds.
fn taken_up(nearest: &KramersKronig, lines: &[Tested<'_>]) -> f64 {
    let elastic = [nearest.equilibrium_modulus, nearest.viscosity];
    let parameters = nearest.branches.len() + elastic.iter().filter(|x| **x > 0.0).count();
    let of_line = |line: &Tested<'_>| {
        line.freedom
            .map_or(1.0, |freedom| freedom / (freedom + 2.0))
    };
    parameters as f64 * lines.iter().map(of_line).sum::<f64>() / lines.len() as f64
}

/// Returns |δE|²/σ² of all lines, after subtraction of the common errors.
fn squares(nearest: &KramersKronig, lines: &[Tested<'_>]) -> Vec<f64> {
    let residuals = nearest.lines.iter().zip(lines);
    residuals
        .map(|(residual, line)| {
            (residual.residual * residual.modulus.norm() / line.error).norm_sqr()
        })
        .collect()
}

/// Returns δE due to every source on all lines; 0 on a line that does not depend on the source.
fn common_errors(lines: &[Tested<'_>]) -> Vec<Vec<Complex64>> {
    let mut sources: Vec<ErrorSource> = Vec::new();
    for shift in lines
        .iter()
        .flat_map(|line| &line.line.uncertainty.systematic)
    {
        if !sources.contains(&shift.source) {
            sources.push(shift.source);
        }
    }
    let of_line =
        |line: &Tested<'_>, source| shift_of(&line.line.uncertainty.systematic, source).modulus;
    sources
        .into_iter()
        .map(|source| lines.iter().map(|line| of_line(line, source)).collect())
        .collect()
}

/// Returns 2/D - 2/Σν: the contribution of shared variances to the variance of Σu, divided by n².
fn shared(estimate: &ModulusEstimate, lines: &[Tested<'_>]) -> f64 {
    let all: f64 = estimate
        .telling()
        .filter_map(|line| line.uncertainty.own_degrees_of_freedom)
        .sum();
    let each: f64 = lines.iter().filter_map(|line| line.freedom).sum();
    if all > 0.0 && each > all {
        2.0 / all - 2.0 / each
    } else {
        0.0
    }
}

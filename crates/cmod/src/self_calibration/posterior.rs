//! Sizes of common errors by least squares with their stated uncertainties as priors.

use faer::linalg::solvers::Solve as _;
use faer::{Mat, Side};
use num_complex::Complex64;

use super::LARGEST_TERM;
use super::line::{LinearisedLine, Misfit, shift_of, sources_of};
use super::smooth::Smoothing;
use crate::estimate::{ErrorSource, ModulusLine};
use crate::vectors::{dot, length, without};

/// Minimum ratio of twice the number of lines to the number of unknowns.
const FEWEST_PER_UNKNOWN: f64 = 3.0;

/// Estimated sizes of the errors, and the covariance of the remaining errors.
pub(super) struct Posterior {
    pub(super) sources: Vec<ErrorSource>,
    pub(super) sizes: Vec<f64>,
    /// Cholesky factor of the covariance of the remaining errors, by rows.
    pub(super) factor: Vec<Vec<f64>>,
    pub(super) mean_square: f64,
    /// Smooth modulus of each line.
    pub(super) smooth: Vec<Complex64>,
}

impl Posterior {
    /// Solves for the errors from `lines`, which are linearised about a smooth modulus. Errors of
    /// the `measured` sources with the sizes `removed` were removed from these lines. Returns
    /// `None` if there are too few lines.
    pub(super) fn of(
        lines: &[&ModulusLine],
        about: &[LinearisedLine],
        measured: &[ErrorSource],
        removed: &[f64],
        added_damping: f64,
    ) -> Option<Self> {
        let sources = sources_of(about, measured);
        let smoothing = Smoothing::of(lines, about, added_damping, LARGEST_TERM)?;
        let rows = 2 * lines.len();
        let freedom = rows as f64 - smoothing.parameters;
        let unknowns = smoothing.parameters + sources.len() as f64;
        if (rows as f64) < FEWEST_PER_UNKNOWN * unknowns {
            return None;
        }
        // the modulus including the errors that were removed, to first order
        let with_errors = smoothing.whitened(about.iter().map(|line| {
            let back = measured.iter().zip(removed);
            line.modulus
                + back
                    .map(|(source, size)| shift_of(&line.shifts, *source).modulus * *size)
                    .sum::<Complex64>()
        }));
        let shifts: Vec<Vec<f64>> = sources
            .iter()
            .map(|source| {
                let of_source = |line: &LinearisedLine| shift_of(&line.shifts, *source).modulus;
                smoothing.whitened(about.iter().map(of_source))
            })
            .collect();
        let target = smoothing.rest_of(&with_errors);
        let columns: Vec<Vec<f64>> = shifts
            .iter()
            .map(|shift| smoothing.rest_of(shift))
            .collect();

        let misfit = Misfit::of(about, removed);
        let (sizes, _) = ridge(&columns, &target, &misfit, 1.0)?;
        let left = without(&target, &columns, &sizes);
        let mean_square = (dot(&left, &left) + dot(&sizes, &sizes) + misfit.left(&sizes))
            / (freedom + misfit.degrees_of_freedom);
        let (sizes, covariance) = ridge(&columns, &target, &misfit, mean_square.max(1.0))?;
        let mut smooth = smoothing.smooth(&without(&with_errors, &shifts, &sizes));
        // the errors of the specimen are added, because the next round linearises about lines that
        // still contain them
        let specimen = || sources.iter().zip(&sizes).skip(measured.len());
        for (modulus, line) in smooth.iter_mut().zip(about) {
            let errors =
                specimen().map(|(source, size)| shift_of(&line.shifts, *source).modulus * size);
            *modulus += errors.sum::<Complex64>();
        }
        let factor = covariance.llt(Side::Lower).ok()?;
        let factor = factor.L();
        let n = sources.len();
        Some(Self {
            sources,
            sizes,
            factor: (0..n)
                .map(|i| (0..n).map(|j| factor[(i, j)]).collect())
                .collect(),
            mean_square,
            smooth,
        })
    }

    /// Returns the largest difference between a size and the corresponding size in `others`, in
    /// standard errors of the size.
    pub(super) fn distance(&self, others: &[f64]) -> f64 {
        others
            .iter()
            .zip(&self.sizes)
            .zip(&self.factor)
            .map(|((other, own), row)| (own - other).abs() / length(row))
            .fold(0.0, f64::max)
    }
}

/// Returns the ξ that minimises (|b - Jξ|² + the square of the `misfit`)/s² + |ξ|², and the
/// covariance of ξ, (I + JᵀJ/s²)⁻¹; `None` if a value is not finite.
fn ridge(
    columns: &[Vec<f64>],
    target: &[f64],
    misfit: &Misfit,
    mean_square: f64,
) -> Option<(Vec<f64>, Mat<f64>)> {
    let n = columns.len();
    let measured = misfit.gradient.len();
    let product = |i: usize, j: usize| -> f64 {
        let pair = columns.get(i).zip(columns.get(j));
        let of_lines = pair.map_or(0.0, |(a, b)| dot(a, b));
        let of_misfit = if j < measured {
            misfit.normal.get(i * measured + j).copied().unwrap_or(0.0)
        } else {
            0.0
        };
        (of_lines + of_misfit) / mean_square + f64::from(u8::from(i == j))
    };
    let normal = Mat::from_fn(n, n, product);
    let right = Mat::from_fn(n, n + 1, |i, j| {
        if j < n {
            f64::from(u8::from(i == j))
        } else {
            let of_lines = columns.get(i).map_or(0.0, |column| dot(column, target));
            let of_misfit = misfit.gradient.get(i).copied().unwrap_or(0.0);
            (of_lines + of_misfit) / mean_square
        }
    });
    let solved = normal.llt(Side::Lower).ok()?.solve(right);
    let sizes: Vec<f64> = (0..n).map(|i| solved[(i, n)]).collect();
    // rounding leaves the inverse asymmetric in its last digits
    let covariance = Mat::from_fn(n, n, |i, j| 0.5 * (solved[(i, j)] + solved[(j, i)]));
    sizes
        .iter()
        .all(|size| size.is_finite())
        .then_some((sizes, covariance))
}

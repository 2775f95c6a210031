//! Residual of a law that the common errors of its data do not explain.
//!
//! An error that all lines share, as that of the mass on the end of a rod, bends the modulus by far
//! more than noise, and no law of the material follows it. Judged by noise alone the right law would
//! be refused. With the whitened shifts g_s of the common errors, one column of G each, what is left
//! of the residual r of the minimum and the errors that explain it are
//!
//! ```text
//! min_ξ |r - G⊥ξ|² + |ξ|² ,   G⊥ = G - JJ⁺G ,
//! ```
//!
//! which is the least χ² of the law with the covariance I + GGᵀ, linear in parameters and errors.

use super::data::ModulusData;
use super::fit::ErrorScale;
use super::least_squares::Linearised;
use super::symmetric::{factorise, solve};
use crate::directions::Directions;

/// Residual without what common errors explain.
#[derive(Debug, Clone)]
pub(super) struct Explained {
    pub(super) residual: Vec<f64>,
    /// Its sum of squares and that of the errors, in their standard uncertainties.
    pub(super) chi_squared: f64,
}

impl Explained {
    /// Separates the whitened residual of a minimum, with its derivatives. Where the errors of the lines
    /// follow from the residual, common errors explain nothing.
    pub(super) fn of(
        data: &ModulusData,
        linearised: &Linearised,
        information: &Directions,
        scale: ErrorScale,
    ) -> Self {
        let square = |values: &[f64]| values.iter().map(|x| x * x).sum::<f64>();
        let mut residual = linearised.residual.clone();
        let columns: Vec<Vec<f64>> = match scale {
            ErrorScale::FromResidual => Vec::new(),
            _ => (0..data.common.len())
                .map(|source| beside_the_law(&data.whitened_shift(source), linearised, information))
                .collect(),
        };
        let n = columns.len();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut normal = vec![0.0; n * n];
        let rows = normal.chunks_exact_mut(n.max(1)).zip(&columns).enumerate();
        for (own, (row, column)) in rows {
            for (entry, other) in row.iter_mut().zip(&columns) {
                *entry = dot(column, other);
            }
            if let Some(diagonal) = row.get_mut(own) {
                *diagonal += 1.0;
            }
        }
        let mut sizes: Vec<f64> = columns
            .iter()
            .map(|column| dot(column, &residual))
            .collect();
        if factorise(&mut normal, n, 0.0) {
            solve(&normal, &mut sizes);
        } else {
            // shifts that are not finite explain nothing
            sizes.fill(0.0);
        }
        for (column, size) in columns.iter().zip(&sizes) {
            for (rest, shift) in residual.iter_mut().zip(column) {
                *rest -= size * shift;
            }
        }
        Self {
            chi_squared: square(&residual) + square(&sizes),
            residual,
        }
    }
}

/// A whitened shift without what a change of the parameters of the law follows.
fn beside_the_law(shift: &[f64], linearised: &Linearised, information: &Directions) -> Vec<f64> {
    let change = information.change(linearised, shift);
    let rows = linearised.jacobian.chunks_exact(change.len().max(1));
    let followed = rows.map(|row| row.iter().zip(&change).map(|(a, b)| a * b).sum::<f64>());
    shift
        .iter()
        .zip(followed)
        .map(|(own, law)| own - law)
        .collect()
}

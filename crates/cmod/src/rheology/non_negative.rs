//! Least squares with non-negative coefficients, from the normal equations.

use super::count;
use super::symmetric::{add_products, factorise, solve};
use crate::vectors::dot;

/// Solves min |b - A x|² over x >= 0 by the active-set method of Lawson & Hanson (*Solving Least
/// Squares Problems*, 1974, ch. 23), on AᵀA and Aᵀb as in Bro & de Jong (*J. Chemom.* **11** (1997)
/// 393).
///
/// The columns are whitened values of a law. Columns of neighbouring relaxation times of a grid
/// differ so much that the squared condition number of the normal equations is acceptable for a
/// starting point that is refined afterwards. A column that depends linearly on the other columns
/// within rounding is not used.
#[derive(Debug)]
pub(crate) struct NonNegative {
    columns: usize,
    values: usize,
    /// Matrix AᵀA of the columns, scaled to length 1, by rows.
    gram: Vec<f64>,
    /// Vector Aᵀb of the columns, scaled to length 1.
    target: Vec<f64>,
    lengths: Vec<f64>,
    /// Square bᵀb of the target.
    square: f64,
}

/// Optimum of the problem.
#[derive(Debug)]
pub(crate) struct Optimum {
    pub(crate) coefficients: Vec<f64>,
    /// Sum of squares |b - A x|².
    pub(crate) square: f64,
}

/// Pivot, for columns of length 1, below which a pivot counts as rounding.
const LEAST_PIVOT: f64 = 1e-12;
/// Largest number of columns that are all tried at once before the search.
const FEW: usize = 40;

#[allow(
    clippy::indexing_slicing,
    reason = "the matrix has n rows of n elements and the lists n, and all indices are numbers of columns, of which there are n"
)]
impl NonNegative {
    /// Creates the problem of `columns` and `target` of the same length. Columns that are 0 get the
    /// coefficient 0.
    pub(crate) fn new(columns: &[Vec<f64>], target: &[f64]) -> Self {
        let n = columns.len();
        let rows: Vec<f64> = (0..target.len())
            .flat_map(|k| columns.iter().map(move |column| column[k]))
            .collect();
        let mut gram = vec![0.0; n * n];
        add_products(&mut gram, &rows, n);
        let lengths: Vec<f64> = (0..n).map(|i| gram[i * n + i].sqrt()).collect();
        for i in 0..n {
            for j in i..n {
                let value = gram[i * n + j] / (lengths[i] * lengths[j]);
                gram[i * n + j] = value;
                gram[j * n + i] = value;
            }
        }
        Self {
            columns: n,
            values: target.len(),
            gram,
            target: columns
                .iter()
                .zip(&lengths)
                .map(|(column, length)| dot(column, target) / length)
                .collect(),
            lengths,
            square: dot(target, target),
        }
    }

    /// Replaces the target; `columns` must be the columns of the problem.
    pub(crate) fn set_target(&mut self, columns: &[Vec<f64>], target: &[f64]) {
        for ((own, column), length) in self.target.iter_mut().zip(columns).zip(&self.lengths) {
            *own = dot(column, target) / length;
        }
        self.square = dot(target, target);
    }

    /// Returns the problem with only the `chosen` columns.
    pub(crate) fn of_columns(&self, chosen: &[usize]) -> Self {
        let pick = |values: &[f64]| chosen.iter().map(|j| values[*j]).collect::<Vec<f64>>();
        Self {
            columns: chosen.len(),
            values: self.values,
            gram: chosen
                .iter()
                .flat_map(|i| chosen.iter().map(move |j| self.gram[i * self.columns + j]))
                .collect(),
            target: pick(&self.target),
            lengths: pick(&self.lengths),
            square: self.square,
        }
    }

    /// Solves until no single column is predicted to lower |b - A x|² by more than 1e-4 of the mean
    /// square per value, or by more than 1e-4 if the mean square exceeds 1. This accuracy is
    /// sufficient for a starting point.
    pub(crate) fn solve(&self) -> Optimum {
        self.solve_to(1e-4)
    }

    /// Solves until no single column is predicted to lower |b - A x|² by more than the fraction
    /// `tolerance` of the mean square per value, or by more than `tolerance` if the mean square
    /// exceeds 1. Many columns together may lower |b - A x|² by far more if they are nearly
    /// dependent.
    pub(crate) fn solve_to(&self, tolerance: f64) -> Optimum {
        let n = self.columns;
        let mut x = vec![0.0; n];
        let mut passive: Vec<usize> = Vec::new();
        let mut refused = vec![false; n];
        if n <= FEW {
            let all: Vec<usize> = (0..n).collect();
            if let Some(z) = self.least_squares(&all)
                && z.iter().all(|z| *z > 0.0)
            {
                x = z;
                passive = all;
            }
        }
        let rounding = 1e-13 * self.target.iter().fold(0.0, |l: f64, b| l.max(b.abs()));
        for _ in 0..4 * n {
            let rest = self.rest(&x, &passive);
            let enough = (tolerance * (rest.max(0.0) / count(self.values)).min(1.0)).sqrt();
            let steepest = (0..n)
                .filter(|j| !refused[*j] && !passive.contains(j))
                .map(|j| (j, self.gradient(j, &x, &passive)))
                .max_by(|a, b| a.1.total_cmp(&b.1));
            let Some((entering, gradient)) = steepest else {
                break;
            };
            // the gradient of a column that is 0 is NaN
            if gradient.is_nan() || gradient <= enough.max(rounding) {
                break;
            }
            passive.push(entering);
            if self.settle(&mut x, &mut passive, entering) {
                refused.fill(false);
            } else {
                refused[entering] = true;
            }
        }
        Optimum {
            square: self.rest(&x, &passive).max(0.0),
            coefficients: x
                .iter()
                .zip(&self.lengths)
                .map(|(x, l)| if *x > 0.0 { x / l } else { 0.0 })
                .collect(),
        }
    }

    /// Moves to the optimum of the passive columns; passive columns whose coefficients would become
    /// negative are removed. Returns false, without a move, if the entering column would become
    /// negative.
    fn settle(&self, x: &mut [f64], passive: &mut Vec<usize>, entering: usize) -> bool {
        loop {
            let Some(optimum) = self.least_squares(passive) else {
                passive.retain(|j| *j != entering);
                return false;
            };
            let own = passive.iter().zip(&optimum).find(|(j, _)| **j == entering);
            if x[entering] <= 0.0 && own.is_some_and(|(_, z)| *z <= 0.0) {
                passive.retain(|j| *j != entering);
                return false;
            }
            let share = passive
                .iter()
                .zip(&optimum)
                .filter(|(_, z)| **z <= 0.0)
                .map(|(j, z)| x[*j] / (x[*j] - z))
                .fold(1.0, f64::min);
            let blocked = optimum.iter().any(|z| *z <= 0.0);
            for (j, z) in passive.iter().zip(&optimum) {
                let leaves = *z <= 0.0 && x[*j] / (x[*j] - z) <= share;
                x[*j] = if leaves {
                    0.0
                } else {
                    x[*j] + share * (z - x[*j])
                };
            }
            if !blocked {
                return true;
            }
            passive.retain(|j| x[*j] > 0.0);
        }
    }

    /// Returns the optimum over the given columns, by Cholesky factors; `None` if the columns are
    /// not independent.
    fn least_squares(&self, passive: &[usize]) -> Option<Vec<f64>> {
        let k = passive.len();
        let mut factor = vec![0.0; k * k];
        for (j, column) in factor.chunks_exact_mut(k.max(1)).enumerate() {
            let gram = &self.gram[passive[j] * self.columns..][..self.columns];
            for (entry, i) in column.iter_mut().zip(passive).skip(j) {
                *entry = gram[*i];
            }
        }
        if !factorise(&mut factor, k, LEAST_PIVOT) {
            return None;
        }
        let mut z: Vec<f64> = passive.iter().map(|j| self.target[*j]).collect();
        solve(&factor, &mut z);
        Some(z)
    }

    fn gradient(&self, j: usize, x: &[f64], passive: &[usize]) -> f64 {
        let row = &self.gram[j * self.columns..(j + 1) * self.columns];
        self.target[j] - passive.iter().map(|i| row[*i] * x[*i]).sum::<f64>()
    }

    /// Returns |b - A x|².
    fn rest(&self, x: &[f64], passive: &[usize]) -> f64 {
        // bᵀb - bᵀAx - xᵀ(Aᵀb - AᵀAx)
        let fitted: f64 = passive
            .iter()
            .map(|j| x[*j] * (self.target[*j] + self.gradient(*j, x, passive)))
            .sum();
        self.square - fitted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks the conditions of Karush, Kuhn and Tucker, which only the optimum satisfies, on a
    /// problem whose unconstrained optimum has negative coefficients.
    #[test]
    fn optimum_satisfies_its_conditions() {
        let columns: Vec<Vec<f64>> = (0..12)
            .map(|k| (0..20).map(|j| (-0.05 * f64::from(k * j)).exp()).collect())
            .collect();
        let target: Vec<f64> = (0..20).map(|j| 1.0 / (1.0 + f64::from(j * j))).collect();
        let optimum = NonNegative::new(&columns, &target).solve();
        let mut rest = target;
        for (column, amount) in columns.iter().zip(&optimum.coefficients) {
            assert!(*amount >= 0.0);
            for (rest, entry) in rest.iter_mut().zip(column) {
                *rest -= amount * entry;
            }
        }
        assert!((dot(&rest, &rest) - optimum.square).abs() < 1e-14);
        let enough = 1e-2 * (optimum.square / 20.0).sqrt();
        for (column, amount) in columns.iter().zip(&optimum.coefficients) {
            let gradient = dot(column, &rest) / dot(column, column).sqrt();
            // tolerances: the limit that ends the search, and, for columns with a coefficient above
            // 0, the rounding error at a condition number of 1e6
            assert!(gradient < 1.01 * enough, "{gradient:e}");
            assert!(*amount == 0.0 || gradient.abs() < 1e-10, "{gradient:e}");
        }
        assert!(optimum.coefficients.iter().any(|amount| *amount > 0.0));
        assert!(optimum.coefficients.contains(&0.0));
    }

    #[test]
    fn target_inside_the_cone_is_reached() {
        let columns = [
            vec![1.0, 0.0, 0.0],
            vec![1.0, 1.0, 0.0],
            vec![0.0, 1.0, 3.0],
        ];
        let optimum = NonNegative::new(&columns, &[3.0, 4.0, 3.0]).solve();
        for (found, exact) in optimum.coefficients.iter().zip([0.0, 3.0, 1.0]) {
            assert!((found - exact).abs() < 1e-12, "{found}");
        }
    }
}

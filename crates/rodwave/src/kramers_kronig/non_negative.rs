//! Non-negative least squares, with a bound on the decrease that is still possible.

/// Minimisation of |b - A x| over x >= 0.
///
/// The active-set method of Lawson & Hanson (*Solving Least Squares Problems*, 1974, ch. 23):
/// columns enter one at a time, the one with the largest gradient first, and leave when their
/// coefficient would become negative.
#[derive(Debug)]
pub(super) struct NonNegativeProblem {
    /// Columns of A, scaled to length 1.
    columns: Vec<Vec<f64>>,
    lengths: Vec<f64>,
    target: Vec<f64>,
    /// Largest sum of the coefficients of the scaled columns at the optimum.
    largest_sum: f64,
}

/// Best x that was found.
#[derive(Debug)]
pub(super) struct Solution {
    pub(super) coefficients: Vec<f64>,
    /// |b - A x|.
    pub(super) residual: f64,
    /// Lower bound of |b - A x| at the optimum.
    pub(super) residual_lower_bound: f64,
}

/// Fraction of |b - A x|² by which it may still decrease when the search ends.
const TOLERANCE: f64 = 1e-2;

#[allow(
    clippy::indexing_slicing,
    reason = "an index of a passive column counts `columns`, of which `lengths` and a gradient have one each; `triangle` is lower triangular with a row, a \
              projection and an unknown for each passive column"
)]
impl NonNegativeProblem {
    /// Creates the problem from its columns. `largest_sum` is an upper bound of the sum of the
    /// coefficients at the optimum, for columns of length 1.
    pub(super) fn new(mut columns: Vec<Vec<f64>>, target: Vec<f64>, largest_sum: f64) -> Self {
        let lengths: Vec<f64> = columns.iter().map(|column| length(column)).collect();
        for (column, length) in columns.iter_mut().zip(&lengths) {
            for entry in column {
                *entry /= length;
            }
        }
        Self {
            columns,
            lengths,
            target,
            largest_sum,
        }
    }

    /// Searches until |b - A x| is at most `enough`, or within [`TOLERANCE`] of its optimum, or
    /// rounding stops the search.
    pub(super) fn solve(&self, enough: f64) -> Solution {
        let mut passive: Vec<Passive> = Vec::new();
        let mut refused: Vec<usize> = Vec::new();
        let mut factors = Factors::default();
        // Each step reduces the residual, so no set of columns recurs; the limit on the steps only
        // guards against rounding.
        for _ in 0..3 * self.columns.len() {
            let rest = self.rest(&passive);
            let gradient = self.gradient(&rest);
            if length(&rest) <= enough || self.gain(&gradient) <= TOLERANCE * dot(&rest, &rest) {
                break;
            }
            let best = (0..self.columns.len())
                .filter(|index| !refused.contains(index))
                .filter(|index| passive.iter().all(|entry| entry.index != *index))
                .map(|index| (index, gradient[index]))
                .max_by(|a, b| a.1.total_cmp(&b.1));
            let Some((index, gradient)) = best else {
                break;
            };
            if gradient <= 0.0 {
                break;
            }
            match self.enter(&passive, index, &mut factors) {
                Some(next) => {
                    passive = next;
                    refused.clear();
                }
                // Only rounding can give a column of positive gradient a negative coefficient.
                None => refused.push(index),
            }
        }
        let rest = self.rest(&passive);
        let mut coefficients = vec![0.0; self.columns.len()];
        for entry in &passive {
            coefficients[entry.index] = entry.amount / self.lengths[entry.index];
        }
        Solution {
            coefficients,
            residual: length(&rest),
            residual_lower_bound: (dot(&rest, &rest) - self.gain(&self.gradient(&rest)))
                .max(0.0)
                .sqrt(),
        }
    }

    /// Computes Aᵀ `rest`.
    fn gradient(&self, rest: &[f64]) -> Vec<f64> {
        let columns = self.columns.iter();
        columns.map(|column| dot(column, rest)).collect()
    }

    /// Upper bound of the decrease of |b - A x|² from its `gradient` g = Aᵀ(b - A x).
    ///
    /// If x is optimal among its own columns, the bound is, by convexity, 2 g·x* for the optimum
    /// x*.
    fn gain(&self, gradient: &[f64]) -> f64 {
        let steepest = gradient.iter().copied().fold(0.0, f64::max);
        2.0 * steepest * self.largest_sum
    }

    /// Computes b - A x.
    fn rest(&self, passive: &[Passive]) -> Vec<f64> {
        let mut rest = self.target.clone();
        for entry in passive {
            subtract(&mut rest, entry.amount, &self.columns[entry.index]);
        }
        rest
    }

    /// Finds the optimum over the passive columns and one more. Columns whose coefficient would be
    /// negative are removed.
    fn enter(
        &self,
        passive: &[Passive],
        index: usize,
        factors: &mut Factors,
    ) -> Option<Vec<Passive>> {
        let mut current = passive.to_vec();
        current.push(Passive { index, amount: 0.0 });
        loop {
            let optimum = self.least_squares(&current, factors);
            let newcomer = current.iter().zip(&optimum).find(|(c, _)| c.index == index);
            if newcomer.is_none_or(|(c, z)| c.amount <= 0.0 && *z <= 0.0) {
                return None;
            }
            let step = current
                .iter()
                .zip(&optimum)
                .filter(|(_, z)| **z <= 0.0)
                .map(|(c, z)| c.amount / (c.amount - z))
                .fold(1.0, f64::min);
            let blocked = optimum.iter().any(|z| *z <= 0.0);
            for (c, z) in current.iter_mut().zip(&optimum) {
                let leaves = *z <= 0.0 && c.amount / (c.amount - z) <= step;
                c.amount = if leaves {
                    0.0
                } else {
                    c.amount + step * (z - c.amount)
                };
            }
            if !blocked {
                return Some(current);
            }
            current.retain(|c| c.amount > 0.0);
        }
    }

    /// Minimises |b - A x| over the `passive` columns by modified Gram-Schmidt, orthogonalised
    /// twice. Existing `factors` of the leading columns are reused.
    fn least_squares(&self, passive: &[Passive], factors: &mut Factors) -> Vec<f64> {
        factors.keep(passive);
        let mut rest = self.target.clone();
        for (vector, projection) in factors.basis.iter().zip(&factors.projections) {
            subtract(&mut rest, *projection, vector);
        }
        for entry in passive.iter().skip(factors.columns.len()) {
            let mut vector = self.columns[entry.index].clone();
            let mut row = vec![0.0; factors.basis.len()];
            for _ in 0..2 {
                for (direction, coefficient) in factors.basis.iter().zip(&mut row) {
                    let part = dot(direction, &vector);
                    subtract(&mut vector, part, direction);
                    *coefficient += part;
                }
            }
            let remaining = length(&vector);
            row.push(remaining);
            for entry in &mut vector {
                *entry /= remaining.max(f64::MIN_POSITIVE);
            }
            let projection = dot(&vector, &rest);
            subtract(&mut rest, projection, &vector);
            factors.columns.push(entry.index);
            factors.projections.push(projection);
            factors.basis.push(vector);
            factors.triangle.push(row);
        }
        let Factors {
            triangle,
            projections,
            ..
        } = &*factors;
        let mut solution = vec![0.0; passive.len()];
        for k in (0..passive.len()).rev() {
            let known: f64 = (k + 1..passive.len())
                .map(|j| triangle[j][k] * solution[j])
                .sum();
            // A column that equals a combination of the others within rounding adds no information.
            solution[k] = if triangle[k][k] > 1e-13 {
                (projections[k] - known) / triangle[k][k]
            } else {
                0.0
            };
        }
        solution
    }
}

/// Orthogonal factors of some columns, in their order.
#[derive(Debug, Default)]
struct Factors {
    /// Numbers of the columns.
    columns: Vec<usize>,
    basis: Vec<Vec<f64>>,
    triangle: Vec<Vec<f64>>,
    /// Projection of the target on each basis vector, after those on the vectors before it were
    /// subtracted.
    projections: Vec<f64>,
}

impl Factors {
    /// Keeps the factors of the leading columns that `passive` also begins with.
    fn keep(&mut self, passive: &[Passive]) {
        let pairs = self.columns.iter().zip(passive);
        let kept = pairs
            .take_while(|(own, other)| **own == other.index)
            .count();
        self.columns.truncate(kept);
        self.basis.truncate(kept);
        self.triangle.truncate(kept);
        self.projections.truncate(kept);
    }
}

/// A column that may have a coefficient above 0.
#[derive(Debug, Clone, Copy)]
struct Passive {
    index: usize,
    amount: f64,
}

/// Returns a·b. Eight partial sums are computed in parallel, so that no addition waits for the one
/// before; their order does not depend on the processor.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let mut sums = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

pub(super) fn length(vector: &[f64]) -> f64 {
    dot(vector, vector).sqrt()
}

pub(super) fn subtract(from: &mut [f64], amount: f64, vector: &[f64]) {
    for (from, entry) in from.iter_mut().zip(vector) {
        *from -= amount * entry;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Creates a problem with the bound |x*|₁ <= |A x*|₁ <= √m |b|: a column of length 1 without
    /// negative entries has a sum of entries of at least 1.
    fn problem(columns: Vec<Vec<f64>>, target: Vec<f64>) -> NonNegativeProblem {
        let largest_sum = (target.len() as f64).sqrt() * length(&target);
        NonNegativeProblem::new(columns, target, largest_sum)
    }

    /// Checks the conditions of Karush, Kuhn and Tucker, which only the optimum satisfies, on a
    /// problem whose unconstrained optimum has negative coefficients.
    #[test]
    fn solution_satisfies_the_optimality_conditions() {
        let columns: Vec<Vec<f64>> = (0..12)
            .map(|k| (0..20).map(|j| (-0.02 * f64::from(k * j)).exp()).collect())
            .collect();
        let target: Vec<f64> = (0..20).map(|j| 1.0 / (1.0 + f64::from(j * j))).collect();
        let problem = problem(columns.clone(), target.clone());
        let solution = problem.solve(0.0);
        let mut rest = target;
        for (column, amount) in columns.iter().zip(&solution.coefficients) {
            subtract(&mut rest, *amount, column);
        }
        assert!((length(&rest) - solution.residual).abs() < 1e-14);
        // By `TOLERANCE`, the squared residual is within 1 % of its optimum, and the residual
        // within slightly more than 0.5 %.
        assert!(solution.residual_lower_bound <= solution.residual);
        assert!(solution.residual_lower_bound > 0.994 * solution.residual);
        for (column, amount) in columns.iter().zip(&solution.coefficients) {
            let gradient = dot(column, &rest);
            assert!(*amount >= 0.0);
            // Tolerance: rounding of the orthogonalisation, with 20 terms and a condition number of
            // the columns of up to 1e3.
            assert!(gradient < 1e-10, "{gradient:e}");
            assert!(*amount == 0.0 || gradient.abs() < 1e-10, "{gradient:e}");
        }
        assert!(solution.coefficients.iter().any(|amount| *amount > 0.0));
        assert!(solution.coefficients.contains(&0.0));
    }

    /// Checks that a target inside the cone is reached.
    #[test]
    fn target_inside_the_cone_is_reached() {
        let columns = vec![
            vec![1.0, 0.0, 0.0],
            vec![1.0, 1.0, 0.0],
            vec![0.0, 1.0, 3.0],
        ];
        let problem = problem(columns, vec![3.0, 4.0, 3.0]);
        let solution = problem.solve(1e-12);
        assert!(solution.residual < 1e-12);
        let exact = [0.0, 3.0, 1.0];
        for (found, exact) in solution.coefficients.iter().zip(exact) {
            assert!((found - exact).abs() < 1e-12);
        }
    }
}

//! Errors that are common to all lines, in addition to independent ones.
//!
//! In units of the independent errors, with half of a complex unit variance for each part, twice
//! the covariance of the residuals is C = I + 2 Σ g gᵀ with the vectors g of the common errors. The
//! problem is whitened with C^{-1/2}, one rank after the other: whitening of the first vector
//! changes the second, and so on.

use super::non_negative::{NonNegativeProblem, dot, length, subtract};

/// Vectors of common errors in units of the independent ones, real and imaginary parts in turn.
pub(super) struct CommonErrors {
    vectors: Vec<Vec<f64>>,
    /// The vectors, each whitened by those before it.
    whitened: Vec<Vec<f64>>,
}

impl CommonErrors {
    pub(super) fn new(vectors: Vec<Vec<f64>>) -> Self {
        let mut common = Self {
            vectors: Vec::new(),
            whitened: Vec::new(),
        };
        for mut vector in vectors {
            common.vectors.push(vector.clone());
            common.whiten(&mut vector);
            common.whitened.push(vector);
        }
        common
    }

    /// The vectors as given.
    pub(super) fn vectors(&self) -> &[Vec<f64>] {
        &self.vectors
    }

    /// Computes C^{-1/2} `values`, which is never longer.
    fn whiten(&self, values: &mut [f64]) {
        for vector in &self.whitened {
            let square = 2.0 * dot(vector, vector);
            if square > 0.0 {
                // (I + a aᵀ)^{-1/2} = I - a aᵀ (1 - 1/√(1 + a²))/a², without the difference
                let root = (1.0 + square).sqrt();
                let part = 2.0 * dot(vector, values) / (root * (1.0 + root));
                subtract(values, part, vector);
            }
        }
    }

    /// Whitened problem of the nearest sum of `columns` to `target`.
    pub(super) fn problem(&self, mut columns: Vec<Vec<f64>>, target: &[f64]) -> NonNegativeProblem {
        let mut whitened = target.to_vec();
        self.whiten(&mut whitened);
        for column in &mut columns {
            self.whiten(column);
        }
        // By optimality the sum of columns x* has |C^{-1/2} A x*| <= |C^{-1/2} b|, and C^{-1/2}
        // shortens a vector by at most this factor; columns without negative entries have a
        // sum of at least their length, |x*|₁ <= |A x*|₁ <= √m |A x*|.
        let shortest: f64 = self
            .whitened
            .iter()
            .map(|vector| (1.0 + 2.0 * dot(vector, vector)).sqrt())
            .product();
        let largest_sum = (target.len() as f64).sqrt() * length(&whitened) * shortest;
        NonNegativeProblem::new(columns, whitened, largest_sum)
    }

    /// Sizes ξ of the common errors that best explain the residual `rest`, by |rest - Σ ξ g|² + ½ Σ
    /// ξ².
    pub(super) fn sizes(&self, rest: &[f64]) -> Vec<f64> {
        // ξ = 2 gᵀ C⁻¹ rest, by C⁻¹ = W Wᵀ with the steps of whitening applied forwards and
        // backwards
        let mut solved = rest.to_vec();
        self.whiten(&mut solved);
        for vector in self.whitened.iter().rev() {
            let square = 2.0 * dot(vector, vector);
            if square > 0.0 {
                let root = (1.0 + square).sqrt();
                let part = 2.0 * dot(vector, &solved) / (root * (1.0 + root));
                subtract(&mut solved, part, vector);
            }
        }
        self.vectors
            .iter()
            .map(|vector| 2.0 * dot(vector, &solved))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The whitened length is the minimum over ξ of |r - Σ ξ g|² + ½ Σ ξ², and `sizes` are at this
    /// minimum.
    #[test]
    fn r14_common_errors_are_taken_off_where_the_sum_of_squares_is_least() {
        let first = vec![3.0, 1.0, 0.0, -2.0, 0.5];
        let second = vec![1.0, 1.0, 4.0, 0.0, -1.0];
        let rest = vec![2.0, -1.0, 3.0, 0.7, 0.1];
        let common = CommonErrors::new(vec![first.clone(), second.clone()]);
        let objective = |sizes: &[f64]| {
            let mut left = rest.clone();
            subtract(&mut left, sizes[0], &first);
            subtract(&mut left, sizes[1], &second);
            dot(&left, &left) + 0.5 * dot(sizes, sizes)
        };
        let sizes = common.sizes(&rest);
        let least = objective(&sizes);
        for (a, b) in [(1e-3, 0.0), (-1e-3, 0.0), (0.0, 1e-3), (0.0, -1e-3)] {
            assert!(objective(&[sizes[0] + a, sizes[1] + b]) > least);
        }
        let mut whitened = rest.clone();
        common.whiten(&mut whitened);
        assert!((dot(&whitened, &whitened) - least).abs() < 1e-12);
    }

    /// A Maxwell material that is wrong by 1.5 times a wavy common error: no relaxing material has
    /// these values, unless the error is declared.
    #[test]
    fn r14_a_declared_common_error_is_no_violation() {
        use crate::kramers_kronig::{KramersKronig, Verdict};
        use num_complex::Complex64;

        let omega: Vec<f64> = (1..=100).map(|j| 500.0 * f64::from(j)).collect();
        let relaxing = |omega: f64| {
            let s_tau = Complex64::new(0.0, omega * 1e-4);
            2e9 + 1e9 * s_tau / (1.0 + s_tau)
        };
        let wave: Vec<Complex64> = omega
            .iter()
            .map(|omega| Complex64::new(5e7 * (omega / 2e3).sin(), 0.0))
            .collect();
        let measured = omega.iter().zip(&wave);
        let modulus: Vec<Complex64> = measured.map(|(w, e)| relaxing(*w) + 1.5 * e).collect();
        let errors = vec![1e7; omega.len()];
        let silent = KramersKronig::of_measured_modulus(&omega, &modulus, &errors).unwrap();
        assert_eq!(silent.verdict(), Verdict::NotCausal);
        let declared =
            KramersKronig::of_modulus_with_common_errors(&omega, &modulus, &errors, &[wave]);
        let declared = declared.unwrap();
        assert_eq!(declared.verdict(), Verdict::Causal);
        assert!((declared.common_errors[0] - 1.5).abs() < 0.1);
    }
}

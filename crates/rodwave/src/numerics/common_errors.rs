//! Common errors of values, in addition to independent errors.

/// Whitening of values with independent errors of unit variance and common errors.
///
/// If a common error is wrong by its standard uncertainty, all values change by its vector g. The
/// covariance of the values is therefore C = I + Σ g gᵀ. [`whiten`](Self::whiten) multiplies by
/// C^{-1/2}, one rank after the other: the whitening by the first vector changes the second, and so
/// on.
///
/// ```
/// use rodwave::numerics::CommonErrors;
///
/// // three measurements of one length; the error of the scale is 3 times the random error of a
/// // measurement
/// let common = CommonErrors::new(vec![vec![3.0; 3]]);
/// let mut residual = [3.1, 2.9, 3.0];
/// // the mean of 3 is one standard uncertainty of the scale; the term ξ² reduces ξ by 1 part in 28
/// assert!((common.sizes(&residual)[0] - 27.0 / 28.0).abs() < 1e-12);
/// common.whiten(&mut residual);
/// let square: f64 = residual.iter().map(|r| r * r).sum();
/// assert!((square - (0.02 + 27.0 / 28.0)).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CommonErrors {
    vectors: Vec<Vec<f64>>,
    /// The vectors; each is whitened by those before it.
    whitened: Vec<Vec<f64>>,
}

impl CommonErrors {
    /// Creates the whitening from the vector g of each source of error, with one entry per value.
    #[must_use]
    pub fn new(vectors: Vec<Vec<f64>>) -> Self {
        let mut common = Self::default();
        for vector in vectors {
            let mut whitened = vector.clone();
            common.whiten(&mut whitened);
            common.whitened.push(whitened);
            common.vectors.push(vector);
        }
        common
    }

    /// Returns the vectors as given.
    #[must_use]
    pub fn vectors(&self) -> &[Vec<f64>] {
        &self.vectors
    }

    /// Computes C^{-1/2} `values` in place; the result is never longer than `values`.
    pub fn whiten(&self, values: &mut [f64]) {
        for vector in &self.whitened {
            whiten_by(vector, values);
        }
    }

    /// Returns an upper bound of the factor by which whitening shortens a vector.
    #[must_use]
    pub fn shortening(&self) -> f64 {
        let root = |vector: &Vec<f64>| (1.0 + dot(vector, vector)).sqrt();
        self.whitened.iter().map(root).product()
    }

    /// Returns the sizes ξ of the common errors, in standard uncertainties, that best explain the
    /// residual `rest`. They minimise |rest - Σ ξ g|² + Σ ξ²; the minimum is the squared length of
    /// the whitened residual.
    #[must_use]
    pub fn sizes(&self, rest: &[f64]) -> Vec<f64> {
        // ξ = gᵀ C⁻¹ rest; C⁻¹ is the whitening, applied forwards and then backwards
        let mut solved = rest.to_vec();
        self.whiten(&mut solved);
        for vector in self.whitened.iter().rev() {
            whiten_by(vector, &mut solved);
        }
        let along = |vector: &Vec<f64>| dot(vector, &solved);
        self.vectors.iter().map(along).collect()
    }
}

/// Computes (I + a aᵀ)^{-1/2} `values` = values - a (a·values) (1 - 1/√(1 + a²))/a², without
/// cancellation in the difference.
fn whiten_by(vector: &[f64], values: &mut [f64]) {
    let root = (1.0 + dot(vector, vector)).sqrt();
    let part = dot(vector, values) / (root * (1.0 + root));
    for (value, entry) in values.iter_mut().zip(vector) {
        *value -= part * entry;
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that the squared length of the whitened residual is the minimum over ξ of |r - Σ ξ
    /// g|² + Σ ξ², and that `sizes` returns the ξ of this minimum.
    #[test]
    fn common_errors_are_taken_off_where_the_sum_of_squares_is_least() {
        let first = vec![3.0, 1.0, 0.0, -2.0, 0.5];
        let second = vec![1.0, 1.0, 4.0, 0.0, -1.0];
        let rest = vec![2.0, -1.0, 3.0, 0.7, 0.1];
        let common = CommonErrors::new(vec![first.clone(), second.clone()]);
        let objective = |[a, b]: [f64; 2]| {
            let parts = rest.iter().zip(&first).zip(&second);
            let left = parts.map(|((r, f), s)| (r - a * f - b * s).powi(2));
            left.sum::<f64>() + a * a + b * b
        };
        let sizes = common.sizes(&rest);
        let sizes = [sizes[0], sizes[1]];
        let least = objective(sizes);
        for [a, b] in [[1e-3, 0.0], [-1e-3, 0.0], [0.0, 1e-3], [0.0, -1e-3]] {
            assert!(objective([sizes[0] + a, sizes[1] + b]) > least);
        }
        let mut whitened = rest.clone();
        common.whiten(&mut whitened);
        assert!((dot(&whitened, &whitened) - least).abs() < 1e-12);
        assert!(dot(&rest, &rest).sqrt() <= common.shortening() * least.sqrt());
    }
}

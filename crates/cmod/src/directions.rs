//! Singular directions of a Jacobian, and the covariance of parameters.

use faer::Mat;

use crate::vectors::{dot, length};

/// Singular values and right vectors of a Jacobian, J = U S Vᵀ.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Directions {
    /// Singular values in descending order, one per parameter; 0 where there are fewer residuals
    /// than parameters, and at the level of rounding.
    pub(crate) singular_values: Vec<f64>,
    /// Right singular vectors; `vectors[k]` belongs to `singular_values[k]`.
    pub(crate) vectors: Vec<Vec<f64>>,
    /// Product Uᵀ r with the residual r.
    pub(crate) projected: Vec<f64>,
}

impl Directions {
    /// Decomposes the Jacobian whose entry for residual i and parameter j is `entry(i, j)`; `None`
    /// if it is not finite. A singular value below the fraction `rank` of the largest one counts as
    /// rounding and is set to 0.
    #[allow(
        clippy::indexing_slicing,
        reason = "the decomposition has as many values and vectors as there are parameters"
    )]
    pub(crate) fn of(
        residual: &[f64],
        parameters: usize,
        entry: impl Fn(usize, usize) -> Option<f64>,
        rank: f64,
    ) -> Option<Self> {
        // empty rows at the end do not change the singular values, but make the number of singular
        // values equal to the number of parameters
        let rows = residual.len().max(parameters);
        let matrix = Mat::from_fn(rows, parameters, |i, j| entry(i, j).unwrap_or(0.0));
        let svd = matrix.thin_svd().ok()?;
        let values = svd.S().column_vector();
        let largest = if parameters > 0 { values[0] } else { 0.0 };
        if !largest.is_finite() {
            return None;
        }
        let (left, right) = (svd.U(), svd.V());
        let above_rounding = |value: f64| if value > rank * largest { value } else { 0.0 };
        Some(Self {
            singular_values: (0..parameters).map(|k| above_rounding(values[k])).collect(),
            vectors: (0..parameters)
                .map(|k| (0..parameters).map(|j| right[(j, k)]).collect())
                .collect(),
            projected: (0..parameters)
                .map(|k| {
                    let rows = residual.iter().enumerate();
                    rows.map(|(i, r)| left[(i, k)] * r).sum()
                })
                .collect(),
        })
    }

    /// Returns the number of singular values above rounding.
    pub(crate) fn rank(&self) -> usize {
        self.singular_values.iter().filter(|s| **s > 0.0).count()
    }

    /// Returns gᵀ (JᵀJ)⁻¹ h; infinite, with a sign, if g and h have a component along an
    /// undetermined direction.
    pub(crate) fn covariance(&self, g: &[f64], h: &[f64]) -> f64 {
        self.singular_values
            .iter()
            .zip(&self.vectors)
            .map(|(s, vector)| {
                let (a, b) = (dot(g, vector), dot(h, vector));
                if *s > 0.0 {
                    a * b / (s * s)
                } else if a.abs() <= 1e-6 * length(g) || b.abs() <= 1e-6 * length(h) {
                    // a component this small may be due to rounding errors of the singular vector
                    0.0
                } else {
                    f64::INFINITY * (a * b).signum()
                }
            })
            .sum()
    }
}

//! Sums over vectors, of residuals and of parameters.

/// Returns `values` - Σ sizes · columns.
pub(crate) fn without(values: &[f64], columns: &[Vec<f64>], sizes: &[f64]) -> Vec<f64> {
    let mut left = values.to_vec();
    for (size, column) in sizes.iter().zip(columns) {
        subtract(&mut left, *size, column);
    }
    left
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(crate) fn length(values: &[f64]) -> f64 {
    dot(values, values).sqrt()
}

pub(crate) fn subtract(values: &mut [f64], factor: f64, other: &[f64]) {
    for (value, other) in values.iter_mut().zip(other) {
        *value -= factor * other;
    }
}

/// Adds `weight` · v vᵀ to `matrix`.
pub(crate) fn add_square(matrix: &mut [Vec<f64>], weight: f64, vector: &[f64]) {
    for (row, own) in matrix.iter_mut().zip(vector) {
        subtract(row, -weight * own, vector);
    }
}

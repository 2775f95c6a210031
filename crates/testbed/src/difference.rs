//! Differences between two computations.

use num_complex::Complex64;

use crate::claim::Found;

/// Returns the largest magnitude; NaN if any value is NaN, so that a NaN cannot pass a test.
pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().map(f64::abs).fold(0.0, |worst, value| {
        if value > worst || value.is_nan() {
            value
        } else {
            worst
        }
    })
}

/// Returns the largest difference between two histories of equal length; NaN if their lengths
/// differ.
pub fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    if a.len() == b.len() {
        largest(a.iter().zip(b).map(|(a, b)| a - b))
    } else {
        f64::NAN
    }
}

/// Returns the largest `error` of several `cases`, or the first failure.
pub fn worst<T>(cases: impl IntoIterator<Item = T>, error: impl FnMut(T) -> Found) -> Found {
    let errors: Result<Vec<f64>, _> = cases.into_iter().map(error).collect();
    Ok(largest(errors?))
}

/// Returns |a - b|/|b|.
pub fn relative(a: Complex64, b: Complex64) -> f64 {
    (a - b).norm() / b.norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_is_the_largest() {
        assert!(largest([1.0, f64::NAN, 2.0]).is_nan());
        assert!(largest_difference(&[1.0], &[1.0, 2.0]).is_nan());
        assert!((largest([1.0, -3.0, 2.0]) - 3.0).abs() < f64::EPSILON);
    }
}

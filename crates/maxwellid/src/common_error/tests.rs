use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

use super::*;

/// Two common errors whose columns, of five rows, are not orthogonal.
fn common() -> (CommonErrors, Vec<Vec<f64>>) {
    let columns = vec![
        vec![3.0, -1.0, 0.5, 0.0, 2.0],
        vec![1.0, 4.0, 0.0, -2.0, 1.0],
    ];
    (CommonErrors::of_columns(columns.clone()), columns)
}

/// Compares the product of the factors with the Cholesky factorisation of the covariance.
#[test]
fn the_factors_are_an_inverse_square_root() {
    let (common, columns) = common();
    let covariance = Mat::from_fn(5, 5, |i, j| {
        let own: f64 = columns.iter().map(|a| a[i] * a[j]).sum();
        own + if i == j { 1.0 } else { 0.0 }
    });
    let inverse = covariance.llt(Side::Lower).unwrap();
    let vector = [0.3, -1.2, 2.0, 0.7, -0.4];
    let solved = inverse.solve(Mat::from_fn(5, 1, |i, _| vector[i]));
    let mut without = vector.to_vec();
    common.without(&mut without);
    let mut white = vector.to_vec();
    common.whiten(&mut white);
    let (mut of_white, mut of_inverse) = (0.0, 0.0);
    for i in 0..5 {
        assert!((without[i] - solved[(i, 0)]).abs() < 1e-14);
        of_white += white[i] * white[i];
        of_inverse += vector[i] * solved[(i, 0)];
    }
    assert!((of_white / of_inverse - 1.0).abs() < 1e-14);
}

/// Checks the estimate of one error with the column a from a residual proportional to a: its prior
/// reduces it by the fraction 1/(1 + |a|²), here 1/26.
#[test]
fn the_most_likely_errors_are_those_of_least_squares() {
    let column = vec![3.0, 0.0, 4.0];
    let common = CommonErrors::of_columns(vec![column.clone()]);
    // simulated minus measured, for a true error of two standard uncertainties
    let residual: Vec<f64> = column.iter().map(|a| -2.0 * a).collect();
    let found = common.most_likely(residual)[0];
    assert!((found - 2.0 * 25.0 / 26.0).abs() < 1e-14, "{found}");
}

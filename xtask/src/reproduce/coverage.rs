//! Agreement of estimates with the material of a virtual test.

use cmod::{ModulusEstimate, ModulusLine};
use num_complex::Complex64;

/// Returns the fraction of the values E' and E'' of valid lines within a number of standard errors.
pub(crate) fn within(
    estimate: &ModulusEstimate,
    exact: &dyn Fn(&ModulusLine) -> Complex64,
    limit: f64,
) -> f64 {
    let deviations: Vec<f64> = estimate
        .valid()
        .flat_map(|line| {
            let exact = exact(line);
            [
                (line.modulus.re - exact.re) / line.standard_error.storage_modulus,
                (line.modulus.im - exact.im) / line.standard_error.loss_modulus,
            ]
        })
        .collect();
    let inside = deviations.iter().filter(|d| d.abs() < limit).count();
    inside as f64 / deviations.len().max(1) as f64
}

//! Lines linearised about a smooth modulus, and the residual that no modulus explains.

use num_complex::Complex64;

use crate::estimate::{ErrorSource, SystematicShift};
use crate::vectors::{dot, subtract};

/// Line linearised about a smooth modulus. Its derivatives are independent of the noise.
/// Derivatives at the modulus of the line itself would be correlated with the noise, and if the
/// data determine a source poorly, this correlation would be mistaken for an error of the source.
pub(crate) struct LinearisedLine {
    pub(crate) modulus: Complex64,
    /// Variance E|δE|² \[Pa²\].
    pub(crate) variance: f64,
    pub(crate) shifts: Vec<SystematicShift>,
    /// Residual that no modulus explains, if there are redundant measurements.
    pub(crate) misfit: Option<Misfit>,
}

/// Normal equations for the errors of the measured sources, from the residual that no modulus
/// explains, in units of the noise.
#[derive(Debug, Clone, Default)]
pub(crate) struct Misfit {
    /// Products of the derivatives with each other, by rows.
    pub(crate) normal: Vec<f64>,
    /// Products of the derivatives with the residual.
    pub(crate) gradient: Vec<f64>,
    /// Sum of squares of the residual.
    pub(crate) square: f64,
    pub(crate) degrees_of_freedom: f64,
}

impl Misfit {
    /// Returns the sum over the `lines`, from which errors of the sizes `removed` were removed. The
    /// sum is converted to its value before this removal.
    pub(crate) fn of(lines: &[LinearisedLine], removed: &[f64]) -> Self {
        let n = removed.len();
        let mut sum = Self {
            normal: vec![0.0; n * n],
            gradient: vec![0.0; n],
            ..Self::default()
        };
        for misfit in lines.iter().filter_map(|line| line.misfit.as_ref()) {
            subtract(&mut sum.normal, -1.0, &misfit.normal);
            subtract(&mut sum.gradient, -1.0, &misfit.gradient);
            sum.square += misfit.square;
            sum.degrees_of_freedom += misfit.degrees_of_freedom;
        }
        let before = sum
            .normal
            .chunks_exact(n.max(1))
            .map(|row| dot(row, removed));
        let before: Vec<f64> = before.collect();
        sum.square += 2.0 * dot(&sum.gradient, removed) + dot(&before, removed);
        subtract(&mut sum.gradient, -1.0, &before);
        sum
    }

    /// Returns the same information on `n` sources, the measured sources first, as readings with
    /// errors of variance 1. Each reading is a weighted sum of the sizes: the weights, and the
    /// value of the sum.
    pub(crate) fn readings(&self, n: usize) -> Vec<(Vec<f64>, f64)> {
        // Cholesky factors by rows; a source that depends on earlier sources has no pivot
        let measured = self.gradient.len();
        let mut rest = self.normal.clone();
        let mut right = self.gradient.clone();
        let mut readings = Vec::with_capacity(measured);
        for pivot in 0..measured {
            let row = rest.get(pivot * measured..(pivot + 1) * measured);
            let row: Vec<f64> = row.unwrap_or_default().to_vec();
            let size = row.get(pivot).copied().unwrap_or(0.0);
            let whole = self
                .normal
                .get(pivot * measured + pivot)
                .copied()
                .unwrap_or(0.0);
            if size.is_nan() || size <= 1e-10 * whole {
                continue;
            }
            let mut factors: Vec<f64> = row.iter().map(|entry| entry / size.sqrt()).collect();
            let value = right.get(pivot).copied().unwrap_or(0.0) / size.sqrt();
            for (row, own) in rest.chunks_exact_mut(measured).zip(&factors) {
                subtract(row, *own, &factors);
            }
            subtract(&mut right, value, &factors);
            factors.resize(n, 0.0);
            readings.push((factors, value));
        }
        readings
    }

    /// Returns the sum of squares that remains after removal of errors of these `sizes`.
    pub(super) fn left(&self, sizes: &[f64]) -> f64 {
        let rows = self.normal.chunks_exact(self.gradient.len().max(1));
        let quadratic: f64 = rows
            .zip(sizes)
            .map(|(row, size)| size * dot(row, sizes))
            .sum();
        (self.square - 2.0 * dot(&self.gradient, sizes) + quadratic).max(0.0)
    }
}

/// Returns the sources of all lines that have a standard uncertainty, the `measured` sources first.
pub(crate) fn sources_of(lines: &[LinearisedLine], measured: &[ErrorSource]) -> Vec<ErrorSource> {
    let mut sources = measured.to_vec();
    for shift in lines.iter().flat_map(|line| &line.shifts) {
        if shift.source != ErrorSource::LateralInertia && !sources.contains(&shift.source) {
            sources.push(shift.source);
        }
    }
    sources
}

/// Returns the part of the `shifts` of a line due to `source`; 0 if the line does not depend on it.
pub(crate) fn shift_of(shifts: &[SystematicShift], source: ErrorSource) -> SystematicShift {
    let mut sum = SystematicShift::new(source, Complex64::ZERO, Complex64::ZERO);
    for shift in shifts {
        if shift.source == source {
            sum.modulus += shift.modulus;
            sum.propagation_coefficient += shift.propagation_coefficient;
        }
    }
    sum
}

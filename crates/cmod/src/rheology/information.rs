//! Errors of the parameters from the linearised law.

use num_complex::Complex64;

use super::least_squares::Linearised;
use crate::directions::Directions;
use crate::vectors::{dot, subtract};

/// Fraction of the largest singular value below which a singular value counts as rounding.
const RANK: f64 = 1e-10;

#[allow(
    clippy::indexing_slicing,
    reason = "every singular value has a direction, every direction an element for each parameter, and the indices are below these numbers"
)]
impl Directions {
    /// Decomposes the whitened Jacobian of a law; `None` if it is not finite.
    pub(super) fn of_law(linearised: &Linearised, parameters: usize) -> Option<Self> {
        let entry = |i: usize, j: usize| linearised.jacobian.get(i * parameters + j).copied();
        Self::of(&linearised.residual, parameters, entry, RANK)
    }

    /// Returns the change of the coordinates due to a change `whitened` of the data, J⁺ times
    /// `whitened`; 0 along undetermined directions.
    pub(super) fn change(&self, linearised: &Linearised, whitened: &[f64]) -> Vec<f64> {
        let parameters = self.singular_values.len();
        let mut gradient = vec![0.0; parameters];
        let rows = linearised.jacobian.chunks_exact(parameters.max(1));
        for (row, value) in rows.zip(whitened) {
            subtract(&mut gradient, -value, row);
        }
        let mut change = vec![0.0; parameters];
        for (s, direction) in self.singular_values.iter().zip(&self.vectors) {
            if *s > 0.0 {
                let along = dot(direction, &gradient);
                for (sum, entry) in change.iter_mut().zip(direction) {
                    *sum += entry * along / (s * s);
                }
            }
        }
        change
    }

    /// Returns the covariance of the coordinates; `None` if a combination of coordinates is
    /// undetermined.
    pub(super) fn matrix(&self) -> Option<Vec<Vec<f64>>> {
        let parameters = self.singular_values.len();
        (self.rank() == parameters).then(|| {
            (0..parameters)
                .map(|i| (0..parameters).map(|j| self.entry(i, j)).collect())
                .collect()
        })
    }

    /// Returns the covariance of the last `count` coordinates; its elements are infinite where
    /// undetermined.
    pub(super) fn of_last(&self, count: usize) -> Vec<Vec<f64>> {
        let parameters = self.singular_values.len();
        let unit = |own: usize| {
            let mut unit = vec![0.0; parameters];
            unit[own] = 1.0;
            unit
        };
        let first = parameters.saturating_sub(count);
        let units: Vec<Vec<f64>> = (first..parameters).map(unit).collect();
        let row = |a: &Vec<f64>| units.iter().map(|b| self.covariance(a, b)).collect();
        units.iter().map(row).collect()
    }

    pub(super) fn variance(&self, index: usize) -> f64 {
        let mut unit = vec![0.0; self.singular_values.len()];
        unit[index] = 1.0;
        self.covariance(&unit, &unit)
    }

    fn entry(&self, i: usize, j: usize) -> f64 {
        self.singular_values
            .iter()
            .zip(&self.vectors)
            .map(|(s, direction)| direction[i] * direction[j] / (s * s))
            .sum()
    }

    /// Returns the covariance \[Pa²\] of (E', E'') from the derivatives `gradient` \[Pa\] of the
    /// modulus with respect to the coordinates.
    pub(super) fn of_modulus(&self, gradient: &[Complex64]) -> [[f64; 2]; 2] {
        let storage: Vec<f64> = gradient.iter().map(|g| g.re).collect();
        let loss: Vec<f64> = gradient.iter().map(|g| g.im).collect();
        let mixed = self.covariance(&storage, &loss);
        [
            [self.covariance(&storage, &storage), mixed],
            [mixed, self.covariance(&loss, &loss)],
        ]
    }

    /// Returns the correlation partner of the coordinate `index`, that is, the other coordinate
    /// with the largest component in the direction that contributes most to the variance of
    /// `index`, and the correlation coefficient of the two coordinates.
    pub(super) fn partner(&self, index: usize) -> Option<(usize, f64)> {
        // the direction that contributes most to the variance of the coordinate
        let floor = RANK * self.singular_values.first().copied().unwrap_or(0.0);
        let weight = |k: usize| self.vectors[k][index] / self.singular_values[k].max(floor);
        let weakest =
            (0..self.vectors.len()).max_by(|a, b| weight(*a).abs().total_cmp(&weight(*b).abs()))?;
        let direction = &self.vectors[weakest];
        let partner = (0..direction.len())
            .filter(|other| *other != index)
            .max_by(|a, b| direction[*a].abs().total_cmp(&direction[*b].abs()))?;
        let correlation = self.correlation(index, partner);
        correlation.is_finite().then_some((partner, correlation))
    }

    /// Returns the correlation coefficient of two coordinates; singular values below the limit of
    /// rounding are replaced by this limit.
    pub(super) fn correlation(&self, i: usize, j: usize) -> f64 {
        let floor = RANK * self.singular_values.first().copied().unwrap_or(0.0);
        let sum = |i: usize, j: usize| -> f64 {
            self.singular_values
                .iter()
                .zip(&self.vectors)
                .map(|(s, direction)| direction[i] * direction[j] / s.max(floor).powi(2))
                .sum()
        };
        sum(i, j) / (sum(i, i) * sum(j, j)).sqrt()
    }
}

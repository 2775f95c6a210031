//! Errors of sensors and positions that are the same on all lines.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use num_complex::Complex64;

use crate::free_end::{FreeEndShape, RodWithFreeEnd};
use crate::multi_point::{GaugeUncertainty, Quantity};

/// Property of the arrangement that has an error.
#[derive(Debug, Clone, Copy)]
enum Property {
    Position(usize),
    Factor(usize),
    Delay(usize),
    /// Position of the free end, which changes all distances.
    FreeEnd,
    /// Length of rod that has the same mass as the end mass.
    EndLength,
}

/// Errors with a normal prior, in standard deviations of the prior.
#[derive(Debug)]
pub(super) struct CommonErrors {
    properties: Vec<(Property, f64)>,
    values: Vec<f64>,
}

/// Sums over lines of the linearised problem.
#[derive(Debug)]
pub(super) struct NormalEquations {
    /// Σ Re J*J, row by row.
    matrix: Vec<f64>,
    /// Σ Re J*r.
    right: Vec<f64>,
}

impl CommonErrors {
    /// Creates errors of 0 for the quantities that are uncertain.
    pub(super) fn of(uncertainty: &GaugeUncertainty, rod: &RodWithFreeEnd) -> Self {
        let each = |values: &[f64], property: fn(usize) -> Property| -> Vec<(Property, f64)> {
            let values = values.iter().enumerate();
            values
                .map(|(gauge, value)| (property(gauge), *value))
                .collect()
        };
        let length = rod.length_of_end_mass();
        let of_error = RodWithFreeEnd {
            end_mass: uncertainty.end_mass,
            ..*rod
        };
        let of_length = of_error
            .length_of_end_mass()
            .hypot(2.0 * length * uncertainty.diameter / rod.diameter)
            .hypot(length * uncertainty.density / rod.density);
        let mut properties = each(&uncertainty.positions, Property::Position);
        properties.extend(each(&uncertainty.factors, Property::Factor));
        properties.extend(each(&uncertainty.delays, Property::Delay));
        properties.push((Property::FreeEnd, uncertainty.free_end));
        properties.push((Property::EndLength, of_length));
        properties.retain(|(_, deviation)| *deviation > 0.0);
        Self {
            values: vec![0.0; properties.len()],
            properties,
        }
    }

    /// Returns the number of errors.
    pub(super) fn count(&self) -> usize {
        self.properties.len()
    }

    fn sum(&self, is: impl Fn(Property) -> bool) -> f64 {
        let each = self.properties.iter().zip(&self.values);
        each.filter(|((property, _), _)| is(*property))
            .map(|((_, deviation), value)| deviation * value)
            .sum()
    }

    /// Returns the distance of a sensor from the free end, with its errors \[m\].
    pub(super) fn distance(&self, sensor: usize, stated: f64) -> f64 {
        stated
            + self.sum(|property| match property {
                Property::Position(own) => own == sensor,
                Property::FreeEnd => true,
                _ => false,
            })
    }

    /// Returns the factor of the values of a sensor at the angular frequency ω.
    pub(super) fn factor(&self, sensor: usize, omega: f64) -> Complex64 {
        let gain = self.sum(|property| matches!(property, Property::Factor(own) if own == sensor));
        let delay = self.sum(|property| matches!(property, Property::Delay(own) if own == sensor));
        (1.0 + gain) * (-Complex64::I * omega * delay).exp()
    }

    /// Returns the length of rod that has the same mass as the end mass, with its error \[m\].
    pub(super) fn end_length(&self, stated: f64) -> f64 {
        stated + self.sum(|property| matches!(property, Property::EndLength))
    }

    /// Returns the changes of the value f of a sensor at this distance by one standard deviation of
    /// each error.
    pub(super) fn changes(
        &self,
        (sensor, distance): (usize, f64),
        (shape, gamma, omega): (&FreeEndShape, Complex64, f64),
    ) -> impl Iterator<Item = Complex64> {
        // ∂f/∂d is γ times the shape of the other quantity
        let of_other = |length_of_end_mass: f64| {
            let quantity = match shape.quantity {
                Quantity::Strain => Quantity::Displacement,
                _ => Quantity::Strain,
            };
            let other = FreeEndShape {
                quantity,
                length_of_end_mass,
            };
            gamma * other.at(distance, gamma).value
        };
        let value = shape.at(distance, gamma).value;
        let by_distance = of_other(shape.length_of_end_mass);
        let by_length = of_other(0.0);
        self.properties.iter().map(move |(property, deviation)| {
            let own = match property {
                Property::Position(own) if *own == sensor => by_distance,
                Property::Factor(own) if *own == sensor => value,
                Property::Delay(own) if *own == sensor => -Complex64::I * omega * value,
                Property::FreeEnd => by_distance,
                Property::EndLength => by_length,
                _ => Complex64::ZERO,
            };
            *deviation * own
        })
    }

    /// Moves the errors to the minimum of the linearised problem with the prior. Returns χ² at this
    /// minimum, from `chi_square` of the data at the previous errors, and the decrease of χ²;
    /// `None` if the equations have no solution.
    pub(super) fn improve(
        &mut self,
        equations: &NormalEquations,
        chi_square: f64,
    ) -> Option<(f64, f64)> {
        let count = self.count();
        let of = |values: &[f64], at: usize| values.get(at).copied().unwrap_or(f64::NAN);
        let normal = Mat::from_fn(count, count, |row, column| {
            let of_prior = if row == column { 1.0 } else { 0.0 };
            2.0 * of(&equations.matrix, row * count + column) + of_prior
        });
        let right = Mat::from_fn(count, 1, |row, _| {
            2.0 * of(&equations.right, row) - of(&self.values, row)
        });
        let step = normal.llt(Side::Lower).ok()?.solve(&right);
        let of_prior: f64 = self.values.iter().map(|value| value * value).sum();
        let fall: f64 = (0..count).map(|row| step[(row, 0)] * right[(row, 0)]).sum();
        for (row, value) in self.values.iter_mut().enumerate() {
            *value += step[(row, 0)];
        }
        Some((chi_square + of_prior - fall, fall))
    }
}

impl NormalEquations {
    pub(super) fn new(count: usize) -> Self {
        Self {
            matrix: vec![0.0; count * count],
            right: vec![0.0; count],
        }
    }

    /// Adds one line, with the `columns` J of the errors and the residual r.
    pub(super) fn add(&mut self, columns: &[Vec<Complex64>], residual: &[Complex64]) {
        let product = |a: &[Complex64], b: &[Complex64]| -> f64 {
            a.iter().zip(b).map(|(a, b)| (a.conj() * b).re).sum()
        };
        let mut entries = self.matrix.iter_mut();
        for own in columns {
            for (entry, other) in entries.by_ref().take(columns.len()).zip(columns) {
                *entry += product(own, other);
            }
        }
        for (sum, own) in self.right.iter_mut().zip(columns) {
            *sum += product(own, residual);
        }
    }
}

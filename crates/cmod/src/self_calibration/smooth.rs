//! What a smooth and causal modulus can follow of values on lines, and what it cannot.

use std::f64::consts::TAU;

use faer::Mat;
use num_complex::Complex64;

use super::line::LinearisedLine;
use super::vectors::{dot, subtract};
use crate::estimate::ModulusLine;

/// Quotient of neighbouring relaxation times. Coefficients of any sign on a grid of 2.5 leave 1e-4 of a loss that rises by powers of ten, which
/// makes a bias of many standard errors in quiet records; on this grid what they leave is below every noise.
const GRID: f64 = 1.5;
/// The grid goes so far beyond the band.
const BEYOND: f64 = 1000.0;
/// Standard deviation of the largest contribution of a term in the band, by the largest modulus there.
const LARGEST_TERM: f64 = 10.0;

/// Least squares of a smooth modulus through lines, in units of their noise.
pub(super) struct Smoothing {
    weights: Vec<f64>,
    /// Orthonormal directions of all smooth moduli, over the lines and the priors of the coefficients.
    basis: Vec<Vec<f64>>,
    /// Number of parameters that the lines determine.
    pub(super) parameters: f64,
}

impl Smoothing {
    /// `None` without lines, or where a value is not finite.
    pub(super) fn of(lines: &[&ModulusLine], about: &[LinearisedLine]) -> Option<Self> {
        let weight = |line: &LinearisedLine| (2.0 / line.variance).sqrt();
        let weights: Vec<f64> = about.iter().map(weight).collect();
        let columns: Vec<Vec<f64>> = SmoothModulus::on(lines)?
            .terms(lines)
            .into_iter()
            .map(|term| whitened(&weights, term.into_iter()))
            .collect();
        let rows = 2 * lines.len();
        let basis = basis(&columns, rows)?;
        // of the directions in the rows of the lines; the rest is of the priors
        let of_lines =
            |direction: &Vec<f64>| direction.iter().take(rows).map(|x| x * x).sum::<f64>();
        Some(Self {
            weights,
            parameters: basis.iter().map(of_lines).sum(),
            basis,
        })
    }

    /// Values of the lines by their noise, real and imaginary parts in turn, and 0 for the priors.
    pub(super) fn whitened(&self, values: impl Iterator<Item = Complex64>) -> Vec<f64> {
        let mut values = whitened(&self.weights, values);
        values.resize(values.len() + self.basis.len(), 0.0);
        values
    }

    /// What no smooth modulus follows of whitened `values`.
    pub(super) fn rest_of(&self, values: &[f64]) -> Vec<f64> {
        let mut rest = values.to_vec();
        for direction in &self.basis {
            let part = dot(direction, &rest);
            subtract(&mut rest, part, direction);
        }
        rest
    }

    /// The smooth modulus of each line nearest to whitened `values`.
    pub(super) fn smooth(&self, values: &[f64]) -> Vec<Complex64> {
        let mut smooth = values.to_vec();
        subtract(&mut smooth, 1.0, &self.rest_of(values));
        let lines = smooth.chunks_exact(2).zip(&self.weights);
        lines
            .map(|(parts, w)| match parts {
                [re, im] => Complex64::new(re / w, im / w),
                _ => Complex64::ZERO,
            })
            .collect()
    }
}

fn whitened(weights: &[f64], values: impl Iterator<Item = Complex64>) -> Vec<f64> {
    let whitened = weights.iter().zip(values).map(|(w, value)| w * value);
    whitened.flat_map(|value| [value.re, value.im]).collect()
}

/// Functions of frequency whose sums any smooth and causal modulus in a band is.
struct SmoothModulus {
    relaxation_times: Vec<f64>,
    highest: f64,
}

impl SmoothModulus {
    /// `None` without lines.
    fn on(lines: &[&ModulusLine]) -> Option<Self> {
        let lowest = TAU * lines.first()?.frequency_hz;
        let highest = TAU * lines.last()?.frequency_hz;
        let shortest = (BEYOND * highest).recip();
        let longest = BEYOND / lowest;
        let relaxation_times = std::iter::successors(Some(shortest), |tau| Some(GRID * tau));
        Some(Self {
            relaxation_times: relaxation_times.take_while(|tau| *tau <= longest).collect(),
            highest,
        })
    }

    /// Each function on the `lines`, as large as its coefficient may be expected at most.
    fn terms(&self, lines: &[&ModulusLine]) -> Vec<Vec<Complex64>> {
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let modulus = largest(&mut lines.iter().map(|line| line.modulus.norm()));
        let on_lines = |function: &dyn Fn(f64) -> Complex64| -> Vec<Complex64> {
            let values = lines.iter().map(|line| function(TAU * line.frequency_hz));
            let mut values: Vec<Complex64> = values.collect();
            let scale =
                LARGEST_TERM * modulus / largest(&mut values.iter().map(|value| value.norm()));
            for value in &mut values {
                *value *= scale;
            }
            values
        };
        let relative = |omega: f64| omega / self.highest;
        let mut terms = vec![
            on_lines(&|_| Complex64::ONE),
            on_lines(&|omega| Complex64::new(0.0, relative(omega))),
            on_lines(&|omega| Complex64::new(relative(omega).powi(2), 0.0)),
        ];
        terms.extend(self.relaxation_times.iter().map(|tau| {
            on_lines(&|omega| {
                let phase = Complex64::new(0.0, omega * tau);
                phase / (1.0 + phase)
            })
        }));
        terms
    }
}

/// Orthonormal directions that span the `columns` of so many `rows` on top of a unit matrix, which is the prior of their coefficients. `None` if an
/// entry is not finite.
fn basis(columns: &[Vec<f64>], rows: usize) -> Option<Vec<Vec<f64>>> {
    let entry = |i: usize, j: usize| -> f64 {
        match i.checked_sub(rows) {
            Some(own) => f64::from(u8::from(own == j)),
            None => columns
                .get(j)
                .and_then(|column| column.get(i))
                .copied()
                .unwrap_or(0.0),
        }
    };
    let all = rows + columns.len();
    let vectors = Mat::from_fn(all, columns.len(), entry)
        .qr()
        .compute_thin_Q();
    let directions: Vec<Vec<f64>> = (0..columns.len())
        .map(|k| (0..all).map(|i| vectors[(i, k)]).collect())
        .collect();
    directions
        .iter()
        .flatten()
        .all(|x| x.is_finite())
        .then_some(directions)
}

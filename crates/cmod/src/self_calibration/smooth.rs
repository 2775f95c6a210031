//! Projection of values at lines onto smooth and causal moduli, and the residual of this
//! projection.

use faer::Mat;
use num_complex::Complex64;

use super::line::LinearisedLine;
use crate::complex_frequency::ComplexFrequency;
use crate::estimate::ModulusLine;
use crate::vectors::{dot, subtract};

/// Ratio of neighbouring relaxation times. With a ratio of 2.5, a fit with coefficients of any sign
/// leaves a residual of 1e-4 of a loss that rises by several powers of ten in the band; in quiet
/// records this causes a bias of many standard errors. With the ratio of 1.5 the residual is below
/// any noise.
const GRID: f64 = 1.5;
/// Factor by which the grid extends beyond the band.
const BEYOND: f64 = 1000.0;

/// Least-squares fit of a smooth modulus to lines, in units of their noise.
pub(super) struct Smoothing {
    weights: Vec<f64>,
    /// Orthonormal directions of all smooth moduli, over the lines and the priors of the
    /// coefficients.
    basis: Vec<Vec<f64>>,
    functions: SmoothModulus,
    /// Number of parameters determined by the lines.
    pub(super) parameters: f64,
}

impl Smoothing {
    /// Creates the fit for values on the lines s = σ + iω of the `added_damping` σ, and terms whose
    /// contribution has the standard deviation `largest_term` relative to the largest modulus.
    /// Returns `None` without lines, or if a value is not finite.
    pub(super) fn of(
        lines: &[&ModulusLine],
        about: &[LinearisedLine],
        added_damping: f64,
        largest_term: f64,
    ) -> Option<Self> {
        let weight = |line: &LinearisedLine| (2.0 / line.variance).sqrt();
        let weights: Vec<f64> = about.iter().map(weight).collect();
        let laplace =
            |line: &&ModulusLine| ComplexFrequency::new(line.frequency_hz, added_damping).laplace();
        let places: Vec<Complex64> = lines.iter().map(laplace).collect();
        let largest = lines.iter().map(|line| line.modulus.norm());
        let largest = largest_term * largest.fold(0.0, f64::max);
        let functions = SmoothModulus::on(&places, largest)?;
        let terms: Vec<Vec<Complex64>> = places.iter().map(|s| functions.at(*s)).collect();
        let columns: Vec<Vec<f64>> = (0..functions.scales.len())
            .map(|term| {
                let values = terms.iter().filter_map(|line| line.get(term).copied());
                whitened(&weights, values)
            })
            .collect();
        let rows = 2 * lines.len();
        let basis = basis(&columns, rows)?;
        // squares of the directions in the rows of the lines; the remaining rows are the rows of
        // the priors
        let of_lines =
            |direction: &Vec<f64>| direction.iter().take(rows).map(|x| x * x).sum::<f64>();
        Some(Self {
            weights,
            parameters: basis.iter().map(of_lines).sum(),
            basis,
            functions,
        })
    }

    /// Returns the components of whitened `values` along the directions.
    pub(super) fn parts(&self, values: &[f64]) -> Vec<f64> {
        self.basis
            .iter()
            .map(|direction| dot(direction, values))
            .collect()
    }

    /// Returns, for each direction, the difference between the smooth modulus at `to` and at `from`
    /// \[1/s\] for a component of 1. The rows of the priors are the coefficients of the functions
    /// in each direction.
    pub(super) fn difference(&self, from: Complex64, to: Complex64) -> Vec<Complex64> {
        let rows = 2 * self.weights.len();
        let terms = self
            .functions
            .at(to)
            .into_iter()
            .zip(self.functions.at(from));
        let terms: Vec<Complex64> = terms.map(|(to, from)| to - from).collect();
        let along = |direction: &Vec<f64>| -> Complex64 {
            let coefficients = direction.iter().skip(rows);
            terms
                .iter()
                .zip(coefficients)
                .map(|(term, c)| term * c)
                .sum()
        };
        self.basis.iter().map(along).collect()
    }

    /// Returns the values of the lines divided by their noise, with alternating real and imaginary
    /// parts, followed by 0 for each prior.
    pub(super) fn whitened(&self, values: impl Iterator<Item = Complex64>) -> Vec<f64> {
        let mut values = whitened(&self.weights, values);
        values.resize(values.len() + self.basis.len(), 0.0);
        values
    }

    /// Returns the part of whitened `values` that no smooth modulus explains.
    pub(super) fn rest_of(&self, values: &[f64]) -> Vec<f64> {
        let mut rest = values.to_vec();
        for direction in &self.basis {
            let part = dot(direction, &rest);
            subtract(&mut rest, part, direction);
        }
        rest
    }

    /// Returns the values on all lines of the smooth modulus that is nearest to whitened `values`.
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

/// Functions of s that span the smooth and causal moduli in a band.
struct SmoothModulus {
    relaxation_times: Vec<f64>,
    /// Highest angular frequency of the band \[rad/s\].
    highest: f64,
    /// Scale of each function: a coefficient of 1 then contributes at most the largest expected
    /// value in the band.
    scales: Vec<f64>,
}

impl SmoothModulus {
    /// Creates the functions for the band of `places`, values of s in order of increasing
    /// frequency. A term with the coefficient 1 contributes at most `largest` \[Pa\] in the band.
    /// Returns `None` without places.
    fn on(places: &[Complex64], largest: f64) -> Option<Self> {
        let lowest = places.first()?.im;
        let highest = places.last()?.im;
        let shortest = (BEYOND * highest).recip();
        let longest = BEYOND / lowest;
        let relaxation_times = std::iter::successors(Some(shortest), |tau| Some(GRID * tau));
        let relaxation_times: Vec<f64> =
            relaxation_times.take_while(|tau| *tau <= longest).collect();
        let mut functions = Self {
            scales: vec![1.0; 3 + relaxation_times.len()],
            relaxation_times,
            highest,
        };
        let mut sizes = vec![0.0_f64; functions.scales.len()];
        for s in places {
            for (size, value) in sizes.iter_mut().zip(functions.at(*s)) {
                *size = size.max(value.norm());
            }
        }
        functions.scales = sizes.iter().map(|size| largest / size).collect();
        Some(functions)
    }

    /// Returns the value of each function at s.
    fn at(&self, s: Complex64) -> Vec<Complex64> {
        let relative = s / self.highest;
        let first = [Complex64::ONE, relative, -(relative * relative)];
        let relaxation = self.relaxation_times.iter().map(|tau| {
            let phase = s * tau;
            phase / (1.0 + phase)
        });
        let all = first.into_iter().chain(relaxation);
        all.zip(&self.scales)
            .map(|(value, scale)| value * scale)
            .collect()
    }
}

/// Returns orthonormal directions that span the `columns` of `rows` rows, stacked on a unit matrix,
/// which represents the prior of the coefficients; `None` if an entry is not finite.
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

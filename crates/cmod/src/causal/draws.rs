//! Errors of a projection on a cone, from random draws about the projected point.
//!
//! The projection is not a linear function of the values: the values determine which branches are
//! occupied, and no modulus becomes negative. Therefore draws of the noise and of the common errors
//! about the nearest material are projected in the same way as the data.

use num_complex::Complex64;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use rodwave::modulus::MaxwellBranch;

use super::projection::{Projection, Whitened, share, solved};
use crate::rheology::non_negative::NonNegative;
use crate::rheology::symmetric::{factorise, solve};
use crate::vectors::{dot, subtract};

/// Number of draws; with this number the standard errors scatter by 4 %.
const DRAWS: u32 = 300;
/// Relaxation times per decade in the projections of the draws, in addition to those of the nearest
/// material.
const TIMES_A_DECADE: f64 = 24.0;

/// Changes of the nearest material due to draws of the errors.
#[derive(Debug, Clone)]
pub(super) struct Draws {
    times: Vec<f64>,
    /// Changes of the spring and of the branches due to each draw, without the effect of its common
    /// errors, divided by the square root of the number of draws.
    random: Vec<Vec<f64>>,
    /// Changes of the spring and of the branches due to one standard uncertainty of each common
    /// error.
    common: Vec<Vec<f64>>,
    /// Standard errors of the sizes of the common errors.
    pub(super) errors_of_sizes: Vec<f64>,
    /// Mean of χ² over the draws, that is, the degrees of freedom of χ².
    pub(super) degrees_of_freedom: f64,
}

impl Draws {
    /// Makes the draws about `nearest`, the projection of the values; `None` if a number is not
    /// finite.
    pub(super) fn about(nearest: &Projection, values: &Whitened<'_>) -> Option<Self> {
        let material = &nearest.material;
        let of_grid = values.grid(TIMES_A_DECADE)?.into_iter();
        let of_grid = of_grid.map(|relaxation_time| MaxwellBranch {
            modulus: 0.0,
            relaxation_time,
        });
        let mut branches: Vec<MaxwellBranch> = of_grid.collect();
        branches.extend(&material.branches);
        branches.sort_by(|a, b| a.relaxation_time.total_cmp(&b.relaxation_time));
        let times: Vec<f64> = branches.iter().map(|own| own.relaxation_time).collect();
        let moduli = branches.iter().map(|own| own.modulus);
        let truth: Vec<f64> = std::iter::once(material.equilibrium)
            .chain(moduli)
            .collect();
        let columns = values.columns(&times);
        let fitted = combined(&columns, &truth, values.rows());
        let mut problem = NonNegative::new(&columns, &fitted);

        let mut normal = normals();
        let sources = values.common.vectors();
        // the estimated sizes are the scalar products of the whitened vectors with the residual
        let directions: Vec<Vec<f64>> = sources
            .iter()
            .map(|vector| {
                let mut direction = vector.clone();
                values.common.whiten(&mut direction);
                direction
            })
            .collect();
        let mut drawn: Vec<Vec<f64>> = Vec::new();
        let mut changes: Vec<Vec<f64>> = Vec::new();
        let mut squares_of_sizes = vec![0.0; sources.len()];
        let mut sum_of_squares = 0.0;
        for _ in 0..DRAWS {
            let sizes: Vec<f64> = sources.iter().map(|_| normal()).collect();
            let mut noise: Vec<f64> = (0..values.rows()).map(|_| normal()).collect();
            for (size, vector) in sizes.iter().zip(sources) {
                subtract(&mut noise, -size, vector);
            }
            values.common.whiten(&mut noise);
            let target: Vec<f64> = fitted.iter().zip(&noise).map(|(f, n)| f + n).collect();
            problem.set_target(&columns, &target);
            let found = solved(&problem);
            let mut rest = target;
            subtract(&mut rest, 1.0, &combined(&columns, &found, values.rows()));
            sum_of_squares += dot(&rest, &rest);
            let change: Vec<f64> = found.iter().zip(&truth).map(|(f, t)| f - t).collect();
            let pairs = directions.iter().zip(&sizes);
            for (sum, (direction, size)) in squares_of_sizes.iter_mut().zip(pairs) {
                *sum += (dot(direction, &rest) - size).powi(2);
            }
            changes.push(change);
            drawn.push(sizes);
        }
        let number = f64::from(DRAWS);
        let common = regressed(&changes, &drawn);
        for (change, sizes) in changes.iter_mut().zip(&drawn) {
            for (size, shift) in sizes.iter().zip(&common) {
                subtract(change, *size, shift);
            }
            for entry in change.iter_mut() {
                *entry /= number.sqrt();
            }
        }
        Some(Self {
            random: changes,
            common,
            errors_of_sizes: squares_of_sizes
                .iter()
                .map(|sum| (sum / number).sqrt())
                .collect(),
            degrees_of_freedom: sum_of_squares / number,
            times,
        })
        .filter(|draws| draws.degrees_of_freedom.is_finite())
    }

    /// Returns the changes of the modulus at s = `place` due to the random errors, as a combination
    /// of independent errors of variance 1.
    pub(super) fn random_changes(&self, place: Complex64) -> Vec<Complex64> {
        self.changes(place, &self.random)
    }

    /// Returns the change of the modulus at s = `place` due to one standard uncertainty of each
    /// common error.
    pub(super) fn common_changes(&self, place: Complex64) -> Vec<Complex64> {
        self.changes(place, &self.common)
    }

    fn changes(&self, place: Complex64, of: &[Vec<f64>]) -> Vec<Complex64> {
        let shares = self.times.iter().map(|time| share(place, *time));
        let all: Vec<Complex64> = std::iter::once(Complex64::ONE).chain(shares).collect();
        let change = |own: &Vec<f64>| own.iter().zip(&all).map(|(c, share)| *c * share).sum();
        of.iter().map(change).collect()
    }
}

/// Returns a generator of standard normal numbers, with the same seed for every estimate.
fn normals() -> impl FnMut() -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    move || StandardNormal.sample(&mut random)
}

/// Returns the sum of the columns, each multiplied by its coefficient.
fn combined(columns: &[Vec<f64>], coefficients: &[f64], rows: usize) -> Vec<f64> {
    let mut sum = vec![0.0; rows];
    for (column, coefficient) in columns.iter().zip(coefficients) {
        if *coefficient != 0.0 {
            subtract(&mut sum, -coefficient, column);
        }
    }
    sum
}

/// Returns the changes due to each source of size 1, by least squares from the `changes` for the
/// `drawn` sizes.
fn regressed(changes: &[Vec<f64>], drawn: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let n = drawn.first().map_or(0, Vec::len);
    let length = changes.first().map_or(0, Vec::len);
    let mut normal = vec![0.0; n * n];
    let mut sums = vec![vec![0.0; length]; n];
    for (change, sizes) in changes.iter().zip(drawn) {
        for (row, own) in normal.chunks_exact_mut(n.max(1)).zip(sizes) {
            subtract(row, -own, sizes);
        }
        for (sum, own) in sums.iter_mut().zip(sizes) {
            subtract(sum, -own, change);
        }
    }
    if !factorise(&mut normal, n, 0.0) {
        return vec![vec![0.0; length]; n];
    }
    for entry in 0..length {
        let of_entry = sums
            .iter()
            .map(|sum| sum.get(entry).copied().unwrap_or(0.0));
        let mut solved: Vec<f64> = of_entry.collect();
        solve(&normal, &mut solved);
        for (sum, value) in sums.iter_mut().zip(solved) {
            if let Some(place) = sum.get_mut(entry) {
                *place = value;
            }
        }
    }
    sums
}

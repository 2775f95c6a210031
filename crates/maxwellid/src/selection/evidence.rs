//! The evidence of one candidate, Z = ∫ L π dθ, by importance sampling.
//!
//! Laplace's method takes L π for normal about its maximum. It is not where the data bound a parameter on one side only, as a relaxation time that is too long to be seen: what lies
//! beyond the bound is the prior. Here its normal is the start of a proposal only. Along the columns of its Cholesky factor the proposal is a product
//! of t distributions with four degrees of freedom and a scale of its own to either side (Geweke, *Econometrica* **57** (1989) 1317), so that its tails are heavier than those
//! of L π. The points are those of an additive recurrence: no randomness, and the same whatever the order of tests and candidates.

use crate::least_squares::{LeastSquares, ScaledDecomposition, sum_of_squares};
use crate::parallel::map_in_order;
use crate::selection::posterior::{Posterior, PosteriorProblem};

/// ln Z with its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Evidence {
    pub(crate) ln: f64,
    /// Standard error of ln Z, as if the points were random.
    pub(crate) error: f64,
}

/// Points of the first attempt for a nonlinear law; each further attempt doubles them.
const FEWEST_POINTS: usize = 128;
/// Points of the first attempt for a linear law, whose response costs little and whose shares and times bend about each other.
const FEWEST_POINTS_LINEAR: usize = 1024;
/// Points of the last attempt.
const MOST_POINTS: usize = 2048;

/// Standard error of ln Z, as if the points were random, that is good enough. Points that are spread evenly err by a third of it and less.
const GOOD_ENOUGH: f64 = 0.1;

/// Distances along an axis, in standard deviations of the normal, at which the scale of the proposal is found.
const DISTANCES: [f64; 3] = [1.0, 2.5, 5.0];

/// Least and largest scale, in standard deviations of the normal.
const SCALES: (f64, f64) = (0.2, 8.0);

/// The logarithm of likelihood times prior about the most probable parameters, in coordinates of standard deviations of the normal.
struct Integrand<'a> {
    problem: &'a PosteriorProblem<'a>,
    ln_likelihood: &'a (dyn Fn(f64) -> f64 + Sync),
    centre: &'a [f64],
    /// Lower Cholesky factor of the covariance of θ, by rows.
    factor: Vec<Vec<f64>>,
}

impl Integrand<'_> {
    /// -∞ where the model does not exist.
    fn at(&self, z: &[f64]) -> f64 {
        let parameters: Vec<f64> = self
            .factor
            .iter()
            .zip(self.centre)
            .map(|(row, centre)| centre + row.iter().zip(z).map(|(l, z)| l * z).sum::<f64>())
            .collect();
        let bounds = self.problem.bounds();
        let is_inside = |(value, (low, high)): (&f64, &(f64, f64))| value >= low && value <= high;
        if !parameters.iter().zip(&bounds).all(is_inside) {
            return f64::NEG_INFINITY;
        }
        let Some(residual) = self.problem.residual(&parameters) else {
            return f64::NEG_INFINITY;
        };
        let (of_data, of_prior) = residual.split_at(self.problem.samples());
        (self.ln_likelihood)(sum_of_squares(of_data)) - 0.5 * sum_of_squares(of_prior)
    }

    /// Scales of the proposal below and above the centre, an entry for each axis.
    fn scales(&self) -> Vec<[f64; 2]> {
        let axes = self.centre.len();
        let top = self.at(&vec![0.0; axes]);
        let mut places = Vec::new();
        for axis in 0..axes {
            for sign in [-1.0, 1.0] {
                places.extend(DISTANCES.map(|distance| (axis, sign * distance)));
            }
        }
        let drops = map_in_order(&places, |(axis, at)| {
            let mut z = vec![0.0; axes];
            if let Some(own) = z.get_mut(*axis) {
                *own = *at;
            }
            top - self.at(&z)
        });
        let mut scales = vec![[SCALES.0; 2]; axes];
        for ((axis, at), drop) in places.iter().zip(drops) {
            // a normal of this scale drops by as much
            let scale = at.abs() / (2.0 * drop.max(1e-9)).sqrt();
            if let Some([below, above]) = scales.get_mut(*axis) {
                let side = if *at < 0.0 { below } else { above };
                *side = side.max(scale.min(SCALES.1));
            }
        }
        scales
    }
}

/// ln Z about the most probable parameters; `ln_likelihood` is of χ². `None` if the covariance is not positive definite.
pub(crate) fn evidence(
    problem: &PosteriorProblem<'_>,
    probable: &Posterior,
    ln_likelihood: &(dyn Fn(f64) -> f64 + Sync),
) -> Option<Evidence> {
    let deviations = &problem.prior.deviation;
    let linearisation = &probable.minimum.linearisation;
    let svd = ScaledDecomposition::new(linearisation, deviations)?;
    let factor = cholesky(&covariance(&svd, deviations))?;
    // ∫ dθ = det(factor) ∫ dz, and the prior has the factor (2π)^(-d/2) Π 1/s
    let constant: f64 = factor
        .iter()
        .zip(deviations)
        .filter_map(|(row, s)| Some(row.last()? / s))
        .map(|ratio| ratio.ln() - 0.5 * std::f64::consts::TAU.ln())
        .sum();
    let integrand = Integrand {
        problem,
        ln_likelihood,
        centre: &probable.minimum.parameters,
        factor,
    };
    let scales = integrand.scales();
    let mut ln_weights: Vec<f64> = Vec::new();
    let mut count = if problem.model.is_linear() {
        FEWEST_POINTS_LINEAR
    } else {
        FEWEST_POINTS
    };
    loop {
        let places: Vec<usize> = (ln_weights.len()..count).collect();
        ln_weights.extend(map_in_order(&places, |index| {
            let (z, ln_density) = proposed(*index, &scales);
            integrand.at(&z) - ln_density
        }));
        let (ln_mean, error) = ln_mean(&ln_weights);
        if error < GOOD_ENOUGH || count >= MOST_POINTS {
            return Some(Evidence {
                ln: constant + ln_mean,
                error,
            });
        }
        count *= 2;
    }
}

/// ln of the mean of weights that are given by their logarithms, and its standard error.
fn ln_mean(ln_weights: &[f64]) -> (f64, f64) {
    let largest = ln_weights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if !largest.is_finite() {
        return (f64::NEG_INFINITY, f64::INFINITY);
    }
    let count = ln_weights.len() as f64;
    let (mut sum, mut squares) = (0.0, 0.0);
    for ln_weight in ln_weights {
        let weight = (ln_weight - largest).exp();
        sum += weight;
        squares += weight * weight;
    }
    let variance = (count * squares / (sum * sum) - 1.0).max(0.0);
    (largest + (sum / count).ln(), (variance / count).sqrt())
}

/// Point `index` of the proposal in standard deviations of the normal, and the logarithm of its density.
fn proposed(index: usize, scales: &[[f64; 2]]) -> (Vec<f64>, f64) {
    // the root of x^(d+1) = x + 1 (Roberts, 2018)
    let exponent = 1.0 / (scales.len() as f64 + 1.0);
    let ratio = (0..60).fold(1.5_f64, |x, _| (x + 1.0).powf(exponent));
    let mut ln_density = 0.0;
    let z = scales
        .iter()
        .enumerate()
        .map(|(axis, [below, above])| {
            let share = (0.5 + (index as f64 + 1.0) * ratio.powf(-(axis as f64 + 1.0))).fract();
            // the halves of a split density meet at its peak: each has the weight of its scale
            let left = below / (below + above);
            let (scale, quantile) = if share < left {
                (*below, t4_quantile(0.5 * share / left))
            } else {
                (
                    *above,
                    t4_quantile(0.5 + 0.5 * (share - left) / (1.0 - left)),
                )
            };
            // ⅜ (1 + t²/4)^(-5/2), times 2/(below + above)
            ln_density +=
                (0.75 / (below + above)).ln() - 2.5 * (0.25 * quantile * quantile).ln_1p();
            scale * quantile
        })
        .collect();
    (z, ln_density)
}

/// Quantile of Student's t of four degrees of freedom (Shaw, *J. Comput. Finance* **9** (2006) 37).
fn t4_quantile(probability: f64) -> f64 {
    let p = probability.clamp(1e-12, 1.0 - 1e-12);
    let root = (4.0 * p * (1.0 - p)).sqrt().min(1.0);
    let q = (root.acos() / 3.0).cos() / root;
    (p - 0.5).signum() * 2.0 * (q - 1.0).max(0.0).sqrt()
}

/// Covariance of θ from the decomposition of data and prior together, scaled by the deviations of the prior.
fn covariance(svd: &ScaledDecomposition, deviations: &[f64]) -> Vec<Vec<f64>> {
    let directions = || svd.right.iter().zip(&svd.singular_values);
    let scaled = |vector: &[f64]| -> Vec<f64> {
        vector.iter().zip(deviations).map(|(v, s)| v * s).collect()
    };
    let mut covariance = vec![vec![0.0; deviations.len()]; deviations.len()];
    for (vector, s) in directions() {
        let vector = scaled(vector);
        for (row, a) in covariance.iter_mut().zip(&vector) {
            for (entry, b) in row.iter_mut().zip(&vector) {
                *entry += a * b / (s * s);
            }
        }
    }
    covariance
}

/// Lower Cholesky factor by rows, row i with i + 1 entries; `None` unless the matrix is positive definite.
fn cholesky(matrix: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let mut factor: Vec<Vec<f64>> = Vec::with_capacity(matrix.len());
    for (i, row) in matrix.iter().enumerate() {
        let mut own: Vec<f64> = Vec::with_capacity(i + 1);
        for (above, entry) in factor.iter().zip(row) {
            let known: f64 = above.iter().zip(&own).map(|(a, b)| a * b).sum();
            own.push((entry - known) / above.last()?);
        }
        let squares: f64 = own.iter().map(|v| v * v).sum();
        let pivot = row.get(i)? - squares;
        if pivot.is_nan() || pivot <= 0.0 {
            return None;
        }
        own.push(pivot.sqrt());
        factor.push(own);
    }
    Some(factor)
}

#[cfg(test)]
mod tests;

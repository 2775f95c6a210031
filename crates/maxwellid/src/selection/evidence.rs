//! The evidence of one candidate, Z = ∫ L π dθ, by importance sampling.
//!
//! Laplace's method approximates L π by a normal density about its maximum. This fails if the data
//! bound a parameter on one side only, such as a relaxation time that is too long to be visible:
//! beyond the bound L π follows the prior. Here the normal density only provides the axes of the
//! first proposal: along the columns of its Cholesky factor the proposal is a product of t
//! distributions with four degrees of freedom and separate scales on either side (Geweke,
//! *Econometrica* **57** (1989) 1317), so that its tails are heavier than those of L π. If the
//! error of ln Z is still too large, each further batch of points is drawn from t distributions
//! about the point of greatest weight, along the axes of Laplace's covariance at that point, where
//! L π is largest relative to all previous proposals (Hoogerheide, Kaashoek & van Dijk, *J.
//! Econometrics* **139** (2007) 154). Every point is weighted against the mixture of all proposals
//! (Cornuet, Marin, Mira & Robert, *Scand. J. Stat.* **39** (2012) 798). The points are those of an
//! additive recurrence: they are not random, and do not depend on the order of tests and
//! candidates.

use crate::least_squares::{LeastSquares, ScaledDecomposition, sum_of_squares};
use crate::parallel::map_in_order;
use crate::selection::posterior::{Posterior, PosteriorProblem};

/// ln Z with its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Evidence {
    pub(crate) ln: f64,
    /// Standard error of ln Z, computed as for random points.
    pub(crate) error: f64,
}

/// Number of points of each batch.
const FEWEST_POINTS: usize = 64;
/// Number of points of each batch for a linear law with more than [`FEW_AXES`] parameters: its
/// response is computed fast, and its shares and times are correlated.
const FEWEST_POINTS_LINEAR: usize = 512;
/// Number of parameters up to which a linear law has as many points as other laws.
const FEW_AXES: usize = 2;
/// Total number of points at which the sampling ends in any case.
const MOST_POINTS: usize = 4096;

/// Distances along an axis, in standard deviations of the normal density, from which the scale of
/// the proposal is computed.
const DISTANCES: [f64; 3] = [1.0, 2.5, 5.0];

/// Largest number of points, in descending order of weight, that are tried as the centre of a
/// further proposal.
const MOST_TRIED: usize = 4;

/// Step along a ridge, in standard deviations.
const RIDGE_STEP: f64 = 3.0;

/// Fall of ln(L π) from the centre at which a ridge ends. A normal density falls by ½·3² = 4.5 in
/// the first step, so that a ridge exists only where L π falls more slowly.
const RIDGE_DROP: f64 = 3.0;
const MOST_RIDGE_STEPS: usize = 6;

/// Smallest and largest scale, in standard deviations of the normal density.
const SCALES: (f64, f64) = (0.2, 8.0);

/// The logarithm of likelihood times prior about the most probable parameters, in coordinates in
/// which Laplace's normal density has unit covariance.
struct Integrand<'a> {
    problem: &'a PosteriorProblem<'a>,
    ln_likelihood: &'a (dyn Fn(f64) -> f64 + Sync),
    centre: &'a [f64],
    /// Lower Cholesky factor of the covariance of θ, by rows.
    factor: Vec<Vec<f64>>,
}

impl Integrand<'_> {
    fn parameters(&self, z: &[f64]) -> Vec<f64> {
        self.factor
            .iter()
            .zip(self.centre)
            .map(|(row, centre)| centre + row.iter().zip(z).map(|(l, z)| l * z).sum::<f64>())
            .collect()
    }

    /// Logarithm of the integrand, -∞ where the model does not exist.
    fn at(&self, z: &[f64]) -> f64 {
        let parameters = self.parameters(z);
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

    /// Proposals along ridges, where L π falls more slowly than the normal density: from the centre
    /// to either side of each parameter. A ridge advances in steps of [`RIDGE_STEP`] standard
    /// deviations of Laplace's method at its last point, with the other parameters at their
    /// minimum, as long as ln(L π) is less than [`RIDGE_DROP`] below its value at the centre.
    fn ridges(&self) -> Vec<Proposal> {
        let axes = self.centre.len();
        let top = self.at(&vec![0.0; axes]);
        let sides: Vec<(usize, f64)> = (0..axes)
            .flat_map(|axis| [(axis, -1.0), (axis, 1.0)])
            .collect();
        let of_sides = map_in_order(&sides, |(axis, sign)| {
            let mut ridge: Vec<Proposal> = Vec::new();
            let mut last = Proposal::about_the_centre(vec![[1.0; 2]; axes]);
            while ridge.len() < MOST_RIDGE_STEPS
                && let Some(next) = self.next_on_ridge(&last, *axis, *sign)
                && top - self.at(&next.centre) < RIDGE_DROP
            {
                ridge.push(next.clone());
                last = next;
            }
            ridge
        });
        of_sides.into_iter().flatten().collect()
    }

    /// The proposal one step further on a ridge, about the minimum of the linearised problem for a
    /// constant parameter `axis`.
    fn next_on_ridge(&self, last: &Proposal, axis: usize, sign: f64) -> Option<Proposal> {
        let along = last.covariances(axis)?;
        let variance = along.get(axis)?;
        let length = sign * RIDGE_STEP / variance.sqrt();
        let point: Vec<f64> = last
            .centre
            .iter()
            .zip(&along)
            .map(|(z, c)| z + length * c)
            .collect();
        let (mut next, step) = Proposal::about(self, &point)?;
        let across = next.covariances(axis)?;
        let share = step.get(axis)? / across.get(axis)?;
        for ((centre, step), covariance) in next.centre.iter_mut().zip(&step).zip(&across) {
            *centre += step - share * covariance;
        }
        Some(next)
    }

    /// Scales of the proposal below and above the centre, one entry per axis.
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
            // scale of a normal density that drops by the same amount
            let scale = at.abs() / (2.0 * drop.max(1e-9)).sqrt();
            if let Some([below, above]) = scales.get_mut(*axis) {
                let side = if *at < 0.0 { below } else { above };
                *side = side.max(scale.min(SCALES.1));
            }
        }
        scales
    }
}

/// Computes ln Z about the most probable parameters. `ln_likelihood` is a function of χ²;
/// `sufficient` is the standard error of ln Z below which the sampling ends. The error is computed
/// as for random points; evenly spread points have at most a third of it. `None` if the covariance
/// is not positive definite.
pub(crate) fn evidence(
    problem: &PosteriorProblem<'_>,
    probable: &Posterior,
    (ln_likelihood, sufficient): (&(dyn Fn(f64) -> f64 + Sync), f64),
) -> Option<Evidence> {
    let deviations = &problem.prior.deviation;
    let linearisation = &probable.minimum.linearisation;
    let svd = ScaledDecomposition::new(linearisation, deviations)?;
    let factor = cholesky(&covariance(&principal_axes(&svd, deviations)))?;
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
    let first = if problem.model.is_linear() && deviations.len() > FEW_AXES {
        FEWEST_POINTS_LINEAR
    } else {
        FEWEST_POINTS
    };
    let mut sample = Sample::default();
    sample.add(
        &integrand,
        Proposal::about_the_centre(integrand.scales()),
        first,
    );
    let ridges = integrand.ridges();
    for proposal in &ridges {
        sample.add(&integrand, proposal.clone(), first / ridges.len());
    }
    loop {
        let ln_weights = sample.ln_weights();
        let (ln_mean, error) = ln_mean(&ln_weights);
        if error < sufficient || sample.points.len() >= MOST_POINTS {
            return Some(Evidence {
                ln: constant + ln_mean,
                error,
            });
        }
        let mut by_weight: Vec<_> = sample.points.iter().zip(&ln_weights).collect();
        by_weight.sort_by(|(_, a), (_, b)| b.total_cmp(a));
        // about the point of greatest weight at which the problem can be linearised; if there is
        // none, more points are drawn from the last proposal
        let next = by_weight
            .iter()
            .take(MOST_TRIED)
            .find_map(|(point, _)| Proposal::about(&integrand, point));
        let proposal = match next {
            Some((proposal, _)) => proposal,
            None => sample.proposals.last()?.1.clone(),
        };
        sample.add(&integrand, proposal, first);
    }
}

/// Points drawn from several proposals, with the logarithm of the integrand at each point.
#[derive(Default)]
struct Sample {
    /// Proposals, each with the number of its points.
    proposals: Vec<(f64, Proposal)>,
    points: Vec<Vec<f64>>,
    ln_values: Vec<f64>,
}

impl Sample {
    /// Draws `count` points from `proposal`.
    fn add(&mut self, integrand: &Integrand<'_>, proposal: Proposal, count: usize) {
        let begin = self.points.len();
        let steps = recurrence_steps(proposal.scales.len());
        let points: Vec<_> = (begin..begin + count)
            .map(|index| proposal.point(index, &steps))
            .collect();
        self.ln_values
            .extend(map_in_order(&points, |z| integrand.at(z)));
        self.points.extend(points);
        self.proposals.push((count as f64, proposal));
    }

    /// Logarithms of the integrand divided by the density of the mixture of all proposals.
    fn ln_weights(&self) -> Vec<f64> {
        let all: f64 = self.proposals.iter().map(|(count, _)| count).sum();
        let ln_density = |z: &Vec<f64>| {
            let of_each: Vec<f64> = self
                .proposals
                .iter()
                .map(|(count, proposal)| (count / all).ln() + proposal.ln_density(z))
                .collect();
            let largest = of_each.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            largest
                + of_each
                    .iter()
                    .map(|v| (v - largest).exp())
                    .sum::<f64>()
                    .ln()
        };
        self.points
            .iter()
            .zip(&self.ln_values)
            .map(|(z, value)| value - ln_density(z))
            .collect()
    }
}

/// Logarithm of the mean of weights that are given by their logarithms, and its standard error.
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

/// Steps of the additive recurrence along `axes` axes: powers of the inverse root of x^(d+1) = x +
/// 1 (Roberts, 2018).
fn recurrence_steps(axes: usize) -> Vec<f64> {
    let exponent = 1.0 / (axes as f64 + 1.0);
    let ratio = (0..60).fold(1.5_f64, |x, _| (x + 1.0).powf(exponent));
    (0..axes)
        .map(|axis| ratio.powf(-(axis as f64 + 1.0)))
        .collect()
}

/// A product of split t distributions with four degrees of freedom along the columns of a factor.
#[derive(Clone)]
struct Proposal {
    centre: Vec<f64>,
    /// Lower triangle by rows.
    factor: Vec<Vec<f64>>,
    /// Scales below and above the centre, one entry per axis.
    scales: Vec<[f64; 2]>,
}

impl Proposal {
    fn about_the_centre(scales: Vec<[f64; 2]>) -> Self {
        let axes = scales.len();
        let unit = |row: usize| {
            (0..=row)
                .map(|k| if k == row { 1.0 } else { 0.0 })
                .collect()
        };
        Self {
            centre: vec![0.0; axes],
            factor: (0..axes).map(unit).collect(),
            scales,
        }
    }

    /// Creates a proposal about `point`, along the axes of the covariance of Laplace's method at
    /// this point, and returns it with the step from the point to the minimum of the linearised
    /// problem; `None` if the covariance is not positive definite.
    fn about(integrand: &Integrand<'_>, point: &[f64]) -> Option<(Self, Vec<f64>)> {
        let deviations = &integrand.problem.prior.deviation;
        let there = integrand
            .problem
            .linearisation(&integrand.parameters(point))?;
        let svd = ScaledDecomposition::new(&there, deviations)?;
        let axes: Vec<Vec<f64>> = principal_axes(&svd, deviations)
            .iter()
            .map(|axis| solved(&integrand.factor, axis))
            .collect();
        let mut step = vec![0.0; point.len()];
        for (axis, projection) in axes.iter().zip(&svd.projected) {
            for (own, along) in step.iter_mut().zip(axis) {
                *own -= along * projection;
            }
        }
        let proposal = Self {
            factor: cholesky(&covariance(&axes))?,
            scales: vec![[1.0; 2]; point.len()],
            centre: point.to_vec(),
        };
        Some((proposal, step))
    }

    fn covariances(&self, axis: usize) -> Option<Vec<f64>> {
        let own = self.factor.get(axis)?;
        let product = |row: &Vec<f64>| row.iter().zip(own).map(|(a, b)| a * b).sum();
        Some(self.factor.iter().map(product).collect())
    }

    /// Point `index` of the additive recurrence with these `steps`, in the coordinates of
    /// [`Integrand`].
    fn point(&self, index: usize, steps: &[f64]) -> Vec<f64> {
        let along: Vec<f64> = self
            .scales
            .iter()
            .zip(steps)
            .map(|([below, above], step)| {
                let share = (0.5 + (index as f64 + 1.0) * step).fract();
                // both halves have the same density at the peak, so that their probabilities are
                // proportional to their scales
                let left = below / (below + above);
                if share < left {
                    below * t4_quantile(0.5 * share / left)
                } else {
                    above * t4_quantile(0.5 + 0.5 * (share - left) / (1.0 - left))
                }
            })
            .collect();
        self.factor
            .iter()
            .zip(&self.centre)
            .map(|(row, centre)| centre + row.iter().zip(&along).map(|(l, t)| l * t).sum::<f64>())
            .collect()
    }

    fn ln_density(&self, z: &[f64]) -> f64 {
        let from_centre: Vec<f64> = z.iter().zip(&self.centre).map(|(z, c)| z - c).collect();
        let along = solved(&self.factor, &from_centre);
        let axes = along.iter().zip(&self.scales).zip(&self.factor);
        axes.map(|((along, [below, above]), row)| {
            let t = along / if *along < 0.0 { below } else { above };
            let width = (below + above) * row.last().copied().unwrap_or(f64::NAN);
            // 3/8 (1 + t^2/4)^(-5/2), times 2/width
            (0.75 / width).ln() - 2.5 * (0.25 * t * t).ln_1p()
        })
        .sum()
    }
}

/// Quantile of Student's t with four degrees of freedom (Shaw, *J. Comput. Finance* **9** (2006)
/// 37).
fn t4_quantile(probability: f64) -> f64 {
    let p = probability.clamp(1e-12, 1.0 - 1e-12);
    let root = (4.0 * p * (1.0 - p)).sqrt().min(1.0);
    let q = (root.acos() / 3.0).cos() / root;
    (p - 0.5).signum() * 2.0 * (q - 1.0).max(0.0).sqrt()
}

/// Principal axes of the covariance of θ, each with the length of its standard deviation, from the
/// decomposition of the Jacobian of data and prior scaled by the standard deviations of the prior.
fn principal_axes(svd: &ScaledDecomposition, deviations: &[f64]) -> Vec<Vec<f64>> {
    let axis = |(vector, s): (&Vec<f64>, &f64)| -> Vec<f64> {
        vector
            .iter()
            .zip(deviations)
            .map(|(v, deviation)| v * deviation / s)
            .collect()
    };
    svd.right
        .iter()
        .zip(&svd.singular_values)
        .map(axis)
        .collect()
}

/// Covariance with these principal `axes`, each with the length of its standard deviation.
fn covariance(axes: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let count = axes.len();
    let mut covariance = vec![vec![0.0; count]; count];
    for axis in axes {
        for (row, a) in covariance.iter_mut().zip(axis) {
            for (entry, b) in row.iter_mut().zip(axis) {
                *entry += a * b;
            }
        }
    }
    covariance
}

/// Solves F x = b for a lower triangle F by rows.
fn solved(factor: &[Vec<f64>], b: &[f64]) -> Vec<f64> {
    let mut x: Vec<f64> = Vec::with_capacity(b.len());
    for (row, b) in factor.iter().zip(b) {
        let known: f64 = row.iter().zip(&x).map(|(l, x)| l * x).sum();
        x.push((b - known) / row.last().copied().unwrap_or(f64::NAN));
    }
    x
}

/// Lower Cholesky factor by rows, row i with i + 1 entries; `None` unless the matrix is positive
/// definite.
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

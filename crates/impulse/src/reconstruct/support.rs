//! Forces that act only in a part of the record.

use faer::{Mat, Side};

use super::Penalty;
use super::calibration_scatter::CalibrationLines;
use super::grid::{Support, lags, toeplitz};
use super::lines::WeightedLines;
use super::modes::{Filter, Modes};
use super::path_errors::PathErrors;
use super::supposed::{self, CalibrationShape, Told};
use crate::{ImpulseError, fourier};

/// Normal equations $`(Q + \lambda D)f = b`$ of the samples of a support. D is Toeplitz, as is Q if
/// the frequency responses have no errors: the convolution does not depend on the start of the
/// support.
pub(super) struct SupportProblem {
    /// Matrix Q, from $`q_l = \sum_k w_k|H_k|^2 e^{i\theta_k l}`$ over both sides.
    pub(super) quadratic: Mat<f64>,
    pub(super) right_side: Vec<f64>,
    /// The informed equations, if frequency responses have errors.
    pub(super) informed: Option<Informed>,
    /// Eigenvectors $`V`$ with $`V^T D V = 1`$, $`V^T Q V = \mathrm{diag}(\mu)`$.
    vectors: Mat<f64>,
    pub(super) modes: Modes,
    /// First row of D.
    penalty: Vec<f64>,
}

/// Normal equations that weight every component by its information.
///
/// In the components v of the force, the equations $`Qf = b`$ with $`\mathrm{cov}\,b = T`$ are
/// $`\mu f = b \pm \sqrt\tau`$, and the assumed force of covariance $`P^{-1}`$ is $`f = 0 \pm 1`$.
/// Least squares of both is $`(a\mu + 1) f = a b`$ with $`a = \mu/\tau`$; a is 0 where errors of
/// the frequency response leave $`\mu`$ below zero. Without such errors $`\tau = \mu`$ and
/// $`a = 1`$.
pub(super) struct Informed {
    /// Matrix from the given right side to the right side of the informed equations.
    pub(super) weights: Mat<f64>,
    /// P: variance that the assumed force adds to the right side.
    pub(super) prior: Mat<f64>,
}

impl Informed {
    /// Creates the informed equations; also returns their Q and b.
    #[allow(
        clippy::indexing_slicing,
        reason = "all lists and matrices have as many elements per side as the right side"
    )]
    fn new(
        quadratic: &Mat<f64>,
        right_side: &[f64],
        (errors, covariance): (&PathErrors, &Mat<f64>),
        blows: Option<&CalibrationLines>,
        support: Support,
        n_samples: usize,
    ) -> Result<(Self, Mat<f64>, Vec<f64>), ImpulseError> {
        let length = right_side.len();
        let prior = toeplitz(&lags(&errors.prior, n_samples, length));
        let (values, vectors) = eigen(&prior, length)?;
        let largest = values.iter().copied().fold(0.0, f64::max);
        // components of nearly infinite assumed power are in effect unconstrained: the limit
        // prevents a division by zero
        let least = largest * f64::EPSILON * length as f64;
        let whitening = Mat::from_fn(length, length, |i, j| {
            vectors[(i, j)] / values[j].max(least).sqrt()
        });
        let (values, rotation) = eigen(&(whitening.transpose() * quadratic * &whitening), length)?;
        let components = whitening * rotation;
        let scatter = covariance * &components;
        let counted: Vec<f64> = (0..length)
            .map(|j| {
                let tau: f64 = (0..length)
                    .map(|i| components[(i, j)] * scatter[(i, j)])
                    .sum();
                if values[j] > 0.0 && tau > 0.0 {
                    values[j] / tau
                } else {
                    0.0
                }
            })
            .collect();
        // P v, the dual of v
        let dual = &prior * &components;
        let by =
            |of: &dyn Fn(usize) -> f64| Mat::from_fn(length, length, |i, j| dual[(i, j)] * of(j));
        let weights = by(&|j| counted[j]) * components.transpose();
        let supposed = blows.and_then(|blows| {
            let blow = CalibrationShape::of(&blows.mean_blow, &blows.differences, n_samples);
            let told = (0..length).filter(|j| counted[*j] > 0.0).map(|j| {
                let side: f64 = (0..length)
                    .map(|i| components[(i, j)] * right_side[i])
                    .sum();
                Told {
                    index: j,
                    value: side / values[j],
                    information: counted[j] * values[j],
                }
            });
            supposed::blow(
                &blow,
                support,
                (&components, &dual),
                &told.collect::<Vec<_>>(),
                &prior,
            )
        });
        let told = by(&|j| counted[j] * values[j]) * dual.transpose();
        let (mean, prior) = match supposed {
            Some(supposed) => (supposed.mean, supposed.precision),
            None => (vec![0.0; length], prior),
        };
        let informed = told + &prior;
        let right_side = (0..length)
            .map(|i| {
                let told = (0..length).map(|j| weights[(i, j)] * right_side[j]);
                let supposed = (0..length).map(|j| prior[(i, j)] * mean[j]);
                told.sum::<f64>() + supposed.sum::<f64>()
            })
            .collect();
        Ok((Self { weights, prior }, informed, right_side))
    }

    /// Returns the covariance of the right side, from the covariance of the given right side.
    pub(super) fn covariance(&self, given: &Mat<f64>) -> Mat<f64> {
        &self.weights * given * self.weights.transpose() + &self.prior
    }
}

#[allow(
    clippy::indexing_slicing,
    reason = "all lists and matrices have `length` elements per side, at least one"
)]
impl SupportProblem {
    pub(super) fn new(
        lines: &WeightedLines,
        support: Support,
        penalty: Penalty,
        errors: Option<(&PathErrors, &Mat<f64>)>,
        blows: Option<&CalibrationLines>,
    ) -> Result<Self, ImpulseError> {
        let Support { first, length } = support;
        let n_samples = lines.grid.n_samples;
        let mut quadratic = toeplitz(&lags(&lines.power, n_samples, length));
        let mut right_side: Vec<f64> = fourier::to_samples(&lines.cross, n_samples)
            .into_iter()
            .skip(first)
            .take(length)
            .collect();
        let weights: Vec<f64> = (0..lines.grid.n_lines())
            .map(|line| penalty.weight(lines.grid.omega(line)))
            .collect();
        let penalty_lags = lags(&weights, n_samples, length);
        let mut informed = None;
        if let Some(errors) = errors {
            let (of, equations, side) =
                Informed::new(&quadratic, &right_side, errors, blows, support, n_samples)?;
            (quadratic, right_side, informed) = (equations, side, Some(of));
        }
        // columns W with W^T D W = 1
        let whitening = match penalty {
            Penalty::Size => {
                // the sum of all rotations: D is N times the unit matrix
                Mat::from_fn(length, length, |i, j| {
                    if i == j {
                        penalty_lags[0].sqrt().recip()
                    } else {
                        0.0
                    }
                })
            }
            Penalty::Slope | Penalty::Curvature => {
                let (values, vectors) = eigen(&toeplitz(&penalty_lags), length)?;
                Mat::from_fn(length, length, |i, j| vectors[(i, j)] / values[j].sqrt())
            }
        };
        let reduced = whitening.transpose() * &quadratic * &whitening;
        let (values, rotation) = eigen(&reduced, length)?;
        let vectors = whitening * rotation;
        let mut modes = Modes {
            strengths: Vec::new(),
            energies: Vec::new(),
            dimensions: vec![1.0; length],
            unexplained: 0.0,
            n_data: lines.n_data,
        };
        let largest = values.iter().copied().fold(0.0, f64::max);
        let rounding = length as f64 * f64::EPSILON * largest;
        let mut explained = 0.0;
        for (index, value) in values.iter().enumerate() {
            // a strength at the level of rounding carries no information
            let strength = if *value > rounding { *value } else { 0.0 };
            let energy = if strength > 0.0 {
                let projection: f64 = right_side
                    .iter()
                    .enumerate()
                    .map(|(i, b)| vectors[(i, index)] * b)
                    .sum();
                projection * projection / strength
            } else {
                0.0
            };
            explained += energy;
            modes.strengths.push(strength);
            modes.energies.push(energy);
        }
        modes.unexplained = lines.unexplained(explained);
        for (dimension, strength) in modes.dimensions.iter_mut().zip(&modes.strengths) {
            if *strength <= 0.0 {
                *dimension = 0.0;
            }
        }
        Ok(Self {
            quadratic,
            right_side,
            informed,
            vectors,
            modes,
            penalty: penalty_lags,
        })
    }

    /// Returns the matrix from the right side to the force, $`V\,\mathrm{diag}(\varphi/\mu)\,V^T`$.
    pub(super) fn inverse(&self, filter: Filter, parameter: f64) -> Mat<f64> {
        let n = self.vectors.nrows();
        let scaled = Mat::from_fn(n, n, |i, j| {
            let strength = self.modes.strengths[j];
            if strength > 0.0 {
                self.vectors[(i, j)] * filter.kept(strength, parameter) / strength
            } else {
                0.0
            }
        });
        scaled * self.vectors.transpose()
    }

    /// Returns $`V\,\mathrm{diag}((1-\varphi)^2/\lambda)\,V^T`$: the covariance of the part lost by
    /// regularisation, for noise of weighted variance 1.
    pub(super) fn lost(&self, filter: Filter, parameter: f64) -> Option<Mat<f64>> {
        if filter == Filter::None {
            return None;
        }
        let n = self.vectors.nrows();
        let scaled = Mat::from_fn(n, n, |i, j| {
            let lost = filter.lost(self.modes.strengths[j], parameter);
            self.vectors[(i, j)] * lost * lost / parameter
        });
        Some(scaled * self.vectors.transpose())
    }

    /// Returns $`Q + \lambda D`$.
    pub(super) fn regularised(&self, filter: Filter, parameter: f64) -> Mat<f64> {
        let lambda = if filter == Filter::Tikhonov {
            parameter
        } else {
            0.0
        };
        let n = self.quadratic.nrows();
        Mat::from_fn(n, n, |i, j| {
            self.quadratic[(i, j)] + lambda * self.penalty[i.abs_diff(j)]
        })
    }

    /// Number of components that the responses do not determine above rounding.
    pub(super) fn n_silent(&self) -> usize {
        self.modes.strengths.iter().filter(|s| **s <= 0.0).count()
    }
}

/// Returns a square root S of a covariance $`C = S S^T`$.
pub(super) fn error_factor(covariance: &Mat<f64>) -> Result<Mat<f64>, ImpulseError> {
    let length = covariance.nrows();
    let (values, vectors) = eigen(covariance, length)?;
    // rounding may make a zero variance negative
    Ok(Mat::from_fn(length, length, |i, j| {
        let value = values.get(j).copied().unwrap_or(f64::NAN);
        vectors[(i, j)] * value.max(0.0).sqrt()
    }))
}

fn eigen(matrix: &Mat<f64>, size: usize) -> Result<(Vec<f64>, Mat<f64>), ImpulseError> {
    let decomposition = matrix
        .self_adjoint_eigen(Side::Lower)
        .map_err(|_| ImpulseError::NoDecomposition { size })?;
    let diagonal = decomposition.S().column_vector();
    let values = (0..size).map(|i| diagonal[i]).collect();
    Ok((values, decomposition.U().to_owned()))
}

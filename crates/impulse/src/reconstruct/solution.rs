//! A force and the linear method that gave it: its error, noise gain and bias.

use num_complex::Complex64;

use super::grid::{Support, lags, toeplitz};
use super::lines::{Transformed, WeightedLines};
use super::modes::Modes;
use super::outcome::{ChosenParameter, NonNegativity, ProfileInterval};
use super::profile::Constrained;
use super::support::{self, Informed};
use crate::{ForceError, ImpulseError, fourier};

/// A force and the linear method that gave it.
pub(super) struct Solved {
    pub(super) impulse: Option<f64>,
    /// Change by the regularisation, if the force without it is known.
    pub(super) bias: Option<Vec<f64>>,
    pub(super) samples: Vec<f64>,
    pub(super) parameter: Option<ChosenParameter>,
    pub(super) modes: Modes,
    pub(super) lines: WeightedLines,
    pub(super) gain: Gain,
    pub(super) non_negativity: Option<NonNegativity>,
    /// The problem without tension, if solved.
    pub(super) constrained: Option<Constrained>,
    pub(super) n_silent: usize,
}

/// Linear map from the weighted cross sums of the lines to the force.
#[expect(
    clippy::large_enum_variant,
    reason = "a solution contains only one of these"
)]
pub(super) enum Gain {
    Lines {
        gains: Vec<f64>,
        /// Variance of the part of each line removed by the regularisation, for noise of weighted
        /// variance 1.
        lost: Vec<f64>,
    },
    Support {
        support: Support,
        /// $`V\,\mathrm{diag}(\varphi/\mu)\,V^T`$.
        gain: faer::Mat<f64>,
        /// Matrix Q.
        quadratic: faer::Mat<f64>,
        informed: Option<Informed>,
        /// Gain without regularisation, from which the error follows if the force is assumed to be
        /// like the calibration blows.
        plain: Option<faer::Mat<f64>>,
        /// Covariance of the part removed by the regularisation, for noise of weighted variance 1.
        lost: Option<faer::Mat<f64>>,
    },
}

impl Solved {
    /// Returns the interval of the peak of a force without tension, for noise of the weighted
    /// variance `noise`.
    #[allow(
        clippy::indexing_slicing,
        reason = "the support lies in the record, of which the bias has one element per sample"
    )]
    pub(super) fn peak_interval(
        &self,
        transformed: &Transformed<'_>,
        noise: f64,
        bias: &[f64],
    ) -> Option<ProfileInterval> {
        let (Some(constrained), Gain::Support { support, .. }) = (&self.constrained, &self.gain)
        else {
            return None;
        };
        let growth = transformed.growth_from(support.first);
        let force = constrained.force.iter().zip(growth).enumerate();
        let (at, (_, growth)) =
            force.max_by(|(_, (a, b)), (_, (c, d))| (*a * b).total_cmp(&(*c * d)))?;
        let mut sample = vec![0.0; support.length];
        sample[at] = growth;
        constrained.interval(&sample, noise, growth * bias[support.first + at])
    }

    /// Expected sum of squares of the residual after a force on a support is fitted to noise that
    /// decays with a window and has the weighted variance 1. The fit removes more of the noise
    /// early in the record. The sum is $`n - 2\operatorname{tr} GC + \operatorname{tr} GQGC`$ with
    /// the gain G, the normal matrix Q without its penalty, and the covariance C of the right-hand
    /// side.
    pub(super) fn freedom_left(
        &self,
        transformed: &Transformed<'_>,
        (weights_for, power): (Option<&[f64]>, &[f64]),
    ) -> Option<f64> {
        let (
            Some(_),
            Gain::Support {
                support,
                gain,
                quadratic,
                informed: None,
                ..
            },
        ) = (&transformed.shift, &self.gain)
        else {
            return None;
        };
        let covariance = transformed.cross_covariance(weights_for, power, 1.0, *support);
        let once = gain * covariance;
        let twice = gain * quadratic * &once;
        let trace =
            |matrix: &faer::Mat<f64>| -> f64 { (0..support.length).map(|i| matrix[(i, i)]).sum() };
        Some(self.lines.n_data - 2.0 * trace(&once) + trace(&twice))
    }

    /// Returns the error of a force of this `power`, with `unit_noise` if the noise is not known;
    /// it includes the part removed by the regularisation.
    ///
    /// A regularisation is a prior assumption on the force. The posterior variance (G. Wahba's
    /// interval) is the sum of the propagated noise and of the prior variance of the part removed,
    /// which the square of `bias` replaces where it is greater. For a force that is assumed to be
    /// like the calibration blows, the variance without regularisation and the square of `bias` are
    /// added instead.
    pub(super) fn error(
        &self,
        transformed: &Transformed<'_>,
        (weights_for, power): (Option<&[f64]>, &[f64]),
        unit_noise: f64,
        bias: &[f64],
    ) -> Result<ForceError, ImpulseError> {
        // if the noise is known, the weights contain it
        let noise = if unit_noise > 0.0 { unit_noise } else { 1.0 };
        let n_samples = self.samples.len();
        let none = ForceError::none(n_samples);
        let mut supposed = vec![0.0; n_samples];
        let random = match &self.gain {
            Gain::Lines { gains, lost } => {
                let scale = (n_samples as f64).powi(-2);
                let variances = match &transformed.shift {
                    None => {
                        let cross = transformed.cross_variance(weights_for, power, unit_noise);
                        let lines = gains.iter().zip(cross).zip(lost);
                        lines
                            .map(|((g, v), lost)| (g * g * v + noise * lost) * scale)
                            .collect()
                    }
                    Some(shift) => {
                        let mut sum = vec![0.0; gains.len()];
                        for mut filter in transformed.noise_filters(weights_for, power, unit_noise)
                        {
                            for (line, gain) in filter.iter_mut().zip(gains) {
                                *line *= gain;
                            }
                            for (sum, own) in sum.iter_mut().zip(shift.unwound(&filter)) {
                                *sum += own * scale;
                            }
                        }
                        sum
                    }
                };
                let all: f64 = lost
                    .iter()
                    .enumerate()
                    .map(|(line, lost)| self.lines.grid.sides(line) * lost * noise * scale)
                    .sum();
                supposed.fill(all);
                none.with_lines(variances, n_samples, None)
            }
            Gain::Support {
                support,
                gain,
                informed,
                plain,
                lost,
                ..
            } => {
                let mut covariance =
                    transformed.cross_covariance(weights_for, power, unit_noise, *support);
                if let Some(informed) = informed {
                    covariance = informed.covariance(&covariance);
                }
                let by = plain.as_ref().unwrap_or(gain);
                let mut covariance = by * covariance * by.transpose();
                if let (Some(lost), None) = (lost, plain) {
                    covariance += lost * faer::Scale(noise);
                    for (i, slot) in supposed
                        .iter_mut()
                        .skip(support.first)
                        .take(support.length)
                        .enumerate()
                    {
                        *slot = noise * lost[(i, i)];
                    }
                }
                let factor = support::error_factor(&covariance)?;
                let rows = transformed
                    .growth_from(support.first)
                    .take(support.length)
                    .enumerate();
                let rows = rows
                    .map(|(i, growth)| {
                        let row = (0..support.length).map(|j| growth * factor[(i, j)]);
                        row.collect()
                    })
                    .collect();
                none.with_support(support.first, rows)
            }
        };
        let excess: Vec<f64> = bias
            .iter()
            .zip(supposed)
            .zip(transformed.growth_from(0))
            .map(|((bias, supposed), growth)| {
                growth * (bias * bias - supposed).max(0.0).sqrt().copysign(*bias)
            })
            .collect();
        Ok(if excess.iter().any(|excess| *excess != 0.0) {
            random.with_common(excess)
        } else {
            random
        })
    }

    /// Returns the root mean square of the force for white noise of root mean square 1 on all
    /// responses.
    pub(super) fn noise_gain(
        &self,
        transformed: &Transformed<'_>,
        weights_for: Option<&[f64]>,
    ) -> f64 {
        let deviation = transformed.white_cross_deviation(weights_for);
        let n_samples = self.samples.len();
        match &self.gain {
            Gain::Lines { gains, .. } => {
                if let Some(shift) = &transformed.shift {
                    let filters = transformed
                        .filters(weights_for, |_, _| n_samples as f64 * shift.mean_square());
                    let square: f64 = filters
                        .into_iter()
                        .flat_map(|filter| {
                            let lines = filter.iter().zip(gains).map(|(c, gain)| c * gain);
                            shift.unwound(&lines.collect::<Vec<_>>())
                        })
                        .enumerate()
                        .map(|(index, line)| self.lines.grid.sides(index % gains.len()) * line)
                        .sum();
                    return square.sqrt() / n_samples as f64;
                }
                let lines = gains.iter().zip(&deviation).enumerate();
                let square: f64 = lines
                    .map(|(line, (g, d))| self.lines.grid.sides(line) * (g * d).powi(2))
                    .sum();
                (square / n_samples as f64).sqrt()
            }
            Gain::Support {
                support,
                gain,
                informed,
                ..
            } => {
                if let Some(shift) = &transformed.shift {
                    let filters = transformed
                        .filters(weights_for, |_, _| n_samples as f64 * shift.mean_square());
                    let gain = match informed {
                        Some(informed) => gain * &informed.weights,
                        None => gain.clone(),
                    };
                    let spread = &gain * shift.covariance(&filters, *support);
                    let growth = transformed.growth_from(support.first);
                    let square: f64 = (0..support.length)
                        .zip(growth)
                        .map(|(i, growth)| {
                            let row = (0..support.length).map(|j| spread[(i, j)] * gain[(i, j)]);
                            growth * growth * row.sum::<f64>()
                        })
                        .sum();
                    return (square / support.length as f64).sqrt();
                }
                let variance: Vec<f64> = deviation.iter().map(|d| d * d).collect();
                let lags = lags(&variance, n_samples, support.length);
                let gain = match informed {
                    Some(informed) => gain * &informed.weights,
                    None => gain.clone(),
                };
                let spread = &gain * toeplitz(&lags);
                let square: f64 = (0..support.length)
                    .flat_map(|i| (0..support.length).map(move |j| (i, j)))
                    .map(|at| spread[at] * gain[at])
                    .sum();
                (n_samples as f64 * square / support.length as f64).sqrt()
            }
        }
    }

    /// Returns $`-(1-\varphi)\hat F`$ as a history.
    #[allow(
        clippy::indexing_slicing,
        reason = "the problem and the force have `length` elements, as many as the support in the record"
    )]
    pub(super) fn bias(&self) -> Vec<f64> {
        let n_samples = self.samples.len();
        match &self.gain {
            Gain::Lines { gains, .. } => {
                let force = fourier::to_spectrum(&self.samples);
                let lines = gains.iter().zip(&self.lines.power).zip(&force);
                let lost: Vec<Complex64> = lines
                    .map(|((gain, power), f)| {
                        if *power > 0.0 {
                            (gain * power - 1.0) * f / n_samples as f64
                        } else {
                            Complex64::ZERO
                        }
                    })
                    .collect();
                fourier::to_samples(&lost, n_samples)
            }
            Gain::Support {
                support,
                gain,
                quadratic,
                ..
            } => {
                // G Q f - f
                let Support { first, length } = *support;
                let force = self.samples.get(first..first + length).unwrap_or_default();
                let explained: Vec<f64> = (0..length)
                    .map(|i| {
                        let terms = force.iter().enumerate();
                        terms.map(|(j, f)| quadratic[(i, j)] * f).sum()
                    })
                    .collect();
                let mut bias = vec![0.0; n_samples];
                for (i, slot) in bias.iter_mut().skip(first).take(length).enumerate() {
                    let row = explained.iter().enumerate();
                    let kept: f64 = row.map(|(j, b)| gain[(i, j)] * b).sum();
                    *slot = kept - force[i];
                }
                bias
            }
        }
    }
}

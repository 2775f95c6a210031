//! A force with the linear method that gave it: its error, its gain of noise, its bias.

use num_complex::Complex64;

use super::lines::{Transformed, WeightedLines};
use super::modes::Modes;
use super::outcome::{ChosenParameter, NonNegativity};
use super::support::{self, Support, SupportProblem};
use crate::{ForceError, ImpulseError, fourier};

/// A force, and the linear method that gave it.
pub(super) struct Solved {
    pub(super) samples: Vec<f64>,
    pub(super) parameter: Option<ChosenParameter>,
    pub(super) modes: Modes,
    pub(super) lines: WeightedLines,
    pub(super) gain: Gain,
    pub(super) non_negativity: Option<NonNegativity>,
    pub(super) n_silent: usize,
}

/// From the weighted cross sums of the lines to the force.
pub(super) enum Gain {
    Lines(Vec<f64>),
    Support {
        support: Support,
        /// $`V\,\mathrm{diag}(\varphi/\mu)\,V^T`$.
        gain: faer::Mat<f64>,
        /// First row of Q.
        problem: Vec<f64>,
    },
}

impl Solved {
    /// The error of the force for cross sums of this variance.
    pub(super) fn error(&self, cross_variance: &[f64]) -> Result<ForceError, ImpulseError> {
        let n_samples = self.samples.len();
        let none = ForceError::none(n_samples);
        match &self.gain {
            Gain::Lines(gains) => {
                let scale = (n_samples as f64).powi(-2);
                let lines = gains.iter().zip(cross_variance);
                let variances = lines.map(|(g, v)| g * g * v * scale).collect();
                Ok(none.with_lines(variances, n_samples, None))
            }
            Gain::Support { support, gain, .. } => {
                let factor = SupportProblem::error_factor(gain, cross_variance, n_samples)?;
                let rows = (0..support.length)
                    .map(|i| (0..support.length).map(|j| factor[(i, j)]).collect())
                    .collect();
                Ok(none.with_support(support.first, rows))
            }
        }
    }

    /// Root mean square of the force under white noise of 1.
    pub(super) fn noise_gain(
        &self,
        transformed: &Transformed<'_>,
        weights_for: Option<&[Complex64]>,
    ) -> Result<f64, ImpulseError> {
        let variance = transformed.white_cross_variance(weights_for);
        match &self.gain {
            Gain::Lines(_) => {
                let error = self.error(&variance)?;
                Ok(error.standard_error().first().copied().unwrap_or(f64::NAN))
            }
            Gain::Support { support, gain, .. } => {
                let n_samples = self.samples.len();
                let lags = support::lags(&variance, n_samples, support.length);
                let spread = gain * support::toeplitz(&lags);
                let square: f64 = (0..support.length)
                    .flat_map(|i| (0..support.length).map(move |j| (i, j)))
                    .map(|at| spread[at] * gain[at])
                    .sum();
                Ok((square / support.length as f64).sqrt())
            }
        }
    }

    /// $`-(1-\varphi)\hat F`$ as a history.
    #[allow(
        clippy::indexing_slicing,
        reason = "the problem and the force have `length` elements, which the support of the record holds"
    )]
    pub(super) fn bias(&self) -> Vec<f64> {
        let n_samples = self.samples.len();
        match &self.gain {
            Gain::Lines(gains) => {
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
                problem,
            } => {
                // G Q f - f
                let Support { first, length } = *support;
                let force = self.samples.get(first..first + length).unwrap_or_default();
                let explained: Vec<f64> = (0..length)
                    .map(|i| {
                        let terms = force.iter().enumerate();
                        terms.map(|(j, f)| problem[i.abs_diff(j)] * f).sum()
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

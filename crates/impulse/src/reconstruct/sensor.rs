//! A response, its frequency response and the errors of both.

use std::collections::BTreeSet;

use num_complex::Complex64;

use super::shifted::Shift;
use crate::ImpulseError;
use crate::error::{check_enough, check_length, check_positive, check_samples};

/// The noise of a measured response.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum ResponseNoise<'a> {
    /// Unknown noise: all lines have equal weight, and the level is estimated from the part that
    /// the force does not explain.
    #[default]
    Unknown,
    /// White noise of this standard deviation, in the unit of the response.
    White(f64),
    /// $`\mathrm E\lvert\delta\hat x_k\rvert^2`$ of every line of $`\hat x_k = \sum_n x_n e^{-2\pi
    /// ikn/N}`$ (white noise of standard deviation $`\sigma`$ has $`N\sigma^2`$), circular and
    /// independent between lines; `(n_samples/2 + 1)`. A value that is not finite and above
    /// zero excludes its line.
    Lines(&'a [f64]),
}

/// One measured response, with its frequency response and the errors of both.
///
/// | input | shape | unit |
/// |---|---|---|
/// | response x | `(n_samples)` | unit of x |
/// | frequency response $`H = \hat x/\hat F`$ | `(n_samples/2 + 1)`, from 0 Hz, lines $`1/(N\Delta t)`$ apart | unit of x per N |
/// | variance $`\mathrm E\lvert\delta H\rvert^2`$ | as the frequency response | its square |
#[derive(Debug, Clone)]
pub struct Sensor<'a> {
    pub(super) response: &'a [f64],
    pub(super) frequency_response: &'a [Complex64],
    pub(super) noise: ResponseNoise<'a>,
    pub(super) variance: Option<&'a [f64]>,
    pub(super) left_out: BTreeSet<usize>,
}

impl<'a> Sensor<'a> {
    /// Creates a sensor from a response of unknown noise and a frequency response without errors;
    /// the methods below set both.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::TooShort`] for fewer than four samples, [`ImpulseError::NonFinite`] for a
    /// sample, [`ImpulseError::LengthMismatch`] for the frequency response.
    pub fn new(
        response: &'a [f64],
        frequency_response: &'a [Complex64],
    ) -> Result<Self, ImpulseError> {
        check_enough("response", response.len(), 4)?;
        check_samples("response", response)?;
        check_lines(
            "frequency response",
            frequency_response.len(),
            response.len(),
        )?;
        Ok(Self {
            response,
            frequency_response,
            noise: ResponseNoise::Unknown,
            variance: None,
            left_out: BTreeSet::new(),
        })
    }

    /// Sets the noise of the response.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for a standard deviation that is not above zero,
    /// [`ImpulseError::LengthMismatch`].
    pub fn with_noise(self, noise: ResponseNoise<'a>) -> Result<Self, ImpulseError> {
        match noise {
            ResponseNoise::Unknown => {}
            ResponseNoise::White(deviation) => {
                check_positive("standard deviation of the response", deviation)?;
            }
            ResponseNoise::Lines(lines) => {
                check_lines("noise of the response", lines.len(), self.response.len())?;
            }
        }
        Ok(Self { noise, ..self })
    }

    /// Sets the variance of the frequency response: circular, independent between lines and
    /// independent of the response. A value that is negative or not finite excludes its line.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::LengthMismatch`].
    pub fn with_variance(self, variance: &'a [f64]) -> Result<Self, ImpulseError> {
        check_lines(
            "variance of the frequency response",
            variance.len(),
            self.response.len(),
        )?;
        Ok(Self {
            variance: Some(variance),
            ..self
        })
    }

    /// Excludes lines, for example those with unknown frequency response. Their values are not
    /// read.
    #[must_use]
    pub fn without_lines(mut self, lines: impl IntoIterator<Item = usize>) -> Self {
        self.left_out.extend(lines);
        self
    }

    /// Returns the sensor with its response under the window of `shift`; the noise of lines already
    /// applies to such a response.
    pub(super) fn windowed<'b>(&self, response: &'b [f64], shift: &Shift) -> Sensor<'b>
    where
        'a: 'b,
    {
        let noise = match self.noise {
            ResponseNoise::White(deviation) => {
                ResponseNoise::White(deviation * shift.mean_square().sqrt())
            }
            other => other,
        };
        Sensor {
            response,
            noise,
            ..self.clone()
        }
    }

    /// Noise of a line, if the noise is known.
    pub(super) fn noise_at(&self, line: usize) -> Option<f64> {
        match self.noise {
            ResponseNoise::Unknown => None,
            ResponseNoise::White(deviation) => {
                Some(self.response.len() as f64 * deviation * deviation)
            }
            ResponseNoise::Lines(lines) => lines.get(line).copied(),
        }
    }

    /// Variance of the frequency response at a line; 0 if none was given.
    pub(super) fn variance_at(&self, line: usize) -> f64 {
        self.variance
            .and_then(|variance| variance.get(line).copied())
            .unwrap_or(0.0)
    }

    /// Returns true if the line is excluded, or has errors that are not numbers.
    pub(super) fn is_left_out(&self, line: usize) -> bool {
        let noise = self.noise_at(line).unwrap_or(1.0);
        let variance = self.variance_at(line);
        self.left_out.contains(&line)
            || !(noise.is_finite() && noise > 0.0)
            || !(variance.is_finite() && variance >= 0.0)
    }
}

fn check_lines(what: &'static str, found: usize, n_samples: usize) -> Result<(), ImpulseError> {
    check_length(what, found, n_samples / 2 + 1)
}

//! Prior knowledge of the wave number.

use num_complex::Complex64;

use super::path::State;

/// Wave number at one frequency, with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct KnownWaveNumber {
    pub(super) omega: f64,
    pub(super) wave_number: f64,
    pub(super) standard_error: f64,
}

/// All prior knowledge of the wave speed and of the wave number.
pub(super) struct Anchors<'a> {
    pub(super) slowest: f64,
    pub(super) fastest: f64,
    /// Wave speed [m/s] and the standard error of its logarithm.
    pub(super) speed: Option<(f64, f64)>,
    /// Known wave numbers in order of frequency.
    pub(super) known: &'a [KnownWaveNumber],
}

impl Anchors<'_> {
    pub(super) fn log_prior_of_speed(&self, speed: f64) -> f64 {
        self.speed.map_or(0.0, |(guess, relative)| {
            -0.5 * ((speed / guess).ln() / relative).powi(2)
        })
    }
}

impl KnownWaveNumber {
    /// Returns the log likelihood of a course with `state` at this frequency. The anchor changes
    /// the weights of the courses, and thereby the count of waves; it does not move the courses.
    pub(super) fn log_likelihood(&self, state: &State) -> f64 {
        let Complex64 {
            im: wave_number, ..
        } = state.gamma;
        let variance = self.standard_error.powi(2) + 0.5 * state.variance;
        -0.5 * (wave_number - self.wave_number).powi(2) / variance
    }
}

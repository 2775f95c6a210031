//! Noise of a gauge before the pulse.

use std::f64::consts::PI;

use rand::{Rng, RngExt};
use rand_distr::StandardNormal;
use rodwave::fourier::RealFourier;

use crate::ImpulseError;
use crate::error::check_enough;
use crate::interpolation::at_place;

/// Fewest samples of a silence.
const FEWEST: usize = 32;
/// Distance from rest, in standard deviations of the first samples, beyond which a sample is
/// disturbed.
const DISTURBED: f64 = 20.0;
/// Fraction of the largest sample above which a sample belongs to a pulse.
const PULSE: f64 = 0.05;
/// Number of segments, each half overlapped, over which the power is averaged.
const SEGMENTS: usize = 8;

/// Noise of a gauge from its samples before the pulse: the level at rest and the power spectrum
/// around it.
///
/// The spectrum is the mean of periodograms over half-overlapped segments with Hann's window (Welch
/// 1967), but nowhere less than the quantisation noise of the converter, $`q^2/12`$.
#[derive(Debug, Clone)]
pub struct QuietNoise {
    /// Level at rest.
    pub level: f64,
    /// Standard deviation of a sample.
    pub standard_deviation: f64,
    /// Degrees of freedom of the power of the noise.
    pub degrees_of_freedom: f64,
    /// Variance per line of a segment, in the units of white noise of unit variance:
    /// $`E|X_k|^2/N`$.
    power: Vec<f64>,
}

impl QuietNoise {
    /// Estimates the noise from the first `silent` of the `samples`.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::TooShort`] for fewer than 32 silent samples.
    pub fn before_pulse(samples: &[f64], silent: usize) -> Result<Self, ImpulseError> {
        let quiet = samples.get(..silent).unwrap_or(samples);
        check_enough("silence before the pulse", quiet.len(), FEWEST)?;
        let level = quiet.iter().sum::<f64>() / quiet.len() as f64;
        let step = converter_step(samples);
        let floor = step * step / 12.0;
        // segments overlap by half
        let length = (2 * quiet.len() / (SEGMENTS + 1)).max(FEWEST / 4);
        let window: Vec<f64> = (0..length)
            .map(|n| (PI * (n as f64 + 0.5) / length as f64).sin().powi(2))
            .collect();
        let gain: f64 = window.iter().map(|w| w * w).sum();
        let mut transform = RealFourier::new(length);
        let mut power = vec![0.0; length / 2 + 1];
        let mut count = 0.0;
        for segment in quiet.windows(length).step_by((length / 2).max(1)) {
            for ((sample, x), w) in transform.samples().iter_mut().zip(segment).zip(&window) {
                *sample = (x - level) * w;
            }
            for (sum, line) in power.iter_mut().zip(transform.forward().iter()) {
                *sum += line.norm_sqr() / gain;
            }
            count += 1.0;
        }
        for power in &mut power {
            *power = (*power / count).max(floor);
        }
        let variance =
            quiet.iter().map(|x| (x - level).powi(2)).sum::<f64>() / (quiet.len() - 1) as f64;
        Ok(Self {
            level,
            standard_deviation: variance.max(floor).sqrt(),
            degrees_of_freedom: (quiet.len() - 1) as f64,
            power,
        })
    }

    /// Returns the noise of means of `by` samples each, within the band of such a record.
    pub(super) fn coarser(&self, by: usize) -> Self {
        let kept = (self.power.len().saturating_sub(1) / by).max(4) + 1;
        let power = self.power.iter().take(kept);
        Self {
            power: power.map(|power| power / by as f64).collect(),
            ..self.clone()
        }
    }

    /// Adds a draw of the noise to `samples`; `transform` has at least their length.
    pub(super) fn add_draw<R: Rng>(
        &self,
        samples: &mut [f64],
        transform: &mut RealFourier,
        random: &mut R,
    ) {
        let n = transform.samples().len();
        for sample in transform.samples().iter_mut() {
            *sample = random.sample(StandardNormal);
        }
        let last = self.power.len().saturating_sub(1);
        let lines = transform.forward();
        let of_line = last as f64 / (lines.len().max(2) - 1) as f64;
        for (k, line) in lines.iter_mut().enumerate() {
            // the mean was subtracted before the power was estimated: lines 0 and 1 of a segment
            // contain too little power and are replaced by line 2
            let place = (k as f64 * of_line).max(2.0);
            *line *= at_place(&self.power, place).sqrt() / n as f64;
        }
        for (sample, noise) in samples.iter_mut().zip(transform.inverse().iter()) {
            *sample += noise;
        }
    }
}

/// Returns the first of the `silent` samples that differs from the mean of their first eighth by
/// more than twenty standard deviations of this eighth and more than a twentieth of the largest
/// sample of the record. Hum and drift stay below these limits.
pub(super) fn first_disturbed(samples: &[f64], silent: usize) -> Option<usize> {
    let quiet = samples.get(..silent).unwrap_or(samples);
    let beginning = quiet.get(..quiet.len() / 8)?;
    let n = beginning.len() as f64;
    let level = beginning.iter().sum::<f64>() / n;
    let variance = beginning.iter().map(|x| (x - level).powi(2)).sum::<f64>() / (n - 1.0);
    let largest = samples.iter().map(|x| (x - level).abs());
    let limit = PULSE * largest.fold(0.0_f64, f64::max);
    let limit = limit.max(DISTURBED * variance.sqrt().max(converter_step(samples)));
    let disturbed = |x: &f64| (x - level).abs() > limit;
    quiet.iter().position(disturbed)
}

/// Returns the smallest difference between two different samples: the step of the converter, or
/// rounding.
fn converter_step(samples: &[f64]) -> f64 {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    let differences = sorted.windows(2).filter_map(|pair| match pair {
        [a, b] if b > a => Some(b - a),
        _ => None,
    });
    let least = differences.fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

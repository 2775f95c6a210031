//! Transforms of histories on a line Re s = a, and their inverses.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rodwave::band_limited::VelocityHistory;
use rodwave::fourier::RealFourier;

/// Damping aT_p over the period: the alias of the next period is damped by e^{-16} = 1.1e-7.
const DAMPING_OVER_PERIOD: f64 = 16.0;

/// Points per sample. The interpolation between samples passes nothing above 0.62 of the sampling
/// rate, so that two suffice.
pub(super) const FINER: usize = 2;

/// Number of fine points over which the excitation is faded to zero after its end. Only the ringing
/// of the kink affects times before the end, with 1/n² of the change of slope n points away.
const TAPER: usize = 64;

/// The discrete Laplace transform of one length.
pub(super) struct LaplaceLine {
    interval: f64,
    count: usize,
    damping: f64,
    fourier: RealFourier,
}

impl LaplaceLine {
    /// Creates a transform for histories of `samples` at `sampling_rate_hz`, with a period of at
    /// least twice the record.
    pub(super) fn new(samples: usize, sampling_rate_hz: f64) -> Self {
        let count = (2 * (FINER * samples + TAPER)).next_power_of_two();
        let interval = 1.0 / (sampling_rate_hz * FINER as f64);
        Self {
            interval,
            count,
            damping: DAMPING_OVER_PERIOD / (interval * count as f64),
            fourier: RealFourier::new(count),
        }
    }

    /// The arguments s = a + iω.
    pub(super) fn arguments(&self) -> impl Iterator<Item = Complex64> + use<> {
        let (damping, step) = (self.damping, TAU / (self.interval * self.count as f64));
        (0..=self.count / 2).map(move |k| Complex64::new(damping, step * k as f64))
    }

    /// Σ q(t_n) e^{-s t_n}, unscaled, of a history that is known over `samples` samples and then
    /// faded to zero.
    pub(super) fn transform(
        &mut self,
        history: &dyn VelocityHistory,
        samples: usize,
    ) -> Vec<Complex64> {
        let known = FINER * samples.saturating_sub(1) + 1;
        let last = history.at((known - 1) as f64 * self.interval);
        let damped = self.fourier.samples();
        damped.fill(0.0);
        for (n, value) in damped.iter_mut().enumerate().take(known + TAPER) {
            let time = n as f64 * self.interval;
            let undamped = if n < known {
                history.at(time)
            } else {
                let u = (n + 1 - known) as f64 / (TAPER + 1) as f64;
                last * 0.5 * (1.0 + (0.5 * TAU * u).cos())
            };
            *value = undamped * (-self.damping * time).exp();
        }
        self.fourier.forward().to_vec()
    }

    /// Points per second of a history.
    pub(super) fn rate_hz(&self) -> f64 {
        1.0 / self.interval
    }

    /// The first `points` fine points of the history of this unscaled transform.
    pub(super) fn history(&mut self, lines: &[Complex64], points: usize) -> Vec<f64> {
        for (own, line) in self.fourier.lines().iter_mut().zip(lines) {
            *own = *line;
        }
        let scale = 1.0 / self.count as f64;
        let (damping, interval) = (self.damping, self.interval);
        let samples = self.fourier.inverse().iter().take(points);
        samples
            .enumerate()
            .map(|(n, value)| value * (scale * (damping * interval * n as f64).exp()))
            .collect()
    }
}

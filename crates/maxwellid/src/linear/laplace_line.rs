//! Histories to transforms on a line Re s = a, and back.

use std::f64::consts::TAU;
use std::sync::Arc;

use num_complex::Complex64;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rodwave::band_limited::VelocityHistory;

/// aT_p: what comes around from the next period is damped by e^{-16} = 1.1e-7.
const DAMPING_OVER_PERIOD: f64 = 16.0;

/// Points per sample. The interpolation between samples passes nothing above 0.62 of the sampling rate, so two hold it.
pub(super) const FINER: usize = 2;

/// Fine points over which the excitation is taken to zero behind its end. Nothing of it returns to times before the end but the
/// ringing of the kink, 1/n² of the change of slope n points away.
const TAPER: usize = 64;

/// The discrete Laplace transform of one length.
pub(super) struct LaplaceLine {
    interval: f64,
    count: usize,
    damping: f64,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
}

impl LaplaceLine {
    /// For histories of `samples` at `sampling_rate_hz`, with a period of at least twice the record.
    pub(super) fn new(samples: usize, sampling_rate_hz: f64) -> Self {
        let count = (2 * (FINER * samples + TAPER)).next_power_of_two();
        let interval = 1.0 / (sampling_rate_hz * FINER as f64);
        let mut planner = RealFftPlanner::new();
        Self {
            interval,
            count,
            damping: DAMPING_OVER_PERIOD / (interval * count as f64),
            forward: planner.plan_fft_forward(count),
            inverse: planner.plan_fft_inverse(count),
        }
    }

    /// The arguments s = a + iω.
    pub(super) fn arguments(&self) -> impl Iterator<Item = Complex64> + use<> {
        let (damping, step) = (self.damping, TAU / (self.interval * self.count as f64));
        (0..=self.count / 2).map(move |k| Complex64::new(damping, step * k as f64))
    }

    /// Σ q(t_n) e^{-s t_n}, unscaled, of a history that is known over `samples` samples and then taken to zero.
    pub(super) fn transform(
        &self,
        history: &dyn VelocityHistory,
        samples: usize,
    ) -> Option<Vec<Complex64>> {
        let known = FINER * samples.saturating_sub(1) + 1;
        let last = history.at((known - 1) as f64 * self.interval);
        let mut damped = self.forward.make_input_vec();
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
        let mut lines = self.forward.make_output_vec();
        self.forward.process(&mut damped, &mut lines).ok()?;
        Some(lines)
    }

    /// Points a second of a history.
    pub(super) fn rate_hz(&self) -> f64 {
        1.0 / self.interval
    }

    /// The first `points` fine points of the history of this unscaled transform, which is overwritten.
    pub(super) fn history(&self, lines: &mut [Complex64], points: usize) -> Option<Vec<f64>> {
        // real samples show only the real parts of the first and the last line
        if let [first, .., last] = lines {
            first.im = 0.0;
            last.im = 0.0;
        }
        let mut history = self.inverse.make_output_vec();
        self.inverse.process(lines, &mut history).ok()?;
        history.truncate(points);
        let scale = 1.0 / self.count as f64;
        for (n, value) in history.iter_mut().enumerate() {
            *value *= scale * (self.damping * self.interval * n as f64).exp();
        }
        Some(history)
    }
}

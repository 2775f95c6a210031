//! Free metal rod that is struck at one end. The ringing is computed from the wave solution in the
//! Laplace domain, not from a sum of modes; the record has noise and 16-bit rounding.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

use num_complex::Complex64;
use rodwave::fourier::RealFourier;

use crate::noise::Noise;

/// Free rod with an accelerometer at the far end.
#[derive(Debug, Clone)]
pub struct RingingRod {
    /// Length \[m\].
    pub length: f64,
    pub diameter: f64,
    /// Density [kg/m³].
    pub density: f64,
    /// Magnitude of E at 5 kHz \[Pa\]. E is a power of the frequency, which corresponds to a
    /// constant loss factor.
    pub modulus: f64,
    pub loss_factor: f64,
    /// Mass of the accelerometer \[kg\].
    pub end_mass: f64,
    /// Sampling rate \[Hz\].
    pub rate: f64,
}

impl RingingRod {
    /// Creates a steel bar with a length of 600 mm and a diameter of 12 mm.
    pub fn steel(loss_factor: f64) -> Self {
        Self {
            length: 0.6,
            diameter: 0.012,
            density: 7800.0,
            modulus: 206e9,
            loss_factor,
            end_mass: 0.0,
            rate: 48e3,
        }
    }

    /// Returns the modulus E at s.
    pub fn modulus_at(&self, s: Complex64) -> Complex64 {
        self.modulus * (s / (TAU * 5e3)).powf(self.loss_factor / FRAC_PI_2)
    }

    /// Returns the exact acceleration of the far end from the start of a hit on the near end. The
    /// force of the hit is a half sine of 60 us.
    pub fn ringing(&self, n_samples: usize) -> Vec<f64> {
        const DURATION: f64 = 60e-6;
        let n = 4 * n_samples;
        let period = n as f64 / self.rate;
        let damping = 16.0 / period;
        let area = FRAC_PI_4 * self.diameter * self.diameter;
        let mut transform = RealFourier::new(n);
        for (line, value) in transform.lines().iter_mut().enumerate() {
            let s = Complex64::new(damping, TAU * line as f64 / period);
            let e = self.modulus_at(s);
            let gamma = s * (self.density / e).sqrt();
            let w = PI / DURATION;
            let force = 1e3 * w * (1.0 + (-s * DURATION).exp()) / (s * s + w * w);
            let way = gamma * self.length;
            let echo = (-2.0 * way).exp();
            let mass = self.end_mass * s * s / (area * e * gamma);
            // cosh and sinh times e^(-γL), which do not overflow
            let (cosh, sinh) = (0.5 * (1.0 + echo), 0.5 * (1.0 - echo));
            *value = s * s * force * (-way).exp() / (area * e * gamma * (sinh + mass * cosh));
            // the filter of the recorder
            *value *= (-0.5 * (s.im / (0.375 * TAU * self.rate)).powi(8)).exp();
        }
        let history = transform.inverse();
        let samples = history.iter().take(n_samples).enumerate();
        samples
            .map(|(index, x)| x / period * (damping * index as f64 / self.rate).exp())
            .collect()
    }

    /// Returns the record of the history `exact` with 16 bits, and with `noise` relative to its
    /// largest value.
    pub fn recorded(exact: &[f64], noise: f64, seed: u64) -> Vec<f64> {
        let largest = exact.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        let step = largest / 32768.0;
        let mut normal = Noise::seeded(seed);
        exact
            .iter()
            .map(|x| ((x + noise * largest * normal.normal()) / step).round() * step)
            .collect()
    }
}

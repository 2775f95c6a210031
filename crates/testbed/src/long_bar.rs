//! A shot on a long bar, computed in the order of an experiment: force of a striker, waves between
//! two free ends or between a free end and a mass, gauges with gains, filter, noise, converter.
//!
//! The one-dimensional waves are computed by damped Fourier transforms, without transition
//! matrices.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;
use rodwave::fourier::RealFourier;

use crate::noise::Noise;

/// Round bar with strain gauges, struck at x = 0, with a free end or a mass at x = `length`.
#[derive(Debug, Clone)]
pub struct LongBar {
    /// Modulus E(s) \[Pa\] in the right half plane.
    pub modulus: fn(Complex64) -> Complex64,
    /// Density [kg/m³].
    pub density: f64,
    /// Length \[m\].
    pub length: f64,
    pub diameter: f64,
    /// Mass on the end \[kg\].
    pub end_mass: f64,
    pub gauges: Vec<f64>,
    /// Rise, duration and fall \[s\] of the force, a trapezoid of 4 kN.
    pub pulse: [f64; 3],
    /// Sampling rate \[Hz\].
    pub rate: f64,
    pub n_samples: usize,
    /// Time before the impact \[s\].
    pub before: f64,
    /// Standard deviation of the noise relative to the largest strain.
    pub noise: f64,
    pub bits: i32,
}

impl LongBar {
    /// Creates a bar of a glassy polymer, 2.5 m long, with a loss factor of 0.02. A pulse of 2 ms
    /// overlaps with its reflections at gauges 0.9 and 0.5 m before the free end, and the bar still
    /// rings after 9 ms.
    pub fn glassy() -> Self {
        Self {
            modulus: |s| {
                let exponent = 2.0 / PI * 0.02_f64.atan();
                2.4e9 / (0.5 * PI * exponent).cos() * (s / (TAU * 10e3)).powf(exponent)
            },
            density: 1190.0,
            length: 2.5,
            diameter: 0.02,
            end_mass: 0.0,
            gauges: vec![1.6, 2.0],
            pulse: [60e-6, 2e-3, 120e-6],
            rate: 250e3,
            n_samples: 2250,
            before: 1e-3,
            noise: 5e-4,
            bits: 14,
        }
    }

    /// Returns the records of one shot, with one row per gauge; `gains` contains the sensitivities
    /// of the gauges.
    pub fn shot(&self, gains: &[f64], seed: u64) -> Vec<Vec<f64>> {
        // the period is so long that the wrap-around is below rounding; the damping reduces the
        // accuracy to half of the digits
        let n = 4 * self.n_samples;
        let period = n as f64 / self.rate;
        let damping = 20.0 / period;
        let time = |index: usize| index as f64 / self.rate;
        let mut transform = RealFourier::new(n);
        for (index, sample) in transform.samples().iter_mut().enumerate() {
            *sample = self.force(time(index)) * (-damping * time(index)).exp();
        }
        let force = transform.forward().to_vec();
        let area = 0.25 * PI * self.diameter * self.diameter;
        let mut noise = Noise::seeded(seed);
        let mut rows: Vec<Vec<f64>> = self
            .gauges
            .iter()
            .zip(gains)
            .map(|(x, gain)| {
                for (line, (value, force)) in transform.lines().iter_mut().zip(&force).enumerate() {
                    let s = Complex64::new(damping, TAU * line as f64 / period);
                    let modulus = (self.modulus)(s);
                    let gamma = s * (self.density / modulus).sqrt();
                    // reflection coefficient of strain at the end, with the opposite sign
                    let held = self.end_mass * s * s / (area * modulus * gamma);
                    let back = (1.0 - held) / (1.0 + held);
                    // sinh γ(L - x)/sinh γL for a free end, without terms that overflow
                    let shape = ((-gamma * x).exp()
                        - back * (-gamma * (2.0 * self.length - x)).exp())
                        / (1.0 - back * (-2.0 * gamma * self.length).exp());
                    *value = -gain * force * shape / (area * modulus) * self.filter(s);
                }
                let samples = transform.inverse().iter().take(self.n_samples).enumerate();
                samples
                    .map(|(index, x)| x / n as f64 * (damping * time(index)).exp())
                    .collect()
            })
            .collect();
        let largest = rows.iter().flatten().fold(0.0_f64, |a, x| a.max(x.abs()));
        let step = 2.0 * largest / 2.0_f64.powi(self.bits);
        for sample in rows.iter_mut().flatten() {
            let noisy = *sample + self.noise * largest * noise.normal();
            *sample = (noisy / step).round() * step;
        }
        rows
    }

    fn force(&self, time: f64) -> f64 {
        let [rise, duration, fall] = self.pulse;
        let t = time - self.before;
        4e3 * (t / rise).min((duration - t) / fall).clamp(0.0, 1.0)
    }

    /// Returns the response of a four-pole filter with its corner at a fifth of the sampling rate.
    fn filter(&self, s: Complex64) -> Complex64 {
        let corner = TAU * 0.2 * self.rate;
        [0.382_683_432_365_09, 0.923_879_532_511_29]
            .into_iter()
            .map(|damping| {
                let r = s / corner;
                (r * r + 2.0 * damping * r + 1.0).inv()
            })
            .product()
    }
}

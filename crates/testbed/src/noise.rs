//! Normally distributed errors with a known seed.

use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Number of draws of a statistical test: `usual`, or the value of the environment variable
/// `SEEDS`.
#[allow(
    clippy::expect_used,
    reason = "a test with a requested number of draws must not run with the default number"
)]
pub fn draws(usual: u64) -> u64 {
    std::env::var("SEEDS").map_or(usual, |text| {
        text.parse().expect("SEEDS is a number of draws")
    })
}

#[derive(Debug)]
pub struct Noise(pub ChaCha8Rng);

impl Noise {
    pub fn seeded(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// Returns white noise of the standard deviation `deviation`.
    pub fn white(&mut self, n_samples: usize, deviation: f64) -> Vec<f64> {
        (0..n_samples).map(|_| deviation * self.normal()).collect()
    }

    /// Returns `history` with white noise of the standard deviation `deviation`.
    pub fn added_to(&mut self, history: &[f64], deviation: f64) -> Vec<f64> {
        let noisy = history.iter().map(|v| v + deviation * self.normal());
        noisy.collect()
    }

    /// Returns a complex error z with E|z|² = `variance`, half of it in the real and half in the
    /// imaginary part.
    pub fn circular(&mut self, variance: f64) -> Complex64 {
        (0.5 * variance).sqrt() * Complex64::new(self.normal(), self.normal())
    }

    /// Returns the spectrum or ratio `clean` with noise of this `variance` on each line.
    pub fn on(&mut self, clean: &[Complex64], variance: &[f64]) -> Vec<Complex64> {
        let lines = clean.iter().zip(variance);
        lines.map(|(value, v)| value + self.circular(*v)).collect()
    }
}

//! Tracking of the wave number from line to line, for methods without a closed form.
//!
//! The tracked quantity is γ/ω, which is nearly constant over a quarter wave. Its expectation is
//! the mean of the previous lines, each weighted by its information on γ/ω. A singular line has
//! almost no weight and cannot affect the others.

use std::f64::consts::FRAC_PI_2;

use num_complex::Complex64;

use crate::branch::BranchDoubt;

/// Expected γ/ω from the lines processed so far.
pub(super) struct Expectation {
    /// Weighted mean of γ/ω [s/m].
    slowness: Complex64,
    weight: f64,
    /// Distance over which waves are counted \[m\].
    distance: f64,
    last_omega: f64,
}

impl Expectation {
    /// Creates the expectation from the slowness of the first lines; `omega` is the angular
    /// frequency of the first line.
    pub(super) fn new(slowness: Complex64, distance: f64, omega: f64) -> Self {
        Self {
            slowness,
            weight: 0.0,
            distance,
            last_omega: omega,
        }
    }

    /// Returns γ expected at `omega`, which is ω - iσ if damping was added.
    pub(super) fn gamma(&self, omega: Complex64) -> Complex64 {
        Complex64::new(self.slowness.re.max(0.0), self.slowness.im) * omega
    }

    /// Returns the distance over which waves are counted \[m\].
    pub(super) fn distance(&self) -> f64 {
        self.distance
    }

    /// Returns the expected advance of the phase over the distance since the last line.
    fn advance(&self, omega: f64) -> f64 {
        self.slowness.im * (omega - self.last_omega) * self.distance
    }

    /// Returns the doubt about the branch of `gamma`, found at `omega`.
    pub(super) fn doubt(&self, omega: Complex64, gamma: Complex64) -> Option<BranchDoubt> {
        let expected = self.gamma(omega).im * self.distance;
        let found = gamma.im * self.distance;
        BranchDoubt::of_phase(self.advance(omega.re), expected, found)
    }

    /// Adds a line with the `information` 1/var γ. The weight of a line decreases to 1/e over a
    /// quarter wave.
    pub(super) fn update(&mut self, omega: Complex64, gamma: Complex64, information: f64) {
        let kept = self.weight * (-self.advance(omega.re) / FRAC_PI_2).exp();
        let new = omega.norm_sqr() * information;
        let weight = kept + new;
        if weight > 0.0 && weight.is_finite() {
            self.slowness = (kept * self.slowness + new * (gamma / omega)) / weight;
            self.weight = weight;
            self.last_omega = omega.re;
        }
    }
}

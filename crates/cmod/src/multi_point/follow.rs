//! The wave number from line to line, where there is no closed form.
//!
//! What is followed is γ/ω, nearly constant over a quarter wave: the mean of the lines before, each weighted by its
//! information on γ/ω. A singular line has almost none and cannot lead the others astray.

use std::f64::consts::{FRAC_PI_2, PI};

use num_complex::Complex64;

use crate::branch::BranchDoubt;

/// What the lines so far lead to expect.
pub(super) struct Expectation {
    /// Weighted mean of γ/ω [s/m].
    slowness: Complex64,
    weight: f64,
    /// Distance by which waves are counted \[m\].
    distance: f64,
    last_omega: f64,
}

impl Expectation {
    /// From the slowness of the first lines, before `omega` of the first.
    pub(super) fn new(slowness: Complex64, distance: f64, omega: f64) -> Self {
        Self {
            slowness,
            weight: 0.0,
            distance,
            last_omega: omega,
        }
    }

    /// γ expected at `omega`, which is ω - iσ where damping was added.
    pub(super) fn gamma(&self, omega: Complex64) -> Complex64 {
        Complex64::new(self.slowness.re.max(0.0), self.slowness.im) * omega
    }

    /// Expected advance of the phase over the distance since the last line.
    fn advance(&self, omega: f64) -> f64 {
        self.slowness.im * (omega - self.last_omega) * self.distance
    }

    /// What speaks against `gamma`, found at ω.
    pub(super) fn doubt(&self, omega: Complex64, gamma: Complex64) -> Option<BranchDoubt> {
        let advance = self.advance(omega.re);
        let expected = self.gamma(omega).im * self.distance;
        let found = gamma.im * self.distance;
        if advance > PI {
            Some(BranchDoubt::Gap { advance })
        } else if (found - expected).abs() > FRAC_PI_2 {
            Some(BranchDoubt::Leap { expected, found })
        } else {
            None
        }
    }

    /// One more line, with the `information` 1/var γ. The weight of a line fades to 1/e over a quarter wave.
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

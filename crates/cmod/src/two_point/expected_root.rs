//! What the lines before lead to expect of γL, for lines where two roots come near to each other.
//!
//! Continuation in the mass ratio is sure as long as its path keeps off double roots. Near kL = nπ of a specimen without end
//! mass noise can turn the path around one, and its end is then the root that mirrors the right one. Both are exact roots; only
//! the neighbouring lines tell which one belongs to the material.

use std::f64::consts::FRAC_PI_2;

use num_complex::Complex64;

use super::end_mass::{EndMassEquation, EndMassRoot};

/// The other root must be nearer than this part of the distance of the first one from what is expected: what is expected is
/// not exact.
const CLEARLY_NEARER: f64 = 0.5;

/// Weighted mean of γL/f over the lines before. The weight of a line is what its Ψ tells of γL/f, and fades to 1/e over a quarter
/// wave.
#[derive(Default)]
pub(super) struct ExpectedRoot {
    slowness: Complex64,
    weight: f64,
    last_hz: f64,
}

impl ExpectedRoot {
    /// `found`, or where its path came near to a double root and the root next to what is expected is clearly nearer, that.
    pub(super) fn choose(
        &self,
        equation: &EndMassEquation,
        found: EndMassRoot,
        frequency_hz: f64,
    ) -> EndMassRoot {
        if found.steps < 2 || self.weight == 0.0 {
            return found;
        }
        let expected = self.slowness * frequency_hz;
        let other = equation.newton(expected);
        let distance = |root: &EndMassRoot| (root.gamma_length - expected).norm();
        if other.termination.was_successful()
            && distance(&other) < CLEARLY_NEARER * distance(&found)
        {
            EndMassRoot {
                steps: found.steps,
                ..other
            }
        } else {
            found
        }
    }

    /// One more line.
    pub(super) fn update(&mut self, equation: &EndMassEquation, root: &EndMassRoot, hz: f64) {
        if !root.gamma_length.is_finite() {
            return;
        }
        let slope = equation.derivative(root.gamma_length).norm_sqr();
        let information = hz * hz * slope / (1.0 + equation.acceleration_ratio.norm_sqr());
        let advance = self.slowness.im * (hz - self.last_hz);
        let kept = self.weight * (-advance / FRAC_PI_2).exp();
        let weight = kept + information;
        if weight > 0.0 && weight.is_finite() {
            self.slowness = (kept * self.slowness + information * root.gamma_length / hz) / weight;
            self.weight = weight;
            self.last_hz = hz;
        }
    }
}

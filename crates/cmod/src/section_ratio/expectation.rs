//! What the lines so far lead to expect of the next one.

use std::f64::consts::{FRAC_PI_2, PI};

use num_complex::Complex64;

use crate::branch::BranchDoubt;

/// Over this advance of the phase a line loses 1/e of its weight.
const MEMORY: f64 = PI;

/// Standard deviation of d ln(γ/ω)/d ln ω over materials: dispersion goes with the loss, and is 0.03 for a loss factor of 0.1.
const DISPERSION: f64 = 0.05;

/// A straight line through γ/ω over ln ω, each of the lines before with the weight of its γ/ω, fading with the phase.
///
/// Lines near singular ones have almost no weight. The slope is held near 0 by what is known of dispersion, so that few and
/// noisy lines do not make one.
pub(super) struct Expectation {
    /// γ/ω from the start [s/m], until there are lines.
    start: Complex64,
    /// Distance by which waves are counted \[m\].
    distance: f64,
    /// Delay that is known, over which no wave needs to be counted [s].
    delay: f64,
    last_omega: f64,
    /// Weighted means of ln ω and γ/ω, and the sums about them.
    weight: f64,
    abscissa: f64,
    slowness: Complex64,
    spread: f64,
    product: Complex64,
}

impl Expectation {
    pub(super) fn new(slowness: Complex64, distance: f64, omega: f64) -> Self {
        Self {
            start: slowness,
            distance,
            delay: 0.0,
            last_omega: omega,
            weight: 0.0,
            abscissa: omega.ln(),
            slowness,
            spread: 0.0,
            product: Complex64::ZERO,
        }
    }

    /// The same with what is known of the delay of the later pulse, if anything.
    pub(super) fn with_delay(self, delay: Option<f64>) -> Self {
        Self {
            delay: delay.unwrap_or(0.0),
            ..self
        }
    }

    /// γ expected at ω.
    pub(super) fn gamma(&self, omega: f64) -> Complex64 {
        let prior = (DISPERSION * self.start.norm()).powi(-2);
        let slope = self.product / (self.spread + prior);
        let slowness = self.slowness + slope * (omega.ln() - self.abscissa);
        Complex64::new(slowness.re.max(0.0), slowness.im) * omega
    }

    /// Expected advance of the phase from the last line.
    fn advance(&self, omega: f64) -> f64 {
        self.slowness.im * (omega - self.last_omega) * self.distance
    }

    /// The part of it that is not that of the known delay, either sign.
    fn unknown_advance(&self, omega: f64) -> f64 {
        (self.advance(omega) - self.delay * (omega - self.last_omega)).abs()
    }

    /// What speaks against `gamma`, found at ω.
    pub(super) fn doubt(&self, omega: f64, gamma: Complex64) -> Option<BranchDoubt> {
        let advance = self.unknown_advance(omega);
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

    /// One more line, with the `information` 1/var γ.
    pub(super) fn update(&mut self, omega: f64, gamma: Complex64, information: f64) {
        let fading = (-self.advance(omega).max(0.0) / MEMORY).exp();
        let kept = self.weight * fading;
        let new = omega * omega * information;
        let weight = kept + new;
        if !(weight > 0.0 && weight.is_finite()) {
            return;
        }
        let share = new / weight;
        let (x, y) = (omega.ln() - self.abscissa, gamma / omega - self.slowness);
        self.abscissa += share * x;
        self.slowness += share * y;
        self.spread = fading * self.spread + kept * share * x * x;
        self.product = fading * self.product + kept * share * x * y;
        self.weight = weight;
        self.last_omega = omega;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A power law is a straight line but for its curvature, and bad lines of no weight do not move it.
    #[test]
    fn dispersion_is_followed() {
        let law = |omega: f64| Complex64::new(0.02, 1.0) * 9e-4 * omega.powf(0.97);
        let mut expectation = Expectation::new(law(100.0) / 100.0, 0.5, 100.0);
        for j in 1..400 {
            let omega = 100.0 * f64::from(j);
            if j > 20 {
                let error = (expectation.gamma(omega) - law(omega)).norm() * 0.5;
                // Curvature: half of 0.03² kd Δ(ln ω)², Δ(ln ω) = π/kd, and what the prior takes off the slope.
                assert!(error < 0.02, "{omega}: {error}");
            }
            let information = if j % 7 == 0 { 0.0 } else { 1e6 };
            let gamma = if j % 7 == 0 {
                2.0 * law(omega)
            } else {
                law(omega)
            };
            expectation.update(omega, gamma, information);
        }
    }
}

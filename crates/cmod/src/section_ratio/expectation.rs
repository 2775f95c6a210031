//! Expectation of the next line from the lines processed so far.

use std::f64::consts::PI;

use num_complex::Complex64;

use crate::branch::BranchDoubt;

/// Advance of the phase over which the weight of a line decreases to 1/e.
const MEMORY: f64 = PI;

/// Standard deviation of d ln(γ/ω)/d ln ω among materials: dispersion is coupled to the loss, and
/// is 0.03 for a loss factor of 0.1.
const DISPERSION: f64 = 0.05;

/// Linear regression of γ/ω on ln ω. Previous lines are weighted with their information on γ/ω;
/// this weight decreases as the phase advances.
///
/// Lines near singular lines have almost no weight. A prior on the dispersion keeps the slope near
/// 0 if there are few lines or much noise.
pub(super) struct Expectation {
    /// Initial γ/ω [s/m], which is used until there are lines.
    start: Complex64,
    /// Distance over which waves are counted \[m\].
    distance: f64,
    /// Known delay [s], in which no waves need to be counted.
    delay: f64,
    last_omega: f64,
    /// Sum of the weights, weighted means of ln ω and γ/ω, and weighted sums of squares and
    /// products about these means.
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

    /// Sets the known delay of the later pulse, if there is one.
    pub(super) fn with_delay(self, delay: Option<f64>) -> Self {
        Self {
            delay: delay.unwrap_or(0.0),
            ..self
        }
    }

    /// Returns the γ expected at `omega`.
    pub(super) fn gamma(&self, omega: f64) -> Complex64 {
        let prior = (DISPERSION * self.start.norm()).powi(-2);
        let slope = self.product / (self.spread + prior);
        let slowness = self.slowness + slope * (omega.ln() - self.abscissa);
        Complex64::new(slowness.re.max(0.0), slowness.im) * omega
    }

    /// Returns the expected advance of the phase from the last line.
    fn advance(&self, omega: f64) -> f64 {
        self.slowness.im * (omega - self.last_omega) * self.distance
    }

    /// Returns the absolute value of the part of the advance that is not due to the known delay.
    fn unknown_advance(&self, omega: f64) -> f64 {
        (self.advance(omega) - self.delay * (omega - self.last_omega)).abs()
    }

    /// Returns the doubt about `gamma`, found at `omega`.
    pub(super) fn doubt(&self, omega: f64, gamma: Complex64) -> Option<BranchDoubt> {
        let expected = self.gamma(omega).im * self.distance;
        let found = gamma.im * self.distance;
        BranchDoubt::of_phase(self.unknown_advance(omega), expected, found)
    }

    /// Adds a line, with the `information` 1/var γ.
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

    /// The regression follows lines on a power law, with an error due to the curvature of the law.
    /// Outliers without weight do not change the regression.
    #[test]
    fn dispersion_is_followed() {
        let law = |omega: f64| Complex64::new(0.02, 1.0) * 9e-4 * omega.powf(0.97);
        let mut expectation = Expectation::new(law(100.0) / 100.0, 0.5, 100.0);
        for j in 1..400 {
            let omega = 100.0 * f64::from(j);
            if j > 20 {
                let error = (expectation.gamma(omega) - law(omega)).norm() * 0.5;
                // The error is due to the curvature, half of 0.03² kd Δ(ln ω)² with Δ(ln ω) = π/kd,
                // and to the reduction of the slope by the prior.
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

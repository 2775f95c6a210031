//! The force in a stated band of frequencies.
//!
//! Theory: `docs/theory/stick-force.md#band-limited-force`.

use std::f64::consts::{LN_2, PI};

use statrs::function::erf::erfc;

use crate::error::check_positive;
use crate::{ForceHistory, ForcePeak, ImpulseError};

/// Half-width of the Gaussian in standard deviations: $`3\cdot10^{-7}`$ of its area is beyond each
/// end.
const REACH: f64 = 5.0;

/// Fewest steps within $`1/f_b`$: with fewer, the force of a step does not represent the band.
const FEWEST_STEPS: f64 = 8.0;

/// Steps within $`1/f_b`$ for which the effect of the step length is below $`10^{-3}`$ of a jump.
const STEPS: f64 = 32.0;

/// A zero-phase Gaussian low-pass filter of unit gain at 0 Hz and $`-3`$ dB at the upper end
/// $`f_b`$ of the band,
///
/// ```math
/// \hat F_b = \hat F\,e^{-\sigma^2\omega^2/2}, \qquad \sigma = \frac{\sqrt{\ln 2}}{2\pi f_b} = \frac{0.1325}{f_b} .
/// ```
///
/// Its impulse response is positive: a compressive force stays compressive, jumps do not overshoot,
/// and the impulse is conserved. A jump rises from 10 % to 90 % within $`0.34/f_b`$.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandLimit {
    upper_hz: f64,
}

impl BandLimit {
    /// The band of paper E: "Frequencies up to 10 kHz were used" (Ödeen 1993, paper E, section
    /// 3.2).
    pub const PAPER_E: Self = Self { upper_hz: 10e3 };

    /// Creates a band up to `upper_hz` \[Hz\], where the gain is $`1/\sqrt2`$.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] unless it is finite and above 0.
    pub fn up_to(upper_hz: f64) -> Result<Self, ImpulseError> {
        Ok(Self {
            upper_hz: check_positive("upper end of the band [Hz]", upper_hz)?,
        })
    }

    /// Creates the default band of a force between bodies that are measured up to `highest_hz`
    /// \[Hz\] (infinite for computed bodies): the band of paper E or, if it is narrower, a band up
    /// to half of `highest_hz`. At `highest_hz` the gain of the latter is a quarter.
    ///
    /// # Errors
    ///
    /// The errors of [`BandLimit::up_to`].
    pub fn by_default(highest_hz: f64) -> Result<Self, ImpulseError> {
        Self::up_to(Self::PAPER_E.upper_hz.min(0.5 * highest_hz))
    }

    /// Upper end of the band \[Hz\].
    #[must_use]
    pub fn upper_hz(self) -> f64 {
        self.upper_hz
    }

    /// Standard deviation $`\sigma`$ of the Gaussian \[s\].
    #[must_use]
    pub fn standard_deviation(self) -> f64 {
        LN_2.sqrt() / (2.0 * PI * self.upper_hz)
    }

    /// Time step \[s\] that resolves the band: $`1/(32f_b)`$, for which the force in the band
    /// depends on the step by less than a thousandth of a jump.
    #[must_use]
    pub fn time_step(self) -> f64 {
        1.0 / (STEPS * self.upper_hz)
    }

    /// Returns the force in the band, at the times of `history` and $`5\sigma`$ before and after
    /// it. The force is assumed constant in each step about its time and zero outside the history;
    /// the integral over each step is exact.
    ///
    /// # Validity
    ///
    /// If a force lasts to the end of its history, the force in the band decays to zero within
    /// $`5\sigma`$ of that end: [`Prediction::band_limited`](crate::Prediction::band_limited) omits
    /// this part.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] if the step is longer than $`1/(8f_b)`$.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a positive number, which is small for any history that fits in memory"
    )]
    pub fn apply(self, history: &ForceHistory) -> Result<ForceHistory, ImpulseError> {
        let step = history.time_step();
        if step * self.upper_hz * FEWEST_STEPS > 1.0 + 1e-9 {
            return Err(ImpulseError::NonPhysical {
                quantity: "product of the time step of a force in a band and the upper end of the band",
                value: step * self.upper_hz,
                expected: "at most 1/8: use a shorter step or a lower band",
            });
        }
        let deviation = self.standard_deviation();
        let reach = (REACH * deviation / step).ceil() as usize;
        // part of the area of the Gaussian above the edge of a step
        let above = |edge: f64| 0.5 * erfc(edge * step / deviation / std::f64::consts::SQRT_2);
        let mut weights: Vec<f64> = (0..=2 * reach)
            .map(|index| {
                let at = index as f64 - reach as f64;
                above(at - 0.5) - above(at + 0.5)
            })
            .collect();
        // renormalised for the part beyond the reach: the impulse is conserved
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= sum);
        let force = history.force();
        let mut limited = vec![0.0; force.len() + 2 * reach];
        for (index, value) in force.iter().enumerate().filter(|(_, f)| **f != 0.0) {
            let about = limited.iter_mut().skip(index);
            for (sample, weight) in about.zip(&weights) {
                *sample += weight * value;
            }
        }
        ForceHistory::new(history.time_at(0) - reach as f64 * step, step, limited)
    }
}

impl ForceHistory {
    /// Returns the largest force between samples, by the parabola through the largest sample and
    /// its neighbours.
    ///
    /// # Validity
    ///
    /// Valid for a force that is smooth over three samples, such as a force in a band.
    #[must_use]
    pub fn smooth_peak(&self) -> ForcePeak {
        let force = self.force();
        let mut peak = self.peak();
        let around = force
            .windows(3)
            .enumerate()
            .filter_map(|(index, window)| match window {
                [before, here, after] if before <= here && after <= here => {
                    Some((index + 1, *before, *here, *after))
                }
                _ => None,
            })
            .find(|(_, _, here, _)| *here >= peak.force);
        if let Some((index, before, here, after)) = around {
            let bend = before - 2.0 * here + after;
            if bend < 0.0 {
                let away = 0.5 * (before - after) / bend;
                peak.time = self.time_at(index) + away * self.time_step();
                peak.force = here - 0.25 * (before - after) * away;
            }
        }
        peak
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::distribution::{ContinuousCDF, Normal};

    fn exponential(step: f64) -> ForceHistory {
        // means over the steps of exp(-t/T), T = 0.5 ms, like the force of time marching
        let rate = 1.0 / 0.5e-3;
        #[allow(clippy::cast_possible_truncation, reason = "thousands of steps")]
        let n = (4e-3 / step).round() as i32;
        let mean = |k: i32| {
            let (a, b) = (f64::from(k) * step, f64::from(k + 1) * step);
            ((-rate * a).exp() - (-rate * b).exp()) / (rate * step)
        };
        ForceHistory::new(0.5 * step, step, (0..n).map(mean).collect()).unwrap()
    }

    /// ∫ exp(-t'/T) H(t') N(t - t'; σ) dt' = exp(σ²/2T² - t/T) Φ(t/σ - σ/T).
    fn exact(time: f64, deviation: f64) -> f64 {
        let rate = 1.0 / 0.5e-3;
        let reduced = deviation * rate;
        (0.5 * reduced * reduced - rate * time).exp()
            * Normal::standard().cdf(time / deviation - reduced)
    }

    #[test]
    fn r07_a_jump_in_the_band_is_that_of_the_closed_form_at_any_step() {
        let band = BandLimit::PAPER_E;
        let deviation = band.standard_deviation();
        for (step, tolerance) in [(3e-6, 3e-3), (1e-6, 4e-4), (0.25e-6, 3e-5)] {
            let limited = band.apply(&exponential(step)).unwrap();
            for (index, force) in limited.force().iter().enumerate() {
                let time = limited.time_at(index);
                // the force ends with its history: a jump of e^-8
                if time < 3.8e-3 {
                    let away = (force - exact(time, deviation)).abs();
                    // a constant step adds its variance h²/12 to σ²: (h/σ)²/24 of the jump near it
                    assert!(away < tolerance, "{step} {time}: {away}");
                }
            }
            let kept = limited.impulse() / exponential(step).impulse();
            assert!((kept - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn r07_the_gain_is_3_db_down_at_the_end_of_the_band() {
        let band = BandLimit::up_to(4e3).unwrap();
        let step = 1e-6;
        let sine: Vec<f64> = (0..8000)
            .map(|n| (2.0 * PI * 4e3 * f64::from(n) * step).sin())
            .collect();
        let limited = band
            .apply(&ForceHistory::new(0.0, step, sine).unwrap())
            .unwrap();
        let middle = limited.force().iter().skip(3000).take(2000);
        let largest = middle.fold(0.0_f64, |top, f| top.max(*f));
        // error due to the steps: (h ω)²/24 = 2.6e-5
        assert!((largest - 0.5_f64.sqrt()).abs() < 1e-4, "{largest}");
        let long = ForceHistory::new(0.0, 40e-6, vec![1.0; 20]).unwrap();
        assert!(band.apply(&long).is_err());
        assert!(BandLimit::up_to(f64::NAN).is_err());
    }

    #[test]
    fn a_peak_between_samples_is_found() {
        let parabola: Vec<f64> = (0..9).map(|n| 5.0 - (f64::from(n) - 4.3).powi(2)).collect();
        let peak = ForceHistory::new(0.0, 0.5, parabola).unwrap().smooth_peak();
        assert!((peak.force - 5.0).abs() < 1e-12 && (peak.time - 2.15).abs() < 1e-12);
        // at the end of a history there is no parabola
        let rising = ForceHistory::new(0.0, 0.5, vec![1.0, 2.0, 4.0]).unwrap();
        assert!((rising.smooth_peak().force - 4.0).abs() < f64::EPSILON);
    }
}

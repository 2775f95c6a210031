//! Damped Fourier transform: numerical inversion of the Laplace transform.

use num_complex::Complex64;

use super::{SynthesizedHistory, check_lines, check_synthesized, to_samples};
use crate::RodwaveError;
use crate::error::{check_positive, check_that};

/// Product aT_p: the alias of the next period is e^{-16} = 1.1e-7, and a rounding error of 1e-16
/// grows to e^{16} 1e-16 = 1e-9.
const DAMPING_OVER_PERIOD: f64 = 16.0;

/// Time from the start of a smoothed history to time 0, in standard deviations of the smoothing: at
/// the start, a smoothed jump at time 0 has reached only about e^{-8²/2} = 1e-14 of its height.
const DELAY: f64 = 8.0;

/// Largest number of samples of a period.
const LARGEST_COUNT: f64 = 67_108_864.0; // 2^26

/// Histories from transforms on a line Re s = a.
///
/// ```text
/// q(t_n) = e^{a t_n}/T_p Σ_k Q(s_k) e^{iω_k t_n} ,   s_k = a + iω_k ,   ω_k = 2πk/T_p ,   |k| <= N/2
/// ```
///
/// The period T_p is at least twice the duration T, and aT_p = 16.
///
/// # Validity
/// q must be causal, and Q analytic for Re s > 0. The value at t contains e^{-16} = 1.1e-7 of the
/// value at t + T_p, and a rounding error of up to 1e-9 of the largest value. Transforms that decay
/// as 1/s belong to histories that begin with a jump or contain one. Without smoothing, the jump
/// rings, with an amplitude of 1/(πn) of the jump at n samples from it. A Gaussian smoothing of
/// standard deviation σ removes the ringing and spreads the jump over ±6σ; elsewhere, a piecewise
/// constant or linear history is unchanged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DampedSynthesis {
    interval: f64,
    /// Half the number of samples of a period; one more sample is kept.
    half_count: usize,
    smoothing: f64,
    is_flat: bool,
}

/// Number of terms of the series for the flat smoothing.
const FLAT: usize = 4;

impl DampedSynthesis {
    /// Creates a synthesis of histories from 0 to `duration` T \[s\] in steps of `interval` \[s\];
    /// the duration is rounded up to a whole number of steps.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless both are finite and above 0 and the number of steps is
    /// at most 2²⁵.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "checked to be between 1 and 2^25"
    )]
    pub fn new(duration: f64, interval: f64) -> Result<Self, RodwaveError> {
        check_positive("duration [s]", duration)?;
        let interval = check_positive("interval between samples [s]", interval)?;
        let steps = (duration / interval).ceil();
        check_that(
            (1.0..=LARGEST_COUNT / 2.0).contains(&steps),
            "number of intervals",
            steps,
            "between 1 and 2^25",
        )?;
        let synthesis = Self {
            interval,
            half_count: steps as usize,
            smoothing: 0.0,
            is_flat: false,
        };
        check_positive("damping of the transform [1/s]", synthesis.damping())?;
        check_positive(
            "greatest angular frequency of the transform [rad/s]",
            std::f64::consts::PI / interval,
        )?;
        Ok(synthesis)
    }

    /// Convolves the history with a Gaussian of this `standard_deviation` σ \[s\]; the history then
    /// begins at -8σ and includes the rise of a jump at time 0.
    ///
    /// With a σ of 2.5 intervals, the factor of the Gaussian is 4e-14 at the Nyquist frequency; a
    /// smaller σ leaves some ringing.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless σ is finite and above 0 and 8σ is less than the
    /// duration.
    pub fn smoothed(self, standard_deviation: f64) -> Result<Self, RodwaveError> {
        let smoothing = check_positive(
            "standard deviation of the smoothing [s]",
            standard_deviation,
        )?;
        check_positive(
            "duration less 8 standard deviations of the smoothing [s]",
            self.half_count as f64 * self.interval - DELAY * smoothing,
        )?;
        Ok(Self { smoothing, ..self })
    }

    /// Makes the smoothing flat: lines are multiplied by $`e^{-z}\sum_{k=0}^{4} z^k/k!`$, $`z =
    /// \omega^2\sigma^2/2`$, instead of $`e^{-z}`$ alone.
    ///
    /// Below $`\omega\sigma = 0.6`$, the history is unsmoothed within $`z^5/120`$ = 2e-6, whereas
    /// the Gaussian alone reduces it by 17 %. With a σ of 2.5 intervals, the factor is 2e-9 at the
    /// Nyquist frequency.
    #[must_use]
    pub fn flat(self) -> Self {
        Self {
            is_flat: true,
            ..self
        }
    }

    /// Real part a [1/s] of the arguments.
    #[must_use]
    pub fn damping(&self) -> f64 {
        DAMPING_OVER_PERIOD / self.period()
    }

    /// Arguments s [1/s] at which the transform is needed: first a, then along the line to the
    /// Nyquist frequency.
    #[must_use]
    pub fn arguments(&self) -> impl ExactSizeIterator<Item = Complex64> + use<> {
        let (damping, step) = (self.damping(), std::f64::consts::TAU / self.period());
        (0..self.half_count + 1).map(move |k| Complex64::new(damping, step * k as f64))
    }

    /// Returns the history of a `transform` Q(s) \[q s\] at the [arguments](Self::arguments).
    ///
    /// # Errors
    /// [`RodwaveError::LengthMismatch`] if the number of values is not that of the arguments;
    /// [`RodwaveError::NonFiniteSample`] for a value of the transform that is not finite.
    pub fn history(&self, transform: &[Complex64]) -> Result<SynthesizedHistory, RodwaveError> {
        check_lines("transform", transform, self.half_count + 1)?;
        let start = -DELAY * self.smoothing;
        let lines: Vec<Complex64> = transform
            .iter()
            .zip(self.arguments())
            .map(|(value, s)| {
                let gaussian = 0.5 * (s * self.smoothing).powu(2);
                let flat = if self.is_flat { FLAT } else { 0 };
                // Horner's scheme of the series of e^{-gaussian}
                let series = (1..=flat).rev().fold(Complex64::ONE, |sum, k| {
                    Complex64::ONE - gaussian / k as f64 * sum
                });
                value * (s * start + gaussian).exp() * series
            })
            .collect();
        let mut samples = to_samples(&lines);
        samples.truncate(self.half_count + 1);
        let (damping, scale) = (self.damping(), 1.0 / self.period());
        for (index, sample) in samples.iter_mut().enumerate() {
            *sample *= scale * (damping * self.interval * index as f64).exp();
        }
        check_synthesized(&samples)?;
        Ok(SynthesizedHistory {
            start,
            interval: self.interval,
            samples,
        })
    }

    /// Period T_p \[s\].
    fn period(&self) -> f64 {
        2.0 * self.half_count as f64 * self.interval
    }
}

//! Discrete Fourier transform, with its scaling.

use num_complex::Complex64;

use super::{SynthesizedHistory, check_lines, check_synthesized, to_samples};
use crate::RodwaveError;
use crate::error::{check_enough_samples, check_positive, check_that};

/// Largest number of lines of a spectrum, which takes some gigabytes with its history.
const MOST_LINES: usize = 1 << 27;

/// Histories from one-sided spectra.
///
/// ```text
/// q(t_n) = Δf Σ_k q̂(2πkΔf) e^{2πikn/N} ,   |k| <= N/2 ,   N = 2 (n_lines - 1) ,   t_n = n/(NΔf)
/// ```
///
/// # Validity
/// The history has the period 1/Δf: q must decay within it, otherwise the result is the sum of all
/// repetitions. The method cannot be used if there is a pole on the frequency axis, such as that of
/// an elastic body with free or fixed ends. Content above the last line is missing; a jump
/// therefore rings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FourierSynthesis {
    frequency_step_hz: f64,
    n_lines: usize,
}

impl FourierSynthesis {
    /// Creates a synthesis for spectra of `n_lines` lines from 0 Hz, spaced by `frequency_step_hz`
    /// Δf.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the step is finite and above 0;
    /// [`RodwaveError::TooFewSamples`] for fewer than two lines.
    pub fn new(frequency_step_hz: f64, n_lines: usize) -> Result<Self, RodwaveError> {
        check_enough_samples("the spectrum", n_lines, 2)?;
        check_that(
            n_lines <= MOST_LINES,
            "number of lines",
            n_lines as f64,
            "at most 2^27",
        )?;
        check_positive("frequency step [Hz]", frequency_step_hz)?;
        let highest = frequency_step_hz * n_lines as f64;
        check_positive(
            "greatest angular frequency of the spectrum [rad/s]",
            std::f64::consts::TAU * highest,
        )?;
        check_positive("interval between samples [s]", 0.5 / highest)?;
        Ok(Self {
            frequency_step_hz,
            n_lines,
        })
    }

    /// Frequencies ω [rad/s] at which the spectrum is needed, from 0.
    #[must_use]
    pub fn omegas(&self) -> impl ExactSizeIterator<Item = f64> + use<> {
        let step = std::f64::consts::TAU * self.frequency_step_hz;
        (0..self.n_lines).map(move |k| step * k as f64)
    }

    /// Returns the history of a `spectrum` q̂ \[q s\], one-sided and not doubled.
    ///
    /// # Errors
    /// [`RodwaveError::LengthMismatch`] if the number of lines differs;
    /// [`RodwaveError::NonFiniteSample`] for a line that is not finite, for example at a pole.
    pub fn history(&self, spectrum: &[Complex64]) -> Result<SynthesizedHistory, RodwaveError> {
        check_lines("spectrum", spectrum, self.n_lines)?;
        let mut samples = to_samples(spectrum);
        for sample in &mut samples {
            *sample *= self.frequency_step_hz;
        }
        check_synthesized(&samples)?;
        Ok(SynthesizedHistory {
            start: 0.0,
            interval: 1.0 / (self.frequency_step_hz * samples.len() as f64),
            samples,
        })
    }
}

//! What the estimators of a frequency response are off by in the mean.

use super::{Estimator, FrequencyResponse};

/// Relative systematic errors of |H| on one line. All are about the magnitude: noise that is uncorrelated with everything leaves the
/// phase unbiased.
///
/// From one coherence it cannot be told which channel the noise is on. `input_noise` and `output_noise` are therefore
/// alternatives: what the estimator is off by *if all* of the missing coherence were noise on that channel.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Bias {
    /// $`+\varepsilon^2/2`$: the modulus of a number with random error $`\varepsilon`$ in both components is too large in the mean.
    pub scatter: f64,
    /// $`\gamma^2-1`$ for H1, 0 for H2, $`\gamma-1`$ for Hv.
    pub input_noise: f64,
    /// 0 for H1, $`1/\gamma^2-1`$ for H2, $`1/\gamma-1`$ for Hv.
    pub output_noise: f64,
}

impl FrequencyResponse {
    /// The bias of every line, NaN on invalid ones; none where there is no coherence.
    ///
    /// # Validity
    ///
    /// To first order in the random error. Leakage, a window that is too short for a delay, and resonances narrower than the noise
    /// bandwidth bias a response as well; of these the lines know nothing.
    #[must_use]
    pub fn bias(&self) -> Option<Vec<Bias>> {
        let coherences = self.coherence.as_ref()?;
        let line = |coherence: &f64| {
            let root = coherence.sqrt();
            let (input_noise, output_noise) = match self.estimator {
                Estimator::H1 => (coherence - 1.0, 0.0 * coherence),
                Estimator::H2 => (0.0 * coherence, 1.0 / coherence - 1.0),
                Estimator::Hv => (root - 1.0, 1.0 / root - 1.0),
            };
            Bias {
                scatter: (1.0 - coherence) / (4.0 * self.effective_averages * coherence),
                input_noise,
                output_noise,
            }
        };
        Some(coherences.iter().map(line).collect())
    }
}

//! Bias of the estimators of a frequency response.

use super::{Estimator, FrequencyResponse};
use crate::{AveragedSpectra, LabioError};

/// Relative systematic errors of |H| on one line. All of them concern the magnitude: noise that is
/// uncorrelated with the signals and with other noise does not bias the phase.
///
/// A coherence does not show which channel has the noise. `input_noise` and `output_noise` are
/// therefore alternatives: the bias of the estimator *if all* of the missing coherence were caused
/// by noise on that channel.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Bias {
    /// $`+\varepsilon^2/2`$: the modulus of a number with random error $`\varepsilon`$ in both
    /// components is too large on average.
    pub scatter: f64,
    /// $`\gamma^2-1`$ for H1, 0 for H2, $`\gamma-1`$ for Hv, 0 for Hs.
    pub input_noise: f64,
    /// 0 for H1, $`1/\gamma^2-1`$ for H2, $`1/\gamma-1`$ for Hv, 0 for Hs.
    pub output_noise: f64,
}

impl FrequencyResponse {
    /// Returns the bias of every line, NaN on invalid lines; `None` without coherence.
    ///
    /// # Validity
    ///
    /// To first order in the random error. Leakage, a window that is too short for a delay, and
    /// resonances narrower than the noise bandwidth bias a response as well; these are not
    /// included.
    #[must_use]
    pub fn bias(&self) -> Option<Vec<Bias>> {
        let coherences = self.coherence.as_ref()?;
        let line = |coherence: &f64| Bias::of(self.estimator, *coherence, self.effective_averages);
        Some(coherences.iter().map(line).collect())
    }

    /// Returns the possible bias that follows from the coherence: negative for H1, positive for H2
    /// and Hv.
    pub(super) fn bias_by_coherence(&self) -> Option<Vec<f64>> {
        let coherences = self
            .coherence
            .as_ref()
            .filter(|_| self.noise_bias.is_none())?;
        let of = |coherence: &f64| {
            let bias = Bias::of(self.estimator, *coherence, self.effective_averages);
            if bias.output_noise.abs() < bias.input_noise.abs() {
                bias.input_noise
            } else {
                bias.output_noise
            }
        };
        Some(coherences.iter().map(of).collect())
    }
}

impl Bias {
    pub(crate) fn of(estimator: Estimator, coherence: f64, effective_averages: f64) -> Self {
        let root = coherence.sqrt();
        let (input_noise, output_noise) = match estimator {
            Estimator::H1 => (coherence - 1.0, 0.0 * coherence),
            Estimator::H2 => (0.0 * coherence, 1.0 / coherence - 1.0),
            Estimator::Hv => (root - 1.0, 1.0 / root - 1.0),
            Estimator::Hs => (0.0 * coherence, 0.0 * coherence),
        };
        Self {
            scatter: (1.0 - coherence) / (4.0 * (effective_averages - 1.0) * coherence),
            input_noise,
            output_noise,
        }
    }
}

#[allow(
    clippy::indexing_slicing,
    reason = "the response was computed from these spectra and has the same lines, and so has the noise of a channel"
)]
impl AveragedSpectra {
    /// Sets the bias of a response that is caused by the noise of its channels at rest, and removes
    /// that bias for [`Estimator::Hs`].
    pub(super) fn consider_rest_noise(
        &self,
        response: &mut FrequencyResponse,
    ) -> Result<(), LabioError> {
        let (input, output) = (response.input.name(), response.output.name());
        let part = |channel: &str| -> Result<Option<Vec<f64>>, LabioError> {
            let levels = self.auto_lines(channel)?;
            let noise = self.rest_energy(channel)?;
            Ok(noise.map(|noise| noise.iter().zip(levels).map(|(n, g)| n / g).collect()))
        };
        let (on_input, on_output) = (part(input)?, part(output)?);
        let n_lines = response.values.len();
        let zero = || vec![0.0; n_lines];
        let (on_input, on_output) = match (response.estimator, on_input, on_output) {
            (Estimator::Hs, Some(on_input), Some(on_output)) => {
                let coherence = self.pair(input, output)?.coherences();
                for (line, c) in coherence.iter().enumerate() {
                    let (a, b) = (on_input[line], on_output[line]);
                    let root = ((b - a).powi(2) + 4.0 * a * b * c).sqrt();
                    // two forms of the same number, of which the one without a difference of nearly
                    // equal terms is used
                    let factor = match (a > 0.0 || b > 0.0, b >= a) {
                        (false, _) => 1.0,
                        (true, true) => 2.0 * b / (root + b - a),
                        (true, false) => (root - b + a) / (2.0 * a * c),
                    };
                    response.values[line] *= factor;
                    if let Some(variance) = &mut response.variance {
                        variance[line] *= factor * factor;
                    }
                }
                (Some(zero()), Some(zero()))
            }
            (Estimator::Hs, known, _) => {
                let channel = if known.is_none() { input } else { output };
                return Err(LabioError::UnknownRestNoise {
                    channel: channel.to_owned(),
                });
            }
            (Estimator::H1, on_input, _) => (on_input, Some(zero())),
            (Estimator::H2, _, on_output) => (Some(zero()), on_output),
            (Estimator::Hv, on_input, on_output) => (on_input, on_output),
        };
        response.noise_bias = on_input.zip(on_output).map(|(on_input, on_output)| {
            let lines = on_input.iter().zip(&on_output).zip(&response.values);
            lines
                .map(|((a, b), value)| {
                    // the signal's share of the power; NaN if there is none
                    let signal = |noise: f64| if noise < 1.0 { 1.0 - noise } else { f64::NAN };
                    let bias = match response.estimator {
                        Estimator::H1 => -a,
                        Estimator::H2 => b / signal(*b),
                        Estimator::Hv => (signal(*a) / signal(*b)).sqrt() - 1.0,
                        Estimator::Hs => 0.0,
                    };
                    if value.is_nan() { f64::NAN } else { bias }
                })
                .collect()
        });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bendat and Piersol: with a coherence of 0.64, H1 is 0.36 too low if the noise is on the
    /// input, H2 is 0.5625 too high if it is on the output, and Hv is 0.2 too low or 0.25 too high,
    /// respectively.
    #[test]
    fn the_possible_biases_are_those_of_the_coherence() {
        for (estimator, input_noise, output_noise) in [
            (Estimator::H1, -0.36, 0.0),
            (Estimator::H2, 0.0, 0.5625),
            (Estimator::Hv, -0.2, 0.25),
            (Estimator::Hs, 0.0, 0.0),
        ] {
            let found = Bias::of(estimator, 0.64, 10.0);
            assert!((found.input_noise - input_noise).abs() < 1e-15, "{found:?}");
            assert!(
                (found.output_noise - output_noise).abs() < 1e-15,
                "{found:?}"
            );
            assert!((found.scatter - 0.36 / (4.0 * 9.0 * 0.64)).abs() < 1e-16);
            assert!(Bias::of(estimator, f64::NAN, 10.0).input_noise.is_nan());
        }
    }
}

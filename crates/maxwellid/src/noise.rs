//! Noise of the two histories of a test: stated or estimated from the quiet part, and its covariance.

use crate::error::MaxwellidError;
use crate::test::{RodTest, half_rise};
use crate::velocity::Differentiator;

/// Noise of one velocity history: stationary, of known autocovariance.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum HistoryNoise {
    /// Independent errors of all samples.
    White {
        /// Standard deviation [m/s].
        standard_deviation: f64,
    },
    /// White noise of a displacement that was differentiated: neighbouring samples are correlated.
    Differentiated {
        /// Standard deviation of the displacement \[m\].
        displacement: f64,
        /// Differentiator of the velocity.
        differentiator: Differentiator,
        /// Sampling rate \[Hz\].
        rate_hz: f64,
    },
    /// Noise of known autocovariance.
    Coloured {
        /// Autocovariance from lag 0 on, zero beyond [m²/s²].
        autocovariance: Vec<f64>,
    },
}

impl HistoryNoise {
    /// Autocovariance [m²/s²] at `lag` samples.
    #[must_use]
    pub fn autocovariance(&self, lag: usize) -> f64 {
        match self {
            Self::White { standard_deviation } if lag == 0 => standard_deviation.powi(2),
            Self::White { .. } => 0.0,
            Self::Differentiated {
                displacement,
                differentiator,
                rate_hz,
            } => (displacement * rate_hz).powi(2) * differentiator.autocovariance(lag),
            Self::Coloured { autocovariance } => autocovariance.get(lag).copied().unwrap_or(0.0),
        }
    }

    /// Standard deviation of a sample [m/s].
    #[must_use]
    pub fn standard_deviation(&self) -> f64 {
        self.autocovariance(0).sqrt()
    }
}

/// Noise of excitation and response of a test.
#[derive(Debug, Clone, PartialEq)]
pub struct TestNoise {
    /// Noise of v_e.
    pub excitation: HistoryNoise,
    /// Noise of v_r.
    pub response: HistoryNoise,
}

/// Fewest samples of a quiet part for a standard deviation, which is then known to a fifth.
pub(crate) const QUIET_SAMPLES: usize = 16;

/// Number of samples before the half height of the first rise that do not count as quiet: the rise itself and the precursor of
/// an anti-aliasing filter.
const PRECURSOR: usize = 10;

/// Standard deviation about their mean of the samples before the first rise, and their number, which is the error if it is too small.
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "sample counts are far below 2^52 and an index of a rise is not negative"
)]
#[allow(
    clippy::indexing_slicing,
    reason = "an arrival is within the samples, and the quiet part ends before it"
)]
pub(crate) fn quiet_standard_deviation(
    samples: &[f64],
    arrival: f64,
) -> Result<(f64, usize), usize> {
    let quiet = (arrival.floor() as usize).saturating_sub(PRECURSOR);
    if quiet < QUIET_SAMPLES {
        return Err(quiet);
    }
    let quiet = &samples[..quiet];
    let mean = quiet.iter().sum::<f64>() / quiet.len() as f64;
    let squares: f64 = quiet.iter().map(|v| (v - mean).powi(2)).sum();
    Ok(((squares / (quiet.len() - 1) as f64).sqrt(), quiet.len()))
}

impl RodTest {
    /// Sets the standard deviations [m/s] of white noise of excitation and response. A fit then weights the residual by the
    /// covariance of both, and its errors are those of data with this noise.
    ///
    /// # Errors
    /// [`MaxwellidError::Noise`] unless the excitation's is finite and not negative, the response's finite and positive.
    pub fn with_noise(self, excitation: f64, response: f64) -> Result<Self, MaxwellidError> {
        let white = |standard_deviation| HistoryNoise::White { standard_deviation };
        self.with_history_noise(TestNoise {
            excitation: white(excitation),
            response: white(response),
        })
    }

    /// Sets the noise of both histories, white or not.
    ///
    /// # Errors
    /// As [`Self::with_noise`].
    pub fn with_history_noise(mut self, noise: TestNoise) -> Result<Self, MaxwellidError> {
        for (history, of_history, least) in [
            ("excitation", &noise.excitation, true),
            ("response", &noise.response, false),
        ] {
            let value = of_history.standard_deviation();
            if !(value.is_finite() && (value > 0.0 || (least && value == 0.0))) {
                return Err(MaxwellidError::Noise {
                    test: self.name,
                    history,
                    value,
                });
            }
        }
        self.noise = Some(noise);
        self.quiet_samples = None;
        Ok(self)
    }

    /// Sets white noise of both histories, estimated from their quiet parts, the samples before the first rise.
    ///
    /// # Errors
    /// [`MaxwellidError::NoArrival`]; [`MaxwellidError::NoQuietPart`] for fewer than 16 quiet samples; [`MaxwellidError::Noise`]
    /// if the quiet part of the response is exactly constant.
    pub fn with_noise_of_quiet_part(self) -> Result<Self, MaxwellidError> {
        let measure = |history: &'static str, samples: &[f64]| {
            let arrival = half_rise(samples).ok_or_else(|| MaxwellidError::NoArrival {
                test: self.name.clone(),
                history,
            })?;
            quiet_standard_deviation(samples, arrival).map_err(|found| {
                MaxwellidError::NoQuietPart {
                    test: self.name.clone(),
                    history,
                    found,
                    expected: QUIET_SAMPLES,
                }
            })
        };
        let (excitation, of_excitation) = measure("excitation", &self.excitation_samples)?;
        let (response, of_response) = measure("response", &self.response)?;
        let quiet_samples = Some(of_excitation.min(of_response));
        Ok(Self {
            quiet_samples,
            ..self.with_noise(excitation, response)?
        })
    }

    /// The stated or estimated noise, if any.
    #[must_use]
    pub fn noise(&self) -> Option<&TestNoise> {
        self.noise.as_ref()
    }
}

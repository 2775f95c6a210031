//! Noise of the two histories of a test: stated or estimated from the quiet part, and its
//! covariance.

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

/// Fewest samples of a quiet part for a standard deviation, which then has an error of a fifth.
pub(crate) const QUIET_SAMPLES: usize = 16;

/// Number of samples before the half height of the first rise that do not count as quiet: the rise
/// itself and the precursor of an anti-aliasing filter.
const PRECURSOR: usize = 10;

/// Returns the standard deviation of the samples before the first rise about their mean, and their
/// number; if there are too few, `Err` contains their number.
#[expect(
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
    /// Sets the standard deviations [m/s] of white noise of excitation and response. A fit then
    /// weights the residual with the covariance of both, and states the errors for data with this
    /// noise.
    ///
    /// # Errors
    /// [`MaxwellidError::Noise`] unless the standard deviation of the excitation is finite and not
    /// negative, and that of the response finite and positive.
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
    /// The errors of [`Self::with_noise`].
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
        match self.unfiltered.take() {
            Some(unfiltered) => self.with_recorder(unfiltered.filter()),
            None => Ok(self),
        }
    }

    /// Sets white noise of both histories, estimated from their quiet parts, the samples before the
    /// first rise.
    ///
    /// # Errors
    /// [`MaxwellidError::NoArrival`]; [`MaxwellidError::NoQuietPart`] for fewer than 16 quiet
    /// samples; [`MaxwellidError::Noise`] if the quiet part of the response is exactly
    /// constant.
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

/// Degrees of freedom of the noise of all `tests`, if it was estimated from their quiet parts.
pub(crate) fn quiet_degrees(tests: &[RodTest]) -> Option<f64> {
    let of_test = |test: &RodTest| test.quiet_samples.map(|samples| samples.saturating_sub(1));
    let degrees: usize = tests.iter().map(of_test).sum::<Option<usize>>()?;
    (degrees > 0).then_some(degrees as f64)
}

/// Returns true if the variance of a white residual exceeds that of the noise by more than three
/// standard deviations of their ratio; see [`residual_variance`].
pub(crate) fn exceeds_noise(chi_square: f64, degrees: f64, quiet: Option<f64>) -> bool {
    let chance = 2.0 / degrees + quiet.map_or(0.0, |quiet| 2.0 / quiet);
    chi_square / degrees > 1.0 + 3.0 * chance.sqrt()
}

/// Variance of a white residual of `chi_square` with `degrees` of freedom, in units of the stated
/// noise.
///
/// If the ratio to the noise exceeds 1 by more than three standard deviations, the variance is that
/// of the residual. Otherwise it is 1 for stated noise or, for noise estimated from quiet
/// parts with `quiet` degrees of freedom, the pooled estimate of quiet parts and residual.
pub(crate) fn residual_variance(chi_square: f64, degrees: f64, quiet: Option<f64>) -> f64 {
    if exceeds_noise(chi_square, degrees, quiet) {
        return chi_square / degrees;
    }
    quiet.map_or(1.0, |quiet| (quiet + chi_square) / (quiet + degrees))
}

#[cfg(test)]
mod tests {
    use super::{exceeds_noise, residual_variance};
    use testbed::noise::Noise;

    fn estimated_variance(noise: &mut Noise, samples: u32) -> f64 {
        (0..samples).map(|_| noise.normal().powi(2)).sum()
    }

    /// A true variance of 1 in units of a noise from 30 quiet samples, with 90 residuals: the
    /// pooled estimate has 120 degrees of freedom.
    #[test]
    fn r13_noise_of_few_quiet_samples_is_pooled_with_the_residual() {
        let mut noise = Noise::seeded(13);
        let draws = 4000;
        let (mut as_stated, mut pooled, mut above) = (0.0, 0.0, 0.0);
        for _ in 0..draws {
            let quiet = estimated_variance(&mut noise, 30) / 30.0;
            let chi_square = estimated_variance(&mut noise, 90) / quiet;
            as_stated += quiet.ln().powi(2);
            pooled += (quiet * residual_variance(chi_square, 90.0, Some(30.0)))
                .ln()
                .powi(2);
            above += f64::from(u8::from(exceeds_noise(chi_square, 90.0, Some(30.0))));
        }
        // the variance of ln s^2 is about 2/ν: 1/15 as stated, 1/60 pooled; the ratio from 4000
        // draws is known to 2 %
        let ratio = pooled / as_stated;
        assert!((0.2..0.32).contains(&ratio), "{ratio}");
        // correct records are called misfits in less than 3 % of the draws, because F with few
        // degrees of freedom has a long tail; they would be in 22 % if the noise were taken as
        // known
        assert!(above / f64::from(draws) < 0.03, "{above}");
        assert!(exceeds_noise(90.0 * 3.0, 90.0, Some(30.0)));
        assert!((residual_variance(80.0, 90.0, None) - 1.0).abs() < 1e-15);
        assert!((residual_variance(180.0, 90.0, None) - 2.0).abs() < 1e-15);
    }
}

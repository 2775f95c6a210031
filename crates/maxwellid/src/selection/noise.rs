//! What is known of the noise of both histories.

use crate::error::MaxwellidError;

/// Standard deviations of the noise of both histories, white from sample to sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseLevels {
    /// Of the excitation, as a share of V0.
    pub excitation: f64,
    /// Of the response, as a share of V0.
    pub response: f64,
    /// Number of samples from which the levels were estimated, if they were: the common factor of both is then uncertain, and is
    /// averaged over. `None` for levels that are known.
    pub degrees_of_freedom: Option<f64>,
}

impl NoiseLevels {
    /// Known levels, as shares of V0.
    #[must_use]
    pub fn known(excitation: f64, response: f64) -> Self {
        Self {
            excitation,
            response,
            degrees_of_freedom: None,
        }
    }

    /// Levels estimated from so many samples of rest; 0 if nothing but their ratio is known.
    #[must_use]
    pub fn estimated(excitation: f64, response: f64, samples: f64) -> Self {
        Self {
            excitation,
            response,
            degrees_of_freedom: Some(samples),
        }
    }

    pub(crate) fn check(&self) -> Result<(), MaxwellidError> {
        for (setting, value, least) in [
            ("noise of the excitation over V0", self.excitation, 0.0),
            (
                "noise of the response over V0",
                self.response,
                f64::MIN_POSITIVE,
            ),
            (
                "degrees of freedom of the noise level",
                self.degrees_of_freedom.unwrap_or(0.0),
                0.0,
            ),
        ] {
            if !(value.is_finite() && value >= least) {
                return Err(MaxwellidError::Setting {
                    setting,
                    value,
                    expected: "a finite value, not negative, and above 0 for the response",
                });
            }
        }
        Ok(())
    }
}

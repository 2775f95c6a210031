//! Sensor errors that all samples share.

/// Standard uncertainties of the measuring chain of a sensor, or of the ratio of two sensors.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SensorError {
    /// Relative uncertainty of the sensitivity.
    pub gain: f64,
    /// Uncertainty of the time skew \[s\].
    pub delay: f64,
}

impl SensorError {
    /// Returns the uncertainties of the ratio of two independent sensors: the root sum of squares
    /// of the relative gain uncertainties, and that of the delay uncertainties.
    #[must_use]
    pub fn combined(self, other: Self) -> Self {
        Self {
            gain: self.gain.hypot(other.gain),
            delay: self.delay.hypot(other.delay),
        }
    }

    /// Returns true if the gain or the delay is uncertain.
    #[must_use]
    pub fn is_uncertain(self) -> bool {
        self.gain > 0.0 || self.delay > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ratio_of_two_sensors_has_the_errors_of_both() {
        let of = |gain, delay| SensorError { gain, delay };
        let both = of(0.03, 0.0).combined(of(0.04, 2e-6));
        assert!((both.gain - 0.05).abs() < 1e-15 && (both.delay - 2e-6).abs() < 1e-20);
        assert!(both.is_uncertain() && of(0.0, 1e-6).is_uncertain());
        assert!(!SensorError::default().is_uncertain());
    }
}

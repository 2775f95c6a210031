//! Errors of a sensor that all samples share.

use crate::{LabioError, Record};

/// Standard uncertainties of the chain of a sensor, or of the ratio of two.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SensorError {
    /// Relative uncertainty of the sensitivity.
    pub gain: f64,
    /// Uncertainty of the time skew \[s\].
    pub delay: f64,
}

impl SensorError {
    /// Returns the errors of the ratio or the sum of delays of two independent sensors: the root of
    /// the summed squares.
    #[must_use]
    pub fn combined(self, other: Self) -> Self {
        Self {
            gain: self.gain.hypot(other.gain),
            delay: self.delay.hypot(other.delay),
        }
    }

    /// Returns true if there is an error.
    #[must_use]
    pub fn is_uncertain(self) -> bool {
        self.gain > 0.0 || self.delay > 0.0
    }
}

impl Record {
    /// Returns the errors of the sensor of the channel called `name`; none without a
    /// [`SensorChain`](crate::SensorChain).
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`].
    pub fn sensor_error(&self, name: &str) -> Result<SensorError, LabioError> {
        let chain = self.chain(name)?;
        Ok(
            chain.map_or_else(SensorError::default, |chain| SensorError {
                gain: chain.relative_uncertainty(),
                delay: chain.time_skew_uncertainty(),
            }),
        )
    }
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::*;
    use crate::{Channel, Provenance, Quantity, Rating, SensorChain};

    #[test]
    fn the_ratio_of_two_sensors_has_the_errors_of_both() {
        let channels = ["a", "b"].map(|name| Channel::new(name, Quantity::Voltage).unwrap());
        let samples = Array2::zeros((2, 4));
        let record = Record::new(
            samples,
            1e3,
            0.0,
            channels.to_vec(),
            Provenance::computed("x"),
        );
        let chain = |percent: f64, delay: f64| {
            let rating = Rating::new(10.0, "mV/N").unwrap();
            let rating = rating.with_uncertainty(0.1 * percent).unwrap();
            let chain = SensorChain::of_sensitivity(rating).unwrap();
            chain.with_time_skew_uncertainty(delay).unwrap()
        };
        let record = record.unwrap().calibrated("a", chain(3.0, 0.0)).unwrap();
        assert!(!record.sensor_error("b").unwrap().is_uncertain());
        let record = record.calibrated("b", chain(4.0, 2e-6)).unwrap();
        let [a, b] = ["a", "b"].map(|name| record.sensor_error(name).unwrap());
        let both = a.combined(b);
        assert!((both.gain - 0.05).abs() < 1e-15 && (both.delay - 2e-6).abs() < 1e-20);
        assert!(record.sensor_error("c").is_err());
    }
}

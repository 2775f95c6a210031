//! The force window, which passes the contact of the hammer and suppresses the rest of its record.

use std::f64::consts::PI;

use crate::LabioError;
use crate::error::{check_positive, non_physical};

/// The force window: weight 1 from `start` to `end`, falling to 0 as half a cosine over `taper`
/// before and after; 0 elsewhere.
///
/// A hammer is in contact for a small part of the record; in the rest of the record its channel
/// contains noise, which the force window removes from the input spectrum. Times count from the
/// first sample of the hit.
///
/// # Validity
///
/// The flat part must contain the whole contact. A window wider than the contact changes only the
/// noise, so that levels need no correction. An offset of the channel must be removed first
/// ([`Detrend`](crate::Detrend) or a baseline measured before the hit): inside the window it would
/// act as a second pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceWindow {
    start: f64,
    end: f64,
    taper: f64,
}

impl ForceWindow {
    /// Creates a window from `start` to `end` \[s\] with edges of `taper` \[s\] outside that
    /// interval.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if a time is not finite, `end` is not after `start`, or `taper`
    /// is negative.
    pub fn new(start: f64, end: f64, taper: f64) -> Result<Self, LabioError> {
        if !start.is_finite() {
            return non_physical("start of the force window [s]", start, "a finite time");
        }
        if !(end.is_finite() && end > start) {
            let expected = "a finite time after its start";
            return non_physical("end of the force window [s]", end, expected);
        }
        if !(taper.is_finite() && taper >= 0.0) {
            let expected = "a finite time, not negative";
            return non_physical("taper of the force window [s]", taper, expected);
        }
        Ok(Self { start, end, taper })
    }

    /// Computes the weights of `n_samples` samples at `sampling_rate_hz` \[Hz\].
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] for the sampling rate.
    pub fn weights(&self, n_samples: usize, sampling_rate_hz: f64) -> Result<Vec<f64>, LabioError> {
        check_positive("sampling rate [Hz]", sampling_rate_hz)?;
        super::check_length(n_samples)?;
        Ok((0..n_samples)
            .map(|n| self.weight(n as f64 / sampling_rate_hz))
            .collect())
    }

    fn weight(&self, time: f64) -> f64 {
        let outside = (self.start - time).max(time - self.end);
        if outside <= 0.0 {
            1.0
        } else if outside < self.taper {
            0.5 + 0.5 * (PI * outside / self.taper).cos()
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_is_flat_inside_and_nothing_outside() {
        let window = ForceWindow::new(0.2, 0.5, 0.2).unwrap();
        let weights = window.weights(10, 10.0).unwrap();
        // half a cosine over two samples: 1/2 at its middle; rounding errors of the times affect
        // the weights through the slope
        let expected = [0.0, 0.5, 1.0, 1.0, 1.0, 1.0, 0.5, 0.0, 0.0, 0.0];
        for (weight, expected) in weights.iter().zip(expected) {
            assert!((weight - expected).abs() < 1e-14, "{weights:?}");
        }
        let abrupt = ForceWindow::new(0.2, 0.5, 0.0).unwrap();
        assert_eq!(
            abrupt.weights(8, 10.0).unwrap(),
            [0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0]
        );
    }

    #[test]
    fn a_window_without_width_is_refused() {
        let refusals = [
            ForceWindow::new(0.2, 0.2, 0.0),
            ForceWindow::new(f64::NAN, 0.2, 0.0),
            ForceWindow::new(0.0, 0.2, -1.0),
        ]
        .map(|w| w.unwrap_err().to_string())
        .join("\n");
        insta::assert_snapshot!(refusals, @r"
        end of the force window [s] is 0.2, expected a finite time after its start
        start of the force window [s] is NaN, expected a finite time
        taper of the force window [s] is -1, expected a finite time, not negative
        ");
    }
}

//! A force over time.

use rodwave::band_limited::{SampledHistory, VelocityHistory};

use crate::ImpulseError;
use crate::error::{check_enough, check_finite, check_positive, check_samples};

/// Number of interpolated points per sample around the largest sample.
const FINER: usize = 32;

/// Equally spaced samples of a force \[N\], positive in compression.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceHistory {
    start_time: f64,
    time_step: f64,
    force: Vec<f64>,
}

/// The largest force of a history, at a sample or interpolated between samples.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ForcePeak {
    /// Time \[s\].
    pub time: f64,
    /// Force \[N\].
    pub force: f64,
}

impl ForceHistory {
    /// Creates a history from samples of `force` \[N\], the first at `start_time` \[s\],
    /// `time_step` \[s\] apart.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for the times, [`ImpulseError::TooShort`] without a sample,
    /// [`ImpulseError::NonFinite`] for a sample.
    pub fn new(start_time: f64, time_step: f64, force: Vec<f64>) -> Result<Self, ImpulseError> {
        check_positive("time step [s]", time_step)?;
        check_finite("start time [s]", start_time)?;
        check_enough("force history", force.len(), 1)?;
        check_samples("force history", &force)?;
        let end = start_time + force.len() as f64 * time_step;
        check_finite("end of the force history [s]", end)?;
        Ok(Self {
            start_time,
            time_step,
            force,
        })
    }

    /// The samples \[N\]; `(n_samples)`.
    #[must_use]
    pub fn force(&self) -> &[f64] {
        &self.force
    }

    /// Time between samples \[s\].
    #[must_use]
    pub fn time_step(&self) -> f64 {
        self.time_step
    }

    /// Time of sample `index` \[s\].
    #[must_use]
    pub fn time_at(&self, index: usize) -> f64 {
        self.start_time + index as f64 * self.time_step
    }

    /// Index of the sample nearest to `time` \[s\], or `None` outside the history.
    #[must_use]
    pub fn index_near(&self, time: f64) -> Option<usize> {
        let mut edges =
            (0..self.force.len()).map(|index| self.time_at(index) + 0.5 * self.time_step);
        if time < self.start_time - 0.5 * self.time_step {
            return None;
        }
        edges.position(|edge| time < edge)
    }

    /// Slope of the force [N/s] between the neighbours of the sample nearest to `time` \[s\];
    /// `None` where one of them is missing, or for a slope of 0.
    pub(crate) fn slope_near(&self, time: f64) -> Option<f64> {
        let index = self.index_near(time)?;
        let before = self.force.get(index.checked_sub(1)?)?;
        let after = self.force.get(index + 1)?;
        let slope = (after - before) / (2.0 * self.time_step);
        (slope.abs() > 0.0).then_some(slope)
    }

    /// The largest sample.
    #[must_use]
    pub fn peak(&self) -> ForcePeak {
        let mut peak = ForcePeak {
            time: self.start_time,
            force: f64::NEG_INFINITY,
        };
        for (index, &force) in self.force.iter().enumerate() {
            if force > peak.force {
                peak.time = self.time_at(index);
                peak.force = force;
            }
        }
        peak
    }

    /// Returns the largest force between samples, by band-limited interpolation about the largest
    /// sample.
    ///
    /// # Validity
    ///
    /// Valid for samples of a force that has passed the anti-alias filter of a recorder, such as a
    /// force that was found from responses: up to 0.38 of the sampling rate the interpolation is
    /// exact to 2e-5.
    #[must_use]
    pub fn interpolated_peak(&self) -> ForcePeak {
        let peak = self.peak();
        let fine = || {
            let at = self.index_near(peak.time)?;
            let reach = 2 * SampledHistory::HALF_WIDTH;
            let first = at.saturating_sub(reach);
            let around = self.force.get(first..self.force.len().min(at + reach))?;
            let history = SampledHistory::new(around, 1.0 / self.time_step).ok()?;
            let begin = (at - first) as f64 - 1.0;
            let time = |point: usize| self.time_step * (begin + point as f64 / FINER as f64);
            let fine = (0..=2 * FINER).map(|point| history.at(time(point)));
            let step = self.time_step / FINER as f64;
            Self::new(peak.time - self.time_step, step, fine.collect()).ok()
        };
        fine().map_or(peak, |fine| fine.smooth_peak())
    }

    /// Impulse $`\int F\,dt`$ \[N s\], as the sum of samples times the time step. It is exact for a
    /// band-limited history of one period; a jump that is not sampled at its middle causes an error
    /// of up to half a step times the jump.
    #[must_use]
    pub fn impulse(&self) -> f64 {
        self.time_step * self.force.iter().sum::<f64>()
    }

    /// Creates a history with the same times and other forces.
    pub(crate) fn with_force(&self, force: Vec<f64>) -> Self {
        Self { force, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A Gaussian pulse of 3 samples, sampled anywhere between its peak and half a sample before.
    #[test]
    fn a_peak_between_samples_is_found() {
        for shift in [0.0, 0.13, 0.31, 0.5] {
            let sample = |n: i32| (-0.5 * ((f64::from(n) - 40.0 - shift) / 1.5).powi(2)).exp();
            let force = ForceHistory::new(1.0, 0.5, (0..80).map(sample).collect()).unwrap();
            let peak = force.interpolated_peak();
            // exp(-(2 π 0.38 1.5)²/2) of the pulse is beyond the band of the interpolation; its
            // largest samples are 0.946 to 1
            assert!((peak.force - 1.0).abs() < 2e-3, "{shift}: {peak:?}");
            let time = 1.0 + 0.5 * (40.0 + shift);
            assert!((peak.time - time).abs() < 1e-2, "{shift}: {peak:?}");
        }
    }

    #[test]
    fn peak_and_impulse_of_a_triangle() {
        let triangle = ForceHistory::new(-0.25, 0.25, vec![0.0, 0.0, 4.0, 8.0, 4.0, 0.0]).unwrap();
        let peak = triangle.peak();
        // dyadic numbers: exact
        assert_eq!(peak.time.to_bits(), 0.5_f64.to_bits());
        assert_eq!(peak.force.to_bits(), 8.0_f64.to_bits());
        assert_eq!(triangle.impulse().to_bits(), 4.0_f64.to_bits());
    }

    #[test]
    fn the_nearest_sample_is_found_and_none_beyond_the_ends() {
        let history = ForceHistory::new(-0.5, 0.25, vec![0.0; 4]).unwrap();
        for (time, index) in [
            (-0.7, None),
            (-0.6, Some(0)),
            (0.0, Some(2)),
            (0.1, Some(2)),
            (0.3, Some(3)),
            (0.4, None),
            (f64::NAN, None),
        ] {
            assert_eq!(history.index_near(time), index, "{time}");
        }
    }

    #[test]
    fn a_history_without_time_or_with_holes_is_refused() {
        assert!(ForceHistory::new(0.0, 0.0, vec![1.0]).is_err());
        assert!(ForceHistory::new(f64::NAN, 1.0, vec![1.0]).is_err());
        assert!(ForceHistory::new(0.0, 1.0, Vec::new()).is_err());
        let error = ForceHistory::new(0.0, 1.0, vec![1.0, f64::NAN]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "element 1 of the force history is not finite"
        );
    }
}

//! Load history of the specimen before its recovery.

use std::f64::consts::TAU;

use super::dashpot::{Dashpot, SpringStress};
use crate::error::{CmodError, check_finite, check_not_negative, check_positive, check_values};

/// Minimum number of integration steps per period of a sine.
const STEPS_PER_PERIOD: f64 = 8.0;

/// Part of a load. The time within each segment starts at 0.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum LoadSegment {
    /// Constant stress; 0 for a rest.
    Constant {
        /// Stress \[Pa\].
        stress: f64,
        /// Duration \[s\].
        duration: f64,
    },
    /// Stress that is linear in time.
    Ramp {
        /// Stress at the beginning \[Pa\].
        from: f64,
        /// Stress at the end \[Pa\].
        to: f64,
        /// Duration \[s\].
        duration: f64,
    },
    /// Stress σ_a + σ_c sin 2πf_c t, as in Test 6 of paper C.
    Periodic {
        /// Mean stress σ_a \[Pa\].
        mean: f64,
        /// Amplitude σ_c \[Pa\].
        amplitude: f64,
        /// Frequency f_c \[Hz\].
        frequency_hz: f64,
        /// Duration \[s\].
        duration: f64,
    },
}

impl LoadSegment {
    fn check(&self) -> Result<(), CmodError> {
        check_not_negative("duration of a load segment [s]", self.duration())?;
        let stresses = match *self {
            Self::Constant { stress, .. } => [stress, stress],
            Self::Ramp { from, to, .. } => [from, to],
            Self::Periodic {
                mean,
                amplitude,
                frequency_hz,
                ..
            } => {
                check_positive("frequency of a load segment [Hz]", frequency_hz)?;
                [mean, amplitude]
            }
        };
        for value in stresses {
            check_finite("stress of a load segment [Pa]", value)?;
        }
        Ok(())
    }

    fn largest_stress(&self) -> f64 {
        match *self {
            Self::Constant { stress, .. } => stress.abs(),
            Self::Ramp { from, to, .. } => from.abs().max(to.abs()),
            Self::Periodic {
                mean, amplitude, ..
            } => mean.abs() + amplitude.abs(),
        }
    }

    fn duration(&self) -> f64 {
        match *self {
            Self::Constant { duration, .. }
            | Self::Ramp { duration, .. }
            | Self::Periodic { duration, .. } => duration,
        }
    }
}

/// Sequence of load segments on a virgin specimen, followed by unloading.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadHistory {
    segments: Vec<LoadSegment>,
}

impl LoadHistory {
    /// Creates the load from consecutive `segments`.
    ///
    /// # Errors
    /// [`CmodError::NoLoad`] without segments; [`CmodError::NonPhysical`] for a stress that is not
    /// finite, a duration that is negative or not finite, or a frequency that is not above 0.
    pub fn new(segments: Vec<LoadSegment>) -> Result<Self, CmodError> {
        if segments.is_empty() {
            return Err(CmodError::NoLoad);
        }
        for segment in &segments {
            segment.check()?;
        }
        Ok(Self { segments })
    }

    /// Creates a load of constant `stress` \[Pa\] for `duration` \[s\], as in Tests 1-5 of paper C.
    ///
    /// # Errors
    /// The errors of [`LoadHistory::new`].
    pub fn creep(stress: f64, duration: f64) -> Result<Self, CmodError> {
        Self::new(vec![LoadSegment::Constant { stress, duration }])
    }

    /// Creates a load that varies linearly between samples of the `stress` \[Pa\] at increasing
    /// `time` \[s\], as recorded by a testing machine or in an impact. Both arrays have one entry
    /// per sample; the first sample is applied as a step.
    ///
    /// # Errors
    /// [`CmodError::ReadingCount`] for unequal lengths, [`CmodError::NoLoad`] for fewer than two
    /// samples, [`CmodError::NonPhysical`] as in [`LoadHistory::new`]; a decreasing time is
    /// reported as a negative duration.
    pub fn from_samples(time: &[f64], stress: &[f64]) -> Result<Self, CmodError> {
        check_values("stress", stress.len(), time.len(), "time")?;
        let segments = time
            .windows(2)
            .zip(stress.windows(2))
            .filter_map(|(t, s)| match (t, s) {
                (&[begin, end], &[from, to]) => Some(LoadSegment::Ramp {
                    from,
                    to,
                    duration: end - begin,
                }),
                _ => None,
            })
            .collect();
        Self::new(segments)
    }

    /// Returns the segments, in order.
    #[must_use]
    pub fn segments(&self) -> &[LoadSegment] {
        &self.segments
    }

    /// Returns the largest absolute stress \[Pa\].
    #[must_use]
    pub fn largest_stress(&self) -> f64 {
        self.segments
            .iter()
            .map(LoadSegment::largest_stress)
            .fold(0.0, f64::max)
    }

    /// Returns the duration of the whole load \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.segments.iter().map(LoadSegment::duration).sum()
    }

    /// Returns the load with each periodic segment replaced by the constant stress with the same
    /// mean of |σ|^m σ, which drives the dashpot as long as the stress of the parallel spring is
    /// small. This is accurate enough for a starting point and avoids the integration of thousands
    /// of periods.
    pub(super) fn averaged(&self, m: f64) -> Self {
        let average = |mean: f64, amplitude: f64| {
            // sixteen equidistant phases; the mean over a period converges fast with the number of
            // phases
            let rate: f64 = (0..16_u32)
                .map(|i| {
                    let stress = mean + amplitude * (TAU * f64::from(i) / 16.0).sin();
                    stress.abs().powf(m) * stress / 16.0
                })
                .sum();
            rate.signum() * rate.abs().powf(1.0 / (m + 1.0))
        };
        let segments = self.segments.iter().map(|segment| match *segment {
            LoadSegment::Periodic {
                mean,
                amplitude,
                duration,
                ..
            } => LoadSegment::Constant {
                stress: average(mean, amplitude),
                duration,
            },
            other => other,
        });
        Self {
            segments: segments.collect(),
        }
    }

    /// Returns the stress of the parallel spring at unloading; the stress of the dashpot is then
    /// its negative.
    pub(super) fn response(&self, pair: &Dashpot) -> Result<SpringStress, CmodError> {
        let largest = self.largest_stress();
        let mut state = SpringStress::default();
        if largest == 0.0 {
            return Ok(state);
        }
        for (segment, load) in self.segments.iter().enumerate() {
            let driven = match *load {
                LoadSegment::Constant { stress, duration } => {
                    Ok(pair.hold(state, stress, duration))
                }
                LoadSegment::Ramp { duration, .. } | LoadSegment::Periodic { duration, .. }
                    if duration == 0.0 =>
                {
                    Ok(state)
                }
                LoadSegment::Ramp { from, to, duration } => pair.drive(
                    state,
                    |t| from + (to - from) * (t / duration),
                    duration,
                    duration,
                    largest,
                ),
                LoadSegment::Periodic {
                    mean,
                    amplitude,
                    frequency_hz,
                    duration,
                } => pair.drive(
                    state,
                    |t| mean + amplitude * (TAU * frequency_hz * t).sin(),
                    duration,
                    1.0 / (STEPS_PER_PERIOD * frequency_hz),
                    largest,
                ),
            };
            state = driven.map_err(|time| CmodError::LoadNotIntegrated { segment, time })?;
        }
        Ok(state)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAIR: Dashpot = Dashpot {
        rate: 2e-3,
        exponent: 1.8,
        reference_stress: 30e6,
    };

    #[test]
    fn samples_are_joined_by_straight_lines() {
        let load = LoadHistory::from_samples(&[0.0, 1.0, 3.0], &[1e6, 2e6, 0.0]).unwrap();
        assert_eq!(
            load.segments(),
            [
                LoadSegment::Ramp {
                    from: 1e6,
                    to: 2e6,
                    duration: 1.0
                },
                LoadSegment::Ramp {
                    from: 2e6,
                    to: 0.0,
                    duration: 2.0
                }
            ]
        );
    }

    #[test]
    fn averaged_load_responds_alike() {
        let periodic = |frequency_hz| {
            LoadHistory::new(vec![LoadSegment::Periodic {
                mean: 32e6,
                amplitude: 13e6,
                frequency_hz,
                duration: 100.0,
            }])
            .unwrap()
        };
        let (load, averaged) = (periodic(4.0), periodic(4.0).averaged(1.8));
        let (a, b) = (
            load.response(&PAIR).unwrap().value,
            averaged.response(&PAIR).unwrap().value,
        );
        // the stress of the spring reaches a fifth of the load; the amplitude of the load affects
        // this stress only to second order
        assert!((a / b - 1.0).abs() < 0.02, "{a} {b}");
        // under the mean stress alone the rate is lower by m(m+1)/4 (13/32)² = 20 %
        let mean = LoadHistory::creep(32e6, 100.0).unwrap();
        assert!(a > 1.1 * mean.response(&PAIR).unwrap().value);
    }

    #[test]
    fn impossible_loads_are_refused() {
        let text = |result: Result<LoadHistory, CmodError>| result.unwrap_err().to_string();
        assert_eq!(text(LoadHistory::new(Vec::new())), "no load segment");
        assert_eq!(
            text(LoadHistory::creep(f64::NAN, 1.0)),
            "stress of a load segment [Pa] is NaN, expected a finite value"
        );
        assert_eq!(
            text(LoadHistory::creep(1.0, -1.0)),
            "duration of a load segment [s] is -1, expected a finite value, 0 or above"
        );
        assert_eq!(
            text(LoadHistory::from_samples(&[0.0, 1.0], &[1.0])),
            "stress has 1 values, expected 2, one per time"
        );
        assert_eq!(
            text(LoadHistory::from_samples(&[0.0, -1.0], &[1.0, 2.0])),
            "duration of a load segment [s] is -1, expected a finite value, 0 or above"
        );
    }
}

//! One rod test: two velocity histories of a struck rod.

use std::sync::Arc;

use rodwave::RodwaveError;
use rodwave::band_limited::SampledHistory;

use crate::common_error::CommonError;
use crate::error::{MaxwellidError, check_not_negative, check_positive};
use crate::model::{DrivenRod, RodModel};
use crate::noise::{HistoryNoise, TestNoise};
use crate::recorder::UnfilteredExcitation;

/// Origin of a record.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Provenance {
    /// Measured on a rod.
    Measured,
    /// Computed; `generator` names the solver, as [`rodwave::lumped::GENERATOR`] does.
    Virtual {
        /// Name of the solver.
        generator: String,
    },
}

/// The data of a test for [`RodTest::new`].
#[derive(Debug, Clone, PartialEq)]
pub struct RodTestData {
    /// Name, for messages and reports.
    pub name: String,
    /// Distance L from the section where the excitation is measured to the free end \[m\].
    pub length: f64,
    /// Density [kg/m³].
    pub density: f64,
    /// Impact velocity V0 [m/s], by which residuals and errors are divided.
    pub impact_velocity: f64,
    /// Sampling rate of both histories \[Hz\].
    pub sampling_rate_hz: f64,
    /// Velocity v_e at the section of the excitation [m/s].
    pub excitation: Vec<f64>,
    /// Velocity v_r of the free end [m/s].
    pub response: Vec<f64>,
    /// Origin of the record.
    pub provenance: Provenance,
}

/// A validated test, ready for identification.
///
/// The comparison of simulated and measured response uses all samples up to the end of the window,
/// which is by default [`SampledHistory::HALF_WIDTH`] samples before the end of the record: closer
/// to the end the excitation between the samples is not known to the stated accuracy.
#[derive(Debug, Clone)]
pub struct RodTest {
    pub(crate) name: String,
    pub(crate) length: f64,
    pub(crate) density: f64,
    pub(crate) impact_velocity: f64,
    pub(crate) sampling_rate_hz: f64,
    pub(crate) excitation: SampledHistory,
    pub(crate) excitation_samples: Vec<f64>,
    pub(crate) response: Vec<f64>,
    pub(crate) provenance: Provenance,
    pub(crate) window: usize,
    pub(crate) noise: Option<TestNoise>,
    /// Number of samples at rest from which the noise of each history was estimated; `None` if it
    /// is stated.
    pub(crate) quiet_samples: Option<usize>,
    pub(crate) flags: Vec<TestFlag>,
    pub(crate) common_errors: Vec<CommonError>,
    /// Temperature of the rod \[K\], if it is stated.
    pub(crate) temperature: Option<f64>,
    /// Lateral inertia ν²k_p² \[m²\] of the rod.
    pub(crate) lateral_inertia: f64,
    /// Excitation before the filter of the recorder; `None` if the filter is not stated.
    pub(crate) unfiltered: Option<Arc<UnfilteredExcitation>>,
}

/// A remark on a test.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TestFlag {
    /// A displacement leaves the range of its transducer; samples from there on are not used.
    #[error(
        "the transducer of the {history} is out of range from {:.3} ms on", 1e3 * .time
    )]
    Clipped {
        /// `excitation` or `response`.
        history: &'static str,
        /// Time of the first clipped sample \[s\], from the first sample of the displacement.
        time: f64,
    },
}

/// Limit of samples relative to V0, beyond which they are not velocities and their squares
/// overflow.
const LARGEST: f64 = 1e150;

/// Largest first sample, as a fraction of V0, that is accepted as noise of a rod at rest.
const REST: f64 = 0.15;

impl RodTest {
    /// Validates a test.
    ///
    /// # Errors
    /// [`MaxwellidError`] naming the test, the quantity and the value: non-physical geometry,
    /// samples that are not finite, unequal lengths, fewer than 32 samples, one history as
    /// excitation and response, or a record that begins after the wave has arrived.
    pub fn new(data: RodTestData) -> Result<Self, MaxwellidError> {
        let RodTestData {
            name,
            length,
            density,
            impact_velocity,
            sampling_rate_hz,
            excitation: excitation_samples,
            response,
            provenance,
        } = data;
        let in_test = |source| MaxwellidError::InTest {
            test: name.clone(),
            source,
        };
        for (quantity, value) in [
            ("length [m]", length),
            ("density [kg/m^3]", density),
            ("impact velocity [m/s]", impact_velocity),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return Err(in_test(RodwaveError::NonPhysical {
                    quantity,
                    value,
                    expected: "a finite value above 0",
                }));
            }
        }
        let excitation =
            SampledHistory::new(&excitation_samples, sampling_rate_hz).map_err(in_test)?;
        if let Some((index, &value)) = response.iter().enumerate().find(|(_, v)| !v.is_finite()) {
            return Err(in_test(RodwaveError::NonFiniteSample {
                history: "response",
                index,
                value,
            }));
        }
        for (history, samples) in [
            ("excitation over V0", &excitation_samples),
            ("response over V0", &response),
        ] {
            let ratios = samples.iter().map(|sample| sample / impact_velocity);
            if let Some(value) = ratios.into_iter().find(|ratio| ratio.abs() > LARGEST) {
                return Err(in_test(RodwaveError::NonPhysical {
                    quantity: history,
                    value,
                    expected: "at most 1e150",
                }));
            }
        }
        if response.len() != excitation_samples.len() {
            return Err(MaxwellidError::UnequalLengths {
                test: name,
                response: response.len(),
                excitation: excitation_samples.len(),
            });
        }
        if response == excitation_samples && response.iter().any(|v| *v != 0.0) {
            return Err(MaxwellidError::OneHistory { test: name });
        }
        let window = response.len().saturating_sub(SampledHistory::HALF_WIDTH);
        if window < SampledHistory::HALF_WIDTH {
            return Err(in_test(RodwaveError::TooFewSamples {
                history: "response",
                found: response.len(),
                expected: 2 * SampledHistory::HALF_WIDTH,
            }));
        }
        let allowed = REST * impact_velocity;
        for (history, samples) in [("excitation", &excitation_samples), ("response", &response)] {
            match samples.first() {
                Some(&value) if value.abs() > allowed => {
                    return Err(MaxwellidError::NotAtRest {
                        test: name,
                        history,
                        value,
                        allowed,
                    });
                }
                _ => {}
            }
        }
        Ok(Self {
            name,
            length,
            density,
            impact_velocity,
            sampling_rate_hz,
            excitation,
            excitation_samples,
            response,
            provenance,
            window,
            noise: None,
            quiet_samples: None,
            flags: Vec::new(),
            common_errors: Vec::new(),
            temperature: None,
            lateral_inertia: 0.0,
            unfiltered: None,
        })
    }

    /// Sets the end of the comparison to `end` \[s\] from the first sample.
    ///
    /// # Errors
    /// [`MaxwellidError::ExcitationTooShort`] if the excitation is not known until then.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the end is checked against the record before the cast"
    )]
    pub fn with_window(mut self, end: f64) -> Result<Self, MaxwellidError> {
        let known =
            (self.response.len() - 1 - SampledHistory::HALF_WIDTH) as f64 / self.sampling_rate_hz;
        if !(end.is_finite() && end > 0.0 && end <= known * (1.0 + 1e-12)) {
            return Err(MaxwellidError::ExcitationTooShort {
                test: self.name,
                needed: end,
                found: known,
            });
        }
        // a window ended by a clipped response is not extended
        let limit = if self.flags.is_empty() {
            usize::MAX
        } else {
            self.window
        };
        self.window = ((end * self.sampling_rate_hz).round() as usize + 1).min(limit);
        Ok(self)
    }

    /// Sets the temperature of the rod \[K\], on which thermally activated laws depend.
    ///
    /// # Errors
    /// [`MaxwellidError::Setting`] unless it is finite and above 0.
    pub fn at_temperature(self, temperature: f64) -> Result<Self, MaxwellidError> {
        check_positive("temperature of a rod [K]", temperature)?;
        Ok(Self {
            temperature: Some(temperature),
            ..self
        })
    }

    /// Sets the lateral inertia r² = ν²k_p² \[m²\] of the rod, with Poisson's ratio ν and the polar
    /// radius of gyration k_p of its section: ν²D²/8 for a round rod. Without it, a rod is thin.
    ///
    /// # Errors
    /// [`MaxwellidError::Setting`] unless it is finite and not below 0.
    pub fn with_lateral_inertia(self, lateral_inertia: f64) -> Result<Self, MaxwellidError> {
        check_not_negative("lateral inertia of a rod [m^2]", lateral_inertia)?;
        Ok(Self {
            lateral_inertia,
            ..self
        })
    }

    /// Temperature of the rod \[K\], if it is stated.
    #[must_use]
    pub fn temperature(&self) -> Option<f64> {
        self.temperature
    }

    /// Impact velocity [m/s].
    #[must_use]
    pub fn impact_velocity(&self) -> f64 {
        self.impact_velocity
    }

    /// Density of the rod [kg/m³].
    #[must_use]
    pub fn density(&self) -> f64 {
        self.density
    }

    /// Standard deviations [m/s] of the noise of excitation and response; `None` if it is not
    /// known.
    #[must_use]
    pub fn noise_deviations(&self) -> Option<[f64; 2]> {
        let noise = self.noise.as_ref()?;
        Some([&noise.excitation, &noise.response].map(HistoryNoise::standard_deviation))
    }

    /// Remarks on the test.
    #[must_use]
    pub fn flags(&self) -> &[TestFlag] {
        &self.flags
    }

    /// Name of the test.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Sampling rate of both histories \[Hz\].
    #[must_use]
    pub fn sampling_rate_hz(&self) -> f64 {
        self.sampling_rate_hz
    }

    /// The samples of the response within the window [m/s] (paper D, eq. 10).
    #[must_use]
    #[allow(
        clippy::indexing_slicing,
        reason = "the window ends within the record: `new`, `with_window` and `from_displacements` ensure this"
    )]
    pub fn response(&self) -> &[f64] {
        &self.response[..self.window]
    }

    /// Times of the samples within the window \[s\], from the first sample of the record.
    #[must_use]
    pub fn times(&self) -> Vec<f64> {
        (0..self.window)
            .map(|k| k as f64 / self.sampling_rate_hz)
            .collect()
    }

    /// The rod of this test, driven by its excitation, for the response at `times` \[s\] on a grid
    /// with cells up to `cell` \[m\].
    #[must_use]
    pub fn driven_rod<'a>(&'a self, times: &'a [f64], cell: f64) -> DrivenRod<'a> {
        DrivenRod {
            length: self.length,
            density: self.density,
            sampling_rate_hz: self.sampling_rate_hz,
            samples: &self.excitation_samples,
            excitation: &self.excitation,
            times,
            cell,
            temperature: self.temperature,
            lateral_inertia: self.lateral_inertia,
        }
    }

    /// Returns Young's modulus \[Pa\] from the time of flight: the delay between the half heights
    /// of the two first rises.
    ///
    /// Accurate to a few per cent: the relative error is the rise time divided by the transit time.
    ///
    /// # Errors
    /// [`MaxwellidError::NoArrival`] if a history never rises, or the response does not rise after
    /// the excitation.
    pub fn modulus_from_time_of_flight(&self) -> Result<f64, MaxwellidError> {
        let time = self.time_of_flight()?;
        Ok(self.density * (self.length / time).powi(2))
    }

    /// Delay \[s\] between the half heights of the two first rises.
    fn time_of_flight(&self) -> Result<f64, MaxwellidError> {
        let missing = |history| MaxwellidError::NoArrival {
            test: self.name.clone(),
            history,
        };
        let sent = half_rise(&self.excitation_samples).ok_or_else(|| missing("excitation"))?;
        let received = half_rise(&self.response).ok_or_else(|| missing("response"))?;
        let time = (received - sent) / self.sampling_rate_hz;
        if time <= 0.0 {
            return Err(missing("response"));
        }
        Ok(time)
    }

    /// Checks that the window contains the arrival of the wave and enough samples after it to show
    /// the shape of the wave.
    fn check_window(&self) -> Result<(), MaxwellidError> {
        let arrival = half_rise(&self.response).ok_or_else(|| MaxwellidError::NoArrival {
            test: self.name.clone(),
            history: "response",
        })?;
        let end = (self.window - 1) as f64;
        if end < arrival + AFTER_ARRIVAL {
            return Err(MaxwellidError::WindowTooShort {
                test: self.name.clone(),
                end: end / self.sampling_rate_hz,
                arrival: arrival / self.sampling_rate_hz,
                needed: AFTER_ARRIVAL / self.sampling_rate_hz,
            });
        }
        Ok(())
    }
}

/// Number of samples after the arrival needed for the shape of a front.
const AFTER_ARRIVAL: f64 = 8.0;

/// Error of a time of flight in samples: half a sample at either end, and one sample for the change
/// of a front along the rod.
const TIME_ERROR: f64 = 2.0;

/// Difference of ln E between rods of one material due to dispersion and amplitude, in addition to
/// the error of the time of flight.
const MODULUS_SCATTER: f64 = 0.2;

/// Accepts `tests` with the temperatures that a model needs.
pub(crate) fn check_temperatures(
    model: &dyn RodModel,
    tests: &[RodTest],
) -> Result<(), MaxwellidError> {
    let mut tests = tests.iter();
    match tests.find(|test| test.temperature.is_none()) {
        Some(test) if model.needs_temperature() => Err(MaxwellidError::TemperatureUnknown {
            test: test.name.clone(),
        }),
        _ => Ok(()),
    }
}

/// Rejects one recording as two tests, because its information would be counted twice.
pub(crate) fn check_distinct(tests: &[RodTest]) -> Result<(), MaxwellidError> {
    for (index, first) in tests.iter().enumerate() {
        for second in tests.iter().skip(index + 1) {
            let histories = [
                (
                    "excitation",
                    &first.excitation_samples,
                    &second.excitation_samples,
                ),
                ("response", &first.response, &second.response),
            ];
            for (history, one, other) in histories {
                // without noise, the histories of two tests may be equal
                let moves = one.iter().any(|v| *v != 0.0);
                if moves && first.noise.is_some() && one == other {
                    return Err(MaxwellidError::SameRecording {
                        first: first.name.clone(),
                        second: second.name.clone(),
                        history,
                    });
                }
            }
        }
    }
    Ok(())
}

/// Checks that every window contains a wave and the times of flight do not contradict each other.
pub(crate) fn check_together(tests: &[RodTest]) -> Result<(), MaxwellidError> {
    for test in tests {
        test.check_window()?;
    }
    if tests.len() < 2 {
        return Ok(());
    }
    let moduli: Vec<f64> = tests
        .iter()
        .map(RodTest::modulus_from_time_of_flight)
        .collect::<Result<_, _>>()?;
    let mut sorted = moduli.clone();
    sorted.sort_by(f64::total_cmp);
    // for two tests the larger modulus, so that they are compared with each other
    let Some(median) = sorted.get(sorted.len() / 2).copied() else {
        return Err(MaxwellidError::NoTest);
    };
    for (test, modulus) in tests.iter().zip(&moduli) {
        let time_error = 2.0 * TIME_ERROR / (test.time_of_flight()? * test.sampling_rate_hz);
        let allowed = MODULUS_SCATTER + time_error;
        if (modulus / median).ln().abs() > allowed {
            return Err(MaxwellidError::Contradiction {
                test: test.name.clone(),
                modulus: *modulus,
                others: median,
                allowed,
            });
        }
    }
    Ok(())
}

/// Young's modulus \[Pa\] from the times of flight of all tests: the mean of ln E, each test
/// weighted by the inverse variance. All times of flight have the same error in samples, so that
/// this variance is inversely proportional to the square of the time of flight in samples.
pub(crate) fn modulus_of_all(tests: &[RodTest]) -> Result<f64, MaxwellidError> {
    let mut logarithms = Vec::with_capacity(tests.len());
    for test in tests {
        let samples = test.time_of_flight()? * test.sampling_rate_hz;
        let modulus = test.modulus_from_time_of_flight()?;
        logarithms.push((samples * samples, modulus.ln()));
    }
    let weights: f64 = logarithms.iter().map(|(weight, _)| weight).sum();
    let sum: f64 = logarithms.iter().map(|(weight, ln)| weight * ln).sum();
    if tests.is_empty() {
        return Err(MaxwellidError::NoTest);
    }
    Ok((sum / weights).exp())
}

/// Fractional index at which a history first reaches half the height of its first peak.
///
/// The first peak is the largest magnitude within [`RISE`] samples of the first crossing of a
/// quarter of the overall largest: later waves, whose velocity a free end doubles, may be higher.
pub(crate) fn half_rise(samples: &[f64]) -> Option<f64> {
    let largest = |samples: &[f64]| samples.iter().fold(0.0_f64, |top, v| top.max(v.abs()));
    let quarter = 0.25 * largest(samples);
    if quarter <= 0.0 {
        return None;
    }
    let start = samples.iter().position(|v| v.abs() >= quarter)?;
    let end = samples.len().min(start + RISE);
    let half = 0.5 * largest(samples.get(start..end)?);
    let heights = samples.iter().map(|v| v.abs());
    heights
        .clone()
        .zip(heights.skip(1))
        .enumerate()
        .skip(start.saturating_sub(RISE))
        .find(|(_, (below, above))| *below < half && *above >= half)
        .map(|(index, (below, above))| index as f64 + (half - below) / (above - below))
}

/// Number of samples in which a front is assumed to rise; at 51.2 kHz and a bandwidth of 16 kHz it
/// rises in two.
const RISE: usize = 5;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_without_end_is_refused_however_slow_the_record() {
        let test = RodTest::new(RodTestData {
            name: "slow".into(),
            length: 0.4,
            density: 910.0,
            impact_velocity: 10.0,
            sampling_rate_hz: 1e-308,
            excitation: vec![0.0; 40],
            response: vec![0.0; 40],
            provenance: Provenance::Measured,
        })
        .unwrap();
        assert_eq!(test.clone().with_window(1e308).unwrap().times().len(), 2);
        assert!(test.with_window(f64::INFINITY).is_err());
    }
}

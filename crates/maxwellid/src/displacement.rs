//! A test with displacement histories, as from the transducers of paper D.
//!
//! Theory: `docs/theory/identification.md#velocities-from-displacements`.

use crate::error::MaxwellidError;
use crate::noise::{HistoryNoise, QUIET_SAMPLES, TestNoise, quiet_standard_deviation};
use crate::test::{RodTest, RodTestData, TestFlag, half_rise};
use crate::velocity::Differentiator;

/// Displacement measurement of a test, and its differentiation.
#[derive(Debug, Clone, PartialEq)]
pub struct DisplacementTransducers {
    /// Range \[m\]: a section that has moved further is out of range. Infinite if not known.
    pub range: f64,
    /// Standard deviation \[m\] of excitation and response; `None` to estimate them from the quiet
    /// parts.
    pub noise: Option<(f64, f64)>,
    /// Differentiator for the velocities, the same for both histories.
    pub differentiator: Differentiator,
}

/// Number of consecutive, exactly equal samples away from rest that indicate a clipped transducer:
/// a free section keeps moving.
const STUCK: usize = 4;

impl RodTest {
    /// Validates a test whose `excitation` and `response` are displacements \[m\], positive away
    /// from the striker.
    ///
    /// The velocities begin and end half the width of the differentiator inside the record. Samples
    /// are not used from the first clipped sample on, which is beyond the range or constant away
    /// from rest: the record of the excitation ends there, and the window of comparison ends at the
    /// clipping of either history. [`RodTest::flags`] reports it. The noise of the velocities is
    /// white noise of the displacements, filtered by the differentiator.
    ///
    /// # Errors
    /// The errors of [`RodTest::new`], those of [`RodTest::with_noise_of_quiet_part`] where `noise`
    /// is `None`, and [`MaxwellidError::ClippedTooEarly`] if nothing usable remains.
    pub fn from_displacements(
        data: RodTestData,
        transducers: &DisplacementTransducers,
    ) -> Result<Self, MaxwellidError> {
        let RodTestData {
            name,
            sampling_rate_hz,
            excitation,
            response,
            ..
        } = &data;
        if transducers.range.is_nan() || transducers.range <= 0.0 {
            return Err(MaxwellidError::TransducerRange {
                test: name.clone(),
                value: transducers.range,
            });
        }
        let half_width = transducers.differentiator.half_width();
        // the check of the velocities in `RodTest::new` would report the index of a velocity
        for (history, samples) in [("excitation", excitation), ("response", response)] {
            if let Some((index, &value)) = samples.iter().enumerate().find(|(_, u)| !u.is_finite())
            {
                return Err(MaxwellidError::InTest {
                    test: name.clone(),
                    source: rodwave::RodwaveError::NonFiniteSample {
                        history,
                        index,
                        value,
                    },
                });
            }
        }
        let mut flags = Vec::new();
        let mut ends = [excitation.len(), response.len()];
        for ((history, samples), end) in [("excitation", excitation), ("response", response)]
            .into_iter()
            .zip(&mut ends)
        {
            if let Some(index) = first_clipped(samples, transducers.range) {
                let time = seconds(index, *sampling_rate_hz);
                // too few samples before the clipping, as for a history that never moves from its
                // initial value
                if index < 2 * half_width + 32 {
                    return Err(MaxwellidError::ClippedTooEarly {
                        test: name.clone(),
                        history,
                        time,
                    });
                }
                flags.push(TestFlag::Clipped { history, time });
                *end = index;
            }
        }
        let (noise, quiet_samples) = match transducers.noise {
            Some(noise) => (noise, None),
            None => {
                let (of_excitation, k) = quiet_noise(name, "excitation", excitation, transducers)?;
                let (of_response, l) = quiet_noise(name, "response", response, transducers)?;
                ((of_excitation, of_response), Some(k.min(l)))
            }
        };
        let coloured = |displacement| HistoryNoise::Differentiated {
            displacement,
            differentiator: transducers.differentiator.clone(),
            rate_hz: *sampling_rate_hz,
        };
        let noise = TestNoise {
            excitation: coloured(noise.0),
            response: coloured(noise.1),
        };
        let velocity = |samples: &[f64], end: usize| {
            transducers
                .differentiator
                .velocity(samples.get(..end).unwrap_or(samples), *sampling_rate_hz)
        };
        // checked here, because `RodTest::new` would report the lengths of the velocities
        if excitation.len() != response.len() {
            return Err(MaxwellidError::UnequalLengths {
                test: name.clone(),
                response: response.len(),
                excitation: excitation.len(),
            });
        }
        let v_e = velocity(excitation, ends[0]);
        let mut v_r = velocity(response, ends[0]);
        // the response after its clipping is outside the window: any finite values will do
        let known = velocity(response, ends[1].min(ends[0])).len();
        if known < v_r.len() {
            let last = v_r.get(known.saturating_sub(1)).copied().unwrap_or(0.0);
            v_r.iter_mut().skip(known).for_each(|v| *v = last);
        }
        let mut test = Self::new(RodTestData {
            excitation: v_e,
            response: v_r,
            ..data
        })?;
        test.window = test.window.min(known);
        test.flags = flags;
        Ok(Self {
            quiet_samples,
            ..test.with_history_noise(noise)?
        })
    }
}

fn seconds(index: usize, rate_hz: f64) -> f64 {
    index as f64 / rate_hz
}

/// Index of the first sample out of range, or of the first of [`STUCK`] equal samples above half
/// the largest displacement.
fn first_clipped(samples: &[f64], range: f64) -> Option<usize> {
    let largest = samples.iter().fold(0.0_f64, |top, u| top.max(u.abs()));
    let out = samples.iter().position(|u| u.abs() >= range);
    let stuck = samples.windows(STUCK).position(|run| {
        run.first().is_some_and(|first| {
            first.abs() > 0.5 * largest && run.iter().all(|u| u.to_bits() == first.to_bits())
        })
    });
    match (out, stuck) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}

/// Standard deviation \[m\] of the displacement before the velocity rises, and the number of
/// samples used.
fn quiet_noise(
    test: &str,
    history: &'static str,
    samples: &[f64],
    transducers: &DisplacementTransducers,
) -> Result<(f64, usize), MaxwellidError> {
    let velocity = transducers.differentiator.velocity(samples, 1.0);
    let arrival = half_rise(&velocity).ok_or_else(|| MaxwellidError::NoArrival {
        test: test.to_owned(),
        history,
    })?;
    // velocity k belongs to displacement k + m, with the half width m: as an index of the
    // displacement, `arrival` is m samples before the rise
    quiet_standard_deviation(samples, arrival).map_err(|found| MaxwellidError::NoQuietPart {
        test: test.to_owned(),
        history,
        found,
        expected: QUIET_SAMPLES,
    })
}

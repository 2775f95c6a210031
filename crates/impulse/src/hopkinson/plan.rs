//! Band, windows and times of a result, which are the same for all its perturbations.

use std::f64::consts::PI;
use std::ops::Range;

use super::bar::HopkinsonBar;
use crate::ImpulseError;
use crate::error::check_enough;

/// Method that separates the waves of one bar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WaveSeparation {
    /// One gauge, where the waves pass one after the other.
    Windows,
    /// Two gauges: all waves at all times.
    TwoGauges,
    /// One gauge and the free end of the transmitted bar: all waves at all times.
    FreeEnd,
    /// One gauge on the incident bar, with the force of its face assumed equal to that of the other
    /// face: all waves at all times, without a test of equilibrium.
    Balanced,
}

/// Forces from which the stress is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StressFrom {
    /// Face of the transmitted bar: one wave.
    Transmitted,
    /// Face of the incident bar: two waves.
    Incident,
    /// Mean of both faces: three waves.
    #[default]
    Both,
}

/// Largest amplification of a line that is used.
pub(super) const MOST_AMPLIFICATION: f64 = 10.0;
/// Fractions of the end of the band between which the amplitude falls from 1 to 0.
const FALLS: [f64; 2] = [0.75, 1.25];
/// Fraction of a window before the first sample of the pulse.
const GUARD: f64 = 0.05;
/// Largest number of terms of a series of passages.
const MOST_TERMS: f64 = 500.0;
/// Fewest samples of a result.
const FEWEST: usize = 16;

/// Band, windows and times of a result.
#[derive(Debug, Clone)]
pub(super) struct Plan {
    pub(super) rate_hz: f64,
    pub(super) n_samples: usize,
    pub(super) n_transform: usize,
    /// Half-amplitude end of the band \[Hz\].
    pub(super) band_hz: f64,
    /// Amplitude of each line from 0 Hz to the last one above 0.
    pub(super) weight: Vec<f64>,
    /// Largest amplification of a wave propagated back to a face, within the band.
    pub(super) amplification: f64,
    /// Samples of incident, reflected and transmitted pulse, where windows separate them.
    pub(super) windows: [Range<usize>; 3],
    /// Samples of each bar in which waves pass its gauges along x only, before an echo returns from
    /// the specimen or from the far end.
    pub(super) one_way: [Range<usize>; 2],
    /// Samples of the result.
    pub(super) result: Range<usize>,
    /// Terms of the series of passages of each bar.
    pub(super) terms: [usize; 2],
    /// True if the incident pulse ends within its window; `false` if it runs on into the reflected
    /// one.
    pub(super) incident_ends: bool,
    /// Mean strain of the incident wave at the end of its window; 0 without windows.
    pub(super) incident_tail: f64,
    /// Magnitude of this mean, divided by the largest strain.
    pub(super) tail_part: f64,
    /// True if the record ends before the window of a pulse.
    pub(super) record_ends: bool,
}

/// Inputs of a plan.
pub(super) struct Given<'a> {
    pub(super) bars: [&'a HopkinsonBar; 2],
    pub(super) separation: [WaveSeparation; 2],
    pub(super) band_hz: Option<f64>,
    pub(super) rate_hz: f64,
    pub(super) n_samples: usize,
    pub(super) silent: usize,
    /// First sample of the incident pulse at the first gauge that it meets.
    pub(super) first_sample: usize,
    /// The record of that gauge, without its level at rest.
    pub(super) incident: &'a [f64],
}

impl Plan {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "times are within the record, whose samples are counted"
    )]
    pub(super) fn of(given: &Given<'_>) -> Result<Self, ImpulseError> {
        let rate = given.rate_hz;
        let n_transform = n_transform(given.n_samples);
        let (band_hz, amplification) = band(given)?;
        let weight = weights(band_hz, rate / n_transform as f64, n_transform);
        let fastest = |bar: &HopkinsonBar| -> Result<f64, ImpulseError> {
            let speeds = [0.03, 0.1, 0.3, 1.0].map(|part| bar.phase_velocity(part * band_hz));
            speeds
                .into_iter()
                .try_fold(0.0_f64, |most, speed| Ok(most.max(speed?)))
        };
        let speeds = [fastest(given.bars[0])?, fastest(given.bars[1])?];
        let [first_bar, second_bar] = given.bars;
        let distance = |bar: &HopkinsonBar| {
            let mut all = bar.gauges.iter().map(|gauge| gauge.distance.value);
            let first = all.next().unwrap_or(0.0);
            all.fold((first, first), |(near, far), d| (near.min(d), far.max(d)))
        };
        let (near, far) = (
            [distance(first_bar).0, distance(second_bar).0],
            [distance(first_bar).1, distance(second_bar).1],
        );
        let samples = |seconds: f64| seconds * rate;
        // time for which one gauge records the incident pulse alone
        let alone = samples(2.0 * near[0] / speeds[0]);
        let guard = (GUARD * alone).max(4.0);
        let start =
            (given.first_sample as f64 - guard).max(given.silent.min(given.first_sample) as f64);
        let at_face = start + samples(far[0] / speeds[0]);
        let end = given.n_samples as f64;
        // the band limit smears a pulse ahead by about one period of the frequency at the end of
        // the band; two periods are kept
        let edge = 2.0 * rate / band_hz;

        let incident_end = (start + alone).min(end);
        let tail = ((start + 0.95 * alone) as usize)..(incident_end as usize);
        let largest = given.incident.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        let tail = given.incident.get(tail).unwrap_or(&[]);
        let ends = mean_size(tail) < 0.05 * largest;
        let tail = match given.separation[0] {
            WaveSeparation::Windows => tail.iter().sum::<f64>() / tail.len().max(1) as f64,
            _ => 0.0,
        };
        let reflected_start = start + samples(2.0 * near[0] / speeds[0]);
        let transmitted_start = at_face + samples(near[1] / speeds[1]) - guard;
        let mut longest = f64::INFINITY;
        let mut cut_by_record = f64::INFINITY;
        let mut limited = |by_waves: f64, by_record: f64| {
            longest = longest.min(by_waves);
            cut_by_record = cut_by_record.min(by_record);
        };
        match given.separation[0] {
            WaveSeparation::Windows => {
                let again = samples(2.0 * (first_bar.length.value - near[0]) / speeds[0]);
                limited(again, end - edge - reflected_start);
                if !ends {
                    limited(alone, f64::INFINITY);
                }
            }
            _ => limited(
                f64::INFINITY,
                end - edge - samples(far[0] / speeds[0]) - at_face,
            ),
        }
        match given.separation[1] {
            WaveSeparation::Windows => {
                let again = samples(2.0 * (second_bar.length.value - near[1]) / speeds[1]);
                limited(again, end - edge - transmitted_start);
            }
            _ => limited(
                f64::INFINITY,
                end - edge - samples(far[1] / speeds[1]) - at_face,
            ),
        }
        let record_ends = cut_by_record < longest;
        let duration = longest.min(cut_by_record);
        let range = |from: f64, to: f64| {
            let from = from.clamp(0.0, end) as usize;
            from..(to.clamp(0.0, end) as usize).max(from)
        };
        let result = range(at_face, at_face + duration);
        check_enough(
            "part of the record after the pulse has reached the specimen",
            result.len(),
            FEWEST,
        )?;
        let terms = |separation: WaveSeparation,
                     (near, far, length): (f64, f64, f64),
                     speed: f64|
         -> Result<usize, ImpulseError> {
            let apart = match separation {
                WaveSeparation::Windows => return Ok(0),
                WaveSeparation::TwoGauges => far - near,
                WaveSeparation::FreeEnd => length - near,
                WaveSeparation::Balanced => near,
            };
            let terms = (end / samples(2.0 * apart / speed)).floor();
            if terms <= MOST_TERMS {
                Ok(terms as usize)
            } else {
                Err(ImpulseError::NonPhysical {
                    quantity: "number of passages between two sections within the record",
                    value: terms,
                    expected: "at most 500: place the gauges further apart or use a shorter record",
                })
            }
        };
        Ok(Self {
            rate_hz: rate,
            n_samples: given.n_samples,
            n_transform,
            band_hz,
            weight,
            amplification,
            windows: [
                range(start, incident_end),
                range(reflected_start, reflected_start + duration + edge),
                range(
                    transmitted_start,
                    transmitted_start + duration + guard + edge,
                ),
            ],
            one_way: [
                range(
                    start,
                    (at_face + samples(near[0] / speeds[0]) - 0.5 * edge).min(end - edge),
                ),
                range(
                    transmitted_start,
                    (at_face + samples((2.0 * second_bar.length.value - far[1]) / speeds[1])
                        - 0.5 * edge)
                        .min(end - edge),
                ),
            ],
            result,
            terms: [
                terms(
                    given.separation[0],
                    (near[0], far[0], first_bar.length.value),
                    speeds[0],
                )?,
                terms(
                    given.separation[1],
                    (near[1], far[1], second_bar.length.value),
                    speeds[1],
                )?,
            ],
            incident_ends: ends || given.separation[0] != WaveSeparation::Windows,
            incident_tail: tail,
            tail_part: (tail / largest).abs(),
            record_ends,
        })
    }

    /// Returns the plan with a band twice as wide, or as wide as the sampling rate allows, in which
    /// no wave is amplified more than in this one; `None` if a bar has no wave at one of its lines.
    pub(super) fn wider(&self, bars: [&HopkinsonBar; 2]) -> Option<Self> {
        let band_hz = (2.0 * self.band_hz).min(0.5 * self.rate_hz / FALLS[1]);
        let line_hz = self.rate_hz / self.n_transform as f64;
        let mut weight = weights(band_hz, line_hz, self.n_transform);
        for (line, weight) in weight.iter_mut().enumerate().skip(self.weight.len()) {
            let grown = amplification(bars, line as f64 * line_hz).ok()?;
            *weight *= (self.amplification / grown).min(1.0);
        }
        Some(Self {
            band_hz,
            weight,
            ..self.clone()
        })
    }

    /// Returns the plan for means of `by` samples each.
    pub(super) fn coarser(&self, by: usize) -> Self {
        let rate_hz = self.rate_hz / by as f64;
        let n_samples = self.n_samples / by;
        let n_transform = n_transform(n_samples);
        let part = |samples: &Range<usize>| samples.start / by..(samples.end / by).min(n_samples);
        Self {
            rate_hz,
            n_samples,
            n_transform,
            weight: weights(self.band_hz, rate_hz / n_transform as f64, n_transform),
            windows: self.windows.each_ref().map(part),
            one_way: self.one_way.each_ref().map(part),
            result: part(&self.result),
            ..self.clone()
        }
    }

    /// Frequency of the last line \[Hz\].
    pub(super) fn last_hz(&self) -> f64 {
        FALLS[1] * self.band_hz
    }

    /// Angular frequency of a line [rad/s].
    pub(super) fn omega(&self, line: usize) -> f64 {
        2.0 * PI * line as f64 * self.rate_hz / self.n_transform as f64
    }

    /// Time of sample `index` of the record \[s\].
    pub(super) fn time(&self, index: usize) -> f64 {
        index as f64 / self.rate_hz
    }
}

/// Returns the length of the transform of `n_samples` samples: sums of passages and their
/// reflections reach up to three times the record before they would wrap round.
fn n_transform(n_samples: usize) -> usize {
    (4 * n_samples).next_power_of_two()
}

/// Amplitudes of the lines up to the last one of the band.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a number of lines"
)]
fn weights(band_hz: f64, line_hz: f64, n_transform: usize) -> Vec<f64> {
    let n_lines = ((FALLS[1] * band_hz / line_hz).floor() as usize).min(n_transform / 2) + 1;
    (0..n_lines)
        .map(|k| roll_off(k as f64 * line_hz / band_hz))
        .collect()
}

/// Returns the amplitude at a frequency, given as a fraction of the end of the band.
fn roll_off(part: f64) -> f64 {
    let [from, to] = FALLS;
    let place = ((part - from) / (to - from)).clamp(0.0, 1.0);
    0.5 * (1.0 + (PI * place).cos())
}

fn mean_size(samples: &[f64]) -> f64 {
    samples.iter().map(|x| x.abs()).sum::<f64>() / samples.len().max(1) as f64
}

/// Returns the growth of a wave at a frequency when it is propagated back from the nearest gauge to
/// the face, in the bar where it is larger.
fn amplification(bars: [&HopkinsonBar; 2], frequency_hz: f64) -> Result<f64, ImpulseError> {
    let mut most = 0.0_f64;
    for bar in bars {
        let gamma = bar.propagation(2.0 * PI * frequency_hz)?;
        let distances = bar.gauges.iter().map(|gauge| gauge.distance.value);
        most = most.max((gamma.re * distances.fold(f64::INFINITY, f64::min)).exp());
    }
    Ok(most)
}

/// Returns the end of the band \[Hz\], and the largest amplification in it.
///
/// By default the upper end of the filter, 1.25 times the end of the band, is at most a third of the
/// sampling rate, the frequency of a wavelength of two diameters, and the frequency beyond which a
/// wave propagated back to its face grows more than tenfold; the band ends before the frequency up
/// to which the laws of the bars were measured. It is found in steps of 5 %.
fn band(given: &Given<'_>) -> Result<(f64, f64), ImpulseError> {
    let highest = given.rate_hz / 3.0;
    let amplification = |frequency_hz: f64| amplification(given.bars, frequency_hz);
    if let Some(stated) = given.band_hz {
        if !(stated.is_finite() && stated > 0.0 && FALLS[1] * stated <= 0.5 * given.rate_hz) {
            return Err(ImpulseError::NonPhysical {
                quantity: "end of the band [Hz]",
                value: stated,
                expected: "a frequency above 0 and at most 0.4 of the sampling rate",
            });
        }
        return Ok((stated, amplification(FALLS[1] * stated)?));
    }
    // steps of 5 % from the first line of the record
    let mut band = highest;
    let allowed = |frequency_hz: f64| -> Result<bool, ImpulseError> {
        if amplification(frequency_hz)? > MOST_AMPLIFICATION {
            return Ok(false);
        }
        for bar in given.bars {
            let wavelength = bar.phase_velocity(frequency_hz)? / frequency_hz;
            if wavelength < 2.0 * bar.diameter.value {
                return Ok(false);
            }
        }
        Ok(true)
    };
    let mut frequency = given.rate_hz / given.n_samples as f64;
    let known = given
        .bars
        .iter()
        .fold(f64::INFINITY, |to, bar| to.min(bar.material.known_to_hz()));
    while FALLS[1] * frequency < highest {
        let next = 1.05 * frequency;
        if next > known || !matches!(allowed(FALLS[1] * next), Ok(true)) {
            band = frequency;
            break;
        }
        frequency = next;
        band = frequency;
    }
    Ok((band, amplification(FALLS[1] * band)?))
}

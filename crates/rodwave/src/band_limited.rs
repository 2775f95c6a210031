//! Band-limited interpolation of sampled histories, and its counterpart, the low-pass filter of a
//! recorder.
//!
//! The kernel is the sinc function under an exponential-of-semicircle window (Barnett, Magland and
//! af Klinteberg, SIAM J. Sci. Comput. 41 (2019) C479), which is as sharp as the Kaiser window and
//! needs no special function.
//!
//! Theory: `docs/theory/direct-problem.md#excitation-between-samples`.

use std::sync::OnceLock;

use crate::RodwaveError;
use crate::error::{check_positive, check_samples, check_that};
use crate::interpolation::{Interpolated, cubic};

/// Velocity prescribed as a function of time.
pub trait VelocityHistory: Sync {
    /// Velocity \[m/s\] at `time` \[s\]; 0 before time 0, NaN if `time` is NaN.
    fn at(&self, time: f64) -> f64;

    /// Time derivative of the velocity [m/s²]; 0 before time 0, NaN if `time` is NaN.
    fn slope(&self, time: f64) -> f64;

    /// Time \[s\], not below 0, until which velocity and slope are zero; 0 if this time is not
    /// known.
    fn begin(&self) -> f64 {
        0.0
    }

    /// End of the history \[s\], after which the history is undefined.
    fn end(&self) -> f64;
}

/// Checks that `times` are within the duration of the excitation, and returns the latest of them.
pub(crate) fn check_times(
    times: &[f64],
    excitation: &dyn VelocityHistory,
) -> Result<f64, RodwaveError> {
    let mut last = 0.0_f64;
    for &time in times {
        check_that(
            time.is_finite() && time >= 0.0,
            "time of the response [s]",
            time,
            "a finite value not below 0",
        )?;
        last = last.max(time);
    }
    let end = excitation.end();
    // a time computed as a whole number of sampling intervals may exceed the end by rounding
    if last > end * (1.0 + 1e-12) {
        return Err(RodwaveError::ExcitationTooShort {
            needed: last,
            found: end,
        });
    }
    Ok(last)
}

/// Windowed sinc kernel: sin(πx)/(πx) under a window that vanishes at |x| = `half_width` samples.
/// The kernel passes frequencies below 1/2 - δ and stops those above 1/2 + δ, in cycles per sample,
/// with β = `sharpness`, δ = β/(2π `half_width`) and a ripple of order e^{-β}.
fn windowed_sinc(x: f64, half_width: f64, sharpness: f64) -> f64 {
    let u = x / half_width;
    if u.abs() >= 1.0 {
        return 0.0;
    }
    let window = (sharpness * ((1.0 - u * u).sqrt() - 1.0)).exp();
    let phase = std::f64::consts::PI * x;
    let sinc = if phase.abs() < 1e-8 {
        1.0
    } else {
        phase.sin() / phase
    };
    sinc * window
}

/// A history known at uniform samples, evaluated anywhere by band-limited interpolation.
///
/// Samples before the first are zero (the rod is quiescent). After the last one the history is
/// continued point-symmetrically, so that values within [`Self::HALF_WIDTH`] samples of the end are
/// less accurate.
///
/// # Accuracy
/// A sinusoid of amplitude 1 is reproduced between the samples to 2e-5 up to 0.38 of the sampling
/// rate (checked by a test); the error of a linear interpolation, 1 - cos(πf) at f times the rate,
/// is 0.63 at 0.38 of the rate and 0.29 at a quarter of it. Content above 0.38 of the rate is not
/// reproduced; the recorder's anti-aliasing filter must remove it.
///
/// ```
/// use rodwave::band_limited::{SampledHistory, VelocityHistory};
///
/// let rate = 51_200.0;
/// let pulse = |t: f64| (-((t - 0.5e-3) / 60e-6).powi(2)).exp();
/// let samples: Vec<f64> = (0..60).map(|k| pulse(f64::from(k) / rate)).collect();
/// let history = SampledHistory::new(&samples, rate)?;
/// assert!((history.at(0.4567e-3) - pulse(0.4567e-3)).abs() < 1e-5);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone)]
pub struct SampledHistory {
    /// The history at `OVERSAMPLING` points per sample, starting two fine steps before time 0.
    fine: Vec<f64>,
    fine_rate: f64,
    begin: f64,
    end: f64,
}

/// Points of the fine grid per sample: the error of cubic interpolation between them is 4e-7 at
/// 0.38 of the sampling rate.
const OVERSAMPLING: usize = 32;
/// Fine points kept before time 0 for the cubic stencil.
const LEAD: usize = 2;

/// Weights of the samples around a fine point, for every fine point between two samples. All
/// histories share them.
fn weights() -> &'static [[f64; OVERSAMPLING]] {
    static WEIGHTS: OnceLock<Vec<[f64; OVERSAMPLING]>> = OnceLock::new();
    WEIGHTS.get_or_init(|| {
        let reach = SampledHistory::HALF_WIDTH as f64;
        let weight = |sample: usize, phase: usize| {
            let distance = phase as f64 / OVERSAMPLING as f64 - (sample as f64 + 1.0 - reach);
            windowed_sinc(distance, reach, SampledHistory::SHARPNESS)
        };
        (0..2 * SampledHistory::HALF_WIDTH)
            .map(|sample| std::array::from_fn(|phase| weight(sample, phase)))
            .collect()
    })
}

/// [`interpolate`] as a task that can run with the vector instructions of the processor.
struct Interpolation<'a> {
    continued: &'a [f64],
    weights: &'a [[f64; OVERSAMPLING]],
    fine: &'a mut [f64],
}

impl pulp::NullaryFnOnce for Interpolation<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        interpolate(self.continued, self.weights, self.fine);
    }
}

/// Computes the fine points between each two neighbouring samples together. Every fine point is a
/// sum over its samples in the order of time.
#[inline(always)]
fn interpolate(continued: &[f64], weights: &[[f64; OVERSAMPLING]], fine: &mut [f64]) {
    let fine = fine.as_chunks_mut::<OVERSAMPLING>().0;
    for (around, fine) in continued.windows(weights.len()).zip(fine) {
        let mut sums = [-0.0; OVERSAMPLING]; // the value of an empty sum
        for (sample, weights) in around.iter().zip(weights) {
            for (sum, weight) in sums.iter_mut().zip(weights) {
                *sum += weight * sample;
            }
        }
        *fine = sums;
    }
}

impl SampledHistory {
    /// Reach of the interpolation, in samples to either side.
    pub const HALF_WIDTH: usize = 16;
    /// β of the window: with 16 samples it passes up to 0.38 of the sampling rate.
    const SHARPNESS: f64 = 12.0;

    /// Prepares the interpolation of `samples` \[m/s\] taken at `sampling_rate_hz`, the first at
    /// time 0.
    ///
    /// # Errors
    /// [`RodwaveError`] if a sample is not finite, if there are fewer than 4, or if the rate is not
    /// positive.
    pub fn new(samples: &[f64], sampling_rate_hz: f64) -> Result<Self, RodwaveError> {
        check_positive("sampling rate [Hz]", sampling_rate_hz)?;
        let fine_rate = check_positive(
            "rate of the interpolation, 32 times that of the samples [Hz]",
            sampling_rate_hz * OVERSAMPLING as f64,
        )?;
        check_positive("sampling interval [s]", sampling_rate_hz.recip())?;
        check_samples("excitation", samples)?;
        let count = samples.len();
        let [_, _, _, .., last] = samples else {
            return Err(RodwaveError::TooFewSamples {
                history: "excitation",
                found: count,
                expected: 4,
            });
        };
        // the samples with all neighbours that a fine point needs: zeros before them, their
        // point-symmetric continuation after them
        let (before, after) = (Self::HALF_WIDTH, Self::HALF_WIDTH);
        let mut continued = Vec::with_capacity(before + count + after);
        continued.resize(before, 0.0);
        continued.extend_from_slice(samples);
        continued.extend((count..count + after).map(|index| {
            let mirrored = (2 * (count - 1)).checked_sub(index);
            let mirrored = mirrored.and_then(|k| samples.get(k));
            2.0 * last - mirrored.copied().unwrap_or(0.0)
        }));
        // all fine points from one sample before the first to one after the last, before the ends
        // are cut
        let mut fine = vec![0.0; (count + 1) * OVERSAMPLING];
        pulp::Arch::new().dispatch(Interpolation {
            continued: &continued,
            weights: weights(),
            fine: &mut fine,
        });
        fine.drain(..OVERSAMPLING - LEAD);
        fine.truncate(LEAD + (count - 1) * OVERSAMPLING + 1 + LEAD);
        check_samples("interpolated excitation", &fine)?;
        // `begin` is the last fine point whose cubic stencil contains only zeros
        let zeros = fine.iter().take_while(|v| **v == 0.0).count();
        let begin = zeros.saturating_sub(3 + LEAD) as f64 / fine_rate;
        Ok(Self {
            fine,
            fine_rate,
            begin,
            end: (count - 1) as f64 / sampling_rate_hz,
        })
    }

    /// Index of the fine point before `time`, and the position of `time` between this point and the
    /// next one, in steps of the fine grid.
    #[inline]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the fine grid before the cast"
    )]
    fn locate(&self, time: f64) -> (usize, f64) {
        let position = time * self.fine_rate + LEAD as f64;
        let last = (self.fine.len() - 3) as f64;
        let index = position.floor().clamp(1.0, last);
        // a NaN would give the index 1 and a position that is NaN
        ((index as usize).max(1), (position - index).clamp(-1.0, 2.0))
    }

    /// Value and slope at `time`; the slope is per step of the fine grid.
    #[inline]
    fn interpolated(&self, time: f64) -> Interpolated {
        if time >= 0.0 {
            let (index, u) = self.locate(time);
            return cubic(self.stencil(index), u);
        }
        let known = if time.is_nan() { f64::NAN } else { 0.0 };
        Interpolated {
            value: known,
            slope: known,
        }
    }

    #[inline]
    #[allow(
        clippy::indexing_slicing,
        reason = "`locate` gives an index from 1 to the third from the end of the fine points, of which there are a hundred or more"
    )]
    fn stencil(&self, index: usize) -> [f64; 4] {
        [
            self.fine[index - 1],
            self.fine[index],
            self.fine[index + 1],
            self.fine[index + 2],
        ]
    }
}

impl VelocityHistory for SampledHistory {
    #[inline]
    fn at(&self, time: f64) -> f64 {
        self.interpolated(time).value
    }

    #[inline]
    fn slope(&self, time: f64) -> f64 {
        self.interpolated(time).slope * self.fine_rate
    }

    fn begin(&self) -> f64 {
        self.begin
    }

    fn end(&self) -> f64 {
        self.end
    }
}

/// Changes of a [`SampledHistory`] when single samples change by one unit.
#[derive(Debug, Clone)]
pub struct SamplePulses {
    /// A unit sample between samples that are zero.
    shape: SampledHistory,
    rate_hz: f64,
    samples: Vec<usize>,
}

impl SamplePulses {
    /// Prepares the changes due to the samples with these indices, of a history sampled at
    /// `rate_hz`. Unlike in [`SampledHistory`], the history is not continued beyond its end.
    ///
    /// # Errors
    /// [`RodwaveError`] if the rate is not positive.
    pub fn new(samples: &[usize], rate_hz: f64) -> Result<Self, RodwaveError> {
        let mut unit = [0.0; 2 * SampledHistory::HALF_WIDTH + 1];
        for sample in unit.iter_mut().skip(SampledHistory::HALF_WIDTH).take(1) {
            *sample = 1.0;
        }
        Ok(Self {
            shape: SampledHistory::new(&unit, rate_hz)?,
            rate_hz,
            samples: samples.to_vec(),
        })
    }

    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.samples.len()
    }

    /// Returns true if there is no sample.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// Time \[s\] before which a change of the sample at `place` (an index into the list of
    /// samples) has no effect; it may be negative.
    #[must_use]
    pub fn begin(&self, place: usize) -> f64 {
        let sample = self.samples.get(place).copied().unwrap_or(usize::MAX);
        (sample as f64 - SampledHistory::HALF_WIDTH as f64) / self.rate_hz
    }

    /// Change of the history at `time` \[s\] when the sample at `place` changes by one unit.
    #[must_use]
    pub fn at(&self, place: usize, time: f64) -> f64 {
        let own = time - self.begin(place);
        if (0.0..=self.shape.end()).contains(&own) {
            self.shape.at(own)
        } else {
            0.0
        }
    }
}

/// The recorder of a virtual test: a zero-phase low-pass filter and a sampler.
///
/// The gain of the filter is within 1e-4 of 1 below `cutoff_hz` - 0.08 `rate_hz`, and within 1e-4
/// of 0 above `cutoff_hz` + 0.08 `rate_hz`. The filter reaches 24 samples to either side, so a
/// record must begin at least that long before the first arrival.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recorder {
    /// Sampling rate of the record \[Hz\].
    pub rate_hz: f64,
    /// Frequency at which the filter has dropped to one half \[Hz\].
    pub cutoff_hz: f64,
}

impl Recorder {
    /// Reach of the filter, in samples to either side.
    const HALF_WIDTH: f64 = 24.0;
    /// β of the window.
    const SHARPNESS: f64 = 12.0;

    /// Time by which a record must precede the first arrival \[s\].
    #[must_use]
    pub fn reach(&self) -> f64 {
        Self::HALF_WIDTH / self.rate_hz
    }

    /// Returns the filtered value at `time` of a history sampled at `step` \[s\], which is zero
    /// before its first sample (time 0).
    ///
    /// `step` should be a small fraction of 1/`rate_hz`: the convolution is summed by the
    /// trapezoidal rule, which is exact for the passed frequencies if the history has no
    /// content above 1/`step` - `cutoff_hz`.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the record before the cast"
    )]
    pub fn filtered(&self, history: &[f64], step: f64, time: f64) -> f64 {
        // the kernel in units of the sampling interval of the cut-off, 1/(2 cutoff)
        let scale = 2.0 * self.cutoff_hz;
        let half_width = Self::HALF_WIDTH * scale / self.rate_hz;
        let first = ((time - self.reach()) / step).ceil().max(0.0) as usize;
        let last = ((time + self.reach()) / step).floor();
        if last < 0.0 || first >= history.len() {
            return 0.0;
        }
        let last = (last as usize).min(history.len() - 1);
        history
            .get(first..=last)
            .unwrap_or(&[])
            .iter()
            .enumerate()
            .map(|(k, value)| {
                let lag = time - (first + k) as f64 * step;
                value * windowed_sinc(lag * scale, half_width, Self::SHARPNESS)
            })
            .sum::<f64>()
            * scale
            * step
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_history_rests_until_its_begin_and_not_much_longer() {
        let rate = 51_200.0;
        for first in [0, 10, 16, 17, 40] {
            let samples: Vec<f64> = (0..80).map(|k| if k < first { 0.0 } else { 3.0 }).collect();
            let history = SampledHistory::new(&samples, rate).unwrap();
            let begin = history.begin();
            for k in 0..=100 {
                let t = begin * f64::from(k) / 100.0;
                let rests = history.at(t) == 0.0 && history.slope(t) == 0.0;
                assert!(rests || begin == 0.0, "{first}: {t}");
            }
            // the interpolation reaches 16 samples ahead; tolerance: a few of the 32 fine points
            // per sample
            let expected = (f64::from(first) - 16.0) / rate;
            assert!(
                (begin - expected.max(0.0)).abs() < 0.2 / rate,
                "{first}: {begin}"
            );
        }
        let rest = SampledHistory::new(&[0.0; 80], rate).unwrap();
        assert!(rest.begin() <= rest.end());
    }

    #[test]
    fn the_samples_themselves_are_kept() {
        let samples = [0.0, 0.3, -1.0, 2.0, 0.5, 0.1];
        let history = SampledHistory::new(&samples, 10.0).unwrap();
        for (k, expected) in samples.iter().enumerate() {
            // the sinc vanishes at the other samples to rounding
            let found = history.at(f64::from(u8::try_from(k).unwrap()) / 10.0);
            assert!((found - expected).abs() < 1e-14, "{k}: {found} {expected}");
        }
    }

    /// Compares the fine points with direct sums over 16 samples to either side; the record is zero
    /// before its start and point-symmetric about its end.
    #[test]
    fn fine_points_have_the_digits_of_their_definition() {
        for count in [4_i32, 5, 17, 40] {
            let samples: Vec<f64> = (0..count).map(|k| f64::from(k * k).sin()).collect();
            let history = SampledHistory::new(&samples, 1.0).unwrap();
            let known = |k: i32| usize::try_from(k).ok().and_then(|k| samples.get(k));
            let sample = |k: i32| match known(k) {
                Some(value) => *value,
                None if k < 0 => 0.0,
                None => {
                    2.0 * known(count - 1).unwrap() - known(2 * (count - 1) - k).unwrap_or(&0.0)
                }
            };
            assert_eq!(history.fine.len(), samples.len() * 32 - 32 + 5);
            for (index, found) in (-2..).zip(&history.fine) {
                let (base, phase) = (i32::div_euclid(index, 32), i32::rem_euclid(index, 32));
                let sum: f64 = (-15..=16)
                    .map(|k| {
                        let distance = f64::from(phase) / 32.0 - f64::from(k);
                        windowed_sinc(distance, 16.0, 12.0) * sample(base + k)
                    })
                    .sum();
                assert_eq!(found.to_bits(), sum.to_bits(), "{count}: {index}");
            }
        }
    }

    #[test]
    fn what_is_no_time_has_no_value() {
        let history = SampledHistory::new(&[0.0, 0.3, -1.0, 2.0], 10.0).unwrap();
        assert!(history.at(f64::NAN).is_nan() && history.slope(f64::NAN).is_nan());
        for time in [-1e-300, f64::NEG_INFINITY] {
            assert_eq!(history.at(time).to_bits(), 0, "{time}");
        }
        assert!(history.at(f64::INFINITY).is_finite());
    }

    #[test]
    fn recorder_passes_and_stops_as_stated() {
        let recorder = Recorder {
            rate_hz: 51_200.0,
            cutoff_hz: 16_000.0,
        };
        let step = 1.0 / (51_200.0 * 20.0);
        // a cosine whose crest is at the time of evaluation: the filtered value there is the gain
        let crest = 2000.0 * step;
        let gain = |f: f64| {
            let history: Vec<f64> = (0..4000)
                .map(|k| (TAU * f * (f64::from(k) * step - crest)).cos())
                .collect();
            recorder.filtered(&history, step, crest)
        };
        let margin = 0.08 * recorder.rate_hz;
        for f in [0.0, 3_000.0, 8_000.0, recorder.cutoff_hz - margin] {
            assert!((gain(f) - 1.0).abs() < 1e-4, "{f} Hz: {}", gain(f));
        }
        for f in [recorder.cutoff_hz + margin, 22_000.0, 30_000.0] {
            assert!(gain(f).abs() < 1e-4, "{f} Hz: {}", gain(f));
        }
    }

    #[test]
    fn bad_samples_are_named() {
        assert_eq!(
            SampledHistory::new(&[0.0, 1.0, f64::NAN, 0.0], 1.0)
                .unwrap_err()
                .to_string(),
            "sample 2 of excitation is NaN, expected a finite value"
        );
        assert_eq!(
            SampledHistory::new(&[0.0, 1.0], 1.0)
                .unwrap_err()
                .to_string(),
            "excitation has 2 samples, expected at least 4"
        );
        assert_eq!(
            SampledHistory::new(&[0.0; 8], -1.0)
                .unwrap_err()
                .to_string(),
            "sampling rate [Hz] is -1, expected a finite value above 0"
        );
    }
}

//! The low-pass filter of a recorder, and its effect on a finely sampled history.

use std::fmt;
use std::sync::Arc;

use faer::Mat;
use num_complex::Complex64;
use rodwave::band_limited::Recorder;
use rodwave::fourier::RealFourier;

use crate::error::MaxwellidError;
use crate::vectors::dot;

/// A frequency response h(f), f in Hz.
type Response = Arc<dyn Fn(f64) -> Complex64 + Send + Sync>;

#[derive(Clone)]
enum Kind {
    /// Filter of any kind, given by its response.
    Response(Response),
    /// The zero-phase filter of virtual recorders.
    LinearPhase(Recorder),
}

/// The low-pass filter h of a recorder, through which both histories of a test have passed before
/// they were sampled.
///
/// ```
/// use maxwellid::num_complex::Complex64;
/// use maxwellid::recorder::RecorderFilter;
///
/// // a critically damped filter of second order, 12 kHz
/// let filter = RecorderFilter::new("two poles at 12 kHz", 12e3, |f| {
///     (Complex64::ONE + Complex64::I * f / 12e3).powi(-2)
/// })?;
/// assert_eq!(filter.name(), "two poles at 12 kHz");
/// assert!(RecorderFilter::new("no filter", 12e3, |_| Complex64::ONE).is_err());
/// # Ok::<(), maxwellid::MaxwellidError>(())
/// ```
#[derive(Clone)]
pub struct RecorderFilter {
    name: String,
    cutoff_hz: f64,
    kind: Kind,
}

impl fmt::Debug for RecorderFilter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RecorderFilter")
            .field("name", &self.name)
            .field("cutoff_hz", &self.cutoff_hz)
            .finish_non_exhaustive()
    }
}

/// Largest gain of a filter at four times its cut-off.
const STOPPED: f64 = 0.25;

/// Largest deviation of the gain at frequency 0 from 1 that is accepted as rounding.
const UNIT_GAIN: f64 = 1e-6;

impl RecorderFilter {
    /// Creates a filter of cut-off `cutoff_hz` \[Hz\] from its frequency response at frequencies
    /// above 0, for the time factor e^{iωt}.
    ///
    /// # Errors
    /// [`MaxwellidError::Setting`] for a cut-off that is not finite and above 0, and for a response
    /// that is not 1 at frequency 0 or above a quarter at four times the cut-off.
    pub fn new(
        name: impl Into<String>,
        cutoff_hz: f64,
        response: impl Fn(f64) -> Complex64 + Send + Sync + 'static,
    ) -> Result<Self, MaxwellidError> {
        check_cutoff(cutoff_hz)?;
        let error = (response(0.0) - 1.0).norm();
        if error.is_nan() || error > UNIT_GAIN {
            return Err(MaxwellidError::Setting {
                setting: "gain of the recorder's filter at frequency 0",
                value: response(0.0).norm(),
                expected: "1: a gain belongs to the calibration of the channels",
            });
        }
        let beyond = response(4.0 * cutoff_hz).norm();
        if beyond.is_nan() || beyond > STOPPED {
            return Err(MaxwellidError::Setting {
                setting: "gain of the recorder's filter at four times its cut-off",
                value: beyond,
                expected: "at most 0.25, as for a low-pass filter of second order",
            });
        }
        Ok(Self {
            name: name.into(),
            cutoff_hz,
            kind: Kind::Response(Arc::new(response)),
        })
    }

    /// The zero-phase filter of a virtual recorder.
    ///
    /// # Errors
    /// [`MaxwellidError::Setting`] for a cut-off or a sampling rate that is not finite and above 0.
    pub fn linear_phase(recorder: Recorder) -> Result<Self, MaxwellidError> {
        check_cutoff(recorder.cutoff_hz)?;
        if !(recorder.rate_hz.is_finite() && recorder.rate_hz > 0.0) {
            return Err(MaxwellidError::Setting {
                setting: "sampling rate of the recorder [Hz]",
                value: recorder.rate_hz,
                expected: "a finite value above 0",
            });
        }
        Ok(Self {
            name: format!("linear-phase low-pass at {} Hz", recorder.cutoff_hz),
            cutoff_hz: recorder.cutoff_hz,
            kind: Kind::LinearPhase(recorder),
        })
    }

    /// Sets the name.
    #[must_use]
    pub fn named(self, name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            ..self
        }
    }

    /// Name of the filter.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Cut-off \[Hz\].
    #[must_use]
    pub fn cutoff_hz(&self) -> f64 {
        self.cutoff_hz
    }

    /// The filter followed by `gain`, a real function of the frequency \[Hz\].
    pub(crate) fn followed_by(&self, gain: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Self {
        let kind = match &self.kind {
            Kind::Response(response) => {
                let response = Arc::clone(response);
                Kind::Response(Arc::new(move |f| gain(f) * response(f)))
            }
            Kind::LinearPhase(recorder) => {
                let kernel = impulse_of(*recorder, 4.0 * recorder.rate_hz);
                let rate = 4.0 * recorder.rate_hz;
                Kind::Response(Arc::new(move |f| gain(f) * kernel.response(f / rate)))
            }
        };
        Self {
            kind,
            ..self.clone()
        }
    }

    /// The filter for histories at `rate_hz` \[Hz\] with `every` points per sample.
    pub(crate) fn observation(&self, rate_hz: f64, every: usize) -> Observation {
        let kernel = match &self.kind {
            Kind::LinearPhase(recorder) => impulse_of(*recorder, rate_hz),
            Kind::Response(response) => impulse_response(response.as_ref(), rate_hz),
        };
        Observation { every, ..kernel }
    }
}

fn check_cutoff(cutoff_hz: f64) -> Result<(), MaxwellidError> {
    if cutoff_hz.is_finite() && cutoff_hz > 0.0 {
        return Ok(());
    }
    Err(MaxwellidError::Setting {
        setting: "cut-off of the recorder's filter [Hz]",
        value: cutoff_hz,
        expected: "a finite value above 0",
    })
}

/// Number of points of the transform that gives an impulse response, which has some hundred points
/// with its ringing.
const POINTS: usize = 8192;

/// Part of the sum of magnitudes of an impulse response that is cut off at either end.
const CUT_OFF: f64 = 1e-5;

/// Share of half of the rate from which a response fades to zero.
const FADES_FROM: f64 = 0.6;

/// Gain at a frequency given as a share of half of the rate. An abrupt end of the response at half
/// of the rate would cause long ringing.
fn fading(share: f64) -> f64 {
    let beyond = ((share - FADES_FROM) / (1.0 - FADES_FROM)).clamp(0.0, 1.0);
    0.5 + 0.5 * (std::f64::consts::PI * beyond).cos()
}

/// The impulse response of a filter at `rate_hz`, from its lead on.
fn impulse_response(response: &dyn Fn(f64) -> Complex64, rate_hz: f64) -> Observation {
    let mut fourier = RealFourier::new(POINTS);
    for (line, k) in fourier.lines().iter_mut().zip(0_u32..) {
        let share = 2.0 * f64::from(k) / POINTS as f64;
        *line = fading(share) * response(0.5 * rate_hz * share);
    }
    let circular = fourier.inverse();
    // the first value is now that at the time -POINTS/2
    circular.rotate_right(POINTS / 2);
    Observation::of(circular, POINTS / 2)
}

/// The kernel of a linear-phase recorder for histories at `rate_hz`.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a rate is a small multiple of that of the recorder, whose kernel has some tens of samples"
)]
fn impulse_of(recorder: Recorder, rate_hz: f64) -> Observation {
    let step = 1.0 / rate_hz;
    let reach = (recorder.reach() * rate_hz).ceil().min(POINTS as f64) as usize;
    let impulse: Vec<f64> = (0..=reach)
        .map(|k| if k == reach { 1.0 } else { 0.0 })
        .collect();
    let kernel: Vec<f64> = (0..=2 * reach)
        .map(|k| recorder.filtered(&impulse, step, k as f64 * step))
        .collect();
    Observation::of(&kernel, reach)
}

/// Filter and sampler of a history on a grid that is finer than the samples.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Observation {
    /// Impulse response per point of the grid; the sum is 1.
    kernel: Vec<f64>,
    /// Impulse response in reverse order, which is the order of the history.
    oldest_first: Vec<f64>,
    /// Index in `kernel` of time 0: points by which the filter looks ahead.
    lead: usize,
    /// Points of the grid per sample.
    every: usize,
}

impl Observation {
    /// Returns the observation without a filter: the samples are every `every`-th point of the
    /// grid.
    pub(crate) fn direct(every: usize) -> Self {
        Self {
            kernel: vec![1.0],
            oldest_first: vec![1.0],
            lead: 0,
            every,
        }
    }

    /// Creates the observation with a `kernel` whose time 0 is at `origin`, without the ends that
    /// are less than [`CUT_OFF`] of it, and with unit gain at frequency 0.
    fn of(kernel: &[f64], origin: usize) -> Self {
        let total: f64 = kernel.iter().map(|g| g.abs()).sum();
        let cut = |magnitudes: &mut dyn Iterator<Item = &f64>| {
            let mut sum = 0.0;
            magnitudes
                .take_while(|g| {
                    sum += g.abs();
                    sum < CUT_OFF * total
                })
                .count()
        };
        let first = cut(&mut kernel.iter()).min(origin);
        let last = kernel.len() - cut(&mut kernel.iter().rev());
        let kept = kernel.get(first..last.max(origin + 1)).unwrap_or(kernel);
        let sum: f64 = kept.iter().sum();
        let kernel: Vec<f64> = kept.iter().map(|g| g / sum).collect();
        Self {
            oldest_first: kernel.iter().rev().copied().collect(),
            kernel,
            lead: origin - first,
            every: 1,
        }
    }

    /// Frequency response at `frequency`, a fraction of the rate of the grid.
    fn response(&self, frequency: f64) -> Complex64 {
        let terms = self.kernel.iter().zip(0_u32..);
        terms
            .map(|(g, k)| {
                let lag = f64::from(k) - self.lead as f64;
                g * Complex64::cis(-std::f64::consts::TAU * frequency * lag)
            })
            .sum()
    }

    /// Points of the grid per sample.
    pub(crate) fn every(&self) -> usize {
        self.every
    }

    /// Points by which the filter looks ahead.
    pub(crate) fn lead(&self) -> usize {
        self.lead
    }

    /// Returns this filter with `every` points per sample.
    pub(crate) fn with_every(&self, every: usize) -> Self {
        Self {
            every: every.max(1),
            ..self.clone()
        }
    }

    /// Delay of the filter at frequency 0, in points; 0 if it is negative.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "within the kernel"
    )]
    pub(crate) fn delay(&self) -> usize {
        let terms = self.kernel.iter().enumerate();
        let moment: f64 = terms.map(|(k, g)| g * k as f64).sum();
        (moment - self.lead as f64).round().max(0.0) as usize
    }

    /// Returns the first `count` points of the filtered history 1 - `memory`^(n + 1), n >= 0,
    /// starting at point -lead.
    pub(crate) fn of_step(&self, memory: f64, count: usize) -> Vec<f64> {
        let (mut sum, mut rest) = (0.0, 0.0);
        let kernel = self.kernel.iter().copied().chain(std::iter::repeat(0.0));
        kernel
            .take(count)
            .map(|g| {
                sum += g;
                rest = memory * (rest + g);
                sum - rest
            })
            .collect()
    }

    /// Number of points of the grid, from time 0 on, that `samples` samples need.
    pub(crate) fn points(&self, samples: usize) -> usize {
        samples.saturating_sub(1) * self.every + 1 + self.lead
    }

    /// Returns the samples of `history`, which is at rest before its first point; [`Self::points`]
    /// is the length of history that a number of samples needs.
    pub(crate) fn of_history(&self, history: &[f64]) -> Vec<f64> {
        let count = match history.len().checked_sub(1 + self.lead) {
            Some(points) => points / self.every + 1,
            None => 0,
        };
        (0..count)
            .map(|sample| {
                // entry l of the kernel belongs to the point `newest - l`
                let newest = sample * self.every + self.lead;
                let known = history.get(..=newest).unwrap_or(history);
                let count = known.len().min(self.kernel.len());
                let newest = known.get(known.len() - count..).unwrap_or_default();
                let shown = self.oldest_first.get(self.kernel.len() - count..);
                dot(newest, shown.unwrap_or_default())
            })
            .collect()
    }

    /// Returns the covariance G P Gᵀ of the samples for a covariance P of the points.
    pub(crate) fn of_covariance(&self, covariance: &Mat<f64>) -> Mat<f64> {
        let columns = 0..covariance.ncols();
        let rows: Vec<Vec<f64>> = columns
            .map(|column| self.of_history(covariance.col_as_slice(column)))
            .collect();
        let samples = rows.first().map_or(0, Vec::len);
        let columns: Vec<Vec<f64>> = (0..samples)
            .map(|sample| {
                let across: Vec<f64> = rows
                    .iter()
                    .map(|row| row.get(sample).copied().unwrap_or(0.0))
                    .collect();
                self.of_history(&across)
            })
            .collect();
        Mat::from_fn(samples, samples, |i, k| {
            let own = columns.get(k).and_then(|column| column.get(i));
            own.copied().unwrap_or(0.0)
        })
    }

    /// Returns this filter followed by a symmetric filter of the samples with the weights `taps`,
    /// after which every `keep`-th sample is kept.
    pub(crate) fn followed_by(&self, taps: &[f64], keep: usize) -> Self {
        let reach = taps.len() / 2;
        let mut kernel = vec![0.0; self.kernel.len() + (taps.len().max(1) - 1) * self.every];
        for (j, tap) in taps.iter().enumerate() {
            let own = kernel.iter_mut().skip(j * self.every);
            for (sum, g) in own.zip(&self.kernel) {
                *sum += tap * g;
            }
        }
        Self {
            oldest_first: kernel.iter().rev().copied().collect(),
            kernel,
            lead: self.lead + reach * self.every,
            every: self.every * keep,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE: f64 = 204_800.0;

    /// Two equal poles: h = (1 + i f/f_c)⁻², impulse response a² t e^{-at}, a = 2π f_c.
    fn two_poles(cutoff: f64) -> RecorderFilter {
        RecorderFilter::new("two poles", cutoff, move |f| {
            (Complex64::ONE + Complex64::I * f / cutoff).powi(-2)
        })
        .unwrap()
    }

    fn linear_phase(cutoff: f64) -> RecorderFilter {
        RecorderFilter::linear_phase(Recorder {
            rate_hz: RATE / 4.0,
            cutoff_hz: cutoff,
        })
        .unwrap()
    }

    /// Gain and phase of an observation at `frequency`, from one sample of a filtered cosine and of
    /// a filtered sine, away from the ends.
    fn measured(observation: &Observation, frequency: f64) -> Complex64 {
        let history = |phase: f64| -> Vec<f64> {
            (0..6000)
                .map(|k| (std::f64::consts::TAU * frequency * f64::from(k) / RATE + phase).cos())
                .collect()
        };
        let sample = 300;
        let at = |phase: f64| observation.of_history(&history(phase))[sample];
        let time = (sample * observation.every()) as f64 / RATE;
        let turn = Complex64::cis(-std::f64::consts::TAU * frequency * time);
        Complex64::new(at(0.0), at(-std::f64::consts::FRAC_PI_2)) * turn
    }

    #[test]
    fn gain_and_phase_are_those_of_the_filter() {
        for frequency in [500.0, 4e3, 10e3] {
            let expected = (Complex64::ONE + Complex64::I * frequency / 5e3).powi(-2);
            let found = measured(&two_poles(5e3).observation(RATE, 4), frequency);
            // tolerance: 1e-5 of the impulse response is cut off at either end
            assert!(
                (found - expected).norm() < 1e-4,
                "{frequency}: {found} {expected}"
            );
            let found = measured(&linear_phase(16e3).observation(RATE, 4), frequency);
            // tolerance: the pass band of the recorder is flat to 1e-4
            assert!((found - 1.0).norm() < 3e-4, "{frequency}: {found}");
        }
        let stopped = measured(&linear_phase(16e3).observation(RATE, 4), 21e3);
        assert!(stopped.norm() < 3e-4, "{stopped}");
    }

    /// Checks the product of gains with a moving mean of three samples, whose gain is (1 + 2 cos
    /// ωT)/3.
    #[test]
    fn two_filters_in_turn_have_the_product_of_their_gains() {
        let mean = [1.0 / 3.0; 3];
        for filter in [two_poles(5e3), linear_phase(16e3)] {
            let one = filter.observation(RATE, 4);
            let both = one.followed_by(&mean, 2);
            assert_eq!(both.every(), 8);
            for frequency in [500.0, 6e3] {
                let turn = std::f64::consts::TAU * frequency * 4.0 / RATE;
                let expected = measured(&one, frequency) * (1.0 + 2.0 * turn.cos()) / 3.0;
                let found = measured(&both, frequency);
                // tolerance: rounding, because both are sums of the same terms
                assert!((found - expected).norm() < 1e-12, "{found} {expected}");
            }
        }
        let gain = |f: f64| 0.5 + 0.5 * (-f / 1e4).exp();
        let weaker = two_poles(5e3).followed_by(gain).observation(RATE, 4);
        let expected = measured(&two_poles(5e3).observation(RATE, 4), 4e3) * gain(4e3);
        assert!((measured(&weaker, 4e3) - expected).norm() < 1e-4);
        // the ringing of a response that fades to zero is short
        assert!(two_poles(16e3).observation(RATE, 4).lead() < 60);
    }

    #[test]
    fn a_covariance_is_that_of_filtered_draws() {
        let seen = two_poles(20e3).observation(RATE, 2);
        let points = seen.points(12);
        // a covariance of rank two
        let roots: Vec<Vec<f64>> = [0.3, 0.07]
            .map(|w: f64| (0..points).map(|k| (w * k as f64).sin()).collect())
            .to_vec();
        let covariance = Mat::from_fn(points, points, |i, k| {
            roots.iter().map(|root| root[i] * root[k]).sum::<f64>()
        });
        let found = seen.of_covariance(&covariance);
        let filtered: Vec<Vec<f64>> = roots.iter().map(|root| seen.of_history(root)).collect();
        assert_eq!(found.nrows(), 12);
        for i in 0..12 {
            for k in 0..12 {
                let expected: f64 = filtered.iter().map(|root| root[i] * root[k]).sum();
                assert!((found[(i, k)] - expected).abs() < 1e-12);
            }
        }
    }
}

//! A pulse after a silence, and the windows of the pulse and of its echo.

use std::ops::Range;

use crate::error::{check_enough_samples, check_positive, too_few_samples};
use crate::hits::Extent;
use crate::{LabioError, LevelAtRest, Record};

/// Fraction of the peak above which a sample belongs to the pulse.
const OF_PULSE: f64 = 0.02;
/// Fraction of the peak beyond which a sample of the other sign belongs to the echo.
const OF_ECHO: f64 = 0.05;
/// Number of standard deviations of the noise above which a sample does not count as noise.
const NO_NOISE: f64 = 8.0;
/// Fewest samples of a silence.
const FEWEST_SILENT: usize = 16;
/// Shortest rest of the channel between pulse and echo, as a fraction of the time from front to
/// front.
const QUIET: f64 = 0.03;
/// Largest relative difference of the delay of an echo from the expected delay.
const DELAY: f64 = 0.25;
/// Part of the time to the next wave that the window of an echo may last.
const UNTIL_NEXT: f64 = 0.9;

/// A pulse in one channel, after a silence.
///
/// A sample belongs to the pulse if it exceeds 2 % of the peak, and eight standard deviations of
/// the noise in the first half of the silence, from whose mean all samples are counted: in the
/// second half a pulse may begin if the silence was stated too long.
///
/// ```
/// use labio::ratio::Pulse;
/// use labio::{Channel, Provenance, Quantity, Record};
/// use ndarray::Array2;
///
/// // half a sine of 40 samples, and its reflection from a free end 100 samples later
/// let samples = Array2::from_shape_fn((1, 400), |(_, n)| {
///     let sine = |from: usize| (std::f64::consts::PI * (n - from) as f64 / 40.0).sin();
///     match n {
///         100..140 => sine(100),
///         200..240 => -0.8 * sine(200),
///         _ => 0.0,
///     }
/// });
/// let channels = vec![Channel::new("gauge", Quantity::Strain)?];
/// let shot = Record::new(samples, 1e5, 0.0, channels, Provenance::computed("example"))?;
/// let pulse = Pulse::after_silence(&shot, "gauge", 90)?;
/// assert_eq!(pulse.first_sample, 101);
/// // expected after about 1.1 ms, and the next wave at twice this time after the reflection
/// let [incident, reflected] = pulse.echo_windows(1.1e-3, 2.0)?;
/// assert!(incident.start < 101 && incident.end > 139);
/// assert_eq!(reflected, incident.start + 100..incident.end + 100);
/// # Ok::<(), labio::LabioError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Pulse {
    /// Samples minus the level at rest, in the unit of the channel.
    pub history: Vec<f64>,
    /// First sample of the pulse.
    pub first_sample: usize,
    /// Absolute value above which a sample belongs to the pulse.
    threshold: f64,
    rate_hz: f64,
}

impl Pulse {
    /// Finds the pulse in a `channel` of a record that begins with `n_silent` samples at rest.
    ///
    /// # Errors
    ///
    /// [`LabioError::TooFewSamples`] for a silence of fewer than 16 samples or a record that ends
    /// with it, [`LabioError::SilenceEnds`] if the pulse begins in it,
    /// [`LabioError::NoisySilence`] if its noise exceeds 2 % of the peak or all samples are equal,
    /// [`LabioError::UnknownChannel`].
    pub fn after_silence(
        record: &Record,
        channel: &str,
        n_silent: usize,
    ) -> Result<Self, LabioError> {
        let rate_hz = record.sampling_rate_hz();
        let samples = record.channel(channel)?.to_vec();
        let what = "the record of a pulse after a silence";
        check_enough_samples(what, samples.len(), n_silent.saturating_add(1))?;
        let rest = samples.iter().copied().take(n_silent / 2);
        let rest = LevelAtRest::of(rest).filter(|_| n_silent >= FEWEST_SILENT);
        let Some(LevelAtRest { level, noise, .. }) = rest else {
            return too_few_samples("the silence before a pulse", n_silent, FEWEST_SILENT);
        };
        let history: Vec<f64> = samples.iter().map(|x| x - level).collect();
        let peak = history.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let threshold = (OF_PULSE * peak).max(NO_NOISE * noise);
        let first = history.iter().position(|x| x.abs() > threshold);
        match first.filter(|_| noise <= OF_PULSE * peak) {
            None => Err(LabioError::NoisySilence { noise, peak }),
            Some(first) if first < n_silent => Err(LabioError::SilenceEnds {
                found: first as f64 / rate_hz,
                stated: n_silent as f64 / rate_hz,
            }),
            Some(first_sample) => Ok(Self {
                history,
                first_sample,
                threshold,
                rate_hz,
            }),
        }
    }

    /// Returns the windows of the pulse and of its echo, equally long and with equal margins before
    /// the two fronts. The echo is the next pulse of the opposite sign, such as the strain that
    /// returns from a free end. `delay` \[s\] is its expected delay, known within 25 %, and `next`
    /// the time from its front to the front of the next wave, divided by its delay.
    ///
    /// The channel must rest between pulse and echo for at least 3 % of the delay, and a quarter of
    /// this rest is the margin. The windows last as long as the delay, but not longer than 90 % of
    /// the time to the next wave.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] unless delay and next wave are finite and above 0;
    /// [`LabioError::NoEcho`]; [`LabioError::EchoOverlaps`] without a rest or with another delay;
    /// [`LabioError::EchoOvertaken`] if the pulse lasts until the next wave;
    /// [`LabioError::EchoCut`] if the record ends before the second window does.
    pub fn echo_windows(&self, delay: f64, next: f64) -> Result<[Range<usize>; 2], LabioError> {
        check_positive("expected delay of an echo [s]", delay)?;
        check_positive("time to the next wave, in delays of the echo,", next)?;
        let first = self.first_sample;
        let n_samples = self.history.len();
        let seconds = |samples: usize| samples as f64 / self.rate_hz;
        let cut = |expected: f64| LabioError::EchoCut {
            found: seconds(n_samples),
            expected,
        };
        let Some((end, front)) = self.end_and_echo() else {
            let due = seconds(first) + (1.0 + DELAY) * delay;
            return Err(if seconds(n_samples) < due {
                cut(due)
            } else {
                LabioError::NoEcho { expected: delay }
            });
        };
        let apart = front - first;
        let quiet = front - end;
        if (quiet as f64) < QUIET * apart as f64 || (seconds(apart) / delay - 1.0).abs() > DELAY {
            return Err(LabioError::EchoOverlaps {
                pulse: seconds(end - first),
                delay: seconds(apart),
                expected: delay,
            });
        }
        let until_next = UNTIL_NEXT * apart as f64 * next / self.rate_hz;
        let margin = quiet / 4;
        // a wave so late that its time is no number of samples does not limit the windows
        let until = Extent::Seconds(until_next).samples(self.rate_hz);
        let length = until.map_or(apart, |until| until.min(apart));
        let (from, back) = (first.saturating_sub(margin), front.saturating_sub(margin));
        if end + margin >= from + length {
            return Err(LabioError::EchoOvertaken {
                pulse: seconds(end - first),
                next: until_next,
            });
        }
        if back + length >= n_samples {
            return Err(cut(seconds(back + length)));
        }
        Ok([from..from + length, back..back + length])
    }

    /// Returns the first sample after the pulse, and the first sample of the echo; `None` if no
    /// sample of the other sign follows.
    fn end_and_echo(&self) -> Option<(usize, usize)> {
        let behind = self.history.get(self.first_sample..)?;
        let sign = behind.first()?.signum();
        let is_back = |x: &f64| sign * x < -OF_ECHO / OF_PULSE * self.threshold;
        let back = behind.iter().position(is_back)?;
        let is_quiet = |x: &f64| x.abs() <= self.threshold;
        let mut before = behind.iter().take(back);
        let front = before.rposition(is_quiet).map_or(0, |quiet| quiet + 1);
        let mut pulse = behind.iter().take(front);
        let end = pulse.rposition(|x| !is_quiet(x)).map_or(0, |last| last + 1);
        Some((self.first_sample + end, self.first_sample + front))
    }
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::*;
    use crate::Quantity;

    const RATE_HZ: f64 = 1e5;

    fn shot(samples: Vec<f64>) -> Record {
        let samples = Array2::from_shape_vec((1, samples.len()), samples).unwrap();
        Record::of_test(samples, RATE_HZ, &[("gauge", Quantity::Strain)])
    }

    /// A pulse of 1 in the samples 100 to 139, and its echo of -1 from the sample `echo` on, in
    /// `n` samples.
    fn pulse_and_echo(n: usize, echo: usize) -> Result<Pulse, LabioError> {
        let sample = |at: usize| match at {
            100..140 => 1.0,
            _ if (echo..echo + 40).contains(&at) => -1.0,
            _ => 0.0,
        };
        Pulse::after_silence(&shot((0..n).map(sample).collect()), "gauge", 100)
    }

    fn windows(n: usize, echo: usize, delay: f64, next: f64) -> Result<[Range<usize>; 2], String> {
        let found = pulse_and_echo(n, echo).unwrap().echo_windows(delay, next);
        found.map_err(|error| error.to_string())
    }

    #[test]
    fn windows_are_equal_and_end_before_the_next_wave() {
        // a rest of 60 samples, hence a margin of 15; windows as long as the delay of 100 samples
        assert_eq!(windows(400, 200, 1e-3, 9.0), Ok([85..185, 185..285]));
        // windows of 90 % of the 80 samples to the next wave
        assert_eq!(windows(400, 200, 1.2e-3, 0.8), Ok([85..157, 185..257]));
    }

    #[test]
    fn echoes_that_cannot_be_cut_out_are_refused() {
        for (found, expected) in [
            (
                windows(400, 200, 1.5e-3, 9.0),
                "a pulse lasts 4.000e-4 s and changes sign 1.000e-3 s after its front, expected a rest of the channel and an echo after 1.500e-3 s",
            ),
            (
                windows(400, 142, 4e-4, 9.0),
                "", // a rest of 2 samples of 42 suffices
            ),
            (
                windows(400, 141, 4.1e-4, 9.0),
                "a pulse lasts 4.000e-4 s and changes sign 4.100e-4 s after its front, expected a rest of the channel and an echo after 4.100e-4 s",
            ),
            (
                windows(400, 400, 1e-3, 9.0),
                "no pulse of the opposite sign follows a pulse, expected one after 1.000e-3 s",
            ),
            (
                windows(180, 400, 1e-3, 9.0),
                "the record lasts 1.800e-3 s, expected 2.250e-3 s up to the end of an echo",
            ),
            (
                windows(280, 200, 1e-3, 9.0),
                "the record lasts 2.800e-3 s, expected 2.850e-3 s up to the end of an echo",
            ),
            (
                windows(400, 200, 1e-3, 0.7),
                "the window of an echo may last 6.300e-4 s before the next wave, expected more than the pulse of 4.000e-4 s with its margins",
            ),
            (
                windows(400, 200, f64::NAN, 9.0),
                "expected delay of an echo [s] is NaN, expected a finite value above 0",
            ),
        ] {
            let found = found.err().unwrap_or_default();
            assert_eq!(found, expected);
        }
    }

    #[test]
    fn a_silence_must_be_silent_and_long_enough() {
        let refused = |samples: Vec<f64>, n_silent: usize| {
            let found = Pulse::after_silence(&shot(samples), "gauge", n_silent);
            found.unwrap_err().to_string()
        };
        let step = |from: usize| (0..400).map(|n| if n < from { 0.0 } else { 2.0 }).collect();
        let noisy = (0..400).map(|n| if n % 2 == 0 { 1.0 } else { -1.0 });
        for (found, expected) in [
            (
                refused(step(100), 15),
                "the silence before a pulse has 15 samples, expected at least 16",
            ),
            (
                refused(step(100), 400),
                "the record of a pulse after a silence has 400 samples, expected at least 401",
            ),
            (
                refused(step(90), 100),
                "a pulse begins after 9.000e-4 s, expected a silence of 1.000e-3 s before it",
            ),
            (
                refused(noisy.collect(), 100),
                "the noise in the silence before a pulse is 1.000e0, expected at most 2 % of the largest sample, 1.000e0",
            ),
            (
                refused(vec![3.0; 400], 100),
                "the noise in the silence before a pulse is 0.000e0, expected at most 2 % of the largest sample, 0.000e0",
            ),
        ] {
            assert_eq!(found, expected);
        }
        let last = refused(step(100), usize::MAX);
        assert!(
            last.ends_with(&format!("at least {}", usize::MAX)),
            "{last}"
        );
    }
}

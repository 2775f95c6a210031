//! Hits whose record ends while the body rings: the damping that their transform needs, and the
//! sample from which it starts.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::RestNoise;
use crate::error::check_enough_samples;
use crate::{AddedDamping, LabioError, Record};

/// Number of equal parts of a hit, the last of which must be quiet if the body is at rest.
const TAIL: usize = 16;
/// Fewest samples in the last part.
const LEAST_TAIL: usize = 8;
/// Largest excursion of white noise in a record, in root-mean-square values of the silence.
const NO_NOISE: f64 = 6.0;
/// Ratio of remainder to peak that counts as rest, as in the [criteria](crate::hits::Criteria) for
/// hits.
const AT_REST: f64 = 0.01;
/// Largest effect of the motion that is cut off at the end on the lowest line, divided by the noise
/// of this line.
const PART_OF_NOISE: f64 = 0.3;
/// Multiples of [`EXPONENT_STEP`] that are tried as σT: at the end, the window has fallen to a
/// weight of e^-2 to e^-16.
const EXPONENTS: std::ops::RangeInclusive<u32> = 4..=32;
const EXPONENT_STEP: f64 = 0.5;

/// Returns the exponential window, the same for all `hits`, that is needed because the hits end
/// while `channels` ring. `None` if all channels have come to rest: in the last sixteenth of the
/// hit, a channel is within a hundredth of its peak, within twice the largest excursion in the
/// silence or within six times the root-mean-square value of the silence, and its mean there is too
/// small to change the lowest line, unlike the creep after a long pulse. In addition, the channels
/// must have been quiet for at least as long as the longest pause between two of their motions,
/// because in a long bar a wave that has passed a gauge is on its way back to it. With several
/// channels, this is not required if the channel that moved first was also the last to move.
///
/// The decay rate σ of the window is the smallest of a series of values for which the effect of the
/// motion cut off at the end, $`|x(T)|e^{-\sigma T}/|s|`$ with $`s = \sigma + i\omega`$, is at most
/// three tenths of the noise that the window leaves at `lowest_hz`, or the largest of these values
/// if none suffices. T counts from the end of the first `n_silent` samples ([`from_rest`]).
///
/// # Errors
///
/// [`LabioError::UnknownChannel`]; the errors of [`RestNoise::before`].
pub fn damping_of_ringing(
    hits: &[&Record],
    channels: &[&str],
    n_silent: usize,
    lowest_hz: f64,
) -> Result<Option<AddedDamping>, LabioError> {
    let noise = channels
        .iter()
        .map(|channel| RestNoise::before(hits, channel, n_silent))
        .collect::<Result<Vec<_>, _>>()?;
    let mut needed: Option<f64> = None;
    for hit in hits {
        let motions = channels
            .iter()
            .map(|channel| Ok(Motion::of(&hit.channel(channel)?.to_vec(), n_silent)))
            .collect::<Result<Vec<_>, LabioError>>()?;
        let pause_counts = !has_left(&motions);
        let left = hit.n_samples().saturating_sub(n_silent);
        let duration = left as f64 / hit.sampling_rate_hz();
        for (motion, noise) in motions.iter().zip(&noise) {
            let Some(motion) = motion else { continue };
            let density = noise.density_at(lowest_hz);
            let end = if motion.goes_on(pause_counts) {
                motion.at_end
            } else if is_above_noise(motion.level, density, duration, lowest_hz) {
                motion.level
            } else {
                continue;
            };
            let own = decay_rate(end, density, duration, lowest_hz);
            needed = Some(needed.map_or(own, |rate| rate.max(own)));
        }
    }
    needed.map(AddedDamping::new).transpose()
}

/// Motion of a channel during a hit, in samples after the silence.
struct Motion {
    first: usize,
    last: usize,
    /// Longest time between two motions.
    longest_pause: usize,
    /// Time after the last motion.
    quiet: usize,
    /// Number of samples that must be quiet at the end.
    n_tail: usize,
    /// Largest excursion in the last `n_tail` samples or, if they are quiet, in the last samples
    /// over the length of the longest pause.
    at_end: f64,
    /// Distance of the mean of the last `n_tail` samples from the level before the hit, for example
    /// due to creep; 0 if it may be chance.
    level: f64,
}

impl Motion {
    /// Returns the motion of a channel; `None` if there is none.
    fn of(samples: &[f64], n_silent: usize) -> Option<Self> {
        let (silence, hit) = samples.split_at(n_silent.min(samples.len()));
        let level = silence.iter().sum::<f64>() / n_silent as f64;
        let from_level = |x: &f64| (x - level).abs();
        let largest = |part: &[f64]| part.iter().map(from_level).fold(0.0, f64::max);
        let square: f64 = silence.iter().map(|x| (x - level).powi(2)).sum();
        let noise = (square / n_silent as f64).sqrt();
        let at_rest = (AT_REST * largest(samples))
            .max(2.0 * largest(silence))
            .max(NO_NOISE * noise);

        let mut moving = (0..).zip(hit).filter(|(_, x)| from_level(x) > at_rest);
        let (first, _) = moving.next()?;
        let (mut last, mut longest_pause) = (first, 0);
        for (at, _) in moving {
            longest_pause = longest_pause.max(at - last - 1);
            last = at;
        }
        let quiet = hit.len() - 1 - last;
        let n_tail = (samples.len() / TAIL).max(LEAST_TAIL);
        let n_end = if quiet < n_tail {
            n_tail
        } else {
            longest_pause
        };
        let tail = |n: usize| hit.get(hit.len().saturating_sub(n)..).unwrap_or(hit);
        let mean = tail(n_tail).iter().map(|x| x - level).sum::<f64>() / n_tail as f64;
        let chance = noise * (1.0 / n_tail as f64 + 1.0 / n_silent as f64).sqrt();
        Some(Self {
            first,
            last,
            longest_pause,
            quiet,
            n_tail,
            at_end: largest(tail(n_end)),
            level: if mean.abs() > NO_NOISE * chance {
                mean.abs()
            } else {
                0.0
            },
        })
    }

    /// Returns true if the motion has not ended; `pause_counts` states whether it may begin again
    /// after a pause as long as the longest pause so far.
    fn goes_on(&self, pause_counts: bool) -> bool {
        let pause = if pause_counts { self.longest_pause } else { 0 };
        self.quiet < self.n_tail.max(pause)
    }
}

/// Returns true if the channel that moved first was also the last to move: the waves have left the
/// sections on the side from which they came, and all sections have seen the same passages.
fn has_left(motions: &[Option<Motion>]) -> bool {
    let moved = || motions.iter().flatten().enumerate();
    let first = moved().min_by_key(|(_, motion)| motion.first);
    let last = moved().max_by_key(|(_, motion)| motion.last);
    first
        .zip(last)
        .is_some_and(|((first, _), (last, _))| first == last && motions.len() > 1)
}

/// Returns true if a level that is cut off at the end changes the lowest line of an undamped hit by
/// more than [`PART_OF_NOISE`] of the noise of this line.
fn is_above_noise(level: f64, density: f64, duration: f64, lowest_hz: f64) -> bool {
    let cut_off = 2.0 * (level / (TAU * lowest_hz)).powi(2);
    cut_off > PART_OF_NOISE * PART_OF_NOISE * density * duration
}

/// Returns σ for a channel that ends at the value `end` and has noise of this one-sided `density`.
fn decay_rate(end: f64, density: f64, duration: f64, lowest_hz: f64) -> f64 {
    let rates = EXPONENTS.map(|step| f64::from(step) * EXPONENT_STEP / duration);
    let suffices = |rate: &f64| {
        // energies of a one-sided line are twice the square of a transform
        let cut_off = 2.0 * (end * (-rate * duration).exp()).powi(2)
            / Complex64::new(*rate, TAU * lowest_hz).norm_sqr();
        cut_off <= PART_OF_NOISE * PART_OF_NOISE * density / (2.0 * rate)
    };
    let most = f64::from(*EXPONENTS.end()) * EXPONENT_STEP / duration;
    rates.clone().find(suffices).unwrap_or(most)
}

/// Returns `hit` from the end of its first `n_silent` samples on, each channel minus its mean in
/// these samples, in calibrated values, for use with an exponential window. Under the window, noise
/// of the silence would have more weight than everything after it.
///
/// # Errors
///
/// [`LabioError::TooFewSamples`] if `n_silent` is 0, or if fewer than two samples follow the
/// silence.
pub fn from_rest(hit: &Record, n_silent: usize) -> Result<Record, LabioError> {
    check_enough_samples("the silence before a hit", n_silent, 1)?;
    let part = hit.part(n_silent.min(hit.n_samples())..hit.n_samples())?;
    let mut samples = part.samples().to_owned();
    for (mut of_channel, whole) in samples.rows_mut().into_iter().zip(hit.samples().rows()) {
        let level = whole.iter().take(n_silent).sum::<f64>() / n_silent as f64;
        of_channel -= level;
    }
    Record::new(
        samples,
        part.sampling_rate_hz(),
        part.start_time(),
        part.channels().to_vec(),
        part.provenance().clone(),
    )
}

impl RestNoise {
    /// Root-mean-square value \[unit s\] of the noise in a line of the one-sided energy spectrum of
    /// a record [from its rest on](from_rest) under an exponential `window`; the record lasts
    /// `duration` \[s\] after `silence` \[s\]:
    ///
    /// ```math
    /// \Bigl[S(f)\frac{1-e^{-2\sigma T}}{2\sigma} + \frac{S(0)}{T_0|s|^2}\Bigr]^{1/2} .
    /// ```
    ///
    /// The second term is caused by the level at rest, which is the mean over the silence $`T_0`$.
    #[must_use]
    pub fn damped_amplitude_at(
        &self,
        frequency_hz: f64,
        window: AddedDamping,
        duration: f64,
        silence: f64,
    ) -> f64 {
        let rate = window.decay_rate();
        let lasting = -(-2.0 * rate * duration).exp_m1() / (2.0 * rate);
        let s = Complex64::new(rate, TAU * frequency_hz);
        let of_level = self.density_at(0.0) / (silence * s.norm_sqr());
        (self.density_at(frequency_hz) * lasting + of_level).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AveragedSpectra, Quantity, SpectrumAverager, Window};
    use ndarray::Array2;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn record(samples: Vec<f64>) -> Record {
        let samples = Array2::from_shape_vec((1, samples.len()), samples).unwrap();
        Record::of_test(samples, 10e3, &[("gauge", Quantity::Strain)])
    }

    fn spectra(hit: &Record, window: AddedDamping) -> AveragedSpectra {
        let mut averager = SpectrumAverager::for_records_like(hit, Window::Rectangular)
            .and_then(|averager| averager.with_exponential_window(window))
            .unwrap();
        averager.add(hit).unwrap();
        averager.spectra().unwrap()
    }

    /// A decaying sine with an offset, cut off at 0.4 of its peak: its damped transform is that of
    /// the endless sine, a geometric series.
    #[test]
    fn what_is_cut_off_is_below_the_noise() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let (beta, omega, n_silent) = (9.0, 4000.0, 500);
        let samples = (0..1500).map(|n| {
            let t = (n as f64 - n_silent as f64) / 10e3;
            let ringing = if t < 0.0 {
                0.0
            } else {
                (-beta * t).exp() * (omega * t).sin()
            };
            2.0 + ringing + 1e-3 * (random.random::<f64>() - 0.5)
        });
        let hit = record(samples.collect());
        let window = damping_of_ringing(&[&hit], &["gauge"], n_silent, 50.0)
            .unwrap()
            .unwrap();
        let noise = RestNoise::before(&[&hit], "gauge", n_silent).unwrap();
        let cut = from_rest(&hit, n_silent).unwrap();
        let found = spectra(&cut, window).auto("gauge").unwrap();
        for line in [5, 20, 60, 100] {
            let f = 10.0 * line as f64;
            let s = Complex64::new(window.decay_rate() + beta, TAU * f);
            let (q, turn): (Complex64, f64) = ((-s / 10e3).exp(), omega / 10e3);
            let sum = q * turn.sin() / (1.0 - 2.0 * q * turn.cos() + q * q);
            let exact = 2.0_f64.sqrt() * sum.norm() / 10e3;
            let error = found[line].sqrt() - exact;
            let stated = noise.damped_amplitude_at(f, window, cut.duration(), 0.05);
            assert!(error.abs() < 4.0 * stated, "{f} Hz: {error} {stated}");
        }
    }

    #[test]
    fn a_body_at_rest_needs_no_damping() {
        let samples = (0..2000).map(|n| if (500..700).contains(&n) { 1.0 } else { 0.0 });
        let hit = record(samples.collect());
        assert_eq!(
            damping_of_ringing(&[&hit], &["gauge"], 400, 50.0).unwrap(),
            None
        );
    }

    /// Pulses of 100 samples that begin at `starts` after a silence of 300 samples; the height of
    /// each is 0.8 times that of the previous pulse.
    fn passages(starts: &[usize], n_samples: usize) -> Vec<f64> {
        let mut samples = vec![0.0; n_samples];
        let mut height = 1.0;
        for start in starts {
            let pulse = samples.iter_mut().skip(300 + start).take(100);
            pulse.for_each(|x| *x = height);
            height *= 0.8;
        }
        samples
    }

    #[test]
    fn a_pause_between_passages_is_not_rest() {
        let needs = |n_samples| {
            let hit = record(passages(&[100, 500, 900], n_samples));
            let damping = damping_of_ringing(&[&hit], &["gauge"], 300, 50.0).unwrap();
            damping.is_some()
        };
        // the last passage ends 250 or 350 samples before the end of the record; the pauses between
        // passages last 300 samples
        assert!(needs(1550));
        assert!(!needs(1650));
    }

    /// A bar with two gauges: the pulse passes the first gauge and the second and, on its way back,
    /// the second and the first.
    #[test]
    fn a_wave_that_has_left_all_gauges_leaves_them_at_rest() {
        let needs = |starts: [&[usize]; 2]| {
            let rows = starts.map(|starts| passages(starts, 1550)).concat();
            let samples = Array2::from_shape_vec((2, 1550), rows).unwrap();
            let channels = ["near", "far"].map(|name| (name, Quantity::Strain));
            let hit = Record::of_test(samples, 10e3, &channels);
            let damping = damping_of_ringing(&[&hit], &["near", "far"], 300, 50.0).unwrap();
            damping.is_some()
        };
        assert!(!needs([&[100, 900], &[300, 700]]));
        // the last passage is that of the second gauge: the wave will return to it
        assert!(needs([&[100, 500, 800], &[200, 400, 900]]));
    }

    /// A level of a thousandth of the pulse looks like rest, but it changes the lowest line.
    #[test]
    fn creep_behind_a_pulse_is_not_rest() {
        let needs = |level: f64| {
            let mut random = ChaCha8Rng::seed_from_u64(5);
            let mut samples = passages(&[100], 1550);
            samples.iter_mut().skip(500).for_each(|x| *x = level);
            for x in &mut samples {
                *x += 1e-3 * (random.random::<f64>() - 0.5);
            }
            let hit = record(samples);
            let damping = damping_of_ringing(&[&hit], &["gauge"], 300, 50.0).unwrap();
            damping.is_some()
        };
        assert!(needs(1e-3));
        assert!(!needs(0.0));
    }

    /// White noise in the silence and after it: the mean energy of a line, including the effect of
    /// the subtracted level, is that predicted from the silence.
    #[test]
    fn the_silence_tells_the_noise_under_the_window() {
        let mut random = ChaCha8Rng::seed_from_u64(11);
        let window = AddedDamping::new(150.0).unwrap();
        let n_records = 400;
        let mut sums = [(0.0, 0.0); 3];
        for _ in 0..n_records {
            let samples = (0..1200).map(|_| random.random::<f64>() - 0.5);
            let hit = record(samples.collect());
            let noise = RestNoise::before(&[&hit], "gauge", 200).unwrap();
            let cut = from_rest(&hit, 200).unwrap();
            let found = spectra(&cut, window).auto("gauge").unwrap();
            for (sum, line) in sums.iter_mut().zip([1, 10, 200]) {
                let stated = noise.damped_amplitude_at(10.0 * line as f64, window, 0.1, 0.02);
                sum.0 += found[line] / f64::from(n_records);
                sum.1 += stated * stated / f64::from(n_records);
            }
        }
        for (found, stated) in sums {
            // tolerance: three standard errors, which are 5 % for 400 exponentially distributed
            // energies and 16 % divided by √400 for the silences of 200 samples
            assert!((found / stated - 1.0).abs() < 0.16, "{found} {stated}");
        }
    }
}

//! Hits whose record ends while the body rings: the damping that their transform needs, and the
//! sample from which it starts.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::RestNoise;
use crate::{AddedDamping, LabioError, Record};

/// Number of equal parts of a hit, the last of which shows whether the body rings.
const TAIL: usize = 16;
/// Fewest samples in that part.
const LEAST_TAIL: usize = 8;
/// Ratio of remainder to peak that counts as rest, as in the [criteria](crate::hits::Criteria) for
/// hits.
const AT_REST: f64 = 0.01;
/// Largest effect of the motion cut off at the end on the lowest line, divided by the noise there.
const PART_OF_NOISE: f64 = 0.3;
/// Multiples of [`EXPONENT_STEP`] that are tried as σT: e^-2 to e^-16 is left at the end.
const EXPONENTS: std::ops::RangeInclusive<u32> = 4..=32;
const EXPONENT_STEP: f64 = 0.5;

/// Returns the exponential window that `hits` need because they end while `channels` ring; it is
/// the same for all. `None` if all channels have come to rest: within a hundredth of their peak, or
/// within twice the largest excursion in the silence.
///
/// Its decay rate σ is the smallest of a series of values for which the effect of the motion cut
/// off at the end, $`|x(T)|e^{-\sigma T}/|s|`$ with $`s = \sigma + i\omega`$, is at most three
/// tenths of the noise that the window leaves at `lowest_hz`, or the largest of these values if
/// none suffices. T counts from the end of the first `n_silent` samples ([`from_rest`]).
///
/// # Errors
///
/// [`LabioError::UnknownChannel`], and as for [`RestNoise::before`].
pub fn damping_of_ringing(
    hits: &[&Record],
    channels: &[&str],
    n_silent: usize,
    lowest_hz: f64,
) -> Result<Option<AddedDamping>, LabioError> {
    let mut needed: Option<f64> = None;
    for channel in channels {
        let noise = RestNoise::before(hits, channel, n_silent)?;
        for hit in hits {
            let samples = hit.channel(channel)?;
            let level = samples.iter().take(n_silent).sum::<f64>() / n_silent as f64;
            let from_level = |x: &f64| (x - level).abs();
            let peak = samples.iter().map(from_level).fold(0.0, f64::max);
            let n_tail = (samples.len() / TAIL).max(LEAST_TAIL);
            let tail = samples.iter().rev().take(n_tail).map(from_level);
            let end = tail.fold(0.0, f64::max);
            let rest = samples.iter().take(n_silent).map(from_level);
            let loudest_rest = rest.fold(0.0, f64::max);
            if end <= AT_REST * peak || end <= 2.0 * loudest_rest {
                continue;
            }
            let left = hit.n_samples().saturating_sub(n_silent);
            let duration = left as f64 / hit.sampling_rate_hz();
            let own = decay_rate(end, noise.density_at(lowest_hz), duration, lowest_hz);
            needed = Some(needed.map_or(own, |rate| rate.max(own)));
        }
    }
    needed.map(AddedDamping::new).transpose()
}

/// Returns σ for a channel that is at `end` at its end and has noise of this one-sided `density`.
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
    if n_silent == 0 {
        return Err(LabioError::TooFewSamples {
            what: "the silence before a hit",
            found: 0,
            expected: 1,
        });
    }
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
    use crate::{AveragedSpectra, Channel, Provenance, Quantity, SpectrumAverager, Window};
    use ndarray::Array2;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn record(samples: Vec<f64>) -> Record {
        let samples = Array2::from_shape_vec((1, samples.len()), samples).unwrap();
        let channels = vec![Channel::new("gauge", Quantity::Strain).unwrap()];
        Record::new(samples, 10e3, 0.0, channels, Provenance::computed("test")).unwrap()
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

    /// White noise after white noise: the mean energy of lines, including the effect of the level,
    /// is that predicted from the silence.
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
            // 400 exponentially distributed energies: 5 %, and 16 % from a silence of 200 samples,
            // divided by the root of 400: three times these
            assert!((found / stated - 1.0).abs() < 0.16, "{found} {stated}");
        }
    }
}

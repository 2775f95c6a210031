//! Detection of mains hum on a force.

use std::f64::consts::TAU;

use num_complex::Complex64;

use crate::{LabioError, Record};

/// Harmonics of 50 and 60 Hz \[Hz\], up to the sixth. 300 Hz is a harmonic of both.
const HARMONICS: [f64; 11] = [
    50.0, 100.0, 150.0, 200.0, 250.0, 300.0, 60.0, 120.0, 180.0, 240.0, 360.0,
];
/// Smallest sampling rate \[Hz\] after decimation. At this rate the block means change the
/// amplitude of the highest harmonic by 1 %.
const SLOW_HZ: f64 = 4000.0;
/// Shortest duration of the record after the impact, in periods of the hum.
const PERIODS: f64 = 4.0;
/// Smallest amplitude of a hum, relative to the standard error of an amplitude from noise alone.
const ABOVE_NOISE: f64 = 6.0;
/// Largest change of a hum between the two halves of the time after the impact, relative to the
/// hum. The return of a sensor to zero changes by more.
const STEADY: f64 = 0.5;
/// Fraction of the spectrum of the force above which hum is reported.
const LARGE_PART: f64 = 0.2;

/// Mains hum at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hum {
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// Magnitude of the Fourier sum of the hum divided by that of the whole force at this
    /// frequency, both summed over all hits.
    pub part: f64,
}

/// Returns the harmonics of 50 and 60 Hz, up to the sixth, at which the `force` of the `hits`
/// continues after the impact, if this hum is more than 20 % of the spectrum of the force at this
/// frequency. The frequency response on this line would be the ratio of two hums, with a high
/// coherence.
///
/// The amplitude $`a`$ of the hum is found from N samples in the second half of a hit, an even
/// number of periods, without their mean:
///
/// ```math
/// a = \frac{2}{N}\Big\lvert\sum_n (F_n - \bar F)\,e^{-i\omega n}\Big\rvert ,\qquad
/// \mathrm{part} = \frac{\sum_\mathrm{hits} a N_\mathrm{hit}/2}
/// {\sum_\mathrm{hits}\lvert\sum_n F_n e^{-i\omega n}\rvert} ,
/// ```
///
/// where the last sum is over all $`N_\mathrm{hit}`$ samples of a hit. The amplitude must exceed
/// six times its standard error from noise alone, and may change by at most a half between the two
/// halves of these samples: the return of a sensor to zero changes by more.
///
/// # Validity
///
/// Hits are left out if the force in the second half exceeds a tenth of that in the first, if the
/// second half has fewer than four periods, or if the channel is a motion, which continues after
/// the impact. Fast records are replaced by block means at 4 kHz or more, which changes the
/// amplitude of the highest harmonic by 1 %.
///
/// # Errors
///
/// [`LabioError::UnknownChannel`].
///
/// # Examples
///
/// ```
/// use labio::hits::find_hum;
/// use labio::{Channel, Provenance, Quantity, Record};
/// use ndarray::Array2;
///
/// // an impact of 100 N and 2 ms with a hum of 0.6 N at 50 Hz
/// let samples = Array2::from_shape_fn((1, 8192), |(_, n)| {
///     let omega = 2.0 * std::f64::consts::PI * 50.0 / 8192.0;
///     0.6 * (omega * n as f64).sin() + if (800..816).contains(&n) { 100.0 } else { 0.0 }
/// });
/// let channels = vec![Channel::new("hammer", Quantity::Force)?];
/// let hit = Record::new(samples, 8192.0, 0.0, channels, Provenance::computed("example"))?;
/// let found = find_hum(&[&hit], "hammer")?;
/// assert_eq!((found.len(), found[0].frequency_hz), (1, 50.0));
/// # Ok::<(), labio::LabioError>(())
/// ```
pub fn find_hum(hits: &[&Record], force: &str) -> Result<Vec<Hum>, LabioError> {
    let mut slow: Vec<(Vec<f64>, f64)> = Vec::with_capacity(hits.len());
    for hit in hits {
        let (_, channel) = crate::channel::find(hit.channels(), force)?;
        if channel.quantity().may_be_force() {
            let samples = hit.channel(force)?.to_vec();
            slow.push(decimated(samples, hit.sampling_rate_hz()));
        }
    }
    let mut found = Vec::new();
    for frequency_hz in HARMONICS {
        let (mut hum, mut whole) = (0.0, 0.0);
        for (samples, rate_hz) in slow.iter().filter(|(_, rate)| *rate > 2.0 * frequency_hz) {
            let omega = TAU * frequency_hz / rate_hz;
            let Some(amplitude) = hum_after_blow(samples, omega) else {
                continue;
            };
            hum += 0.5 * amplitude * samples.len() as f64;
            whole += transform(samples.iter(), omega).norm();
        }
        if hum > LARGE_PART * whole {
            found.push(Hum {
                frequency_hz,
                part: hum / whole,
            });
        }
    }
    Ok(found)
}

/// Returns means of blocks of samples, and their sampling rate \[Hz\], which is still far above the
/// tested harmonics.
fn decimated(samples: Vec<f64>, rate_hz: f64) -> (Vec<f64>, f64) {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a ratio of rates, at least 1"
    )]
    let block = (rate_hz / SLOW_HZ).floor().max(1.0) as usize;
    if block == 1 {
        return (samples, rate_hz);
    }
    let blocks = samples.chunks_exact(block);
    let means = blocks.map(|block| block.iter().sum::<f64>() / block.len() as f64);
    (means.collect(), rate_hz / block as f64)
}

/// Returns the amplitude of a vibration at `omega` (in rad per sample) in the second half of a
/// record; `None` if the impact continues into this half, if no steady vibration exceeds the noise,
/// or if the half is too short.
fn hum_after_blow(samples: &[f64], omega: f64) -> Option<f64> {
    let half = samples.len() / 2;
    let largest = |range: std::ops::Range<usize>| {
        let part = samples.iter().skip(range.start).take(range.len());
        part.fold(0.0, |top: f64, x| top.max(x.abs()))
    };
    let is_over = largest(half..samples.len()) < 0.1 * largest(0..half);
    // an even number of periods
    let periods = 2.0 * ((samples.len() - half) as f64 * omega / TAU / 2.0).floor();
    if !is_over || periods < PERIODS {
        return None;
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "whole periods of the second half are at most as long as it"
    )]
    let count = (periods * TAU / omega).round() as usize;
    let tail = || samples.iter().skip(samples.len() - count);
    let mean = tail().sum::<f64>() / count as f64;
    let amplitude_of = |first: usize, length: usize| {
        let part = || tail().skip(first).take(length);
        let line = transform(part(), omega) - mean * transform(part().map(|_| &1.0), omega);
        2.0 * line * Complex64::cis(-omega * first as f64) / length as f64
    };
    let amplitude = amplitude_of(0, count).norm();
    let (first, second) = (
        amplitude_of(0, count / 2),
        amplitude_of(count / 2, count - count / 2),
    );
    let square: f64 = tail().map(|x| (x - mean).powi(2)).sum::<f64>() / count as f64;
    let noise = (square - 0.5 * amplitude * amplitude).max(0.0);
    let is_above_noise = amplitude > ABOVE_NOISE * (2.0 * noise / count as f64).sqrt();
    let is_steady = (first - second).norm() < STEADY * amplitude;
    (is_above_noise && is_steady).then_some(amplitude)
}

/// Returns the Fourier sum at `omega` (in rad per sample).
fn transform<'a>(samples: impl Iterator<Item = &'a f64>, omega: f64) -> Complex64 {
    let each = samples.enumerate();
    each.map(|(n, x)| x * Complex64::cis(-omega * n as f64))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Quantity;
    use testbed::half_sine::half_sine;

    /// 300 Hz is the sixth harmonic of 50 Hz and the fifth of 60 Hz.
    #[test]
    fn hum_is_reported_once_and_only_for_a_force() {
        let found = |quantity| {
            let omega = TAU * 300.0 / 8192.0;
            let samples = ndarray::Array2::from_shape_fn((1, 8192), |(_, n)| {
                let blow = if (800..802).contains(&n) { 100.0 } else { 0.0 };
                blow + (omega * n as f64).sin()
            });
            let hit = Record::of_test(samples, 8192.0, &[("hammer", quantity)]);
            let found = find_hum(&[&hit], "hammer").unwrap();
            found.iter().map(|hum| hum.frequency_hz).collect::<Vec<_>>()
        };
        assert_eq!(found(Quantity::Force), [300.0]);
        assert!(found(Quantity::Acceleration).is_empty());
    }

    /// An impact of 100 N and 2 ms at 8192 Hz, with a hum of 0.6 N at 50 Hz: the Fourier sum of
    /// the impact at 50 Hz is some 1000 N, that of the hum 0.3 N times 8192 samples.
    #[test]
    fn hum_is_found_beside_noise_and_not_in_noise_alone() {
        let blow = |n: usize| 100.0 * half_sine((n as f64 - 800.0) / 16.0);
        let noise = |n: usize| 0.05 * ((n * n * 7919 + n * 104_729) % 1009) as f64 / 1009.0;
        let omega = TAU * 50.0 / 8192.0;
        let with = |hum: f64| -> Vec<f64> {
            (0..8192)
                .map(|n| blow(n) + noise(n) + hum * (omega * n as f64 + 0.4).sin())
                .collect()
        };
        let found = hum_after_blow(&with(0.6), omega).unwrap();
        // the error is due to noise of 0.015 N over 4096 samples
        assert!((found - 0.6).abs() < 2e-3, "{found}");
        assert_eq!(hum_after_blow(&with(0.0), omega), None);
        // a sensor that returns to zero from 5 N with a time constant of 0.1 s
        let mut returning = with(0.0);
        let each = returning.iter_mut().enumerate().skip(800);
        each.for_each(|(n, x)| *x -= 5.0 * (-(n as f64 - 800.0) / 819.2).exp());
        assert_eq!(hum_after_blow(&returning, omega), None);
        // no hum is found if the second half contains fewer than four periods
        assert_eq!(hum_after_blow(&with(0.6)[700..1200], omega), None);
        // the amplitude does not depend on the sampling rate
        let (slow, rate_hz) = decimated(with(0.6), 8192.0);
        let found = hum_after_blow(&slow, TAU * 50.0 / rate_hz).unwrap();
        assert!(
            (rate_hz - 4096.0).abs() < 1e-9 && (found - 0.6).abs() < 2e-3,
            "{found}"
        );
    }
}

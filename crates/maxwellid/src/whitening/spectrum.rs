//! Spectrum of a history that is continued by its mirror image, and the Wiener filter of the
//! excitation.

use num_complex::Complex64;
use rodwave::fourier::RealFourier;

use crate::noise::HistoryNoise;

/// Number of frequencies to either side over which the power of a record is averaged.
pub(super) const SMOOTHED: usize = 5;

/// Ratio of the mean power to the noise power below which a frequency is removed as noise. The mean
/// over eleven lines of pure noise exceeds this ratio in one of ten cases.
const NOISE_POWER: f64 = 1.5;

/// Filters `history` by multiplying each frequency by the fraction of its power that exceeds the
/// noise. The history is continued by its mirror image, which avoids a jump at its ends.
#[allow(
    clippy::indexing_slicing,
    reason = "a range of lines ends with the last"
)]
pub(super) fn wiener_filtered(history: &[f64], noise: &HistoryNoise) -> Vec<f64> {
    let count = history.len();
    if count < 3 {
        return history.to_vec();
    }
    let Mirrored {
        mut fourier,
        spectrum,
        noise,
    } = Mirrored::of(history, noise);
    let last = count - 1;
    for (f, (line, x)) in fourier.lines().iter_mut().zip(&spectrum).enumerate() {
        let (low, high) = (f.saturating_sub(SMOOTHED), (f + SMOOTHED).min(last));
        let squares: f64 = spectrum[low..=high].iter().map(|x| x * x).sum();
        let around = squares / (high - low + 1) as f64;
        let gain = if around > 0.0 {
            (1.0 - NOISE_POWER * noise[f] / around).max(0.0)
        } else {
            1.0
        };
        *line = Complex64::from(gain * x);
    }
    let scale = 1.0 / (2 * last) as f64;
    let filtered = fourier.inverse().iter();
    filtered.take(count).map(|u| scale * u).collect()
}

/// Fourier transform of a history that is continued by its mirror image; the transform is real.
struct Mirrored {
    /// Transform of a period, the history forwards and backwards.
    fourier: RealFourier,
    /// Spectrum with one line per sample, up to half of the sampling rate [m/s].
    spectrum: Vec<f64>,
    /// Expected square of each line of noise alone.
    noise: Vec<f64>,
}

impl Mirrored {
    /// Transforms a history of at least three samples.
    fn of(history: &[f64], noise: &HistoryNoise) -> Self {
        let last = history.len() - 1;
        let period = 2 * last;
        let mut fourier = RealFourier::new(period);
        let back = history.iter().rev().skip(1);
        for (sample, value) in fourier.samples().iter_mut().zip(history.iter().chain(back)) {
            *sample = *value;
        }
        let spectrum = fourier.forward().iter().map(|line| line.re).collect();
        let covariance = (0..=last)
            .map(|lag| noise.autocovariance(lag))
            .take_while(|c| *c != 0.0);
        let samples = fourier.samples();
        samples.fill(0.0);
        for (lag, covariance) in covariance.enumerate() {
            // in a period lag 0 occurs once and every other lag twice, as +lag and -lag
            let behind = (lag > 0).then_some(period - lag);
            for place in [Some(lag), behind].into_iter().flatten() {
                if let Some(sample) = samples.get_mut(place) {
                    *sample += covariance;
                }
            }
        }
        let noise = fourier.forward().iter();
        let noise = noise.map(|line| period as f64 * line.re).collect();
        Self {
            fourier,
            spectrum,
            noise,
        }
    }
}

/// Power of each line of `history`, continued by its mirror image, and the power expected for
/// `noise` alone; the lines are evenly spaced from 0 to half of the sampling rate. Empty for fewer
/// than three samples.
pub(crate) fn mirrored_spectrum(history: &[f64], noise: &HistoryNoise) -> Vec<(f64, f64)> {
    if history.len() < 3 {
        return Vec::new();
    }
    let Mirrored {
        spectrum, noise, ..
    } = Mirrored::of(history, noise);
    spectrum.iter().map(|x| x * x).zip(noise).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_noise_the_filter_passes_everything() {
        let noise = HistoryNoise::White {
            standard_deviation: 0.0,
        };
        let history: Vec<f64> = (0..61_u32)
            .map(|k| f64::from(k * k % 17) + 0.1 * f64::from(k))
            .collect();
        for (a, b) in wiener_filtered(&history, &noise).iter().zip(&history) {
            // tolerance: rounding of two transforms of 61 samples of size 20
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
    }

    #[test]
    fn frequencies_below_the_noise_are_taken_out_and_those_above_kept() {
        let noise = HistoryNoise::White {
            standard_deviation: 0.05,
        };
        let wave = |f: f64, k: u32| (std::f64::consts::PI * f * f64::from(k) / 128.0).cos();
        let history: Vec<f64> = (0..=128)
            .map(|k| wave(8.0, k) + 0.02 * wave(90.0, k))
            .collect();
        for (k, v) in (0..=128).zip(wiener_filtered(&history, &noise)) {
            // tolerance: the power of the wave averaged over 11 lines is 128²/11 = 1490, and the
            // filter subtracts 1.5 · 256 · 0.05² = 0.96 of it
            assert!((v - wave(8.0, k)).abs() < 1e-3, "{k}: {v}");
        }
    }
}

//! Noise of a channel at rest, from the samples before each hit.

use super::averager::{check_same_channel, check_same_rate};
use super::{Detrend, Welch};
use crate::error::{check_enough_samples, too_few_averages};
use crate::quantization::step_above_noise;
use crate::{LabioError, Record, channel};
use std::f64::consts::PI;

/// Greatest length of a transformed segment: noise has no fine structure that a hit of a few
/// thousand samples could resolve.
const LONGEST_SEGMENT: usize = 64;

/// Power spectral density of the noise of one channel, from the silent samples before several hits.
///
/// Segments of at most 64 samples, with their mean removed and a Hann window, are averaged over all
/// hits ([`Welch`]). The density is interpolated between the lines of such a segment; below the
/// third line, it is that of the third line, because mean removal and window reduce the first two.
/// Where the noise is too small to change the output of a converter, the noise of its rounding
/// while the signal moves, step²/12 over all frequencies, is added.
///
/// ```
/// use labio::{Channel, Provenance, Quantity, Record, RestNoise};
/// use ndarray::Array2;
///
/// # fn main() -> Result<(), labio::LabioError> {
/// // samples of alternating sign: all of their power lies at the Nyquist frequency
/// let samples = Array2::from_shape_fn((1, 512), |(_, n)| if n % 2 == 0 { 1.0 } else { -1.0 });
/// let channels = vec![Channel::new("gauge", Quantity::Strain)?];
/// let hit = Record::new(samples, 1000.0, 0.0, channels, Provenance::computed("example"))?;
/// let noise = RestNoise::before(&[&hit], "gauge", 256)?;
/// assert!(noise.density_at(500.0) > 0.01);
/// assert!(noise.density_at(100.0) < 1e-20);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RestNoise {
    step_hz: f64,
    density: Vec<f64>,
    /// Duration of white noise equivalent to the windowed silence of all hits \[s\].
    duration: f64,
    /// Number of independent averages per line.
    averages: f64,
}

impl RestNoise {
    /// Minimum number of silent samples before a hit.
    pub const FEWEST_SAMPLES: usize = 16;

    /// Estimates the noise of the channel called `channel` from the first `n_silent` samples of
    /// each of `hits`.
    ///
    /// # Errors
    ///
    /// [`LabioError::TooFewAverages`] without a hit, [`LabioError::TooFewSamples`] for fewer than
    /// 16 silent samples or a hit with fewer samples than `n_silent`,
    /// [`LabioError::UnknownChannel`], [`LabioError::ChannelMismatch`] or
    /// [`LabioError::SamplingRateMismatch`] for a hit that differs from the first.
    pub fn before(hits: &[&Record], channel: &str, n_silent: usize) -> Result<Self, LabioError> {
        check_enough_samples("the silence before a hit", n_silent, Self::FEWEST_SAMPLES)?;
        let Some(first) = hits.first() else {
            return too_few_averages("the noise before hits", 0, 1);
        };
        let segment = n_silent.min(LONGEST_SEGMENT);
        let welch = Welch::new(segment)?.with_detrend(Detrend::Mean);
        let mut density = vec![0.0; segment / 2 + 1];
        let mut averages = 0.0;
        let (_, measured) = channel::find(first.channels(), channel)?;
        for (index, hit) in hits.iter().enumerate() {
            let (_, found) = channel::find(hit.channels(), channel)?;
            check_same_channel(index, found, measured)?;
            check_same_rate(hit.sampling_rate_hz(), first.sampling_rate_hz())?;
            let spectra = welch.spectra(&hit.part(0..n_silent)?)?;
            averages += spectra.effective_averages();
            let rounding = step_above_noise(hit.channel(channel)?, n_silent)
                .map_or(0.0, |step| step * step / (6.0 * first.sampling_rate_hz()));
            for (sum, value) in density.iter_mut().zip(spectra.power_density(channel)?) {
                *sum += value + rounding;
            }
        }
        for value in &mut density {
            *value /= hits.len() as f64;
        }
        // the removed mean, and the part of it that the window spreads into the first line
        if let [mean, leaked, third, ..] = density.as_mut_slice() {
            (*mean, *leaked) = (*third, *third);
        }
        Ok(Self {
            step_hz: first.sampling_rate_hz() / segment as f64,
            density,
            duration: hits.len() as f64 * samples_left(n_silent, segment)
                / first.sampling_rate_hz(),
            averages,
        })
    }

    /// Degrees of freedom of the density at one frequency: twice the number of independent
    /// segments. The relative standard error of the density is √(2/ν), where ν is this number.
    #[must_use]
    pub fn line_degrees_of_freedom(&self) -> f64 {
        2.0 * self.averages
    }

    /// Degrees of freedom of the mean density over a band of width `bandwidth_hz`: twice the width
    /// times the effective duration of all windowed silences. The relative standard error of that
    /// mean is √(2/ν), where ν is this number.
    #[must_use]
    pub fn degrees_of_freedom(&self, bandwidth_hz: f64) -> f64 {
        2.0 * bandwidth_hz * self.duration
    }

    /// One-sided power spectral density \[unit²/Hz\] at `frequency_hz`, which must be between 0 and
    /// the Nyquist frequency.
    #[must_use]
    #[allow(
        clippy::indexing_slicing,
        reason = "`line` is at most the last but one of the lines, of which 16 silent samples make nine"
    )]
    pub fn density_at(&self, frequency_hz: f64) -> f64 {
        if frequency_hz.is_nan() {
            return f64::NAN;
        }
        let place = (frequency_hz / self.step_hz).max(0.0);
        let last = self.density.len() - 1;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "not negative, and the cast saturates"
        )]
        let line = (place as usize).min(last - 1);
        let fraction = (place - line as f64).min(1.0);
        self.density[line] + fraction * (self.density[line + 1] - self.density[line])
    }

    /// Root-mean-square value \[unit s\] of the noise in a line of the one-sided energy spectrum of
    /// a record of this `duration` \[s\], (density · duration)^½. It can be compared with the
    /// square root of [`AveragedSpectra::auto`](crate::AveragedSpectra::auto).
    #[must_use]
    pub fn amplitude_at(&self, frequency_hz: f64, duration: f64) -> f64 {
        (self.density_at(frequency_hz) * duration).sqrt()
    }
}

/// Returns the number of samples of white noise whose mean square scatters like that of the
/// windowed segments of a silence, (Σg)²/Σg² with the sum g of the squares of all windows. Samples
/// after the last whole segment are not used, and the windows taper towards both ends.
fn samples_left(n_silent: usize, segment: usize) -> f64 {
    let hop = segment - segment / 2;
    let weight = |sample: usize| -> f64 {
        let starts = (0..=n_silent - segment).step_by(hop);
        let over = starts.filter(|start| (*start..start + segment).contains(&sample));
        over.map(|start| {
            (PI * (sample - start) as f64 / segment as f64)
                .sin()
                .powi(4)
        })
        .sum()
    };
    let weights = (0..n_silent).map(weight);
    let (sum, squares) = weights.fold((0.0, 0.0), |(sum, squares), g| (sum + g, squares + g * g));
    sum * sum / squares
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AveragedSpectra, Quantity, Window};
    use ndarray::Array2;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// White noise before and during the hits: the energy of its lines is that predicted from the
    /// silence.
    #[test]
    fn the_silence_before_tells_the_noise_of_the_lines() {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let hits: Vec<Record> = (0..10)
            .map(|_| {
                let samples =
                    Array2::from_shape_fn((1, 2048), |_| 3.0 + random.random::<f64>() - 0.5);
                Record::of_test(samples, 8000.0, &[("gauge", Quantity::Strain)])
            })
            .collect();
        let all: Vec<&Record> = hits.iter().collect();
        let noise = RestNoise::before(&all, "gauge", 512).unwrap();
        // uniform between -1/2 and 1/2: a variance of 1/12, distributed over 4 kHz
        let exact = 1.0 / 12.0 / 4000.0;
        for f in [20.0, 500.0, 3000.0] {
            // tolerance: three standard errors of a line, 8 % for 150 overlapped segments
            assert!((noise.density_at(f) / exact - 1.0).abs() < 0.25, "{f}");
        }
        let spectra = AveragedSpectra::of(&hits, Window::Rectangular).unwrap();
        let energy = spectra.auto("gauge").unwrap();
        let mean = energy[200..600].iter().sum::<f64>() / 400.0;
        let promised = noise.amplitude_at(1600.0, 2048.0 / 8000.0).powi(2);
        assert!((promised / mean - 1.0).abs() < 0.25, "{promised} {mean}");
        // 10 · 512 samples at 8 kHz, over 4 kHz: one degree of freedom per sample, multiplied by
        // 0.947 for the windows (from sin⁴ + cos⁴) and by 15/16 for the half segments at the ends
        let of_samples = noise.degrees_of_freedom(4000.0) / 5120.0;
        let expected = 0.947 * 15.0 / 16.0;
        assert!((of_samples / expected - 1.0).abs() < 0.01, "{of_samples}");
        // 15 segments with half overlap, each of which counts as 0.95 of an independent segment
        let of_segments = noise.line_degrees_of_freedom() / 300.0;
        assert!((0.93..0.97).contains(&of_segments), "{of_segments}");
    }

    #[test]
    fn silence_that_is_too_short_is_refused() {
        let samples = Array2::zeros((1, 100));
        let hit = Record::of_test(samples, 1.0, &[("gauge", Quantity::Strain)]);
        let text = |n| {
            let error = RestNoise::before(&[&hit], "gauge", n).unwrap_err();
            error.to_string()
        };
        assert_eq!(
            text(15),
            "the silence before a hit has 15 samples, expected at least 16"
        );
        assert_eq!(
            text(200),
            "the record that contains the part has 100 samples, expected at least 200"
        );
        assert!(RestNoise::before(&[], "gauge", 20).is_err());
    }
}

//! End of the motion in a record, after which it contains only noise.

use std::ops::Range;

use ndarray::{ArrayView1, Axis, Slice};
use num_complex::Complex64;

use crate::dft::Dft;
use crate::{LabioError, Record};

/// Fewest samples that are kept, a power of two.
const FEWEST: usize = 256;
/// Fewest and most segments from which the noise of a line is measured.
const FEWEST_SEGMENTS: usize = 4;
const MOST_SEGMENTS: usize = 16;
/// Number of lines on each side of a line that are averaged with it, so that a line of hum does not
/// count as motion. The same number of lines from 0 Hz on is not tested, because of drift.
const NEIGHBOURS: usize = 4;
/// Probability of counting noise as motion.
const LEVEL: f64 = 0.01;

/// Returns the number of samples, a power of two, after which no motion is left in `channels` of
/// any of `hits`; `None` if this number is more than a quarter of the shortest hit.
///
/// The motion has ended after $`n`$ samples if the peaks of all channels lie within them, and if no
/// line of the next $`n`$ samples exceeds the noise in the second half of the hit (false alarms: at
/// most 1 % of hits). The function returns $`2n`$: motion below the noise in the second $`n`$
/// samples has then decayed further.
///
/// # Validity
///
/// Valid for motions that decay, and for stationary noise, with or without hum. Without noise the
/// motion never ends.
///
/// # Errors
///
/// [`LabioError::UnknownChannel`].
pub fn samples_of_motion(hits: &[&Record], channels: &[&str]) -> Result<Option<usize>, LabioError> {
    let Some(shortest) = hits.iter().map(|hit| hit.n_samples()).min() else {
        return Ok(None);
    };
    let mut histories = Vec::with_capacity(hits.len() * channels.len());
    for hit in hits {
        for channel in channels {
            histories.push(hit.channel(channel)?);
        }
    }
    let last_peak = histories.iter().copied().map(peak_of).max().unwrap_or(0);
    let mut n = FEWEST;
    while 2 * FEWEST_SEGMENTS * n <= shortest {
        let n_tests = histories.len() * (n / 2);
        if n > last_peak && !histories.iter().any(|history| moves(*history, n, n_tests)) {
            return Ok(Some(2 * n));
        }
        n *= 2;
    }
    Ok(None)
}

/// The sample with the largest deviation from the mean of the second half.
fn peak_of(samples: ArrayView1<'_, f64>) -> usize {
    let rest = part(&samples, samples.len() / 2..samples.len());
    let level = rest.mean().unwrap_or(0.0);
    let deviations = samples.iter().map(|x| (x - level).abs());
    let largest = deviations.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    largest.map_or(0, |(index, _)| index)
}

/// Returns true if a line of the samples from `n` to `2n` exceeds the noise in the second half of
/// the record; the probability of a false alarm over `n_tests` lines is [`LEVEL`].
fn moves(samples: ArrayView1<'_, f64>, n: usize, n_tests: usize) -> bool {
    let mut spectrum = Spectrum::new(n);
    let n_segments = (samples.len() / 2 / n).min(MOST_SEGMENTS);
    let mut noise = vec![0.0; n / 2 + 1];
    for back in 1..=n_segments {
        let from = samples.len() - back * n;
        let powers = spectrum.powers(part(&samples, from..from + n));
        for (sum, power) in noise.iter_mut().zip(powers) {
            *sum += power;
        }
    }
    let averaged = noise.windows(2 * NEIGHBOURS + 1);
    let count = ((2 * NEIGHBOURS + 1) * n_segments) as f64;
    // the ratio of the power of a line to the mean of m others exceeds r with the probability
    // (1 + r/m)^-m
    let limit = count * ((LEVEL / n_tests as f64).powf(-1.0 / count) - 1.0);
    let next = spectrum.powers(part(&samples, n..2 * n));
    let mut lines = next.skip(NEIGHBOURS).zip(averaged);
    lines.any(|(power, noise)| power > limit * noise.iter().sum::<f64>() / count)
}

fn part<'a>(samples: &'a ArrayView1<'_, f64>, range: Range<usize>) -> ArrayView1<'a, f64> {
    samples.slice_axis(Axis(0), Slice::from(range))
}

/// Computes the powers of the lines of segments of one length, whose means are removed.
struct Spectrum {
    dft: Dft,
    lines: Vec<Complex64>,
}

impl Spectrum {
    fn new(n: usize) -> Self {
        Self {
            dft: Dft::new(n),
            lines: vec![Complex64::ZERO; n / 2 + 1],
        }
    }

    fn powers(&mut self, segment: ArrayView1<'_, f64>) -> impl Iterator<Item = f64> {
        let mean = segment.mean().unwrap_or(0.0);
        for (input, sample) in self.dft.input().iter_mut().zip(segment) {
            *input = sample - mean;
        }
        self.dft.transform(&mut self.lines);
        self.lines.iter().map(Complex64::norm_sqr)
    }
}

#[cfg(test)]
mod tests {
    use testbed::noise::Noise;

    use super::*;
    use crate::Quantity;

    const RATE: f64 = 10e3;

    /// A ringing of 400 Hz with this time constant from sample 200 on, with noise and hum of a
    /// thousandth of its peak.
    fn hit(time_constant: f64, n_samples: usize, seed: u64) -> Record {
        let mut noise = Noise::seeded(seed);
        let samples = (0..n_samples).map(|n| {
            let t = n as f64 / RATE;
            let since = (t - 0.02).max(0.0);
            let ringing = (-since / time_constant).exp() * (2513.0 * since).sin();
            ringing + 1e-3 * noise.normal() + 1e-3 * (314.0 * t).sin()
        });
        let samples = ndarray::Array2::from_shape_vec((1, n_samples), samples.collect()).unwrap();
        Record::of_test(samples, RATE, &[("a", Quantity::Acceleration)])
    }

    fn found(time_constant: f64, n_samples: usize, seed: u64) -> Option<usize> {
        let hit = hit(time_constant, n_samples, seed);
        samples_of_motion(&[&hit], &["a"]).unwrap()
    }

    /// The power of the ringing that is cut off is less than a tenth of the power of the noise on
    /// its line, and hum does not delay the end of the motion.
    #[test]
    fn what_is_left_out_is_below_the_noise_of_its_line() {
        for seed in 0..20 {
            let time_constant = 0.01;
            let n = found(time_constant, 65_536, seed).unwrap();
            assert!(n.is_power_of_two());
            let since = n as f64 / RATE - 0.02;
            // Fourier sum of the ringing after sample n, and root-mean-square Fourier sum of the
            // noise of n samples
            let left = (-since / time_constant).exp() * time_constant * RATE / 2.0;
            let noise = 1e-3 * (n as f64).sqrt();
            assert!(left < 0.3 * noise, "{seed}: {n}");
            assert!(n <= 4096, "{seed}: {n}");
        }
    }

    #[test]
    fn a_record_that_rings_to_its_end_is_kept() {
        for seed in 0..20 {
            assert_eq!(found(0.5, 65_536, seed), None);
            assert_eq!(found(0.01, 4096, seed), None);
        }
    }
}

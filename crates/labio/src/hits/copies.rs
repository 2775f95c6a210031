//! Detection of copies among hits: a measurement that was entered twice must count once, because
//! averaging it with itself makes the errors too small.

use std::f64::consts::LN_2;

use num_complex::Complex64;

use super::rest::samples_at_rest;
use crate::quantization::step_above_noise;
use crate::spectra::RestNoise;
use crate::{LabioError, Record, dft};

/// Largest difference between samples that count as equal, relative to the largest sample: twice
/// the rounding of single precision.
const ROUNDING: f64 = 1.0 / 4_194_304.0;

/// Lower limit of the compared lines as a fraction of the sampling rate: hum and drift below it are
/// not line noise.
const LOWEST: f64 = 1.0 / 16.0;
/// Upper limit of the compared lines as a fraction of the sampling rate: recorders attenuate above
/// it.
const HIGHEST: f64 = 0.45;
/// Fewest lines for a comparison.
const FEWEST_LINES: usize = 16;
/// Smallest power of the difference between two separate hits relative to that of the noise: the
/// noise before a hit need not be exactly the noise during the hit.
const LEAST_SHARE: f64 = 0.25;
/// Largest number of iterations for finding the delay between two hits to full precision.
const ITERATIONS: usize = 8;
/// Step of the delay, in half samples, below which the iterations, which converge quadratically,
/// have converged.
const CONVERGED: f64 = 1e-9;
/// Number of lines whose phase factors are products with the factor of the first of them; so few
/// multiplications keep full precision.
const TURNED_TOGETHER: usize = 32;

/// A measurement that occurs twice.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Copy {
    /// Two hits have the same samples on all channels.
    Hits {
        /// Index of the first hit, from 0.
        first: usize,
        /// Index of the second hit, from 0.
        second: usize,
    },
    /// Two channels of a hit have the same samples.
    Channels {
        /// Index of the hit, from 0.
        hit: usize,
        /// Name of the first channel.
        first: String,
        /// Name of the second channel.
        second: String,
    },
}

/// Two hits whose difference is smaller than expected from the noise before them.
#[derive(Debug, Clone, PartialEq)]
pub struct NearCopy {
    /// Index of the first hit, from 0.
    pub first: usize,
    /// Index of the second hit, from 0.
    pub second: usize,
    /// Power of the difference divided by that of the noise, on the channel where this ratio is
    /// greatest: 1 or more for separate hits.
    pub share_of_noise: f64,
}

/// Samples of a channel minus their mean, and the position of the largest.
struct Shape {
    samples: Vec<f64>,
    peak_at: usize,
    peak: f64,
}

impl Shape {
    /// Returns the shape of a channel; `None` if the channel never moves.
    fn of(hit: &Record, channel: &str) -> Result<Option<Self>, LabioError> {
        let samples = hit.channel(channel)?;
        let mean = samples.iter().sum::<f64>() / samples.len().max(1) as f64;
        let samples: Vec<f64> = samples.iter().map(|x| x - mean).collect();
        let mut peak_at = 0;
        let mut peak: f64 = 0.0;
        for (index, sample) in samples.iter().enumerate() {
            if sample.abs() > peak.abs() {
                (peak_at, peak) = (index, *sample);
            }
        }
        Ok((peak.abs() > 0.0).then_some(Self {
            samples,
            peak_at,
            peak,
        }))
    }

    /// Returns true if both shapes are equal except for scale, sign, offset and the rounding of
    /// single precision.
    fn equals(&self, other: &Self) -> bool {
        let Some(scale) = other.samples.get(self.peak_at).filter(|x| x.abs() > 0.0) else {
            return false;
        };
        let allowed = ROUNDING * (self.peak * scale).abs();
        let mut pairs = self.samples.iter().zip(&other.samples);
        self.samples.len() == other.samples.len()
            && pairs.all(|(a, b)| (a * scale - b * self.peak).abs() <= allowed)
    }
}

/// Returns the first measurement that occurs twice in `hits`: two hits with the same samples on all
/// `channels`, or two channels with the same samples in a hit.
///
/// Samples count as the same if they are equal except for a factor, an offset and the rounding of
/// single precision, as after a change of file format or sensitivity. Two separate measurements are
/// never the same: even the noise of the last bit of a converter is greater. Channels that never
/// move are not compared; hits in which no channel moves are not copies.
///
/// The time needed is that of reading the samples once, unless hits are equal.
///
/// # Errors
///
/// [`LabioError::UnknownChannel`].
pub fn find_copy(hits: &[&Record], channels: &[&str]) -> Result<Option<Copy>, LabioError> {
    let mut shapes: Vec<Vec<Option<Shape>>> = Vec::with_capacity(hits.len());
    for (second, hit) in hits.iter().enumerate() {
        let of_hit = channels
            .iter()
            .map(|channel| Shape::of(hit, channel))
            .collect::<Result<Vec<_>, _>>()?;
        for (b, shape) in of_hit.iter().enumerate() {
            let before = of_hit.iter().zip(channels).take(b);
            for (other, name) in before {
                if let (Some(one), Some(other)) = (shape, other)
                    && other.equals(one)
                {
                    return Ok(Some(Copy::Channels {
                        hit: second,
                        first: (*name).to_owned(),
                        second: channels.get(b).copied().unwrap_or_default().to_owned(),
                    }));
                }
            }
        }
        let same = |other: &Vec<Option<Shape>>| {
            let moves = of_hit.iter().any(Option::is_some);
            moves
                && other.iter().zip(&of_hit).all(|pair| match pair {
                    (Some(a), Some(b)) => a.equals(b),
                    (None, None) => true,
                    _ => false,
                })
        };
        if let Some(first) = shapes.iter().position(same) {
            return Ok(Some(Copy::Hits { first, second }));
        }
        shapes.push(of_hit);
    }
    Ok(None)
}

/// The transform of a channel and the noise of its lines.
struct Lines {
    n_samples: usize,
    values: Vec<Complex64>,
    /// E|noise|² of each line.
    noise: Vec<f64>,
    degrees_of_freedom: f64,
}

impl Lines {
    /// Returns the lines of a channel; `None` if there is no silence, or no noise in it that changes
    /// the output of the converter: two hits then have equal samples in their silence and after
    /// they have decayed.
    fn of(hit: &Record, channel: &str, silent: usize) -> Result<Option<Self>, LabioError> {
        if step_above_noise(hit.channel(channel)?, silent).is_some() {
            return Ok(None);
        }
        let noise = RestNoise::before(&[hit], channel, silent)?;
        let samples = hit.channel(channel)?.to_vec();
        let (rate, n) = (hit.sampling_rate_hz(), samples.len() as f64);
        let values = dft::forward(&samples);
        // from a one-sided density to the unscaled transform
        let noise_of = |line: usize| 0.5 * rate * n * noise.density_at(line as f64 * rate / n);
        let of_lines: Vec<f64> = (0..values.len()).map(noise_of).collect();
        let known = of_lines.iter().all(|power| *power > 0.0);
        Ok(known.then(|| Self {
            n_samples: samples.len(),
            values,
            noise: of_lines,
            degrees_of_freedom: noise.degrees_of_freedom(0.5 * rate),
        }))
    }
}

/// Returns pairs of `hits` whose difference on all `channels` is smaller than expected from the
/// noise before them: the same hit rounded, scaled, delayed or resampled. The probability of a
/// false alarm, for all pairs together, is at most `level`.
///
/// For each pair and channel, the factor s and the delay by which the first hit comes closest to
/// the second are found. The difference D of two separate hits contains at least the noise of both:
/// on each line |D|²/(s²N₁ + N₂), with the power N of the noise before each hit ([`RestNoise`]), is
/// distributed as an exponential variable of mean 1, or larger. The statistic is the median over
/// the lines between 1/16 and 0.45 of the sampling rate, divided by ln 2. Its logarithm has the
/// variance 1/(n ln²2) + 2/ν₁ + 2/ν₂ with n lines and ν degrees of freedom of the noise. A pair is
/// reported if the statistic is significantly below 1/4 on all channels. The median is insensitive
/// to lines lost by resampling.
///
/// Channels without noise before the hit, such as computed ones, and hits without silence are
/// skipped.
///
/// # Errors
///
/// [`LabioError::UnknownChannel`]; the errors of [`RestNoise::before`].
pub fn find_near_copies(
    hits: &[&Record],
    channels: &[&str],
    level: f64,
) -> Result<Vec<NearCopy>, LabioError> {
    let mut all = Vec::with_capacity(hits.len());
    for hit in hits {
        let silent = samples_at_rest(&[hit], channels)?;
        let mut of_hit = Vec::with_capacity(channels.len());
        for channel in channels {
            of_hit.push(match silent {
                None => None,
                Some(silent) => Lines::of(hit, channel, silent)?,
            });
        }
        all.push(of_hit);
    }
    let n_pairs = (hits.len() * hits.len().saturating_sub(1) / 2).max(1) as f64;
    // P(Z < -z) <= exp(-z²/2)/2
    let z = (2.0 * (n_pairs / (2.0 * level)).max(1.0).ln()).sqrt();
    let mut found = Vec::new();
    for (second, b) in all.iter().enumerate() {
        for (first, a) in all.iter().enumerate().take(second) {
            let mut greatest: Option<f64> = None;
            let known = a
                .iter()
                .zip(b)
                .filter_map(|(a, b)| a.as_ref().zip(b.as_ref()));
            let mut near = true;
            for (a, b) in known {
                let Some((share, error)) = share_of_noise(a, b) else {
                    continue;
                };
                near &= share.ln() < LEAST_SHARE.ln() - z * error;
                if !near {
                    break;
                }
                greatest = Some(greatest.map_or(share, |greatest| greatest.max(share)));
            }
            if let Some(share_of_noise) = greatest.filter(|_| near) {
                found.push(NearCopy {
                    first,
                    second,
                    share_of_noise,
                });
            }
        }
    }
    Ok(found)
}

/// Returns the fraction `part` of `count`, rounded down.
fn share(count: usize, part: f64) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a fraction of a number of samples"
    )]
    let share = (part * count as f64) as usize;
    share
}

/// Returns the statistic of two hits and the standard deviation of its logarithm; `None` if there
/// are too few lines.
fn share_of_noise(a: &Lines, b: &Lines) -> Option<(f64, f64)> {
    let n_lines = a.values.len();
    if b.n_samples != a.n_samples {
        return None;
    }
    // the lines cover half the sampling rate
    let (from, to) = (share(n_lines, 2.0 * LOWEST), share(n_lines, 2.0 * HIGHEST));
    if to < from + FEWEST_LINES {
        return None;
    }
    let cross: Vec<Complex64> = a
        .values
        .iter()
        .zip(&b.values)
        .map(|(a, b)| b * a.conj())
        .collect();
    let delay = delay(&cross, a.n_samples);
    let turned = turns(-delay, n_lines);
    let size: f64 = a.values.iter().map(Complex64::norm_sqr).sum();
    let pairs = cross.iter().zip(&turned);
    let projected: f64 = pairs.map(|(cross, turn)| (cross * turn.conj()).re).sum();
    let scale = projected / size;
    let lines = a.values.iter().zip(&b.values).zip(&turned);
    let mut shares: Vec<f64> = lines
        .zip(a.noise.iter().zip(&b.noise))
        .take(to)
        .skip(from)
        .map(|(((a, b), turn), (noise_a, noise_b))| {
            let left = b - a * turn * scale;
            left.norm_sqr() / (noise_b + scale * scale * noise_a)
        })
        .collect();
    let middle = shares.len() / 2;
    let (_, median, _) = shares.select_nth_unstable_by(middle, f64::total_cmp);
    let n = (to - from) as f64;
    let variance =
        1.0 / (n * LN_2 * LN_2) + 2.0 / a.degrees_of_freedom + 2.0 / b.degrees_of_freedom;
    Some((median.max(f64::MIN_POSITIVE) / LN_2, variance.sqrt()))
}

/// Returns the delay of the second hit relative to the first, as a phase per line: the delay that
/// maximises their cross-correlation.
fn delay(cross: &[Complex64], n_samples: usize) -> f64 {
    let alike = dft::inverse(cross, n_samples);
    let best = (0..alike.len()).max_by(|i, j| {
        let size = |at: &usize| alike.get(*at).map_or(0.0, |x| x.abs());
        size(i).total_cmp(&size(j))
    });
    let best = best.unwrap_or(0) as f64;
    let mut delay = best * std::f64::consts::TAU / n_samples as f64;
    // Newton iterations to the maximum of the sum of Re(C e^{i k d})
    for _ in 0..ITERATIONS {
        let (mut slope, mut curvature) = (0.0, 0.0);
        let turned = cross.iter().zip(turns(delay, cross.len()));
        for (line, (cross, turn)) in turned.enumerate() {
            let k = line as f64;
            let turned = cross * turn;
            slope -= k * turned.im;
            curvature -= k * k * turned.re;
        }
        let step = slope / curvature;
        // at most half a sample, so that the nearest maximum is found
        let half_sample = std::f64::consts::PI / n_samples as f64;
        if !step.is_finite() || step.abs() > half_sample {
            break;
        }
        delay -= step;
        if step.abs() < CONVERGED * half_sample {
            break;
        }
    }
    delay
}

/// Returns e^{i k `phase`} for the lines k from 0 to `count`.
fn turns(phase: f64, count: usize) -> Vec<Complex64> {
    let within: [Complex64; TURNED_TOGETHER] =
        std::array::from_fn(|k| Complex64::cis(phase * k as f64));
    let mut turns = Vec::with_capacity(count + TURNED_TOGETHER);
    while turns.len() < count {
        let first = Complex64::cis(phase * turns.len() as f64);
        turns.extend(within.iter().map(|turn| first * turn));
    }
    turns.truncate(count);
    turns
}

#[cfg(test)]
#[allow(
    clippy::cast_possible_truncation,
    reason = "one of the files has single precision"
)]
mod tests {
    use super::*;
    use crate::Quantity;
    use ndarray::Array2;
    use testbed::noise::Noise;

    const N: usize = 2048;
    const RATE_HZ: f64 = 50_000.0;

    fn record(rows: [Vec<f64>; 2]) -> Record {
        let samples = Array2::from_shape_fn((2, N), |(row, n)| rows[row][n]);
        let channels = [("force", Quantity::Force), ("end", Quantity::Acceleration)];
        Record::of_test(samples, RATE_HZ, &channels)
    }

    /// A pulse and the ringing of three modes that it excites, beginning `later` samples after
    /// sample 200, where `later` need not be an integer; with white noise of standard deviation
    /// `noise` relative to the peak.
    fn hit(peak: f64, later: f64, noise: f64, rng: &mut Noise) -> [Vec<f64>; 2] {
        let mut of = |value: &dyn Fn(f64) -> f64| -> Vec<f64> {
            (0..N)
                .map(|n| {
                    let unit = rng.normal();
                    peak * (value(n as f64 - 200.0 - later) + noise * unit)
                })
                .collect()
        };
        let force = of(&|t| (-(t - 12.0).powi(2) / 18.0).exp());
        let end = of(&|t| {
            let t = (t - 12.0).max(0.0);
            let modes: [(f64, f64); 3] = [(0.05, 0.004), (0.13, 0.006), (0.31, 0.01)];
            modes
                .iter()
                .map(|(omega, decay)| (omega * t).sin() * (-decay * t).exp())
                .sum()
        });
        [force, end]
    }

    fn copy_of(hits: &[Record]) -> Option<Copy> {
        let hits: Vec<&Record> = hits.iter().collect();
        find_copy(&hits, &["force", "end"]).unwrap()
    }

    fn near(hits: &[Record]) -> Vec<(usize, usize)> {
        let hits: Vec<&Record> = hits.iter().collect();
        let found = find_near_copies(&hits, &["force", "end"], 0.01).unwrap();
        found.iter().map(|pair| (pair.first, pair.second)).collect()
    }

    fn map(rows: &[Vec<f64>; 2], f: impl Fn(f64) -> f64) -> Record {
        record(
            rows.each_ref()
                .map(|row| row.iter().map(|x| f(*x)).collect()),
        )
    }

    #[test]
    fn r10_equal_samples_are_found_whatever_their_scale_and_format() {
        let mut rng = Noise::seeded(1);
        let hits: Vec<[Vec<f64>; 2]> = (0..4).map(|_| hit(1.0, 0.0, 1e-4, &mut rng)).collect();
        let records: Vec<Record> = hits.iter().cloned().map(record).collect();
        assert_eq!(copy_of(&records), None);
        let copies: [(&str, &dyn Fn(f64) -> f64); 4] = [
            ("as it is", &|x| x),
            ("inverted, another sensitivity, an offset", &|x| {
                0.3 - 17.3 * x
            }),
            ("single precision", &|x| f64::from(x as f32)),
            ("nine digits of text", &|x| {
                format!("{x:.9e}").parse().unwrap()
            }),
        ];
        for (what, change) in copies {
            let mut all = records.clone();
            all.push(map(&hits[1], change));
            let expected = Copy::Hits {
                first: 1,
                second: 4,
            };
            assert_eq!(copy_of(&all), Some(expected), "{what}");
        }
        // a hit with the force of one hit and the motion of another is not a copy
        let mut all = records.clone();
        all.push(record([hits[1][0].clone(), hits[2][1].clone()]));
        assert_eq!(copy_of(&all), None);
    }

    #[test]
    fn r10_one_channel_in_two_places_is_found_and_a_dead_one_is_none() {
        let mut rng = Noise::seeded(2);
        let [force, end] = hit(1.0, 0.0, 1e-4, &mut rng);
        let twice = record([force.iter().map(|x| 2.0 * x).collect(), force]);
        let expected = Copy::Channels {
            hit: 0,
            first: "force".into(),
            second: "end".into(),
        };
        assert_eq!(copy_of(&[twice]), Some(expected));
        let dead = || record([vec![0.0; N], vec![0.0; N]]);
        assert_eq!(copy_of(&[dead(), dead()]), None);
        let mute = record([vec![0.0; N], end.clone()]);
        let copy = Copy::Hits {
            first: 0,
            second: 1,
        };
        assert_eq!(copy_of(&[mute.clone(), mute]), Some(copy));
    }

    #[test]
    fn r10_a_hit_that_was_rounded_scaled_or_sampled_again_is_nearly_a_copy() {
        let mut rng = Noise::seeded(3);
        let hits: Vec<[Vec<f64>; 2]> = (0..3).map(|_| hit(1.0, 0.0, 1e-3, &mut rng)).collect();
        let records: Vec<Record> = hits.iter().cloned().map(record).collect();
        assert_eq!(near(&records), []);
        // the third hit rounded to steps of a twentieth of the noise and multiplied by 3
        let rounded = map(&hits[2], |x| 3.0 * (x / 5e-5).round() * 5e-5);
        assert_eq!(copy_of(&[records[2].clone(), rounded.clone()]), None);
        let mut all = records.clone();
        all.push(rounded);
        assert_eq!(near(&all), [(2, 3)]);
        // resampled exactly, with delays of 0.37, 5 and -3.4 samples, and by linear interpolation
        // between the samples
        for late in [0.37, 5.0, -3.4] {
            let again = hits[0].each_ref().map(|row| {
                let mut lines = dft::forward(row);
                for (k, line) in lines.iter_mut().enumerate() {
                    *line *= Complex64::cis(-std::f64::consts::TAU * k as f64 * late / N as f64);
                }
                dft::inverse(&lines, N)
            });
            all[3] = record(again);
            assert_eq!(near(&all), [(0, 3)], "{late}");
        }
        let between = hits[1].each_ref().map(|row| {
            let next = row.iter().skip(1).chain(row.last());
            row.iter()
                .zip(next)
                .map(|(a, b)| 0.95 * a + 0.05 * b)
                .collect()
        });
        all[3] = record(between);
        assert_eq!(near(&all), [(1, 3)]);
    }

    /// Hits of a machine that always strikes with the same force: they differ only by noise.
    #[test]
    fn r10_hits_that_differ_by_noise_only_are_no_copies() {
        let mut rng = Noise::seeded(4);
        for noise in [1e-5, 1e-3, 3e-2] {
            for _ in 0..20 {
                let hits: Vec<Record> = (0..5)
                    .map(|number| record(hit(1.0 + 0.1 * f64::from(number), 0.0, noise, &mut rng)))
                    .collect();
                assert_eq!(near(&hits), [], "{noise}");
            }
        }
        // mains hum and a drift, before and during the hits, both much larger than the noise
        for _ in 0..20 {
            let hits: Vec<Record> = (0..5)
                .map(|_| {
                    let unit = rng.normal();
                    let mut rows = hit(1.0, 0.0, 1e-4, &mut rng);
                    for x in rows.iter_mut().flat_map(|row| row.iter_mut().enumerate()) {
                        let t = x.0 as f64 / RATE_HZ;
                        *x.1 += 0.02 * (std::f64::consts::TAU * 50.0 * t + unit).sin() + 0.1 * t;
                    }
                    record(rows)
                })
                .collect();
            assert_eq!(near(&hits), []);
        }
        // counts of a converter, with noise below its last bit
        for levels in [4096.0, 100.0] {
            let hits: Vec<Record> = (0..5)
                .map(|number| {
                    let peak = 1.0 + 0.01 * f64::from(number);
                    map(&hit(peak, 0.0, 1e-6, &mut rng), |x| (levels * x).round())
                })
                .collect();
            assert_eq!(near(&hits), [], "{levels} levels");
            assert_eq!(copy_of(&hits), None, "{levels} levels");
        }
    }
}

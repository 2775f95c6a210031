//! Ratios of hits, shots and pulses, compared with the true values.

use ndarray::Array2;
use num_complex::Complex64;
use testbed::noise::Noise;

use super::*;
use crate::{Quantity, Rating, SensorChain};

const RATE: f64 = 1e4;

/// A pulse at sample 512 in "x", twice as large in "y", with noise of standard deviation 0.006 in
/// both.
fn shot(random: &mut Noise) -> Record {
    let noise = [
        random.added_to(&[0.0; 1024], 1.0),
        random.added_to(&[0.0; 1024], 1.0),
    ];
    let samples = Array2::from_shape_fn((2, 1024), |(channel, n)| {
        let t = n as f64 - 512.0;
        let pulse = if (0.0..12.0).contains(&t) {
            1.0 - (t / 6.0 - 1.0).powi(2)
        } else {
            0.0
        };
        (1.0 + channel as f64) * pulse + 0.006 * noise[channel][n]
    });
    let channels = ["x", "y"].map(|name| (name, Quantity::Strain));
    Record::of_test(samples, RATE, &channels)
}

/// The mean of |δr|² divided by the stated variance is 1, over 300 shots with noise on both
/// channels.
#[test]
fn the_silence_tells_the_error_of_one_ratio() {
    let mut random = Noise::seeded(19);
    let lines = [3, 10, 30];
    let mut sums = [0.0; 3];
    for _ in 0..300 {
        let ratio = ResponseRatio::of(&[&shot(&mut random)], Some(500), "y", "x").unwrap();
        assert!(ratio.coherence.is_none() && ratio.freedom.is_some());
        for (sum, line) in sums.iter_mut().zip(lines) {
            *sum += (ratio.values[line] - 2.0).norm_sqr() / ratio.variance[line] / 300.0;
        }
    }
    for mean in sums {
        // tolerance: three standard errors, which are 6 % for 300 exponentially distributed squares
        // and 2 % for the noise from a silence of 15 segments
        assert!((mean - 1.0).abs() < 0.2, "{mean}");
    }
}

/// The mean of |δr|² divided by the variance from the coherence is 1, over 60 tests of five hits.
/// The noise of the denominator makes H1 too low, but by less than its random error.
#[test]
fn the_coherence_tells_the_error_of_several_hits() {
    let mut random = Noise::seeded(23);
    let mut sum = 0.0;
    for _ in 0..60 {
        let hits: Vec<Record> = (0..5).map(|_| shot(&mut random)).collect();
        let hits: Vec<&Record> = hits.iter().collect();
        let ratio = ResponseRatio::of(&hits, Some(500), "y", "x").unwrap();
        let lines = 3..40;
        let count = lines.len() as f64;
        for line in lines {
            let square = (ratio.values[line] - 2.0).norm_sqr();
            sum += square / ratio.variance[line] / (60.0 * count);
        }
        let coherent = ratio.above_chance(0.05).unwrap();
        assert!(coherent[3..40].iter().all(|is| *is));
    }
    // some 2000 squares, each divided by a pooled variance; the signal is 40 dB above the noise, so
    // that the bias of H1 is small
    assert!((sum - 1.0).abs() < 0.15, "{sum}");
}

#[test]
fn copies_of_a_hit_and_single_hits_have_no_coherence() {
    let hit = shot(&mut Noise::seeded(1));
    let copies = ResponseRatio::of_hits(&[&hit, &hit, &hit], "y", "x").unwrap_err();
    assert!(
        matches!(copies, LabioError::NoNoise { hits: 3, .. }),
        "{copies}"
    );
    let one = ResponseRatio::of_hits(&[&hit], "y", "x").unwrap_err();
    assert!(
        matches!(one, LabioError::TooFewAverages { found: 1, .. }),
        "{one}"
    );
}

#[test]
fn sensors_are_in_the_ratio_of_two_channels_and_not_of_one() {
    let mut random = Noise::seeded(5);
    let calibrated = |hit: Record| {
        let rating = Rating::new(2.0, "1").unwrap().with_uncertainty(0.02);
        let chain = SensorChain::of_sensitivity(rating.unwrap()).unwrap();
        let chain = chain.with_time_skew_uncertainty(3e-6).unwrap();
        hit.calibrated("x", chain).unwrap()
    };
    let hit = calibrated(shot(&mut random));
    let both = ResponseRatio::of_shot(&hit, 500, "y", "x").unwrap().common;
    assert!((both.gain - 0.01).abs() < 1e-12 && (both.delay - 3e-6).abs() < 1e-18);
    let one = ResponseRatio::of_shot(&hit, 500, "x", "x").unwrap().common;
    assert!(!one.is_uncertain());
}

/// Compares the spectrum of the tail that is cut off an exponential at T, e^{-(a + iω)T}/(a + iω),
/// with its first term, q(T)/ω.
#[test]
fn a_cut_tail_errs_by_its_value_over_omega() {
    use std::f64::consts::TAU;

    let (rate, cut): (f64, f64) = (800.0, 1e-3);
    let edge = (-rate * cut).exp();
    let frequency_hz = [1e3, 3e3, 1e4];
    let noise = noise_of_cut_pulse(0.0, [0.0, edge], &frequency_hz).unwrap();
    for (f, noise) in frequency_hz.iter().zip(noise) {
        let missing = edge / Complex64::new(rate, TAU * f).norm();
        // |a + iω|/ω = 1 + (a/ω)²/2, a difference of less than 1 % here
        assert!(missing <= noise && missing > 0.99 * noise, "{f} Hz");
    }
    let text = |noise: f64, edge: f64, f: f64| {
        let refused = noise_of_cut_pulse(noise, [0.0, edge], &[f]);
        refused.unwrap_err().to_string()
    };
    let frequency = "frequency [Hz] is 0, expected a finite value above 0";
    assert_eq!(text(0.0, 1.0, 0.0), frequency);
    let edge = "value of the record at the edge of a window is NaN, expected a finite value";
    assert_eq!(text(0.0, f64::NAN, 1.0), edge);
    let noise = "noise of a spectrum is -1, expected a finite value, 0 or above";
    assert_eq!(text(-1.0, 1.0, 1.0), noise);
}

/// A pulse that decays at 800/s, and the same pulse 30 ms later with half its size, cut off about
/// 3 ms after its onset: the missing tail causes an error of about the size that the variance
/// states.
#[test]
fn a_pulse_without_its_tail_errs_as_it_states() {
    let pulse = |n: f64| {
        if n < 0.0 {
            0.0
        } else {
            let t = n / RATE;
            (1.0 - (-8000.0 * t).exp()) * (-800.0 * t).exp()
        }
    };
    let hits: Vec<Record> = [3, 4, 5]
        .map(|seed| {
            let mut random = Noise::seeded(seed);
            let noise = random.added_to(&[0.0; 1000], 1.0);
            let samples = Array2::from_shape_fn((1, 1000), |(_, n)| {
                let n_of = |from: f64| n as f64 - from;
                pulse(n_of(100.0)) + 0.5 * pulse(n_of(400.0)) + 1e-6 * noise[n]
            });
            Record::of_test(samples, RATE, &[("gauge", Quantity::Strain)])
        })
        .into();
    let hits: Vec<&Record> = hits.iter().collect();
    let window = |samples| PulseWindow {
        channel: "gauge".to_owned(),
        samples,
    };
    // the earlier pulse to the end of its tail, the later pulse cut off early
    let (earlier, later) = (window(95..400), window(395..430));
    let ratio = ResponseRatio::of_pulses(&hits, None, &later, &earlier).unwrap();
    let centres = ratio.delay.unwrap();
    assert!((0.025..0.03).contains(&centres), "{centres}");
    assert!((ratio.lines_per_independent_line - 1000.0 / 35.0).abs() < 1e-12);
    assert!(!ratio.common.is_uncertain());
    for line in [20, 50, 100] {
        let omega = std::f64::consts::TAU * ratio.frequency_hz[line];
        let exact = 0.5 * Complex64::new(0.0, -omega * 300.0 / RATE).exp();
        let off = (ratio.values[line] - exact).norm();
        let stated = ratio.variance[line].sqrt();
        // true error q(T)/|a + iω|, stated error q(T)/ω: a factor of 1.3 on the lowest line; the
        // stated error also includes the tail of the earlier pulse
        assert!(
            off < 1.1 * stated && off > 0.5 * stated,
            "{line}: {off} {stated}"
        );
    }
    let text = |later: &PulseWindow| {
        let refused = ResponseRatio::of_pulses(&hits, None, later, &earlier);
        refused.unwrap_err().to_string()
    };
    let short = "the window of a pulse has 2 samples, expected at least 3";
    assert_eq!(text(&window(395..397)), short);
    let beyond = "the hit that contains the pulse has 1000 samples, expected at least 1001";
    assert_eq!(text(&window(395..1000)), beyond);
}

/// A bridge with an offset of half the peak: with the level at rest subtracted, ratio and variance
/// are those without offset, up to rounding; without it, the offset counts as a cut pulse.
#[test]
fn an_offset_does_not_change_the_ratio_of_pulses() {
    let hits = |offset: f64| {
        [6, 7, 8].map(|seed| {
            let noise = Noise::seeded(seed).added_to(&[0.0; 1000], 1.0);
            let samples = Array2::from_shape_fn((1, 1000), |(_, n)| {
                let bump = |at: f64| (-((n as f64 - at) / 8.0).powi(2)).exp();
                offset + bump(200.0) - 0.5 * bump(500.0) + 1e-4 * noise[n]
            });
            Record::of_test(samples, RATE, &[("gauge", Quantity::Strain)])
        })
    };
    let window = |samples| PulseWindow {
        channel: "gauge".to_owned(),
        samples,
    };
    let (earlier, later) = (window(150..350), window(350..650));
    let (right, lifted) = (hits(0.0), hits(0.5));
    let ratio = |hits: &[Record], n_silent| {
        let hits: Vec<&Record> = hits.iter().collect();
        ResponseRatio::of_pulses(&hits, n_silent, &later, &earlier).unwrap()
    };
    for count in [1, 3] {
        let expected = ratio(&right[..count], Some(100));
        let found = ratio(&lifted[..count], Some(100));
        for line in [20, 50] {
            let off = (found.values[line] - expected.values[line]).norm();
            let relative = found.variance[line] / expected.variance[line];
            // rounding errors of 1e-16 relative to samples of 1, and to 1 - γ² = 1e-8
            assert!(
                off < 1e-11 && (relative - 1.0).abs() < 1e-7,
                "{off} {relative}"
            );
        }
    }
    // edges of 0.5 instead of edges of noise: a variance more than 1e4 times as large
    let raw = ratio(&lifted, None).variance[20];
    let level = ratio(&lifted, Some(100)).variance[20];
    assert!(raw > 1e4 * level, "{raw} {level}");
}

#[test]
fn ratios_of_other_programs_are_checked() {
    let values = vec![Complex64::new(0.0, 2.0); 3];
    let frequency_hz = vec![1.0, 2.0, 3.0];
    let of = |coherence: Vec<f64>, averages| {
        ResponseRatio::from_coherence(frequency_hz.clone(), values.clone(), coherence, averages)
    };
    let given = of(vec![0.999, 1.0, f64::NAN], 10.0).unwrap();
    assert!((given.variance[0] / (4.0 * 0.001 / (9.0 * 0.999)) - 1.0).abs() < 1e-12);
    assert!(given.variance[1].abs() <= 0.0 && given.variance[2].is_infinite());
    let freedom = given.freedom.unwrap();
    assert!(freedom.iter().all(|of| (of.line - 18.0).abs() <= 0.0));
    let text = |result: Result<ResponseRatio, LabioError>| result.unwrap_err().to_string();
    let few = "number of averages is 1, expected at least 2: the coherence of a single average is always 1";
    assert_eq!(text(of(vec![0.9; 3], 1.0)), few);
    assert_eq!(
        text(of(vec![1.1; 3], 5.0)),
        "coherence is 1.1, expected from 0 to 1"
    );
    assert_eq!(
        text(of(vec![0.9; 2], 5.0)),
        "coherences of a ratio: found 2, expected 3"
    );
    let known =
        |variance| ResponseRatio::from_variance(frequency_hz.clone(), values.clone(), variance);
    assert_eq!(
        text(known(vec![-1.0; 3])),
        "variance of a ratio is -1, expected 0 or more"
    );
    let mut kept = known(vec![0.0; 3]).unwrap();
    kept.keep(1, 3);
    assert_eq!(kept.frequency_hz, [2.0, 3.0]);
    assert!(kept.above_chance(0.05).is_none());
}

/// A decaying motion of six modes, in hits of nearly equal height, is recorded by a converter whose
/// step is sixteen times the noise, and by one whose step is a third of the noise. The ratio
/// without converter and noise is known. Without the shared part of the variance, the squared
/// errors at odd modes are 2.3 times the stated variances.
#[test]
fn rounding_that_is_alike_in_all_hits_is_part_of_the_error() {
    let mut random = Noise::seeded(20);
    let motion = |sign: f64, t: f64| -> f64 {
        let modes = (1..=6).map(f64::from);
        modes
            .map(|k| {
                sign.powf(k) * (-30.0 * k * t).exp() * (std::f64::consts::TAU * 253.0 * k * t).sin()
            })
            .sum()
    };
    let (n, from, rate) = (4096, 64, 2e4);
    let mut mean_square = |noise: f64, step: f64| {
        let mut squares = Vec::new();
        for _ in 0..20 {
            let mut exact = Vec::new();
            let mut found = Vec::new();
            for _ in 0..8 {
                let height = 1.0 + 0.05 * random.added_to(&[0.0], 1.0)[0];
                let added = random.added_to(&vec![0.0; 2 * n], noise);
                let record = |output: &dyn Fn(f64, f64) -> f64| {
                    let samples = Array2::from_shape_fn((2, n), |(channel, sample)| {
                        let sign = [1.0, -1.0][channel];
                        let t = (sample as f64 - f64::from(from)) / rate;
                        let value = if t < 0.0 {
                            0.0
                        } else {
                            height * motion(sign, t)
                        };
                        output(value, added[n * channel + sample])
                    });
                    let channels = ["x", "y"].map(|name| (name, Quantity::Strain));
                    Record::of_test(samples, rate, &channels)
                };
                exact.push(record(&|value, _| value));
                found.push(record(&|value, noise| {
                    step * ((value + noise) / step).round()
                }));
            }
            let all = exact.iter().collect::<Vec<_>>();
            let spectra = AveragedSpectra::of(all.iter().copied(), Window::Rectangular).unwrap();
            let truth = spectra.h1("x", "y").unwrap().values;
            let all = found.iter().collect::<Vec<_>>();
            let ratio = ResponseRatio::of(&all, Some(60), "y", "x").unwrap();
            for line in (0..truth.len()).filter(|line| {
                let mode = ratio.frequency_hz[*line] / 253.0;
                [3.0, 5.0].iter().any(|odd| (mode - odd).abs() < 0.05)
            }) {
                squares.push((ratio.values[line] - truth[line]).norm_sqr() / ratio.variance[line]);
            }
        }
        squares.iter().sum::<f64>() / squares.len() as f64
    };
    // wide limits: 20 tests of some eleven lines, whose errors are correlated within a test, and an
    // estimate of the rounding error from a single other part of the decay
    let undithered = mean_square(5e-4, 8e-3);
    assert!((0.4..1.4).contains(&undithered), "{undithered}");
    // independent rounding errors: 20 tests of eleven lines and fourteen degrees of freedom
    let dithered = mean_square(6e-3, 2e-3);
    assert!((0.75..1.35).contains(&dithered), "{dithered}");
}

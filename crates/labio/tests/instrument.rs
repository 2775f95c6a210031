//! Instruments compared with closed forms of sines and pulses and with the statistics of noise.

use std::f64::consts::{PI, TAU};

use labio::instrument::{AntiAlias, Converter, Instrument, NoiseSpectrum, Saturation};
use labio::{Channel, LabioError, Provenance, Quantity, Rating, Record, SensorChain};
use ndarray::{Array2, array};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

fn history(rate_hz: f64, n: usize, of: impl Fn(usize, f64) -> f64) -> Record {
    let samples = Array2::from_shape_fn((2, n), |(channel, k)| of(channel, k as f64 / rate_hz));
    let channels = ["a", "b"]
        .map(|name| Channel::new(name, Quantity::Acceleration).unwrap())
        .to_vec();
    Record::new(
        samples,
        rate_hz,
        0.5,
        channels,
        Provenance::computed("closed form"),
    )
    .unwrap()
}

fn rng(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

fn taken(instrument: &Instrument, history: &Record) -> Record {
    instrument.record(history, &mut rng(0)).unwrap().record
}

/// A tone with its full amplitude for one second, faded in and out over half a second each.
pub(crate) fn tone(frequency_hz: f64) -> impl Fn(f64) -> f64 {
    move |t| {
        let fade = (t.min(2.0 - t) / 0.5).clamp(0.0, 1.0);
        (PI * fade / 2.0).sin().powi(2) * (TAU * frequency_hz * t).cos()
    }
}

#[test]
fn a_tone_leaves_the_filter_with_the_gain_and_phase_of_its_polynomial() {
    let rate_hz = 20_000.0;
    let cutoff_hz = 400.0;
    let s = |f: f64| Complex64::new(0.0, f / cutoff_hz);
    // order 4: the two quadratics of the Butterworth table, 2 sin(π/8) and 2 sin(3π/8)
    let butterworth = |f: f64| {
        let quadratic = |b: f64| 1.0 / (1.0 + b * s(f) + s(f) * s(f));
        quadratic(0.765_366_864_730_179_5) * quadratic(1.847_759_065_022_573_5)
    };
    // order 4: 105/(s⁴ + 10 s³ + 45 s² + 105 s + 105), which has half power at s = 2.113 917 674
    // 904 216 i
    let bessel = |f: f64| {
        let p = s(f) * 2.113_917_674_904_216;
        105.0 / ((((p + 10.0) * p + 45.0) * p + 105.0) * p + 105.0)
    };
    for f in [100.0, 400.0, 700.0] {
        let history = history(rate_hz, 40_000, |_, t| tone(f)(t));
        let cases = [
            (
                AntiAlias::butterworth(4, cutoff_hz).unwrap(),
                butterworth(f),
            ),
            (AntiAlias::bessel(4, cutoff_hz).unwrap(), bessel(f)),
        ];
        for (filter, expected) in cases {
            assert!((filter.response(f) - expected).norm() < 1e-14);
            let record = taken(&Instrument::new().anti_alias(filter), &history);
            let a = record.channel("a").unwrap();
            for k in 19_000..21_000 {
                let phasor = expected * Complex64::cis(TAU * f * k as f64 / rate_hz);
                // tolerance: rounding errors of a transform of 131 072 lines, some 1e-14. The
                // transient has decayed within the half second of full amplitude before, 1256 time
                // constants of the filter. The fades have almost no content at half the sampling
                // rate, where the response is cut off
                assert!(
                    (a[k] - phasor.re).abs() < 1e-11,
                    "{f} Hz, {k}: {}",
                    a[k] - phasor.re
                );
            }
        }
    }
}

#[test]
fn a_delay_is_that_of_its_channel_and_within_the_record() {
    let history = history(1000.0, 1000, |_, t| (TAU * 50.0 * t).sin());
    let late = taken(&Instrument::new().delay("b", 0.0421).unwrap(), &history);
    assert_eq!(late.channel("a").unwrap(), history.channel("a").unwrap());
    assert_ne!(late.channel("b").unwrap(), history.channel("b").unwrap());
    let beyond = Instrument::new().delay("a", 1.0).unwrap();
    assert!(matches!(
        beyond.record(&history, &mut rng(0)),
        Err(LabioError::NonPhysical { .. })
    ));
}

#[test]
fn samples_without_an_aperture_are_those_of_the_history() {
    let history = history(10_000.0, 20_000, |_, t| tone(30.0)(t));
    let plain = taken(&Instrument::new().sample(1000.0, 0.0).unwrap(), &history);
    assert_eq!(plain.n_samples(), 2000);
    assert!(plain.start_time().to_bits() == history.start_time().to_bits());
    for (k, x) in plain.channel("a").unwrap().iter().enumerate() {
        assert_eq!(x.to_bits(), history.channel("a").unwrap()[10 * k].to_bits());
    }
    let uneven = Instrument::new().sample(3000.0, 0.0).unwrap();
    let error = uneven.record(&history, &mut rng(0)).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("sampling rate of the history over"),
        "{error}"
    );
}

/// Mean of the periodograms of channel a over records with different seeds, at the lines `lines`,
/// with a Hann window.
fn mean_periodogram(
    instrument: &Instrument,
    rate_hz: f64,
    n: usize,
    lines: &[usize],
    seeds: u64,
) -> Vec<f64> {
    let silence = history(rate_hz, n, |_, _| 0.0);
    let window: Vec<f64> = (0..n)
        .map(|k| (PI * k as f64 / n as f64).sin().powi(2))
        .collect();
    let energy: f64 = window.iter().map(|w| w * w).sum();
    let mut sums = vec![0.0; lines.len()];
    for seed in 0..seeds {
        let record = instrument.record(&silence, &mut rng(seed)).unwrap().record;
        let noise = record.channel("a").unwrap();
        for (sum, &line) in sums.iter_mut().zip(lines) {
            let turn = -TAU * line as f64 / n as f64;
            let x: Complex64 = (0..n)
                .map(|k| window[k] * noise[k] * Complex64::cis(turn * k as f64))
                .sum();
            *sum += 2.0 * x.norm_sqr() / (rate_hz * energy) / seeds as f64;
        }
    }
    sums
}

#[test]
fn noise_has_its_density_within_the_spread_of_chi_square() {
    let (rate_hz, n, seeds) = (4000.0, 512, 600);
    let lines = [4, 10, 16, 32, 50, 64, 100, 128, 180, 200, 240];
    let table = NoiseSpectrum::table(&[[50.0, 1e-4], [500.0, 1e-6], [2000.0, 1e-6]]).unwrap();
    let spectra = [
        NoiseSpectrum::white(3e-5).unwrap(),
        NoiseSpectrum::power_law(1e-4, 100.0, 1.0, 20.0).unwrap(),
        table,
    ];
    for spectrum in spectra {
        let instrument = Instrument::new().noise("a", spectrum.clone());
        let found = mean_periodogram(&instrument, rate_hz, n, &lines, seeds);
        for (found, line) in found.into_iter().zip(lines) {
            let expected = spectrum.density(line as f64 * rate_hz / n as f64);
            // tolerance: five standard deviations, for 33 lines. The mean of m = 600 exponential
            // deviates has a relative standard deviation of 1/√m and is nearly Gaussian. The window
            // adds a part of the neighbouring lines: (1/3)·3/10² = 1 % for f⁻² at line 10, and less
            // than 4 % on lower lines
            let spread = 5.0 / (seeds as f64).sqrt();
            let leakage = if line < 10 { 0.07 } else { 0.01 };
            assert!(
                (found / expected - 1.0).abs() < spread + leakage,
                "{spectrum:?} line {line}: {}",
                found / expected
            );
        }
    }
}

#[test]
fn a_seed_makes_a_record_and_another_seed_another() {
    let silence = history(1000.0, 100, |_, _| 0.0);
    let noisy = Instrument::new().noise("a", NoiseSpectrum::white(1.0).unwrap());
    let of = |seed| noisy.record(&silence, &mut rng(seed)).unwrap();
    assert_eq!(of(7), of(7));
    assert_ne!(of(7), of(8));
    let quiet = of(7).record;
    assert!(quiet.channel("b").unwrap().iter().all(|x| *x == 0.0));
}

#[test]
fn cross_talk_is_the_product_with_its_matrix() {
    let history = history(1000.0, 64, |channel, t| {
        if channel == 0 {
            (t * 64.0).floor()
        } else {
            8.0 * (t * 16.0).floor()
        }
    });
    // multiples of a power of 1/2 are exact
    let matrix = array![[1.0, 0.125], [-0.5, 0.75]];
    let mixed = taken(&Instrument::new().cross_talk(matrix).unwrap(), &history);
    let (a, b) = (history.channel("a").unwrap(), history.channel("b").unwrap());
    for k in 0..64 {
        let expected = [a[k] + 0.125 * b[k], -0.5 * a[k] + 0.75 * b[k]];
        for (name, expected) in ["a", "b"].into_iter().zip(expected) {
            let found = mixed.channel(name).unwrap()[k];
            assert!((found - expected).abs() == 0.0, "{found} {expected}");
        }
    }
    let odd = Instrument::new().cross_talk(array![[1.0, 0.0]]).unwrap();
    assert_eq!(
        odd.record(&history, &mut rng(0)).unwrap_err().to_string(),
        "rows and columns of the cross-talk matrix: found 1, expected 2"
    );
}

#[test]
fn gain_offset_and_resolution_are_what_they_say() {
    let history = history(1000.0, 64, |_, t| t);
    let instrument = Instrument::new()
        .gain("a", 1.5)
        .unwrap()
        .offset("a", -0.25)
        .unwrap()
        .resolution("b", 0.015625)
        .unwrap();
    let record = taken(&instrument, &history);
    for k in 0..64 {
        let t = k as f64 / 1000.0;
        assert!((record.channel("a").unwrap()[k] - (1.5 * t - 0.25)).abs() < 1e-16);
        let b = record.channel("b").unwrap()[k];
        // multiples of 1/64
        assert!((b - t).abs() <= 0.5 / 64.0 && (64.0 * b).fract() == 0.0);
    }
}

#[test]
fn a_chain_of_sensors_is_undone_by_calibration_to_a_step_of_the_converter() {
    let sensor = |value: f64| {
        SensorChain::of_sensitivity(Rating::new(value, "mV/g").unwrap())
            .unwrap()
            .with_gain(Rating::new(10.0, "1").unwrap())
            .unwrap()
    };
    let history = history(1000.0, 500, |_, t| 40.0 * (TAU * 3.0 * t).sin());
    let converter = Converter::new(12, 1.0).unwrap();
    let instrument = Instrument::new()
        .sense("a", sensor(10.0))
        .sense("b", sensor(10.0))
        .convert(converter);
    let volts = taken(&instrument, &history);
    assert_eq!(volts.channels()[0].quantity(), Quantity::Voltage);
    let calibrated = volts
        .calibrated("a", sensor(10.0))
        .unwrap()
        .calibrated("b", sensor(10.5))
        .unwrap();
    assert_eq!(calibrated.channels(), history.channels());
    let step = converter.step() / 0.1 * 9.80665; // 100 mV are one standard gravity
    for (k, x) in history.channel("a").unwrap().iter().enumerate() {
        let [a, b] = ["a", "b"].map(|name| calibrated.channel(name).unwrap()[k]);
        assert!((a - x).abs() <= step / 2.0 * (1.0 + 1e-9));
        // a sensitivity that is wrong by 5 %
        assert!((b * 1.05 - a).abs() < 1e-12);
    }
    let wrong = Instrument::new().sense(
        "a",
        SensorChain::of_sensitivity(Rating::new(1.0, "pC/N").unwrap()).unwrap(),
    );
    assert!(matches!(
        wrong.record(&history, &mut rng(0)),
        Err(LabioError::UnitMismatch { .. })
    ));
}

#[test]
fn an_overload_is_reported_and_every_stage_is_named() {
    let history = history(8000.0, 800, |channel, t| {
        if channel == 0 {
            (TAU * 10.0 * t).sin()
        } else {
            0.1
        }
    });
    let instrument = Instrument::new()
        .gain("a", 1.25)
        .unwrap()
        .noise("b", NoiseSpectrum::white(1e-9).unwrap())
        .anti_alias(AntiAlias::bessel(6, 2000.0).unwrap())
        .sample(4000.0, 1e-4)
        .unwrap()
        .convert_channel("a", Converter::new(16, 1.0).unwrap())
        .convert_channel("b", Converter::new(8, 1.0).unwrap().with_dither());
    let taken = instrument.record(&history, &mut rng(2)).unwrap();
    let [Saturation { channel, n_samples }] = taken.saturations.as_slice() else {
        panic!("{:?}", taken.saturations)
    };
    assert_eq!(channel, "a");
    // |1.25 sin| > 1 on the fraction 1 - (2/π) asin(0.8) = 0.4097 of 400 samples; tolerance:
    // rounding to whole samples at each edge
    assert!(
        (*n_samples as f64 - 0.4097 * 400.0).abs() <= 4.0,
        "{n_samples}"
    );
    insta::assert_snapshot!(taken.record.provenance().to_string(), @"computed by closed form, recorded with gain 1.25 of `a`; white noise of 1e-9 unit^2/Hz in `b`; Bessel low-pass of order 6 at 2000 Hz; samples at 4000 Hz with an aperture of 0.0001 s; 16 bits over ±1 for `a`; 8 bits over ±1 with dither for `b`");
    let unknown = Instrument::new().gain("c", 1.0).unwrap();
    assert!(matches!(
        unknown.record(&history, &mut rng(0)),
        Err(LabioError::UnknownChannel { .. })
    ));
}

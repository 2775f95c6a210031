use super::*;
use crate::{ForceWindow, Quantity};
use ndarray::Array2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;

const NAMES: [&str; 3] = ["a", "b", "c"];

fn record(rows: &[Vec<f64>], sampling_rate_hz: f64) -> Record {
    let samples = Array2::from_shape_fn((rows.len(), rows[0].len()), |(c, n)| rows[c][n]);
    let channels = NAMES.map(|name| (name, Quantity::Velocity));
    Record::of_test(samples, sampling_rate_hz, &channels[..rows.len()])
}

fn noise(rng: &mut ChaCha8Rng, n: usize) -> Vec<f64> {
    (0..n).map(|_| StandardNormal.sample(rng)).collect()
}

#[test]
fn the_spectral_matrix_is_the_average_of_direct_sums() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let (n, rate, n_hits) = (30, 50.0, 4);
    let hits: Vec<Vec<Vec<f64>>> = (0..n_hits)
        .map(|_| (0..3).map(|_| noise(&mut rng, n)).collect())
        .collect();
    let records: Vec<Record> = hits.iter().map(|rows| record(rows, rate)).collect();
    let spectra = AveragedSpectra::of(&records, Window::HannPeriodic).unwrap();
    assert_eq!(spectra.n_averages(), n_hits);
    let transform = |samples: &[f64], k: usize| -> Complex64 {
        (0..n)
            .map(|i| {
                let hann = (TAU / 2.0 * i as f64 / n as f64).sin().powi(2);
                samples[i] * hann / rate * Complex64::cis(-TAU * (k * i) as f64 / n as f64)
            })
            .sum()
    };
    for (a, first) in NAMES.iter().enumerate() {
        for (b, second) in NAMES.iter().enumerate() {
            let cross = spectra.cross(first, second).unwrap();
            for (k, line) in cross.iter().enumerate() {
                let sides = if k == 0 || k == n / 2 { 1.0 } else { 2.0 };
                let mean: Complex64 = hits
                    .iter()
                    .map(|h| transform(&h[a], k).conj() * transform(&h[b], k))
                    .sum::<Complex64>()
                    / n_hits as f64;
                let expected = sides * mean / 0.375; // mean squared Hann weight
                // spectra are of order n/rate^2 = 0.01; a few hundred rounding errors
                assert!((line - expected).norm() < 1e-15, "{first}{second} {k}");
            }
        }
    }
}

#[test]
fn a_hit_unlike_the_others_is_refused_and_leaves_the_sums_alone() {
    let good = record(&[vec![1.0, 2.0, 0.5], vec![0.0, 1.0, 0.0]], 10.0);
    let mut averager = SpectrumAverager::for_records_like(&good, Window::Rectangular).unwrap();
    averager.add(&good).unwrap();
    let before = averager.spectra().unwrap();
    let channels = [("a", Quantity::Velocity), ("b", Quantity::Force)];
    let other_channel = Record::of_test(good.samples().to_owned(), 10.0, &channels);
    let refusals = [
        record(&[vec![1.0, 2.0], vec![0.0, 1.0]], 10.0),
        record(&[vec![1.0, 2.0, 3.0]], 10.0),
        record(&[vec![1.0, 2.0, 0.5], vec![0.0, 1.0, 0.0]], 10.001),
        other_channel,
    ]
    .map(|hit| averager.add(&hit).unwrap_err().to_string())
    .join("\n");
    insta::assert_snapshot!(refusals, @r"
    samples of a hit: found 2, expected 3
    channels of a hit: found 1, expected 2
    the sampling rate is 10.001 Hz, expected 10 Hz as in the previous hits
    channel 1 is `b` [N], expected `b` [m/s] as in the previous hits
    ");
    assert_eq!(averager.spectra().unwrap().auto, before.auto);
    assert_eq!(averager.n_averages(), 1);
}

#[test]
fn finite_samples_with_an_infinite_spectrum_are_an_error() {
    let hit = record(&[vec![1e200, -1e200, 1e200]], 10.0);
    let error = AveragedSpectra::of([&hit], Window::Rectangular).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the spectrum of channel `a` overflows at line 0"
    );
}

#[test]
fn no_hit_is_an_error() {
    let error = AveragedSpectra::of([], Window::Rectangular).unwrap_err();
    assert_eq!(
        error.to_string(),
        "an averaged spectrum needs at least 1 averages, found 0"
    );
}

#[test]
fn a_force_window_takes_the_noise_around_the_pulse_and_nothing_else() {
    let n = 64;
    let mut pulse = vec![0.0; n];
    for (i, slot) in pulse.iter_mut().enumerate().take(14).skip(10) {
        *slot = (i as f64 - 9.5).sin();
    }
    let mut rng = ChaCha8Rng::seed_from_u64(21);
    let noise = noise(&mut rng, n);
    let noisy: Vec<f64> = (0..n)
        .map(|i| {
            if (10..14).contains(&i) {
                pulse[i]
            } else {
                noise[i]
            }
        })
        .collect();
    let other = vec![1.0; n];
    let gate = ForceWindow::new(0.10, 0.13, 0.0).unwrap();
    let gated = SpectrumAverager::for_records_like(
        &record(&[noisy.clone(), other.clone()], 100.0),
        Window::Rectangular,
    )
    .unwrap();
    let mut gated = gated.with_force_window("a", gate).unwrap();
    gated.add(&record(&[noisy, other.clone()], 100.0)).unwrap();
    let gated = gated.spectra().unwrap();
    let clean = record(&[pulse, other], 100.0);
    let clean = AveragedSpectra::of([&clean], Window::Rectangular).unwrap();
    // all weights are 1 or 0: the numbers are the same
    assert_eq!(gated.auto("a").unwrap(), clean.auto("a").unwrap());
    assert_eq!(gated.auto("b").unwrap(), clean.auto("b").unwrap());
    assert_eq!(
        gated.cross("a", "b").unwrap(),
        clean.cross("a", "b").unwrap()
    );
}

#[test]
fn windows_that_would_weigh_twice_or_too_late_are_refused() {
    let hit = record(&[vec![1.0, 2.0, 3.0, 4.0]], 10.0);
    let averager = |window| SpectrumAverager::for_records_like(&hit, window).unwrap();
    let gate = ForceWindow::new(0.0, 0.1, 0.0).unwrap();
    let decay = AddedDamping::new(1.0).unwrap();
    let mut late = averager(Window::Rectangular);
    late.add(&hit).unwrap();
    let refusals = [
        averager(Window::HannPeriodic).with_force_window("a", gate),
        averager(Window::HannPeriodic).with_exponential_window(decay),
        averager(Window::Rectangular)
            .with_exponential_window(decay)
            .unwrap()
            .with_exponential_window(decay),
        averager(Window::Rectangular).with_force_window("hammer", gate),
        late.with_force_window("a", gate),
    ]
    .map(|result| result.unwrap_err().to_string())
    .join("\n");
    insta::assert_snapshot!(refusals, @r"
    a force window cannot be combined with HannPeriodic
    an exponential window cannot be combined with HannPeriodic
    an exponential window cannot be combined with an exponential window
    there is no channel `hammer`, only `a`
    a force window must be chosen before the first hit, but 1 have been added
    ");
}

#[test]
fn a_silent_channel_stays_silent_beside_a_loud_one() {
    let mut rng = ChaCha8Rng::seed_from_u64(23);
    let loud: Vec<f64> = noise(&mut rng, 64).iter().map(|x| 1e6 * x).collect();
    let faint: Vec<f64> = noise(&mut rng, 64).iter().map(|x| 1e-9 * x).collect();
    let silent = vec![0.0; 64];
    let hit = record(&[loud, silent, faint.clone()], 10.0);
    let spectra = AveragedSpectra::of([&hit, &hit], Window::HannPeriodic).unwrap();
    assert!(spectra.auto("b").unwrap().iter().all(|g| *g <= 0.0));
    let alone = record(&[faint], 10.0);
    let alone = AveragedSpectra::of([&alone, &alone], Window::HannPeriodic).unwrap();
    // every channel is transformed separately
    assert_eq!(spectra.auto("c").unwrap(), alone.auto("a").unwrap());
}

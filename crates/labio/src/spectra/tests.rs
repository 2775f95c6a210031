use super::*;
use crate::{ForceWindow, Quantity};
use ndarray::Array2;
use testbed::noise::Noise;

const NAMES: [&str; 3] = ["a", "b", "c"];

fn record(rows: &[Vec<f64>], sampling_rate_hz: f64) -> Record {
    let samples = Array2::from_shape_fn((rows.len(), rows[0].len()), |(c, n)| rows[c][n]);
    let channels = NAMES.map(|name| (name, Quantity::Velocity));
    Record::of_test(samples, sampling_rate_hz, &channels[..rows.len()])
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
    let mut rng = Noise::seeded(21);
    let noise = rng.white(n, 1.0);
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
    let mut rng = Noise::seeded(23);
    let loud = rng.white(64, 1e6);
    let faint = rng.white(64, 1e-9);
    let silent = vec![0.0; 64];
    let hit = record(&[loud, silent, faint.clone()], 10.0);
    let spectra = AveragedSpectra::of([&hit, &hit], Window::HannPeriodic).unwrap();
    assert!(spectra.auto("b").unwrap().iter().all(|g| *g <= 0.0));
    let alone = record(&[faint], 10.0);
    let alone = AveragedSpectra::of([&alone, &alone], Window::HannPeriodic).unwrap();
    // every channel is transformed separately
    assert_eq!(spectra.auto("c").unwrap(), alone.auto("a").unwrap());
}

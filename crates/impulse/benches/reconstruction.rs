//! Force from a measured response of 25 600 samples, one second of a hammer test, with the
//! regularisation found from the data; and on a support of 256 samples, with and without tension.
//! The lower bound is the transform of the response and that of the force.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    reason = "the macros of criterion define undocumented functions, and a benchmark that cannot start may panic"
)]

use std::f64::consts::TAU;
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use impulse::{Parameter, Penalty, Reconstruction, Regularisation, TimeInterval};
use num_complex::Complex64;
use realfft::RealFftPlanner;

const N: usize = 25_600;
const RATE_HZ: f64 = 25_600.0;

/// A resonator struck by half a sine, with noise from a linear congruential generator, and its
/// frequency response.
fn data() -> (Vec<f64>, Vec<Complex64>) {
    let (radius, turn) = (0.998_f64, 0.2_f64);
    let mut state = 1_u64;
    let mut noise = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let (mut last, mut before) = (0.0, 0.0);
    let response = (0..N)
        .map(|n| {
            let force = match n {
                40..70 => (TAU * (n as f64 - 40.0) / 60.0).sin(),
                _ => 0.0,
            };
            let x = 2.0 * radius * turn.cos() * last - radius * radius * before + force;
            before = last;
            last = x;
            x + 0.1 * noise()
        })
        .collect();
    let lines = (0..=N / 2)
        .map(|k| {
            let delay = Complex64::cis(-TAU * k as f64 / N as f64);
            1.0 / (1.0 - 2.0 * radius * turn.cos() * delay + radius * radius * delay * delay)
        })
        .collect();
    (response, lines)
}

fn reconstruction(criterion: &mut Criterion) {
    let (response, lines) = data();
    let mut group = criterion.benchmark_group("reconstruction, 25600 samples");
    group.sample_size(10);
    let mut planner = RealFftPlanner::<f64>::new();
    let (forward, inverse) = (planner.plan_fft_forward(N), planner.plan_fft_inverse(N));
    let mut history = forward.make_input_vec();
    let mut spectrum = forward.make_output_vec();
    group.bench_function("transforms alone", |bencher| {
        bencher.iter(|| {
            history.copy_from_slice(black_box(&response));
            forward.process(&mut history, &mut spectrum).unwrap();
            inverse.process(&mut spectrum, &mut history).unwrap();
            black_box(&history);
        });
    });
    for (name, parameter) in [
        ("cross validation", Parameter::GeneralisedCrossValidation),
        ("L-curve", Parameter::LCurve),
    ] {
        let regularisation = Regularisation::Tikhonov {
            penalty: Penalty::Slope,
            parameter,
        };
        let problem = Reconstruction::new(&response, RATE_HZ, &lines)
            .unwrap()
            .with_regularisation(regularisation);
        let support = TimeInterval {
            from: 0.0,
            to: 255.5 / RATE_HZ,
        };
        let confined = problem.clone().acting_during(support);
        let pressing = confined.clone().non_negative();
        for (what, problem) in [
            ("all lines", problem),
            ("support of 256", confined),
            ("support of 256, no tension", pressing),
        ] {
            group.bench_function(format!("{what}, {name}"), |bencher| {
                bencher.iter(|| black_box(&problem).solve().unwrap());
            });
        }
    }
    group.finish();
}

criterion_group!(benches, reconstruction);
criterion_main!(benches);

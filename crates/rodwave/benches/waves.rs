//! Two waves from the strains of two and three gauges with 23 038 samples: transforms of twice the
//! length of the record, the waves at every line, and their histories at another section. The plan
//! of the lines is made for each record, or only once. The bound is the time of the transforms
//! alone.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "the macros of criterion define undocumented functions, and a benchmark that cannot start may panic"
)]

use std::f64::consts::TAU;
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use num_complex::Complex64;
use realfft::RealFftPlanner;
use rodwave::waves::SectionWaves;

const SAMPLES: usize = 23_038;
const RATE_HZ: f64 = 1e6;

/// A pulse of 40 µs in polycarbonate that passes `position` and returns from a free end at 1 m.
fn strain(position: f64) -> Vec<f64> {
    let pulse = |time: f64| (-(time / 40e-6).powi(2)).exp();
    (0..SAMPLES)
        .map(|n| {
            let time = n as f64 / RATE_HZ - 200e-6;
            pulse(time - position / 1450.0) - pulse(time - (2.0 - position) / 1450.0)
        })
        .collect()
}

fn separation(criterion: &mut Criterion) {
    let mut planner = RealFftPlanner::<f64>::new();
    let mut group = criterion.benchmark_group("separation of waves, 23038 samples");
    // about twice the length of the record, with small prime factors
    let n = 46_080;
    let (forward, inverse) = (planner.plan_fft_forward(n), planner.plan_fft_inverse(n));
    let gamma: Vec<Complex64> = (0..=n / 2)
        .map(|k| Complex64::new(0.01, 1.0) * (TAU * RATE_HZ / n as f64 * k as f64 / 1450.0))
        .collect();
    for positions in [&[0.3, 0.5][..], &[0.3, 0.42, 0.5]] {
        let strains: Vec<Vec<f64>> = positions.iter().map(|x| strain(*x)).collect();
        let planned = || SectionWaves::new(black_box(&gamma), positions, 0.4).unwrap();
        let plan = planned();
        let mut padded = forward.make_input_vec();
        let mut spectra = vec![forward.make_output_vec(); positions.len()];
        let mut waves = [inverse.make_input_vec(), inverse.make_input_vec()];
        let mut histories = [inverse.make_output_vec(), inverse.make_output_vec()];
        let mut separate = |plan: &SectionWaves| {
            for (strain, spectrum) in black_box(&strains).iter().zip(&mut spectra) {
                padded.fill(0.0);
                padded[..SAMPLES].copy_from_slice(strain);
                forward.process(&mut padded, spectrum).unwrap();
            }
            let rows: Vec<&[Complex64]> = spectra.iter().map(Vec::as_slice).collect();
            let [along, against] = &mut waves;
            plan.waves(&rows, along, against).unwrap();
            for (wave, history) in waves.iter_mut().zip(&mut histories) {
                // at 0 Hz and at half the sampling rate, a line has no phase
                wave[0] = Complex64::ZERO;
                wave[n / 2] = Complex64::ZERO;
                inverse.process(wave, history).unwrap();
            }
            black_box(&histories);
        };
        let gauges = format!("{} gauges", positions.len());
        group.bench_function(gauges.as_str(), |bencher| {
            bencher.iter(|| separate(&planned()));
        });
        group.bench_function(format!("{gauges}, planned"), |bencher| {
            bencher.iter(|| separate(&plan));
        });
        group.bench_function(format!("{gauges}, transforms alone"), |bencher| {
            bencher.iter(|| {
                for (strain, spectrum) in black_box(&strains).iter().zip(&mut spectra) {
                    padded.fill(0.0);
                    padded[..SAMPLES].copy_from_slice(strain);
                    forward.process(&mut padded, spectrum).unwrap();
                }
                for (wave, history) in waves.iter_mut().zip(&mut histories) {
                    wave.copy_from_slice(&spectra[0]);
                    wave[0] = Complex64::ZERO;
                    wave[n / 2] = Complex64::ZERO;
                    inverse.process(wave, history).unwrap();
                }
                black_box(&histories);
            });
        });
    }
}

criterion_group!(benches, separation);
criterion_main!(benches);

//! Two waves from the strains of two and three gauges: transforms of 23 038 samples padded to 2^17,
//! waves at every line, and their histories at another section.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "the macros of criterion define undocumented functions, and a benchmark that cannot start should say so"
)]

use std::f64::consts::TAU;
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use num_complex::Complex64;
use realfft::RealFftPlanner;
use rodwave::waves::{SectionWaves, TravellingWaves};

const SAMPLES: usize = 23_038;
const LINES: usize = (1 << 16) + 1;
const RATE_HZ: f64 = 1e6;

/// A pulse of 40 µs that passes `position` and comes back from a free end at 1 m, in polycarbonate.
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
    let n = 2 * (LINES - 1);
    let (forward, inverse) = (planner.plan_fft_forward(n), planner.plan_fft_inverse(n));
    let gamma: Vec<Complex64> = (0..LINES)
        .map(|k| Complex64::new(0.01, 1.0) * (TAU * RATE_HZ / n as f64 * k as f64 / 1450.0))
        .collect();
    let mut group = criterion.benchmark_group("separation of waves, 23038 samples");
    for positions in [&[0.3, 0.5][..], &[0.3, 0.42, 0.5]] {
        let strains: Vec<Vec<f64>> = positions.iter().map(|x| strain(*x)).collect();
        group.bench_function(format!("{} gauges", positions.len()), |bencher| {
            bencher.iter(|| {
                let spectra: Vec<Vec<Complex64>> = black_box(&strains)
                    .iter()
                    .map(|strain| {
                        let mut padded = strain.clone();
                        padded.resize(n, 0.0);
                        let mut spectrum = forward.make_output_vec();
                        forward.process(&mut padded, &mut spectrum).unwrap();
                        spectrum
                    })
                    .collect();
                let (mut along, mut against) = (inverse.make_input_vec(), inverse.make_input_vec());
                let mut values = vec![Complex64::ZERO; positions.len()];
                // at 0 Hz and at half the sampling rate a line has no phase
                for k in 1..LINES - 1 {
                    for (value, spectrum) in values.iter_mut().zip(&spectra) {
                        *value = spectrum[k];
                    }
                    let found = TravellingWaves::from_sections(gamma[k], positions, &values);
                    let waves = found.unwrap().waves;
                    along[k] = waves.forward_at(0.4);
                    against[k] = waves.backward_at(0.4);
                }
                [along, against].map(|mut spectrum| {
                    let mut history = inverse.make_output_vec();
                    inverse.process(&mut spectrum, &mut history).unwrap();
                    history
                })
            });
        });
    }
    // the plan once, and transforms of twice the record with small prime factors
    let n = 46_080;
    let (forward, inverse) = (planner.plan_fft_forward(n), planner.plan_fft_inverse(n));
    let gamma: Vec<Complex64> = (0..=n / 2)
        .map(|k| Complex64::new(0.01, 1.0) * (TAU * RATE_HZ / n as f64 * k as f64 / 1450.0))
        .collect();
    for positions in [&[0.3, 0.5][..], &[0.3, 0.42, 0.5]] {
        let strains: Vec<Vec<f64>> = positions.iter().map(|x| strain(*x)).collect();
        let plan = SectionWaves::new(&gamma, positions, 0.4).unwrap();
        let mut padded = forward.make_input_vec();
        let mut spectra = vec![forward.make_output_vec(); positions.len()];
        let mut waves = [inverse.make_input_vec(), inverse.make_input_vec()];
        let mut histories = [inverse.make_output_vec(), inverse.make_output_vec()];
        group.bench_function(format!("{} gauges, planned", positions.len()), |bencher| {
            bencher.iter(|| {
                for (strain, spectrum) in black_box(&strains).iter().zip(&mut spectra) {
                    padded.fill(0.0);
                    padded[..SAMPLES].copy_from_slice(strain);
                    forward.process(&mut padded, spectrum).unwrap();
                }
                let rows: Vec<&[Complex64]> = spectra.iter().map(Vec::as_slice).collect();
                let [along, against] = &mut waves;
                plan.waves(&rows, along, against).unwrap();
                for (wave, history) in waves.iter_mut().zip(&mut histories) {
                    // at 0 Hz and at half the sampling rate a line has no phase
                    wave[0] = Complex64::ZERO;
                    wave[n / 2] = Complex64::ZERO;
                    inverse.process(wave, history).unwrap();
                }
                black_box(&histories);
            });
        });
    }
    group.finish();
}

criterion_group!(benches, separation);
criterion_main!(benches);

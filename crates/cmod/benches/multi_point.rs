//! Benchmark of estimates from the strains on 4096 lines, with errors: by least squares from three
//! and from five gauges, and in closed form from three gauges.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a benchmark may panic, and the macros of criterion define undocumented functions"
)]

use std::f64::consts::TAU;
use std::hint::black_box;

use cmod::{GaugeSpectra, GaugedRod, MultiPoint, ThreePoint};
use criterion::{Criterion, criterion_group, criterion_main};
use num_complex::Complex64;
use testbed::noise::Noise;

const LINES: usize = 4096;
const NOISE: f64 = 0.01;

/// Returns the spectra of two waves in polypropylene at the gauges, with 1 % noise.
fn spectra(positions: &[f64], frequency_hz: &[f64]) -> Vec<Vec<Complex64>> {
    let mut random = Noise::seeded(1);
    let mut spectrum = |x: &f64| {
        let value = |f: &f64| {
            let gamma = Complex64::new(0.035, 1.0) * (TAU * f / 1680.0);
            let noise = random.circular(NOISE * NOISE);
            (-gamma * x).exp() - (-gamma * (0.9 - x)).exp() + noise
        };
        frequency_hz.iter().map(value).collect()
    };
    positions.iter().map(&mut spectrum).collect()
}

fn bench(criterion: &mut Criterion) {
    let frequency_hz: Vec<f64> = (1..=LINES).map(|j| 10e3 / 4096.0 * j as f64).collect();
    let rod = |positions: &[f64]| GaugedRod {
        positions: positions.to_vec(),
        diameter: 0.016,
        density: 919.0,
    };
    for (name, positions) in [
        ("3 gauges", vec![0.1, 0.2, 0.3]),
        ("5 gauges", vec![0.1, 0.13, 0.19, 0.27, 0.3]),
    ] {
        let method = MultiPoint::new(rod(&positions)).unwrap();
        let strains = spectra(&positions, &frequency_hz);
        let noise = vec![vec![NOISE; LINES]; positions.len()];
        criterion.bench_function(
            &format!("least squares, {name}, {LINES} lines"),
            |bencher| {
                bencher.iter(|| {
                    let tests: [&[Vec<Complex64>]; 1] = [black_box(&strains)];
                    method.estimate(&GaugeSpectra {
                        frequency_hz: &frequency_hz,
                        tests: &tests,
                        noise: &noise,
                    })
                });
            },
        );
    }
    let positions = [0.1, 0.2, 0.3];
    let method = ThreePoint::new(rod(&positions)).unwrap();
    let strains = spectra(&positions, &frequency_hz);
    let noise = vec![vec![NOISE; LINES]; 3];
    criterion.bench_function("closed form, 3 gauges, 4096 lines", |bencher| {
        bencher.iter(|| {
            let tests: [&[Vec<Complex64>]; 1] = [black_box(&strains)];
            method.estimate(&GaugeSpectra {
                frequency_hz: &frequency_hz,
                tests: &tests,
                noise: &noise,
            })
        });
    });
}

criterion_group!(benches, bench);
criterion_main!(benches);

//! Two ends, 4096 lines: continuation in the mass ratio with all errors, random and of the
//! specimen.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a bench has no user but the one who runs it"
)]

use std::f64::consts::TAU;
use std::hint::black_box;

use cmod::two_point::{AveragedRatio, SpecimenUncertainty};
use cmod::{Solver, Specimen, TwoPoint};
use criterion::{Criterion, criterion_group, criterion_main};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const LINES: usize = 4096;
const NOISE: f64 = 3e-3;

fn bench(criterion: &mut Criterion) {
    // Test 6 of paper A to 20 kHz
    let specimen = Specimen {
        length: 0.799,
        diameter: 0.0158,
        density: 912.0,
        accelerometer_mass: 2.9e-3,
    };
    let uncertainty = SpecimenUncertainty {
        length: 5e-4,
        diameter: 5e-5,
        density: 1.0,
        accelerometer_mass: 5e-5,
    };
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut normal = move || -> f64 { StandardNormal.sample(&mut random) };
    let frequency_hz: Vec<f64> = (1..=LINES).map(|j| 20e3 / 4096.0 * j as f64).collect();
    let ratio: Vec<Complex64> = frequency_hz
        .iter()
        .map(|f| {
            let x = Complex64::new(0.035, 1.0) * (TAU * f / 1680.0 * specimen.length);
            let ratio = x.cosh() + specimen.mass_ratio() * x * x.sinh();
            ratio * (1.0 + Complex64::new(normal(), normal()) * (NOISE * 0.5_f64.sqrt()))
        })
        .collect();
    let coherence = vec![1.0 - 10.0 * NOISE * NOISE; LINES];
    let averaged = AveragedRatio {
        frequency_hz: &frequency_hz,
        acceleration_ratio: &ratio,
        coherence: &coherence,
        averages: 10.0,
    };
    let method = TwoPoint::new(specimen)
        .unwrap()
        .with_specimen_uncertainty(uncertainty)
        .unwrap();
    for (name, solver) in [
        ("continuation", Solver::Continuation),
        ("Newton", Solver::Newton),
        ("series", Solver::Series),
    ] {
        let method = method.with_solver(solver);
        criterion.bench_function(&format!("two-point, {name}, {LINES} lines"), |bencher| {
            bencher.iter(|| method.estimate_averaged(black_box(&averaged)).unwrap());
        });
    }
    criterion.bench_function(&format!("branches only, {LINES} lines"), |bencher| {
        bencher.iter(|| cmod::branch::resolve(black_box(&frequency_hz), &ratio).unwrap());
    });
}

criterion_group!(benches, bench);
criterion_main!(benches);

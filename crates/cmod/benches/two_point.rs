//! Benchmark of the two-point method on 4096 lines, with random errors and errors of the specimen,
//! by continuation in the mass ratio and by the other solvers. The lower bound of the time is that
//! of one evaluation of the hyperbolic functions per line.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a benchmark may panic, and the macros of criterion define undocumented functions"
)]

use std::f64::consts::TAU;
use std::hint::black_box;

use cmod::two_point::{AveragedRatio, SpecimenUncertainty};
use cmod::{Solver, Specimen, TwoPoint};
use criterion::{Criterion, criterion_group, criterion_main};
use num_complex::Complex64;
use testbed::noise::Noise;

const LINES: usize = 4096;
const NOISE: f64 = 3e-3;

/// Test 6 of paper A, with a chosen number of lines up to 20 kHz.
struct Test {
    specimen: Specimen,
    frequency_hz: Vec<f64>,
    ratio: Vec<Complex64>,
    coherence: Vec<f64>,
}

impl Test {
    fn of(lines: usize) -> Self {
        let specimen = Specimen {
            length: 0.799,
            diameter: 0.0158,
            density: 912.0,
            accelerometer_mass: 2.9e-3,
        };
        let mut random = Noise::seeded(1);
        let frequency_hz: Vec<f64> = (1..=lines)
            .map(|j| 20e3 / lines as f64 * j as f64)
            .collect();
        let ratio = frequency_hz.iter().map(|f| {
            let x = Complex64::new(0.035, 1.0) * (TAU * f / 1680.0 * specimen.length);
            let ratio = x.cosh() + specimen.mass_ratio() * x * x.sinh();
            ratio * (1.0 + random.circular(NOISE * NOISE))
        });
        Self {
            specimen,
            ratio: ratio.collect(),
            coherence: vec![1.0 - 10.0 * NOISE * NOISE; lines],
            frequency_hz,
        }
    }

    fn averaged(&self) -> AveragedRatio<'_> {
        AveragedRatio {
            frequency_hz: &self.frequency_hz,
            acceleration_ratio: &self.ratio,
            coherence: &self.coherence,
            averages: 10.0,
        }
    }

    fn method(&self) -> TwoPoint {
        let uncertainty = SpecimenUncertainty {
            length: 5e-4,
            diameter: 5e-5,
            density: 1.0,
            accelerometer_mass: 5e-5,
        };
        TwoPoint::new(self.specimen)
            .unwrap()
            .with_specimen_uncertainty(uncertainty)
            .unwrap()
    }
}

fn bench(criterion: &mut Criterion) {
    let test = Test::of(LINES);
    let averaged = test.averaged();
    for (name, solver) in [
        ("continuation", Solver::Continuation),
        ("Newton", Solver::Newton),
        ("series", Solver::Series),
    ] {
        let method = test.method().with_solver(solver);
        criterion.bench_function(&format!("two-point, {name}, {LINES} lines"), |bencher| {
            bencher.iter(|| method.estimate_averaged(black_box(&averaged)).unwrap());
        });
    }
    criterion.bench_function(&format!("branches only, {LINES} lines"), |bencher| {
        bencher.iter(|| cmod::branch::resolve(black_box(&test.frequency_hz), &test.ratio).unwrap());
    });
    criterion.bench_function(
        &format!("hyperbolic functions alone, {LINES} lines"),
        |bencher| {
            bencher.iter(|| -> Complex64 {
                let ratios = black_box(&test.ratio).iter();
                ratios.map(|ratio| ratio.cosh() + ratio.sinh()).sum()
            });
        },
    );
    for lines in [1024, 16_384] {
        let test = Test::of(lines);
        criterion.bench_function(&format!("two-point by lines/{lines}"), |bencher| {
            let method = test.method();
            bencher.iter(|| {
                method
                    .estimate_averaged(black_box(&test.averaged()))
                    .unwrap()
            });
        });
    }
}

criterion_group!(benches, bench);
criterion_main!(benches);

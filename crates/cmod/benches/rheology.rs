//! Benchmark of fits: laws of five parameters to 200 points, a Prony series with order selection to
//! 206 points, and master curves.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a benchmark may panic, and the macros of criterion define undocumented functions"
)]

use std::f64::consts::TAU;
use std::hint::black_box;

use cmod::rheology::{
    FitOptions, Law, MasterCurve, ModulusData, ModulusPoint, PronyFit, RheologicalFit,
    TemperatureSweep,
};
use criterion::{Criterion, criterion_group, criterion_main};
use num_complex::Complex64;
use rodwave::modulus::{
    ComplexModulus, FractionalZener, GeneralisedMaxwell, HavriliakNegami, MaxwellBranch,
};
use testbed::noise::Noise;

/// Lines at equal ratios of frequency with 1 % of noise.
fn measured(law: &dyn Fn(f64) -> Complex64, from: f64, to: f64, lines: u32) -> ModulusData {
    let mut random = Noise::seeded(u64::from(lines));
    let step = (to / from).ln() / f64::from(lines - 1);
    let points: Vec<_> = (0..lines)
        .map(|j| {
            let frequency_hz = from * (step * f64::from(j)).exp();
            let modulus = law(TAU * frequency_hz);
            let sigma = 0.01 * modulus.norm();
            let noise = random.circular(2.0 * sigma * sigma);
            ModulusPoint::circular(frequency_hz, modulus + noise, sigma)
        })
        .collect();
    ModulusData::new(&points).unwrap()
}

fn bench(criterion: &mut Criterion) {
    let options = FitOptions::default();
    let branch = |modulus, relaxation_time| MaxwellBranch {
        modulus,
        relaxation_time,
    };
    let two = GeneralisedMaxwell::new(2e9, vec![branch(0.4e9, 2e-5), branch(0.3e9, 1e-3)]).unwrap();
    let data = measured(&|omega| two.at(omega), 20.0, 50e3, 200);
    let far = GeneralisedMaxwell::new(1e9, vec![branch(1e9, 6e-6), branch(0.1e9, 3e-3)]).unwrap();
    let far = cmod::rheology::FittedLaw::GeneralisedMaxwell(far);
    criterion.bench_function(
        "two branches (5 parameters), 200 points, start a factor of three away",
        |bencher| {
            bencher.iter(|| RheologicalFit::from_start(black_box(&data), &far, &options));
        },
    );
    criterion.bench_function("the same with order selection", |bencher| {
        bencher.iter(|| PronyFit::new(black_box(&data), &options));
    });
    let skew = HavriliakNegami::new(1.5e9, 3.6e9, 2e-4, 0.7, 0.5).unwrap();
    let data = measured(&|omega| skew.at(omega), 20.0, 50e3, 200);
    criterion.bench_function(
        "Havriliak-Negami (5 parameters), grid and three starts",
        |bencher| {
            bencher.iter(|| RheologicalFit::new(black_box(&data), Law::HavriliakNegami, &options));
        },
    );
    let broad = FractionalZener::new(1e6, 2e9, 1e-4, 0.35).unwrap();
    let data = measured(&|omega| broad.at(omega), 1e-8, 1e7, 206);
    let plain = options.with_profiles(false);
    for (name, options) in [("", plain), (", with profiles", options)] {
        criterion.bench_function(
            &format!("Prony series with order selection, 206 points over 15 decades{name}"),
            |bencher| {
                bencher.iter(|| PronyFit::new(black_box(&data), &options));
            },
        );
    }
    let sweep = |temperatures: u32| {
        let middle = 0.5 * f64::from(temperatures - 1);
        let step = 13.2 / middle;
        let steps: Vec<_> = (0..temperatures)
            .map(|k| {
                let a = (-0.5 * step * (f64::from(k) - middle)).exp();
                let data = measured(&|omega| broad.at(omega * a), 400.0, 10e3, 16);
                (293.15 + 10.0 * f64::from(k), data)
            })
            .collect();
        TemperatureSweep::new(steps).unwrap()
    };
    for temperatures in [7, 13, 52] {
        let sweep = sweep(temperatures);
        let name = format!(
            "master curve of {temperatures} temperatures, {} points",
            16 * temperatures
        );
        criterion.bench_function(&name, |bencher| {
            bencher.iter(|| MasterCurve::new(black_box(&sweep), 6, &plain));
        });
    }
}

criterion_group!(benches, bench);
criterion_main!(benches);

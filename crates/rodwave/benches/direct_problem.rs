//! Cell updates a second of the direct problem of paper D, for each law; the elastic march is the baseline in the same run.
//!
//! One element of throughput is one node advanced by one step. A compiled Python version of the same scheme advances 32 to 40
//! million a second for Maxwell and 9 million for Maxwell-Norton on a machine of this kind.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    reason = "the macros of criterion define undocumented functions, and a benchmark that cannot start should say so"
)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rodwave::band_limited::SampledHistory;
use rodwave::inelastic::{
    Elastic, InelasticLaw, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton,
};
use rodwave::{DirectProblem, InelasticRod};

const CELLS: usize = 400;
const STEPS: u32 = 4000;

fn march<L: InelasticLaw>(criterion: &mut Criterion, name: &str, law: &L) {
    let rod = InelasticRod::new(0.394, 910.0, 2.58e9, law.clone()).unwrap();
    let problem = DirectProblem::new(rod, CELLS).unwrap();
    let mut group = criterion.benchmark_group("march");
    group.throughput(Throughput::Elements(u64::from(STEPS) * (CELLS as u64 + 1)));
    group.sample_size(20);
    group.bench_function(name, |bencher| {
        bencher.iter(|| {
            let mut march = problem.march(9.0);
            for _ in 0..STEPS {
                march.advance(black_box(9.0));
            }
            march.free_end_velocity()
        });
    });
    group.finish();
}

fn sensitivities<L: InelasticLaw>(criterion: &mut Criterion, name: &str, law: &L) {
    let rod = InelasticRod::new(0.394, 910.0, 2.58e9, law.clone()).unwrap();
    let problem = DirectProblem::new(rod, 100).unwrap();
    let rate = 51_200.0;
    let samples: Vec<f64> = (0..160_u32)
        .map(|k| 9.0 * (-((f64::from(k) - 35.0) / 3.0).powi(2)).exp())
        .collect();
    let excitation = SampledHistory::new(&samples, rate).unwrap();
    let times: Vec<f64> = (0..144_u32).map(|k| f64::from(k) / rate).collect();
    let mut group = criterion.benchmark_group("response of 144 samples");
    group.sample_size(20);
    group.bench_function(format!("{name}, velocity"), |bencher| {
        bencher.iter(|| {
            problem
                .free_end_velocity(black_box(&excitation), &times)
                .unwrap()
        });
    });
    group.bench_function(format!("{name}, velocity and derivatives"), |bencher| {
        bencher.iter(|| {
            problem
                .free_end_velocity_with_sensitivities(black_box(&excitation), &times)
                .unwrap()
        });
    });
    group.finish();
}

fn laws(criterion: &mut Criterion) {
    let maxwell = Maxwell::new(4e6).unwrap();
    let norton = MaxwellNorton::new(2.108, 7e13).unwrap();
    let gurevich = MaxwellGurevichRabinovich::new(3.5e6, 7.08e6).unwrap();
    march(criterion, "elastic", &Elastic);
    march(criterion, "Maxwell", &maxwell);
    march(criterion, "Maxwell-Norton", &norton);
    march(criterion, "Maxwell-Gurevich-Rabinovich", &gurevich);
    sensitivities(criterion, "Maxwell", &maxwell);
    sensitivities(criterion, "Maxwell-Norton", &norton);
    sensitivities(criterion, "Maxwell-Gurevich-Rabinovich", &gurevich);
}

criterion_group!(benches, laws);
criterion_main!(benches);

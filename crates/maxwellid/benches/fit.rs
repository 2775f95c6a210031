//! Whole identifications: the baseline is a least-squares routine of SciPy over a compiled solver
//! in Python, which takes two to three seconds for the first of these.
//!
//! | benchmark | what it shows | aim on two cores |
//! |---|---|---|
//! | four tests, three parameters | a joint fit from scratch, solver error below 0.1 % of V0 | 0.1 s |
//! | a hundred starts, two parameters | a tenth of a search from 1000 starts | 1 s |
//! | one test, noise of both histories | errors in variables with the transfer of a nonlinear rod | |
//!
//! The feature `rayon` spreads tests and starts over the cores.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the macros of criterion define undocumented functions, and a benchmark that cannot start should say so"
)]

#[path = "../tests/virtual_rod/mod.rs"]
mod virtual_rod;

use criterion::{Criterion, criterion_group, criterion_main};
use maxwellid::{Fit, RodTest};
use rodwave::inelastic::{Maxwell, MaxwellNorton};
use virtual_rod::struck;

fn fits(criterion: &mut Criterion) {
    let truth = MaxwellNorton::new(2.108, 7e13).unwrap();
    let start = MaxwellNorton::from_reference_rate(1.2, 1.0, 10e6).unwrap();
    // lengths of the polypropylene rods of paper D, Table 2
    let rods = [0.192, 0.394, 0.592, 0.792].map(|length| struck(length, 10.0, 2.58e9, &truth, 110));
    let tests: Vec<RodTest> = rods
        .iter()
        .map(|rod| RodTest::new(rod.data.clone()).unwrap())
        .collect();
    let mut group = criterion.benchmark_group("fit");
    group.sample_size(10);
    group.bench_function("four tests, three parameters", |bencher| {
        bencher.iter(|| Fit::of(start).to(&tests).unwrap().parameters().to_vec());
    });
    let linear =
        RodTest::new(struck(0.4, 10.0, 3e9, &Maxwell::new(4e6).unwrap(), 110).data).unwrap();
    let maxwell = Maxwell::new(1e6).unwrap();
    group.bench_function("a hundred starts, two parameters", |bencher| {
        bencher.iter(|| {
            let fit = Fit::of(maxwell).with_starts(100);
            fit.to(std::slice::from_ref(&linear))
                .unwrap()
                .parameters()
                .to_vec()
        });
    });
    let noisy = RodTest::new(rods[1].noisy(0.1, 1))
        .unwrap()
        .with_noise(0.1, 0.1)
        .unwrap();
    group.bench_function("one test, noise of both histories", |bencher| {
        bencher.iter(|| {
            let fit = Fit::of(start).to(std::slice::from_ref(&noisy)).unwrap();
            fit.parameters().to_vec()
        });
    });
    group.finish();
}

criterion_group!(benches, fits);
criterion_main!(benches);

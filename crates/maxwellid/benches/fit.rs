//! Benchmarks of complete identifications. For comparison: SciPy's least squares with a compiled
//! solver, called from Python, takes two to three seconds for the first one.
//!
//! | benchmark | what it shows | aim on two cores |
//! |---|---|---|
//! | four tests, three parameters | a joint fit from scratch, solver error below 0.1 % of V0 | 0.1 s |
//! | a hundred starts, two parameters | a tenth of a search from 1000 starts | 1 s |
//! | one test, noise of both histories | a fit that also estimates the excitation | |
//! | responses of the four tests | the responses and derivatives of one step of the joint fit | |
//! | five laws, two tests | a selection with its evidence | 0.3 s |
//!
//! The feature `rayon` spreads tests and starts over the cores. The number of tests in a fit and
//! the number of laws in a selection are varied in separate groups.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the macros of criterion define undocumented functions, and a benchmark that cannot start may panic"
)]

#[path = "../tests/virtual_rod/mod.rs"]
mod virtual_rod;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use maxwellid::selection::{Candidate, Selection};
use maxwellid::{Fit, Law, RodTest};
use rodwave::band_limited::SampledHistory;
use rodwave::inelastic::{Maxwell, MaxwellNorton};
use rodwave::{DirectProblem, InelasticRod};
use virtual_rod::{struck, times};

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
    // with cells of 4 mm, the default of a fit
    let problems = rods.each_ref().map(|rod| {
        let data = &rod.data;
        let cells = (data.length / 4e-3).ceil() as usize;
        let rod = InelasticRod::new(data.length, data.density, 2.58e9, truth).unwrap();
        let excitation = SampledHistory::new(&data.excitation, data.sampling_rate_hz).unwrap();
        let times = times(data.response.len());
        (DirectProblem::new(rod, cells).unwrap(), excitation, times)
    });
    group.bench_function(
        "responses of the four tests with three derivatives",
        |bencher| {
            bencher.iter(|| {
                for (problem, excitation, times) in &problems {
                    let response =
                        problem.free_end_velocity_with_sensitivities(black_box(excitation), times);
                    black_box(response.unwrap());
                }
            });
        },
    );
    for count in [2, 16] {
        let tests: Vec<RodTest> = tests
            .iter()
            .skip(1)
            .take(2)
            .cycle()
            .take(count)
            .cloned()
            .collect();
        group.bench_function(format!("by tests/{count}"), |bencher| {
            bencher.iter(|| Fit::of(start).to(&tests).unwrap().parameters().to_vec());
        });
    }
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

/// Selection of a law for two Maxwell-Norton rods at two velocities, with stated noise.
fn selection(criterion: &mut Criterion) {
    let truth = MaxwellNorton::new(2.108, 7e13).unwrap();
    let tests = [10.0, 25.0].map(|velocity| {
        let rod = struck(0.394, velocity, 2.58e9, &truth, 110);
        let test = RodTest::new(rod.noisy(0.08, 1)).unwrap();
        test.with_noise(0.08, 0.08).unwrap()
    });
    let laws = [
        Law::Elastic,
        Law::Maxwell,
        Law::ConstantQ,
        Law::Norton,
        Law::GurevichRabinovich,
    ];
    let mut group = criterion.benchmark_group("selection");
    group.sample_size(10);
    for (name, laws) in [
        ("five laws, two tests", laws.as_slice()),
        ("two laws, two tests", &laws[3..]),
    ] {
        let candidates: Vec<Candidate> = laws.iter().copied().map(Candidate::of).collect();
        let selection = Selection::new(candidates).unwrap();
        group.bench_function(name, |bencher| {
            bencher.iter(|| selection.compare(black_box(&tests)).unwrap());
        });
    }
    group.finish();
}

criterion_group!(benches, fits, selection);
criterion_main!(benches);

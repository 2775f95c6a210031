//! Benchmark of the count of waves on 4096 lines with 5 % noise: for a free end, for a mass on the
//! end, and for a band that begins at 3 kHz. The lower bound of the time is that of one complex
//! logarithm per line, which gives the phase of the line up to whole waves.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a benchmark may panic, and the macros of criterion define undocumented functions"
)]

use std::f64::consts::TAU;
use std::hint::black_box;

use cmod::branch::{BranchTracker, EndMass, FreeEnd, PhaseObservation, PhaseRecord};
use criterion::{Criterion, criterion_group, criterion_main};
use num_complex::Complex64;
use testbed::noise::Noise;

const LINES: usize = 4096;
const LENGTH: f64 = 0.8;
const NOISE: f64 = 0.05;

/// Lines of a record: frequencies, observed ratios and their variances.
struct Lines {
    frequency_hz: Vec<f64>,
    observed: Vec<Complex64>,
    variance: Vec<f64>,
}

impl Lines {
    fn of(observation: &dyn PhaseObservation, first: f64, count: usize) -> Self {
        let mut random = Noise::seeded(1);
        let step = 5.0 * LINES as f64 / count as f64;
        let frequency_hz: Vec<f64> = (1..=count).map(|j| first + step * j as f64).collect();
        let observed: Vec<Complex64> = frequency_hz
            .iter()
            .map(|f| {
                let gamma = Complex64::new(0.035, 1.0) * (TAU * f / 1680.0);
                let [ratio, ..] = observation.expand(gamma * LENGTH);
                ratio + random.circular(NOISE * NOISE * ratio.norm_sqr())
            })
            .collect();
        let variance = observed
            .iter()
            .map(|ratio| NOISE * NOISE * ratio.norm_sqr());
        Self {
            frequency_hz,
            variance: variance.collect(),
            observed,
        }
    }

    fn record<'a>(&'a self, observation: &'a dyn PhaseObservation) -> PhaseRecord<'a> {
        PhaseRecord {
            observation,
            length: LENGTH,
            frequency_hz: &self.frequency_hz,
            observed: &self.observed,
            variance: Some(&self.variance),
        }
    }
}

fn bench(criterion: &mut Criterion) {
    let mass = EndMass { mass_ratio: 0.02 };
    let cases: [(&str, &dyn PhaseObservation, f64); 3] = [
        ("free end", &FreeEnd, 0.0),
        ("end mass", &mass, 0.0),
        ("end mass from 3 kHz", &mass, 3000.0),
    ];
    let tracker = BranchTracker::new();
    let mut group = criterion.benchmark_group("branch of 4096 lines");
    for (name, observation, first) in cases {
        let lines = Lines::of(observation, first, LINES);
        let record = lines.record(observation);
        group.bench_function(name, |bencher| {
            bencher.iter(|| tracker.track(black_box(&[record])).unwrap());
        });
    }
    let lines = Lines::of(&FreeEnd, 0.0, LINES);
    group.bench_function("logarithms alone", |bencher| {
        bencher.iter(|| -> Complex64 {
            let observed = black_box(&lines.observed).iter();
            observed.map(|ratio| ratio.ln()).sum()
        });
    });
    group.finish();
    let mut group = criterion.benchmark_group("branch by lines");
    for count in [1024, 16_384] {
        let lines = Lines::of(&mass, 0.0, count);
        let record = lines.record(&mass);
        group.bench_function(count.to_string(), |bencher| {
            bencher.iter(|| tracker.track(black_box(&[record])).unwrap());
        });
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);

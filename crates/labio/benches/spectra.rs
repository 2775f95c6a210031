//! Frequency responses and coherence of two channels, from samples in memory to all three results,
//! on one thread.
//!
//! `welch`: 2^20 samples a channel in segments of 8192, Hann periodic, half overlap. `hits`: ten
//! hits of 65 536 samples.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "the macros of criterion define undocumented functions, and a benchmark that cannot start should say so"
)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use labio::{AveragedSpectra, Channel, Provenance, Quantity, Record, Welch, Window};
use ndarray::Array2;

/// Numbers without pattern, from a linear congruence.
fn noise(state: &mut u64) -> f64 {
    *state = state
        .wrapping_mul(6364136223846793005)
        .wrapping_add(1442695040888963407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
}

/// An input of noise and an output that is a filtered input with noise of its own.
fn record(n_samples: usize, state: &mut u64) -> Record {
    let mut samples = Array2::zeros((2, n_samples));
    let mut output = 0.0;
    for n in 0..n_samples {
        let input = noise(state);
        output = 0.9 * output + input;
        samples[(0, n)] = input;
        samples[(1, n)] = output + 0.1 * noise(state);
    }
    let channels = vec![
        Channel::new("force", Quantity::Force).unwrap(),
        Channel::new("response", Quantity::Acceleration).unwrap(),
    ];
    Record::new(
        samples,
        51_200.0,
        0.0,
        channels,
        Provenance::computed("noise"),
    )
    .unwrap()
}

fn welch(criterion: &mut Criterion) {
    let n_samples = 1 << 20;
    let record = record(n_samples, &mut 1);
    let mut group = criterion.benchmark_group("welch");
    group.throughput(Throughput::Elements(2 * n_samples as u64));
    group.bench_function("h1 h2 coherence, 2^20 samples, 8192 Hann", |bencher| {
        bencher.iter(|| {
            let spectra = Welch::new(8192)
                .unwrap()
                .spectra(black_box(&record))
                .unwrap();
            (
                spectra.h1("force", "response").unwrap(),
                spectra.h2("force", "response").unwrap(),
                spectra.coherence("force", "response").unwrap(),
            )
        });
    });
    group.finish();
}

fn hits(criterion: &mut Criterion) {
    let (n_hits, n_samples) = (10, 65_536);
    let mut state = 2;
    let hits: Vec<Record> = (0..n_hits).map(|_| record(n_samples, &mut state)).collect();
    let mut group = criterion.benchmark_group("hits");
    group.throughput(Throughput::Elements(2 * n_hits * n_samples as u64));
    group.bench_function("h1 h2 coherence, 10 hits of 65536", |bencher| {
        bencher.iter(|| {
            let spectra = AveragedSpectra::of(black_box(&hits), Window::Rectangular).unwrap();
            (
                spectra.h1("force", "response").unwrap(),
                spectra.h2("force", "response").unwrap(),
                spectra.coherence("force", "response").unwrap(),
            )
        });
    });
    group.finish();
}

criterion_group!(benches, welch, hits);
criterion_main!(benches);

//! Benchmark of H1, H2 and the coherence of two channels in memory, on one thread.
//!
//! `welch`: 2^20 samples per channel in segments of 8192, with a periodic Hann window and half
//! overlap. `hits`: ten hits of 65 536 samples. The lower bound of either time is that of the same
//! number of real transforms of the same length, including the copies of the samples into the
//! buffer of the transform. Two further groups vary the number and the length of the hits.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "the macros of criterion define undocumented functions, and a benchmark that cannot start may panic"
)]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use labio::{AveragedSpectra, Channel, Provenance, Quantity, Record, Welch, Window};
use ndarray::Array2;
use realfft::RealFftPlanner;

/// Pseudorandom number from a linear congruential generator.
fn noise(state: &mut u64) -> f64 {
    *state = state
        .wrapping_mul(6364136223846793005)
        .wrapping_add(1442695040888963407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
}

/// A record of white noise as input, and of the filtered input plus independent noise as output.
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

/// Returns a function that transforms `count` parts of `record` of `length` samples each.
fn transforms(record: &Record, length: usize, count: usize) -> impl FnMut() + use<> {
    let samples: Vec<f64> = record.samples().iter().copied().collect();
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(length);
    let mut input = transform.make_input_vec();
    let mut spectrum = transform.make_output_vec();
    let mut scratch = transform.make_scratch_vec();
    move || {
        for number in 0..count {
            let from = number * length % (samples.len() - length + 1);
            input.copy_from_slice(&samples[from..from + length]);
            transform
                .process_with_scratch(&mut input, &mut spectrum, &mut scratch)
                .unwrap();
            black_box(&spectrum);
        }
    }
}

fn responses(hits: &[Record]) -> impl Sized {
    let spectra = AveragedSpectra::of(hits, Window::Rectangular).unwrap();
    (
        spectra.h1("force", "response").unwrap(),
        spectra.h2("force", "response").unwrap(),
        spectra.coherence("force", "response").unwrap(),
    )
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
    // two channels, segments that overlap by half
    let segments = 2 * n_samples / 8192 - 1;
    let mut alone = transforms(&record, 8192, 2 * segments);
    group.bench_function("transforms alone", |bencher| bencher.iter(&mut alone));
    group.finish();
}

fn hits(criterion: &mut Criterion) {
    let (n_hits, n_samples) = (10_usize, 65_536);
    let mut state = 2;
    let hits: Vec<Record> = (0..n_hits).map(|_| record(n_samples, &mut state)).collect();
    let mut group = criterion.benchmark_group("hits");
    group.throughput(Throughput::Elements((2 * n_hits * n_samples) as u64));
    group.bench_function("h1 h2 coherence, 10 hits of 65536", |bencher| {
        bencher.iter(|| responses(black_box(&hits)));
    });
    let mut alone = transforms(&hits[0], n_samples, 2 * n_hits);
    group.bench_function("transforms alone", |bencher| bencher.iter(&mut alone));
    group.finish();
}

fn growth(criterion: &mut Criterion) {
    let mut state = 3;
    for (varied, sizes) in [
        ("number", [(4, 8192), (64, 8192)]),
        ("samples", [(4, 8192), (4, 131_072)]),
    ] {
        let mut group = criterion.benchmark_group(format!("hits by {varied}"));
        group.sample_size(20);
        for (n_hits, n_samples) in sizes {
            let hits: Vec<Record> = (0..n_hits).map(|_| record(n_samples, &mut state)).collect();
            let size = if varied == "number" {
                n_hits
            } else {
                n_samples
            };
            group.bench_function(BenchmarkId::from_parameter(size), |bencher| {
                bencher.iter(|| responses(black_box(&hits)));
            });
        }
        group.finish();
    }
}

criterion_group!(benches, welch, hits, growth);
criterion_main!(benches);

//! Mobility of a chain at many frequencies.
//!
//! One element of throughput is one element of the chain at one frequency, including its material
//! law. The groups differ in the law. Within a group, the number of elements and the number of
//! frequencies vary over one band; the rate must not depend on them. The band is the same because a
//! sine takes longer at a phase above a quarter of π than below. The bound for an elastic rod is one
//! hyperbolic cosine and sine of a complex number per element and frequency.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    reason = "the macros of criterion define undocumented functions, and a benchmark that cannot start may panic"
)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use num_complex::Complex64;
use rodwave::chain::{AngularFrequency, ChainBuilder, WaveMedium};
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::{Elastic, FractionalZener, PowerLawPropagation, Zener};
use rodwave::{Chain, Termination};

/// Builds a chain of elements between two sizes, thin at its impact face.
fn chain(
    n_elements: usize,
    add: impl Fn(ChainBuilder, usize, Circle, Circle) -> ChainBuilder,
) -> Chain {
    let [thin, thick] = [0.02, 0.03].map(|diameter| Circle::of_diameter(diameter).unwrap());
    let elements = (0..n_elements).fold(Chain::from_impact_face(), |row, index| {
        let (near, far) = if index % 2 == 0 {
            (thin, thick)
        } else {
            (thick, thin)
        };
        add(row, index, near, far)
    });
    elements.end(Termination::Free).unwrap()
}

fn rods<M>(medium: &M, n_elements: usize) -> Chain
where
    M: WaveMedium<AngularFrequency> + Clone + 'static,
{
    chain(n_elements, |row, _, near, _| row.rod(medium, near, 0.1))
}

/// Highest angular frequency \[rad/s\]: at this frequency, kL of an elastic rod is 4.8 rad.
const TOP: f64 = 245_760.0;

fn measure(criterion: &mut Criterion, group: &str, chain: &Chain, n_frequencies: u32) {
    let n_elements = chain.n_elements();
    let mut group = criterion.benchmark_group(group);
    group.sample_size(30);
    group.throughput(Throughput::Elements(
        n_elements as u64 * u64::from(n_frequencies),
    ));
    let name = format!("{n_elements} elements, {n_frequencies} frequencies");
    group.bench_function(name, |bencher| {
        let spacing = TOP / f64::from(n_frequencies);
        bencher.iter(|| {
            (1..=n_frequencies)
                .map(|line| {
                    chain
                        .mobility(black_box(spacing * f64::from(line)))
                        .unwrap()
                })
                .sum::<Complex64>()
        });
    });
}

fn laws(criterion: &mut Criterion) {
    let elastic = Medium::new(7780.0, Elastic::new(206e9).unwrap()).unwrap();
    let zener = Medium::new(910.0, Zener::new(2.2e9, 2.6e9, 3e-5).unwrap()).unwrap();
    let power = Medium::new(
        1150.0,
        PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970).unwrap(),
    )
    .unwrap();
    let fractional = FractionalZener::new(1e9, 4e9, 1e-4, 0.3).unwrap();
    let fractional = Medium::new(1150.0, fractional).unwrap();

    for (n_elements, n_frequencies) in [
        (4, 1024),
        (16, 1024),
        (64, 1024),
        (256, 1024),
        (16, 256),
        (16, 4096),
    ] {
        let rods = rods(&elastic, n_elements);
        measure(criterion, "elastic rods", &rods, n_frequencies);
    }
    let cones = chain(16, |row, index, near, far| {
        if index % 2 == 0 {
            row.cone(&elastic, near, far, 0.1)
        } else {
            row.horn(&elastic, near, far, 0.1)
        }
    });
    measure(criterion, "elastic cones and horns", &cones, 1024);
    measure(criterion, "Zener rods", &rods(&zener, 16), 1024);
    measure(criterion, "rods of paper E, eq. 7", &rods(&power, 16), 1024);
    for (n_elements, n_frequencies) in [(4, 1024), (16, 1024), (64, 1024), (16, 4096)] {
        let rods = rods(&fractional, n_elements);
        measure(criterion, "fractional rods", &rods, n_frequencies);
    }

    let mut group = criterion.benchmark_group("elastic rods");
    group.sample_size(30);
    group.throughput(Throughput::Elements(16 * 1024));
    group.bench_function("hyperbolic functions alone", |bencher| {
        bencher.iter(|| {
            (0..16 * 1024_u32)
                .map(|n| Complex64::new(1e-3, 1e-3 * black_box(f64::from(n))))
                .map(|argument| argument.cosh() + argument.sinh())
                .sum::<Complex64>()
        });
    });
}

criterion_group!(benches, laws);
criterion_main!(benches);

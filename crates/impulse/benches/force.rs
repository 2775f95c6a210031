//! Stick force by Fourier transform, kernels, and the march with contact.
//!
//! The march is measured for several numbers of steps and compared with direct summation: the march
//! grows as N log² N, the summation as N². The lower bound of the march is one convolution of the
//! whole history by transforms, with the force given; that of the stick force is one transform.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "the macros of criterion define undocumented functions, and a benchmark that cannot start may panic"
)]

use std::f64::consts::TAU;
use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use impulse::{
    ContactLaw, Impact, Kernel, MobilityLaw, Quadrature, StickProblem, StickUncertainty, TimeGrid,
    ZeroLine,
};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use realfft::RealFftPlanner;
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::{ConstantQ, Elastic};

/// Two bodies that stick, on lines `frequency_step_hz` apart.
fn stuck<'a>(
    first: &'a [Complex64],
    second: &'a [Complex64],
    frequency_step_hz: f64,
) -> StickProblem<'a> {
    StickProblem {
        first,
        second,
        frequency_step_hz,
        impact_velocity: 1.0,
        zero_line: ZeroLine::EffectiveMass(0.5),
        roll_off_from_hz: None,
        interpolation: 1,
        until: None,
    }
}

/// Makes one transform from `n` lines to their history, and back if `back` is true, as in a
/// convolution.
fn transforms(n: usize, back: bool) -> impl FnMut() {
    let mut planner = RealFftPlanner::<f64>::new();
    let (inverse, forward) = (planner.plan_fft_inverse(n), planner.plan_fft_forward(n));
    let mut spectrum = inverse.make_input_vec();
    let mut history = inverse.make_output_vec();
    move || {
        spectrum.fill(Complex64::from(1.0));
        inverse
            .process(black_box(&mut spectrum), &mut history)
            .unwrap();
        if back {
            forward.process(&mut history, &mut spectrum).unwrap();
        }
        black_box(&history);
    }
}

fn stick_by_fourier(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("stick force by Fourier transform");
    for exponent in [11, 14, 17] {
        let n_samples = 1_usize << exponent;
        let step_hz = 10.0;
        let line = |k: usize| Complex64::new(0.0, TAU * step_hz * k as f64);
        let striker: Vec<Complex64> = (0..=n_samples / 2).map(|k| 2.0 / line(k)).collect();
        let rod = vec![Complex64::from(1e-3); striker.len()];
        let problem = stuck(&striker, &rod, step_hz);
        group.throughput(Throughput::Elements(n_samples as u64));
        group.bench_function(BenchmarkId::from_parameter(n_samples), |bencher| {
            bencher.iter(|| black_box(&problem).solve().unwrap());
        });
    }
    let mut alone = transforms(1 << 17, false);
    group.bench_function("transform alone", |bencher| bencher.iter(&mut alone));
    group.finish();
}

/// Measures a stick force of 2 x 2048 lines with its simultaneous band, the errors of the lines
/// being propagated to first order.
fn stick_with_its_band(criterion: &mut Criterion) {
    let step_hz = 5.0;
    let line = |k: usize| Complex64::new(0.0, TAU * step_hz * k as f64);
    let striker: Vec<Complex64> = (0..=2048).map(|k| 2.0 / line(k.max(1))).collect();
    let rod = vec![Complex64::from(1e-3); striker.len()];
    let variance: Vec<f64> = rod.iter().map(|line| 1e-4 * line.norm_sqr()).collect();
    let problem = stuck(&striker, &rod, step_hz);
    let errors = StickUncertainty {
        first_variance: Some(&variance),
        second_variance: Some(&variance),
        first_scale: 0.01,
        impact_velocity: 2e-3,
        ..StickUncertainty::default()
    };
    criterion.bench_function("stick force with its band/4096", |bencher| {
        bencher.iter(|| {
            let force = black_box(&problem).solve().unwrap();
            let error = problem.error(&errors).unwrap();
            let mut random = ChaCha8Rng::seed_from_u64(1);
            // the contact lasts an eighth of the period
            let band = error.simultaneous(&force.history, 0.95, 0..512, 400, &mut random);
            band.unwrap()
        });
    });
}

/// Measures the march alone: the mobilities cost nothing, and the kernels are computed outside the
/// measurement.
fn march(criterion: &mut Criterion) {
    let striker = MobilityLaw::analytic(|s| 1.0 / (0.1 * s))
        .free(0.1)
        .unwrap();
    let rod = MobilityLaw::analytic(|_| Complex64::from(1e-3));
    let mut group = criterion.benchmark_group("march with contact");
    group.sample_size(10);
    for n_steps in [1_000_u32, 10_000, 100_000, 1_000_000] {
        let duration = 1e-3;
        for (name, law) in [
            ("rigid", ContactLaw::Rigid),
            ("Hertz", ContactLaw::hertz(5e9).unwrap()),
        ] {
            let impact = Impact::between(&striker, &rod)
                .at_velocity(1.0)
                .through(law)
                .in_steps_of(duration / f64::from(n_steps))
                .discretised(duration)
                .unwrap();
            group.throughput(Throughput::Elements(u64::from(n_steps)));
            group.bench_function(BenchmarkId::new(name, n_steps), |bencher| {
                bencher.iter(|| black_box(&impact).predict().unwrap());
            });
        }
    }
    for n_steps in [100_000_u32, 1_000_000] {
        // the history is continued by zeros to twice its length
        let mut alone = transforms(2 * n_steps as usize, true);
        group.throughput(Throughput::Elements(u64::from(n_steps)));
        group.bench_function(BenchmarkId::new("convolution", n_steps), |bencher| {
            bencher.iter(&mut alone);
        });
    }
    for n_steps in [1_000_u32, 10_000] {
        let kernel: Vec<f64> = (0..n_steps).map(|n| 1e-3 / (1.0 + f64::from(n))).collect();
        group.throughput(Throughput::Elements(u64::from(n_steps)));
        group.bench_function(BenchmarkId::new("direct summation", n_steps), |bencher| {
            bencher.iter(|| directly(black_box(&kernel)));
        });
    }
    group.finish();
}

/// The march with a rigid contact by direct summation over all earlier steps.
fn directly(kernel: &[f64]) -> Vec<f64> {
    let mut force: Vec<f64> = Vec::with_capacity(kernel.len());
    for n in 0..kernel.len() {
        let past: f64 = force
            .iter()
            .zip(kernel[1..=n].iter().rev())
            .map(|(force, weight)| force * weight)
            .sum();
        force.push(((1.0 - past) / kernel[0]).max(0.0));
    }
    force
}

fn kernels(criterion: &mut Criterion) {
    let nylon = Medium::new(1150.0, ConstantQ::new(2.6e9, 0.09, 2e4).unwrap()).unwrap();
    let aluminium = Medium::new(2700.0, Elastic::new(69e9).unwrap()).unwrap();
    let face = Circle::of_diameter(0.032).unwrap();
    let cylinder = AnalyticChain::analytic_from_impact_face()
        .rod(&nylon, face, 0.125)
        .rod(&aluminium, face, 0.125)
        .rod(&nylon, face, 0.125)
        .rod(&aluminium, face, 0.125)
        .end(Termination::Free)
        .unwrap();
    let grid = TimeGrid {
        time_step: 1e-6,
        n_steps: 4096,
    };
    let mut group = criterion.benchmark_group("kernel of the compound cylinder, 4096 steps");
    group.sample_size(10);
    for quadrature in [Quadrature::CellAverages, Quadrature::Bdf2] {
        group.bench_function(format!("{quadrature:?}"), |bencher| {
            bencher.iter(|| Kernel::of(black_box(&cylinder), grid, quadrature).unwrap());
        });
    }
    group.finish();
}

criterion_group!(
    benches,
    stick_by_fourier,
    stick_with_its_band,
    march,
    kernels
);
criterion_main!(benches);

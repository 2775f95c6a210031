//! Cell updates per second of the direct problem of paper D, for each law. The elastic march is the
//! baseline in the same run.
//!
//! | group | what it shows |
//! |---|---|
//! | march | all laws, starting from rest; the bound is the bare recurrence of two waves that cross, without ends, grid or law |
//! | march by cells, march by steps | the work is proportional to the nodes and to the steps: the throughput is constant |
//! | response of 144 samples | a whole response, alone and with all derivatives of its law |
//! | derivatives of a linear law | the cost of one more derivative, for a law whose own cost is negligible |
//!
//! A finer grid has shorter steps, for which the nonlinear laws need fewer terms of their series:
//! from 100 to 1600 cells, their throughput may increase but must not decrease.
//!
//! One element of throughput is one node advanced by one step. A compiled Python version of the
//! same scheme advances 32 to 40 million nodes per second for Maxwell and 9 million for
//! Maxwell-Norton on a machine of this kind.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    reason = "the macros of criterion define undocumented functions, and a benchmark that cannot start may panic"
)]

use std::hint::black_box;

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use rodwave::band_limited::SampledHistory;
use rodwave::inelastic::{
    Elastic, InelasticLaw, LANES, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton,
    RelaxationFlow, RelaxedStress, StressChange,
};
use rodwave::{DirectProblem, InelasticRod, RodwaveError};

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
}

/// Two arrays of waves. Each step moves one of them by a cell and adds a multiple of their
/// difference to both: the least work of the march of a Maxwell rod.
fn recurrence(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("march");
    group.throughput(Throughput::Elements(u64::from(STEPS) * (CELLS as u64 + 1)));
    group.sample_size(20);
    group.bench_function("bare recurrence", |bencher| {
        let (mut along, mut next) = (vec![1.0; CELLS + 2], vec![1.0; CELLS + 2]);
        let mut against = vec![0.5; CELLS + 1];
        bencher.iter(|| {
            for _ in 0..STEPS {
                let part = black_box(1e-3);
                let cells = along.iter().skip(1).zip(&mut next).zip(&mut against);
                for ((arriving, along), against) in cells {
                    let relaxed = part * (arriving - *against);
                    *along = arriving - relaxed;
                    *against += relaxed;
                }
                std::mem::swap(&mut along, &mut next);
            }
            black_box(&along).first().copied()
        });
    });
}

/// Starts with a rod that is in motion everywhere, so that every step advances every node.
fn linearity<L: InelasticLaw<Flow: Clone>>(criterion: &mut Criterion, name: &str, law: &L) {
    let cases = [
        (
            "cells",
            [(100, STEPS), (400, STEPS), (1600, STEPS)].as_slice(),
        ),
        ("steps", &[(CELLS, 1000), (CELLS, 4000)]),
    ];
    for (varied, sizes) in cases {
        let mut group = criterion.benchmark_group(format!("march by {varied}"));
        group.sample_size(10);
        for &(cells, steps) in sizes {
            let rod = InelasticRod::new(0.394, 910.0, 2.58e9, law.clone()).unwrap();
            let mut started = DirectProblem::new(rod, cells).unwrap().march(9.0);
            for _ in 0..cells {
                started.advance(9.0);
            }
            group.throughput(Throughput::Elements(u64::from(steps) * (cells as u64 + 1)));
            let size = match varied {
                "cells" => BenchmarkId::new(name, cells),
                _ => BenchmarkId::new(name, steps),
            };
            group.bench_function(size, |bencher| {
                bencher.iter_batched(
                    || started.clone(),
                    |mut march| {
                        for _ in 0..steps {
                            march.advance(black_box(9.0));
                        }
                        march.free_end_velocity()
                    },
                    BatchSize::SmallInput,
                );
            });
        }
    }
}

/// Excitation of a test, with the times at which the response is computed.
struct Record {
    excitation: SampledHistory,
    times: Vec<f64>,
}

impl Record {
    fn new() -> Self {
        let rate = 51_200.0;
        let samples: Vec<f64> = (0..160_u32)
            .map(|k| 9.0 * (-((f64::from(k) - 35.0) / 3.0).powi(2)).exp())
            .collect();
        Self {
            excitation: SampledHistory::new(&samples, rate).unwrap(),
            times: (0..144_u32).map(|k| f64::from(k) / rate).collect(),
        }
    }

    fn problem<L: InelasticLaw>(law: &L) -> DirectProblem<L> {
        let rod = InelasticRod::new(0.394, 910.0, 2.58e9, law.clone()).unwrap();
        DirectProblem::new(rod, 100).unwrap()
    }

    fn velocity<L: InelasticLaw>(&self, problem: &DirectProblem<L>) -> Vec<f64> {
        problem
            .free_end_velocity(black_box(&self.excitation), &self.times)
            .unwrap()
    }

    fn with_derivatives<L: InelasticLaw>(&self, problem: &DirectProblem<L>) -> Vec<Vec<f64>> {
        problem
            .free_end_velocity_with_sensitivities(black_box(&self.excitation), &self.times)
            .unwrap()
            .by_parameter
    }
}

fn sensitivities<L: InelasticLaw>(criterion: &mut Criterion, name: &str, law: &L) {
    let (record, problem) = (Record::new(), Record::problem(law));
    let derivatives = 1 + L::PARAMETERS.len();
    let mut group = criterion.benchmark_group("response of 144 samples");
    group.sample_size(20);
    group.bench_function(format!("{name}, velocity"), |bencher| {
        bencher.iter(|| record.velocity(&problem));
    });
    group.bench_function(
        format!("{name}, velocity and derivatives ({derivatives})"),
        |bencher| bencher.iter(|| record.with_derivatives(&problem)),
    );
}

/// Law F = e^{p₁ + p₂ + ...} σ/η at p = 0: a linear law with any number of parameters.
#[derive(Debug, Clone)]
struct Linear<const PARAMETERS: usize>;

#[derive(Debug, Clone, Copy)]
struct LinearFlow {
    exponent: f64,
    decrement: f64,
}

impl<const PARAMETERS: usize> InelasticLaw for Linear<PARAMETERS> {
    const PARAMETERS: &'static [&'static str] = &["p"; PARAMETERS];
    type Flow = LinearFlow;

    fn inelastic_strain_rate(&self, stress: f64) -> f64 {
        stress / 4e6
    }

    fn flow(&self, modulus: f64, duration: f64) -> LinearFlow {
        let exponent = modulus * duration / 4e6;
        LinearFlow {
            exponent,
            decrement: (-exponent).exp_m1(),
        }
    }

    fn parameters(&self) -> Vec<f64> {
        vec![0.0; PARAMETERS]
    }

    fn with_parameters(&self, _parameters: &[f64]) -> Result<Self, RodwaveError> {
        Ok(Self)
    }

    fn reference_stress(&self) -> f64 {
        10e6
    }
}

impl RelaxationFlow for LinearFlow {
    fn relax(&self, stress: f64) -> f64 {
        stress * (1.0 + self.decrement)
    }

    fn relax_with_sensitivity(&self, stress: f64, by_parameter: &mut [f64]) -> RelaxedStress {
        let stress = self.relax(stress);
        by_parameter.fill(-self.exponent * stress);
        RelaxedStress {
            stress,
            by_stress: 1.0 + self.decrement,
            by_log_modulus: -self.exponent * stress,
        }
    }

    #[inline(always)]
    fn change(&self, stress: &[f64; LANES]) -> [f64; LANES] {
        stress.map(|stress| stress * self.decrement)
    }

    #[inline(always)]
    fn change_with_sensitivity(&self, stress: &[f64; LANES], parameters: usize) -> StressChange {
        let by_log_rate = -self.exponent * (1.0 + self.decrement);
        let by_log_rate = stress.map(|stress| stress * by_log_rate);
        let mut change = StressChange {
            stress: self.change(stress),
            by_stress: [self.decrement; LANES],
            by_log_modulus: by_log_rate,
            ..StressChange::default()
        };
        for by_parameter in change.by_parameter.iter_mut().take(parameters) {
            *by_parameter = by_log_rate;
        }
        change
    }
}

fn derivatives_of_a_linear_law(criterion: &mut Criterion) {
    let record = Record::new();
    let mut group = criterion.benchmark_group("derivatives of a linear law");
    group.sample_size(20);
    let problem = Record::problem(&Linear::<0>);
    group.bench_function("0", |bencher| bencher.iter(|| record.velocity(&problem)));
    macro_rules! with_derivatives {
        ($($count:literal: $parameters:literal),*) => {$(
            let problem = Record::problem(&Linear::<$parameters>);
            group.bench_function($count, |bencher| {
                bencher.iter(|| record.with_derivatives(&problem));
            });
        )*};
    }
    with_derivatives!("1": 0, "2": 1, "3": 2);
}

fn every<L: InelasticLaw<Flow: Clone>>(criterion: &mut Criterion, name: &str, law: &L) {
    march(criterion, name, law);
    linearity(criterion, name, law);
    sensitivities(criterion, name, law);
}

fn laws(criterion: &mut Criterion) {
    let gurevich = MaxwellGurevichRabinovich::new(3.5e6, 7.08e6).unwrap();
    recurrence(criterion);
    every(criterion, "elastic", &Elastic);
    every(criterion, "Maxwell", &Maxwell::new(4e6).unwrap());
    every(
        criterion,
        "Maxwell-Norton",
        &MaxwellNorton::new(2.108, 7e13).unwrap(),
    );
    every(criterion, "Maxwell-Gurevich-Rabinovich", &gurevich);
    derivatives_of_a_linear_law(criterion);
}

criterion_group!(benches, laws);
criterion_main!(benches);

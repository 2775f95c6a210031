//! Cell updates per second of bodies in a line. The direct problem with as many nodes is the
//! baseline in the same run.
//!
//! One element of throughput is one cell advanced by one step. The cost per step of an elastic line
//! does not depend on its cell count, because its waves travel by moving a window. Public Python
//! codes for elastic bars in contact advance 7.4 and 50 million cells per second.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "the macros of criterion define undocumented functions, and a benchmark that cannot start may panic"
)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rodwave::inelastic::{Elastic, InelasticLaw, Maxwell, MaxwellNorton};
use rodwave::line::{Body, Drive, End, Line, Segment};
use rodwave::modulus::{GeneralisedMaxwell, MaxwellBranch};
use rodwave::{DirectProblem, InelasticRod};

const AREA: f64 = 2e-4;
const STEPS: u32 = 2000;

fn rod<L>(law: L, cells: u32) -> (Line, f64)
where
    L: InelasticLaw + 'static,
    L::Flow: std::fmt::Debug + Clone + 'static,
{
    let segment = Segment::of_rod(&InelasticRod::new(0.394, 910.0, 2.58e9, law).unwrap(), AREA);
    of_segment(segment.unwrap(), cells)
}

fn of_segment(segment: Segment, cells: u32) -> (Line, f64) {
    let step = segment.transit_time() / f64::from(cells) * (1.0 + 1e-9);
    let line = Line::new([Body::new([segment]).unwrap()]).unwrap();
    let driven = line.with_left_end(End::Velocity(Drive::of(|_| 9.0)));
    (driven.unwrap(), step)
}

fn march(criterion: &mut Criterion, name: &str, (line, step): (Line, f64)) {
    let cells: usize = line.grid(step).unwrap().cells.iter().sum();
    let mut group = criterion.benchmark_group("line");
    group.throughput(Throughput::Elements(u64::from(STEPS) * cells as u64));
    group.sample_size(20);
    group.bench_function(format!("{name}, {cells} cells"), |bencher| {
        bencher.iter(|| {
            let mut march = line.march(black_box(step)).unwrap();
            for _ in 0..STEPS {
                march.advance().unwrap();
            }
            march.ends()
        });
    });
}

fn baseline<L: InelasticLaw>(criterion: &mut Criterion, name: &str, law: L) {
    let rod = InelasticRod::new(0.394, 910.0, 2.58e9, law).unwrap();
    let problem = DirectProblem::new(rod, 400).unwrap();
    let mut group = criterion.benchmark_group("line");
    group.throughput(Throughput::Elements(u64::from(STEPS) * 401));
    group.sample_size(20);
    group.bench_function(format!("{name}, direct problem of 400 cells"), |bencher| {
        bencher.iter(|| {
            let mut march = problem.march(9.0);
            for _ in 0..STEPS {
                march.advance(black_box(9.0));
            }
            march.free_end_velocity()
        });
    });
}

fn prony(branches: u8) -> Segment {
    let branch = |k: u8| MaxwellBranch {
        modulus: 0.3e9,
        relaxation_time: 1e-5 * 10_f64.powi(i32::from(k)),
    };
    let law = GeneralisedMaxwell::new(2e9, (0..branches).map(branch).collect()).unwrap();
    Segment::prony(0.394, AREA, 910.0, &law).unwrap()
}

fn impact() -> (Line, f64) {
    let striker = Segment::elastic(0.05, AREA, 2700.0, 69e9).unwrap();
    let law = MaxwellNorton::new(2.108, 7e13).unwrap();
    let rod = Segment::new(0.8, AREA, 910.0)
        .unwrap()
        .with_branch(2.58e9, law)
        .unwrap();
    let bodies = [
        Body::new([striker]).unwrap().moving_at(10.0).unwrap(),
        Body::new([rod]).unwrap(),
    ];
    (Line::new(bodies).unwrap(), 1e-6)
}

fn lines(criterion: &mut Criterion) {
    let maxwell = || Maxwell::new(4e6).unwrap();
    let norton = || MaxwellNorton::new(2.108, 7e13).unwrap();
    baseline(criterion, "Maxwell", maxwell());
    baseline(criterion, "Maxwell-Norton", norton());
    for cells in [400, 1600] {
        march(criterion, "elastic", rod(Elastic, cells));
        march(criterion, "Maxwell", rod(maxwell(), cells));
        march(criterion, "Maxwell-Norton", rod(norton(), cells));
        march(
            criterion,
            "Prony of one branch",
            of_segment(prony(1), cells),
        );
        march(
            criterion,
            "Prony of four branches",
            of_segment(prony(4), cells),
        );
    }
    march(criterion, "striker on Maxwell-Norton", impact());
}

/// Derivatives of velocity, stress and strain: each parameter costs one more relaxation.
fn derivatives(criterion: &mut Criterion) {
    let (line, step) = rod(MaxwellNorton::new(2.108, 7e13).unwrap(), 400);
    let parameters = line.parameters();
    let mut group = criterion.benchmark_group("line, 1 ms of Maxwell-Norton, 400 cells");
    group.sample_size(20);
    for count in 0..=parameters.len() {
        group.bench_function(format!("{count} derivatives"), |bencher| {
            bencher.iter(|| {
                line.run_with_derivatives(step, 1e-3, &[], black_box(&parameters[..count]))
                    .unwrap()
            });
        });
    }
}

/// Striker, incident bar, specimen and transmitter bar with equal wave speeds, as elastic programs
/// use them: 1935 cells, 1600 steps.
fn split_bars(criterion: &mut Criterion) {
    const CELL: f64 = 1e-3;
    let bar = |cells: u32, area| {
        let length = CELL * f64::from(cells);
        Body::new([Segment::elastic(length, area, 7800.0, 210e9).unwrap()]).unwrap()
    };
    let cells = [300_u32, 800, 35, 800];
    let bodies = [
        bar(cells[0], AREA).moving_at(10.0).unwrap(),
        bar(cells[1], AREA),
        bar(cells[2], 0.5 * AREA),
        bar(cells[3], AREA),
    ];
    let line = Line::new(bodies).unwrap();
    let step = CELL / (210e9_f64 / 7800.0).sqrt() * (1.0 + 1e-9);
    assert_eq!(line.grid(step).unwrap().cells.iter().sum::<usize>(), 1935);
    let mut group = criterion.benchmark_group("split Hopkinson bars, 1935 cells, 1600 steps");
    group.sample_size(10);
    let duration = 1599.5 * step;
    group.bench_function("march", |bencher| {
        bencher.iter(|| line.run(step, black_box(duration), &[]).unwrap());
    });
    group.bench_function("x-t diagram", |bencher| {
        bencher.iter(|| line.diagram(step, black_box(duration), 1).unwrap());
    });
    // velocity, stress and strain of every cell at every level, written to new memory
    let values = 3 * 1935 * 1600;
    group.bench_function("values of the diagram into memory", |bencher| {
        bencher.iter(|| (0..values).map(f64::from).collect::<Vec<f64>>());
    });
}

/// Striker, incident bar, a specimen that flows, and transmitter bar, with contacts that open: 6030
/// cells, 23 038 steps.
fn tension_bars(criterion: &mut Criterion) {
    const CELL: f64 = 1e-3;
    let step = CELL / (70e9_f64 / 2700.0).sqrt() * (1.0 + 1e-9);
    let bar = |cells: u32| {
        let length = CELL * f64::from(cells);
        Segment::elastic(length, AREA, 2700.0, 70e9).unwrap()
    };
    let flow = MaxwellNorton::from_reference_rate(10.0, 1e3, 200e6).unwrap();
    let specimen = Segment::new(0.03, 0.2 * AREA, 2700.0).unwrap();
    let specimen = specimen.with_branch(70e9, flow).unwrap();
    let bodies = [
        Body::new([bar(1500)]).unwrap().moving_at(10.0).unwrap(),
        Body::new([bar(3000), specimen, bar(1500)]).unwrap(),
    ];
    let line = Line::new(bodies).unwrap();
    let cells: usize = line.grid(step).unwrap().cells.iter().sum();
    assert_eq!(cells, 6030);
    let mut group = criterion.benchmark_group("bars with a specimen that flows");
    group.sample_size(10);
    group.throughput(Throughput::Elements(23_038 * cells as u64));
    group.bench_function("6030 cells, 23038 steps", |bencher| {
        bencher.iter(|| {
            let mut march = line.march(black_box(step)).unwrap();
            for _ in 0..23_038 {
                march.advance().unwrap();
            }
            march.ends()
        });
    });
}

criterion_group!(benches, lines, derivatives, split_bars, tension_bars);
criterion_main!(benches);

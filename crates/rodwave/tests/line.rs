//! Bodies in a line against closed forms, other solvers and their own balances.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "in a test, a refusal where none is expected is a failure; counts are small"
)]

use num_complex::Complex64;
use proptest::prelude::*;
use rodwave::band_limited::SampledHistory;
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::element::CrossSection;
use rodwave::impact::{ImpactTest, Striker};
use rodwave::inelastic::{
    Elastic, InelasticLaw, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton, RelaxationFlow,
    RelaxedStress,
};
use rodwave::line::{Body, Drive, End, Gauge, Line, LineHistory, Parameter, Segment};
use rodwave::medium::Medium;
use rodwave::modulus::{GeneralisedMaxwell, MaxwellBranch};
use rodwave::synthesis::DampedSynthesis;
use rodwave::{DirectProblem, InelasticRod, RodwaveError};

mod balances;
mod closed_forms;
mod derivatives;
mod diagram;
mod materials;
mod other_solvers;
mod refusals;

const AREA: f64 = 2e-4;

fn steel(length: f64, area: f64) -> Segment {
    Segment::elastic(length, area, 7780.0, 206e9).unwrap()
}

fn aluminium(length: f64, area: f64) -> Segment {
    Segment::elastic(length, area, 2700.0, 69e9).unwrap()
}

fn line(segments: impl IntoIterator<Item = Segment>) -> Line {
    Line::new([Body::new(segments).unwrap()]).unwrap()
}

/// A smooth pulse with a maximum of 1 at 50 µs, negligible at time 0.
fn pulse(time: f64) -> f64 {
    (-((time - 50e-6) / 10e-6).powi(2)).exp()
}

fn pushed(line: Line, force: f64) -> Line {
    line.with_left_end(End::Force(Drive::of(move |t| force * pulse(t))))
        .unwrap()
}

fn closes(history: &LineHistory) {
    let ledger = history.ledger;
    let energy = ledger.initial_energy + ledger.supplied.abs() + ledger.stored;
    // thousands of steps, each rounded relatively by 1e-16 or so
    assert!(
        ledger.energy_residual().abs() < 1e-11 * energy,
        "{ledger:?}"
    );
    assert!(ledger.dissipated >= 0.0 && ledger.radiated >= -1e-15 * energy);
    assert!(ledger.lost_in_contact >= 0.0);
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, f64::max)
}

fn prony() -> GeneralisedMaxwell {
    GeneralisedMaxwell::new(
        2.2e9,
        vec![
            MaxwellBranch {
                modulus: 0.5e9,
                relaxation_time: 1e-3,
            },
            MaxwellBranch {
                modulus: 0.9e9,
                relaxation_time: 4e-5,
            },
        ],
    )
    .unwrap()
}

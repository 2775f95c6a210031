//! Bodies in a line, compared with closed forms and other solvers, and their own balances.

use proptest::prelude::*;
use rodwave::band_limited::SampledHistory;
use rodwave::impact::{ImpactTest, Striker};
use rodwave::inelastic::{
    Elastic, InelasticLaw, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton, RelaxationFlow,
    RelaxedStress,
};
use rodwave::line::{Body, Drive, End, Gauge, Line, LineHistory, Parameter, Segment};
use rodwave::modulus::GeneralisedMaxwell;
use rodwave::{DirectProblem, InelasticRod, RodwaveError};
use testbed::difference::largest;

mod balances;
mod closed_forms;
mod derivatives;
mod diagram;
mod materials;
mod other_solvers;
mod refusals;

pub(crate) const AREA: f64 = 2e-4;

pub(crate) fn steel(length: f64, area: f64) -> Segment {
    Segment::elastic(length, area, 7780.0, 206e9).unwrap()
}

pub(crate) fn aluminium(length: f64, area: f64) -> Segment {
    Segment::elastic(length, area, 2700.0, 69e9).unwrap()
}

pub(crate) fn line(segments: impl IntoIterator<Item = Segment>) -> Line {
    Line::new([Body::new(segments).unwrap()]).unwrap()
}

/// Smooth pulse with a maximum of 1 at 50 µs, negligible at time 0.
pub(crate) fn pulse(time: f64) -> f64 {
    (-((time - 50e-6) / 10e-6).powi(2)).exp()
}

pub(crate) fn pushed(line: Line, force: f64) -> Line {
    line.with_left_end(End::Force(Drive::of(move |t| force * pulse(t))))
        .unwrap()
}

pub(crate) fn closes(history: &LineHistory) {
    let ledger = history.ledger;
    let energy = ledger.initial_energy + ledger.supplied.abs() + ledger.stored;
    // tolerance: thousands of steps, each with a relative rounding error of about 1e-16
    assert!(
        ledger.energy_residual().abs() < 1e-11 * energy,
        "{ledger:?}"
    );
    assert!(ledger.dissipated >= 0.0 && ledger.radiated >= -1e-15 * energy);
    assert!(ledger.lost_in_contact >= 0.0);
}

pub(crate) fn prony() -> GeneralisedMaxwell {
    crate::bodies::prony(2.2e9, &[(0.5e9, 1e-3), (0.9e9, 4e-5)])
}

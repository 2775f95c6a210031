//! Impact as in paper D: an aluminium striker at 10 m/s hits a polyethylene rod with a steel cap at
//! its far end.
//!
//! ```text
//! cargo run --release --package rodwave --example striker_on_a_polymer_rod
//! ```
//!
//! writes `target/examples/striker_on_a_polymer_rod.svg` with the contact force, the velocity of
//! the cap and the strain at the middle, for a linear and a nonlinear law with equal losses at 10
//! MPa. It also prints the energy balance.
#![allow(
    clippy::print_stdout,
    clippy::indexing_slicing,
    reason = "an example prints its results; step counts are small; there is one contact and one gauge"
)]

use std::error::Error;

use rodfigure::{Figure, Mark, Panel, Role};
use rodwave::RodwaveError;
use rodwave::inelastic::{InelasticLaw, Maxwell, MaxwellNorton};
use rodwave::line::{Body, End, Gauge, Line, LineHistory, Segment};

/// Cross-sectional area of a diameter of 15.8 mm \[m²\].
const AREA: f64 = 1.9607e-4;
/// Gauge at the middle of the rod.
const GAUGE: Gauge = Gauge {
    body: 1,
    position: 0.4,
};

fn blow(rod: Segment) -> Result<LineHistory, RodwaveError> {
    let striker = Segment::elastic(0.030, AREA, 2700.0, 69e9)?;
    Line::new([Body::new([striker])?.moving_at(10.0)?, Body::new([rod])?])?
        .with_right_end(End::Mass(0.010))?
        .run(0.2e-6, 1.6e-3, &[GAUGE])
}

fn rod<L>(law: L) -> Result<Segment, RodwaveError>
where
    L: InelasticLaw + 'static,
    L::Flow: std::fmt::Debug + Clone + 'static,
{
    Segment::new(0.8, AREA, 910.0)?.with_branch(2.58e9, law)
}

fn main() -> Result<(), Box<dyn Error>> {
    let norton = MaxwellNorton::new(2.108, 7e13)?;
    // the same inelastic strain rate at 10 MPa
    let maxwell = Maxwell::from_reference_rate(norton.inelastic_strain_rate(10e6), 10e6)?;
    let histories = [
        ("Maxwell", Role::First, blow(rod(maxwell)?)?),
        ("Maxwell-Norton", Role::Second, blow(rod(norton)?)?),
    ];

    let mut panels = [
        ("contact force", "kN"),
        ("velocity of the cap", "m/s"),
        ("strain in the middle", "1e-3"),
    ]
    .map(|label| Panel::new(("time", "ms"), label, Vec::new()));
    for (name, role, history) in &histories {
        let step = history.grid.time_step;
        let curve = |values: &[f64], first: f64, unit: f64| {
            let points = values.iter().enumerate().step_by(4);
            let points = points.map(|(k, value)| (1e3 * step * (k as f64 + first), value / unit));
            Mark::line(*name, *role, points)
        };
        let contact = &history.contacts[0];
        let curves = [
            curve(&contact.force, 0.5, 1e3),
            curve(&history.ends[1].velocity, 0.5, 1.0),
            curve(&history.gauges[0].strain, 0.0, 1e-3),
        ];
        for (panel, curve) in panels.iter_mut().zip(curves) {
            panel.marks.push(curve);
        }

        let ledger = &history.ledger;
        let share = |energy: f64| 100.0 * energy / ledger.initial_energy;
        let end = contact
            .force
            .iter()
            .rposition(|force| *force > 0.0)
            .unwrap_or(0);
        println!(
            "{name:15} peak {:.0} N, last contact {:.0} us; of {:.3} J: {:.1} % left, {:.1} % dissipated, {:.2} % lost in closing gaps; \
             balances closed to {:.0e} and {:.0e}",
            contact.force.iter().copied().fold(0.0, f64::max),
            1e6 * step * end as f64,
            ledger.initial_energy,
            share(ledger.stored),
            share(ledger.dissipated),
            share(ledger.lost_in_contact),
            ledger.energy_residual() / ledger.initial_energy,
            ledger.momentum_residual() / ledger.initial_momentum,
        );
    }

    let title = "Impact on a polyethylene rod with a steel cap";
    let path = Figure::new("striker_on_a_polymer_rod", title, panels.into()).write_to(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../target/examples"
    ))?;
    println!("figure in {}", path.display());
    Ok(())
}

//! A blow like those of paper D: an aluminium striker, 10 m/s, on a polyethylene rod that carries a
//! steel cap at its far end.
//!
//! ```text
//! cargo run --release --package rodwave --example striker_on_a_polymer_rod
//! ```
//!
//! writes `target/examples/striker_on_a_polymer_rod.svg`: contact force, velocity of the cap and
//! strain in the middle for a linear and a nonlinear law of equal loss at 10 MPa, and prints where
//! the energy went.
#![allow(
    clippy::print_stdout,
    clippy::cast_precision_loss,
    clippy::indexing_slicing,
    reason = "an example talks to the one who runs it; step counts are small; there is one contact and one gauge"
)]

use std::error::Error;
use std::fs;
use std::path::Path;

use kuva::backend::svg::SvgBackend;
use kuva::plot::LinePlot;
use kuva::plot::legend::LegendPosition;
use kuva::render::figure::Figure;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use rodwave::RodwaveError;
use rodwave::inelastic::{InelasticLaw, Maxwell, MaxwellNorton};
use rodwave::line::{Body, End, Gauge, Line, LineHistory, Segment};

/// Cross-sectional area of a diameter of 15.8 mm \[m²\].
const AREA: f64 = 1.9607e-4;
/// The middle of the rod.
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
        ("Maxwell", "#1d4ed8", blow(rod(maxwell)?)?),
        ("Maxwell-Norton", "#c2410c", blow(rod(norton)?)?),
    ];

    let mut panels: [Vec<Plot>; 3] = std::array::from_fn(|_| Vec::new());
    for (name, colour, history) in &histories {
        let step = history.grid.time_step;
        let curve = |values: &[f64], first: f64, unit: f64, legend: String| {
            let points = values.iter().enumerate().step_by(4);
            let data: Vec<(f64, f64)> = points
                .map(|(k, value)| (1e3 * step * (k as f64 + first), value / unit))
                .collect();
            Plot::Line(
                LinePlot::new()
                    .with_data(data)
                    .with_color(*colour)
                    .with_legend(legend),
            )
        };
        let contact = &history.contacts[0];
        panels[0].push(curve(&contact.force, 0.5, 1e3, (*name).to_owned()));
        panels[1].push(curve(
            &history.ends[1].velocity,
            0.5,
            1.0,
            (*name).to_owned(),
        ));
        panels[2].push(curve(
            &history.gauges[0].strain,
            0.0,
            1e-3,
            (*name).to_owned(),
        ));

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

    let labels = [
        "contact force, kN",
        "velocity of the cap, m/s",
        "strain in the middle, 1e-3",
    ];
    let layouts = panels
        .iter()
        .zip(labels)
        .map(|(curves, label)| {
            Layout::auto_from_plots(curves)
                .with_x_label("time, ms")
                .with_y_label(label)
                .with_legend_position(LegendPosition::InsideTopRight)
        })
        .collect();
    let scene = Figure::new(3, 1)
        .with_plots(panels.into_iter().collect())
        .with_layouts(layouts)
        .with_cell_size(760.0, 300.0)
        .render();
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .ok_or("the crate lies in the folder crates of its workspace")?;
    let folder = workspace.join("target/examples");
    fs::create_dir_all(&folder)?;
    let path = folder.join("striker_on_a_polymer_rod.svg");
    fs::write(&path, SvgBackend::default().render_scene(&scene))?;
    println!("figure in {}", path.display());
    Ok(())
}

//! Mobility of the compound cylinder of paper E at its two faces, next to that of a rigid body of
//! the same mass.
//!
//! ```text
//! cargo run --release --package rodwave --example mobility_of_a_stack
//! ```
//!
//! writes `target/examples/mobility_of_a_stack.svg`.
#![allow(
    clippy::print_stdout,
    reason = "an example talks to the one who runs it"
)]

use std::error::Error;
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use kuva::backend::svg::SvgBackend;
use kuva::plot::LinePlot;
use kuva::plot::legend::LegendPosition;
use kuva::render::figure::Figure;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::{Elastic, PowerLawPropagation};
use rodwave::{Chain, Termination};

fn main() -> Result<(), Box<dyn Error>> {
    let nylon = Medium::new(
        1150.0,
        PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970)?,
    )?;
    let aluminium = Medium::new(2700.0, Elastic::new(69e9)?)?;
    let face = Circle::of_diameter(0.032)?;
    let cylinder = Chain::from_impact_face()
        .rod(&nylon, face, 0.125)
        .rod(&aluminium, face, 0.125)
        .rod(&nylon, face, 0.125)
        .rod(&aluminium, face, 0.125)
        .end(Termination::Free)?;
    let mass = cylinder.free_mass().ok_or("the body is not free")?;

    let mut nylon_face = Vec::new();
    let mut aluminium_face = Vec::new();
    let mut rigid = Vec::new();
    for line in 1..=1000_u32 {
        let frequency_hz = 10.0 * f64::from(line);
        let omega = TAU * frequency_hz;
        let kilohertz = 1e-3 * frequency_hz;
        nylon_face.push((kilohertz, cylinder.mobility(omega)?.norm().log10()));
        aluminium_face.push((kilohertz, cylinder.far_face_mobility(omega)?.norm().log10()));
        rigid.push((kilohertz, -(omega * mass).log10()));
    }
    let curve = |data, colour: &str, legend: &str| {
        Plot::Line(
            LinePlot::new()
                .with_data(data)
                .with_color(colour)
                .with_legend(legend),
        )
    };
    let curves = vec![
        curve(nylon_face, "#c2410c", "face A, Nylon-6"),
        curve(aluminium_face, "#1d4ed8", "face B, aluminium"),
        curve(rigid, "#777777", "rigid body"),
    ];
    let layout = Layout::auto_from_plots(&curves)
        .with_title("Compound cylinder of paper E")
        .with_x_label("frequency, kHz")
        .with_y_label("log10 of mobility, s/kg")
        .with_legend_position(LegendPosition::InsideTopRight);
    let scene = Figure::new(1, 1)
        .with_plots(vec![curves])
        .with_layouts(vec![layout])
        .with_cell_size(760.0, 440.0)
        .render();

    let workspace = Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .ok_or("the crate lies in the folder crates of its workspace")?;
    let folder = workspace.join("target/examples");
    fs::create_dir_all(&folder)?;
    let path = folder.join("mobility_of_a_stack.svg");
    fs::write(&path, SvgBackend::default().render_scene(&scene))?;
    println!("{mass:.3} kg; figure in {}", path.display());
    Ok(())
}

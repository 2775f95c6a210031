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
    reason = "an example prints its results to the standard output"
)]

use std::error::Error;
use std::f64::consts::TAU;

use rodfigure::{Axis, Figure, Mark, Panel, Role};
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
        nylon_face.push((kilohertz, cylinder.mobility(omega)?.norm()));
        aluminium_face.push((kilohertz, cylinder.far_face_mobility(omega)?.norm()));
        rigid.push((kilohertz, 1.0 / (omega * mass)));
    }
    let marks = vec![
        Mark::line("face A, Nylon-6", Role::Second, nylon_face),
        Mark::line("face B, aluminium", Role::First, aluminium_face),
        Mark::line("rigid body", Role::Reference, rigid),
    ];
    let magnitude = Axis::logarithmic("mobility", "s/kg");
    let panel = Panel::new(("frequency", "kHz"), magnitude, marks);
    let path = Figure::new(
        "mobility_of_a_stack",
        "Compound cylinder of paper E",
        vec![panel],
    )
    .write_to(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../target/examples"
    ))?;
    println!("{mass:.3} kg; figure in {}", path.display());
    Ok(())
}

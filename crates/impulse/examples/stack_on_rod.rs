//! Impact of the compound cylinder of paper E, with its nylon or its aluminium end, on the long
//! steel rod: as the paper computed it, on 1025 lines up to 10 kHz, and without a band limit.
//!
//! ```text
//! cargo run --release --package impulse --example stack_on_rod
//! ```
//!
//! writes `target/examples/stack_on_rod.svg`.
#![allow(
    clippy::print_stdout,
    reason = "an example prints its results to the standard output"
)]

use std::error::Error;

use impulse::{ContactEnd, ForceHistory, Impact, LineBand, separate};
use rodfigure::{Figure, Mark, Panel, Role};
use rodwave::chain::{Chain, Termination};
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::{Elastic, PowerLawPropagation};

const DURATION: f64 = 1.5e-3;

fn cylinder(nylon_first: bool) -> Result<Chain, Box<dyn Error>> {
    let law = PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970)?;
    let nylon = Medium::new(1150.0, law)?;
    let aluminium = Medium::new(2700.0, Elastic::new(69e9)?)?;
    let face = Circle::of_diameter(0.032)?;
    let mut body = Chain::from_impact_face();
    for section in 0..4 {
        body = if (section % 2 == 0) == nylon_first {
            body.rod(&nylon, face, 0.125)
        } else {
            body.rod(&aluminium, face, 0.125)
        };
    }
    Ok(body.end(Termination::Free)?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let steel = Medium::new(7780.0, Elastic::new(206e9)?)?;
    let rod = Chain::from_impact_face().end(Termination::semi_infinite(
        &steel,
        Circle::of_diameter(0.010)?,
    ))?;
    let mut panels = Vec::new();
    for (name, nylon_first, velocity) in [("nylon end", true, 0.92), ("aluminium end", false, 1.01)]
    {
        let body = cylinder(nylon_first)?;
        let impact = Impact::between(&body, &rod).at_velocity(velocity);
        let as_in_paper = impact.stick_force_on_lines(LineBand::PAPER_E)?;
        let peak = as_in_paper.history.peak();
        // the ringing after the jump is about 2 % of the jump where the contacts end
        let ended = separate(&as_in_paper.history, 0.02 * peak.force)?;
        let end = match ended.end {
            ContactEnd::Separated { time } => time,
            _ => f64::NAN,
        };
        let prediction = impact.in_steps_of(1e-6).predict(DURATION)?;
        println!(
            "{name}: {:.0} N and {:.3} ms on lines up to 10 kHz; {:.0} N and {:.3} ms without a limit, restitution {:.3}",
            peak.force,
            1e3 * end,
            prediction.peak().force,
            1e3 * prediction.duration(),
            prediction.balance().restitution.unwrap_or(f64::NAN)
        );
        for flag in &prediction.flags {
            println!("  {flag}");
        }
        let marks = vec![
            line("10 kHz, 2048 samples", Role::Faint, &ended.history),
            line("no limit to the band", Role::First, &prediction.history),
        ];
        let force = format!("force, {name}, {velocity} m/s");
        panels.push(Panel::new(("time", "ms"), (force, "N"), marks));
    }
    let title = "Compound cylinder of paper E on a long steel rod";
    let path = Figure::new("stack_on_rod", title, panels).write_to(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../target/examples"
    ))?;
    println!("figure in {}", path.display());
    Ok(())
}

/// Samples from just before the contact on.
fn line(name: &str, role: Role, history: &ForceHistory) -> Mark {
    let samples = history.force().iter().enumerate();
    let points = samples
        .map(|(n, force)| (1e3 * history.time_at(n), *force))
        .filter(|(time, _)| *time > -0.1 && *time < 1e3 * DURATION);
    Mark::line(name, role, points)
}

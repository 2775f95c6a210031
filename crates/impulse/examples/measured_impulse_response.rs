//! Figures 5 and 6 of paper E on virtual bodies: the force of a truncated cone and of a compound
//! cylinder on a long steel rod, from (I) the measured impulse response of the body, with its band,
//! and (II) the predicted one.
//!
//! ```text
//! cargo run --release --package impulse --example measured_impulse_response
//! ```
//!
//! writes `target/examples/measured_impulse_response.svg`.
#![allow(
    clippy::print_stdout,
    clippy::indexing_slicing,
    reason = "an example prints its results, and may panic on a wrong index"
)]

#[path = "../tests/virtual_laboratory/mod.rs"]
mod virtual_laboratory;

use impulse::{contact_band, separate};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rodfigure::{Figure, Mark, Panel, Role};
use testbed::claim::Fallible;
use testbed::papers::paper_e::bodies::Face;
use testbed::papers::paper_e::load;
use virtual_laboratory::{bare_face, long_rod, on_long_rod, predicted, uncertainty};

fn main() -> Fallible<()> {
    let paper = load()?;
    let rod = long_rod(&paper)?;
    let mut random = ChaCha8Rng::seed_from_u64(1993);
    let mut panels = Vec::new();
    for face in Face::ALL {
        let tests = paper.hammer_tests(face, &mut random)?;
        let larger_force = bare_face(&paper, &tests.by_larger_force()?)?;
        let measured = bare_face(&paper, &tests.by_inverse_variance()?)?;
        let predicted = predicted(&paper, face)?;
        let first = on_long_rod(&paper, face, &measured.mobility, &rod)?;
        let second = on_long_rod(&paper, face, &predicted, &rod)?;
        let error = first.error(&uncertainty(&measured))?;
        let by_larger_force = on_long_rod(&paper, face, &larger_force.mobility, &rod)?
            .error(&uncertainty(&larger_force))?;
        let (first, second) = (first.solve()?.history, second.solve()?.history);
        let contact = first.index_near(0.0).ok_or("time 0 is in the history")?;
        let window = contact..contact + 60;
        let threshold = 0.02 * second.peak().force;
        let (measured, predicted) = (separate(&first, threshold)?, separate(&second, threshold)?);
        let stick_band = error.simultaneous(&first, 0.95, window.clone(), 1000, &mut random)?;
        let band = contact_band(&stick_band, &measured);
        println!(
            "{}: peak {:.0} N measured, {:.0} N predicted; standard error {:.2} N ({:.2} N with the hammer of the larger \
             force alone); end {:?}",
            face.name(),
            first.peak().force,
            second.peak().force,
            error.standard_error()[contact],
            by_larger_force.standard_error()[contact],
            error.contact_end(&first, &measured)
        );
        let at = |n: usize, values: &[f64]| (1e3 * first.time_at(n), 1e-3 * values[n]);
        let edges = window.clone().map(|n| {
            let (time, lower) = at(n, &band.lower);
            (time, lower, 1e-3 * band.upper[n])
        });
        let line = |name: &str, role, values: &[f64]| {
            Mark::line(name, role, window.clone().map(|n| at(n, values)))
        };
        let marks = vec![
            Mark::band("95 % of histories (I)", Role::First, edges),
            line("(I) measured", Role::First, measured.history.force()),
            line("(II) predicted", Role::Second, predicted.history.force()),
        ];
        let velocity = paper.case(face)?.impact_velocity;
        let force = format!("force, {}, {velocity} m/s", face.name());
        panels.push(Panel::new(("time", "ms"), (force, "kN"), marks));
    }
    let title = "Figures 5 and 6 of paper E on virtual bodies";
    let path = Figure::new("measured_impulse_response", title, panels).write_to(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../target/examples"
    ))?;
    println!("{}", path.display());
    Ok(())
}

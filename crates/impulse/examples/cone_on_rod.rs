//! Impact of the truncated cone of paper E, with its narrow or its wide end, on the long steel rod:
//! with faces that stick, with faces that part and meet again, and with a wide end that the thin
//! rod dents.
//!
//! ```text
//! cargo run --release --package impulse --example cone_on_rod
//! ```
//!
//! writes `target/examples/cone_on_rod.svg` and prints every contact with the balance of momentum
//! and energy.
#![allow(
    clippy::print_stdout,
    reason = "an example prints its results to the standard output"
)]

use std::error::Error;
use std::f64::consts::TAU;

use impulse::{ContactLaw, ElasticMaterial, ForceHistory, Impact, Prediction};
use rodfigure::{Figure, Mark, Panel, Role};
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::{ConstantQ, Elastic, PowerLawPropagation};

const DURATION: f64 = 3.5e-3;
const STEP: f64 = 1e-6;

/// A constant loss factor with the propagation coefficient of (Ödeen 1993, paper E, eq. 7) at 3
/// kHz: eq. 7 itself is not a causal law.
fn nylon() -> Result<Medium<ConstantQ>, Box<dyn Error>> {
    let printed = PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970)?;
    let omega = TAU * 3e3;
    let modulus = Medium::new(1150.0, printed)?.modulus(omega);
    let law = ConstantQ::new(modulus.norm(), modulus.im / modulus.re, omega)?;
    Ok(Medium::new(1150.0, law)?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let nylon = nylon()?;
    let steel = Medium::new(7780.0, Elastic::new(206e9)?)?;
    let (narrow, wide) = (Circle::of_diameter(0.030)?, Circle::of_diameter(0.075)?);
    let rod = AnalyticChain::analytic_from_impact_face().end(Termination::semi_infinite(
        &steel,
        Circle::of_diameter(0.010)?,
    ))?;
    let by_narrow_end = AnalyticChain::analytic_from_impact_face()
        .cone(&nylon, narrow, wide, 0.400)
        .end(Termination::Free)?;
    let by_wide_end = AnalyticChain::analytic_from_impact_face()
        .cone(&nylon, wide, narrow, 0.400)
        .end(Termination::Free)?;
    let dent = ContactLaw::flat_punch(
        0.005,
        ElasticMaterial {
            modulus: nylon.modulus(TAU * 5e3).re,
            poisson_ratio: 0.4,
        },
    )?;

    let narrow_end = Impact::between(&by_narrow_end, &rod)
        .at_velocity(1.16)
        .in_steps_of(STEP);
    let wide_end = Impact::between(&by_wide_end, &rod)
        .at_velocity(0.93)
        .in_steps_of(STEP);
    let first = narrow_end.predict(DURATION)?;
    let second = wide_end.predict(DURATION)?;
    let dented = wide_end.clone().through(dent).predict(DURATION)?;
    for (name, prediction) in [
        ("narrow end", &first),
        ("wide end", &second),
        ("wide end, dented", &dented),
    ] {
        report(name, prediction);
    }

    let by_narrow = vec![
        line(
            "faces stick",
            Role::Faint,
            &narrow_end.stick_force(DURATION)?,
        ),
        line("faces part", Role::First, &first.history),
    ];
    let by_wide = vec![
        line("faces stick", Role::Faint, &wide_end.stick_force(DURATION)?),
        line("faces part and meet again", Role::First, &second.history),
        line("wide face dented by the rod", Role::Second, &dented.history),
    ];
    let time = ("time", "ms");
    let panels = vec![
        Panel::new(time, ("force, narrow end, 1.16 m/s", "N"), by_narrow),
        Panel::new(time, ("force, wide end, 0.93 m/s", "N"), by_wide),
    ];
    let title = "Truncated cone of paper E on a long steel rod";
    let path = Figure::new("cone_on_rod", title, panels).write_to(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../target/examples"
    ))?;
    println!("figure in {}", path.display());
    Ok(())
}

fn report(name: &str, prediction: &Prediction) {
    let peak = prediction.peak();
    println!("{name}: {:.0} N at {:.3} ms", peak.force, 1e3 * peak.time);
    for contact in &prediction.contacts {
        let end = contact.end.map_or_else(
            || "the end".to_owned(),
            |end| format!("{:.3} ms", 1e3 * end),
        );
        println!(
            "  contact from {:.3} ms to {end}: {:.5} N s, at most {:.1} N",
            1e3 * contact.begin,
            contact.impulse,
            contact.peak
        );
    }
    let balance = prediction.balance();
    if let (Some(before), Some(restitution), [Some(translation), _]) = (
        balance.energy_before,
        balance.restitution,
        balance.translation_after,
    ) {
        println!(
            "  restitution {restitution:.4}; of {before:.4} J the rod has taken {:.4} J, the cone flies back with {translation:.4} J and keeps \
             {:.4} J as vibration and heat",
            balance.inner[1], balance.inner[0]
        );
    }
    for flag in &prediction.flags {
        println!("  {flag}");
    }
}

/// Every fourth sample.
fn line(name: &str, role: Role, history: &ForceHistory) -> Mark {
    let samples = history.force().iter().enumerate().step_by(4);
    let points = samples.map(|(n, force)| (1e3 * history.time_at(n), *force));
    Mark::line(name, role, points)
}

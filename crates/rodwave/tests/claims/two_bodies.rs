//! The virtual impact of paper E: closed forms and balances.

use std::f64::consts::PI;

use rodwave::chain::{AnalyticChain, Termination};
use rodwave::experiment::impact_of_two_bodies::{ContactEnd, ImpactOfTwoBodies};

use super::bodies::{circle, steel};
use testbed::claim::{Claim, Claims, Fallible};
use testbed::difference::largest;
use testbed::hold;

fn free_rod(diameter: f64, length: f64) -> Fallible<AnalyticChain> {
    Ok(AnalyticChain::analytic_from_impact_face()
        .rod(&steel()?, circle(diameter)?, length)
        .end(Termination::Free)?)
}

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    const INTERVAL: f64 = 5e-7;
    let speed = (206e9_f64 / 7780.0).sqrt();
    let area = PI / 4.0 * 0.010 * 0.010;
    let z = area * (206e9_f64 * 7780.0).sqrt();
    let (trip, velocity) = (2.0 * 0.5 / speed, 2.0);
    let mass = 7780.0 * area * 0.5;
    let long_rod = || -> Fallible<AnalyticChain> {
        Ok(AnalyticChain::analytic_from_impact_face()
            .rod(&steel()?, circle(0.010)?, 0.15)
            .end(Termination::semi_infinite(&steel()?, circle(0.010)?))?)
    };
    let claim = |what: &str, source| {
        Claim::new(
            format!("free rod on a long one of its kind: {what}"),
            source,
        )
    };
    report.check(
        claim(
            "force ZV/2 for one round trip, then none, by ZV/2",
            "closed form (de Saint-Venant)",
        )
        .within(
            1e-8,
            "rounding; 6.4 standard deviations of the Gaussian from the jumps",
        ),
        || {
            let (first, second) = (free_rod(0.010, 0.5)?, long_rod()?);
            let impact = ImpactOfTwoBodies {
                first: &first,
                second: &second,
                velocity,
            };
            let record = impact.run(1e-3, INTERVAL)?;
            Ok(largest(record.force.iter().enumerate().filter_map(
                |(n, force)| {
                    let t = record.start + n as f64 * record.interval;
                    let away = t.abs().min((t - trip).abs()) > 16.0 * INTERVAL;
                    let step = if t > 0.0 && t < trip { 1.0 } else { 0.0 };
                    away.then_some(force / (0.5 * z * velocity) - step)
                },
            )))
        },
    );
    report.check(
        claim("impulse", "conservation of momentum: the striker stops")
            .expects(mass * velocity, "N s")
            .within_part(1e-6, "alias e^(-16)"),
        || {
            let (first, second) = (free_rod(0.010, 0.5)?, long_rod()?);
            let impact = ImpactOfTwoBodies {
                first: &first,
                second: &second,
                velocity,
            };
            Ok(impact.run(1e-3, INTERVAL)?.impulse())
        },
    );
    // the square of a rounded jump falls short of the jump by Pσ/√π at each side
    let shortfall = 2.0 * 1.25e-6 / PI.sqrt() / trip;
    report.check(
        claim(
            "work on the long rod",
            "conservation of energy, less what the Gaussian rounds off",
        )
        .expects(0.5 * mass * velocity * velocity * (1.0 - shortfall), "J")
        .within_part(1e-5, "next order of the rounding"),
        || {
            let (first, second) = (free_rod(0.010, 0.5)?, long_rod()?);
            let impact = ImpactOfTwoBodies {
                first: &first,
                second: &second,
                velocity,
            };
            Ok(impact.run(1e-3, INTERVAL)?.work_on_second())
        },
    );
    report.check(
        Claim::new(
            "free rods of 0.3 and 0.7 m: end of contact",
            "closed form: echo from the far end of the longer",
        )
        .expects(2.0 * 0.7 / speed, "s")
        .within(16.0 * INTERVAL, "width of the Gaussian"),
        || {
            let (first, second) = (free_rod(0.010, 0.3)?, free_rod(0.010, 0.7)?);
            let impact = ImpactOfTwoBodies {
                first: &first,
                second: &second,
                velocity,
            };
            match impact.run(3e-3, INTERVAL)?.end {
                ContactEnd::Separated { time } => Ok(time),
                other => Err(format!("{other:?}").into()),
            }
        },
    );
    hold!(report);
}

//! Virtual impact of paper E: closed forms and balances.

use std::f64::consts::PI;

use rodwave::experiment::impact_of_two_bodies::ContactEnd;
use testbed::claim::{Claims, Within};
use testbed::difference::largest;
use testbed::hold;

use crate::experiment_impact::{VELOCITY, deviation, impedance, long_rod, rod, run, transit_time};

/// Claims on the virtual impact (Ödeen 1993, paper E, Figure 4).
#[test]
fn claims_hold() {
    let mut report = Claims::default();
    let (striker, long) = (rod(10.0, 0.5), long_rod(10.0));
    let record = run(&striker, &long, 1e-3, 5e-7);
    let trip = 2.0 * transit_time(0.5);
    let plateau = 0.5 * impedance(10.0) * VELOCITY;
    let step = |t: f64| if t > 0.0 && t < trip { 1.0 } else { 0.0 };
    let jumps = [0.0, trip];
    report.by("closed form (de Saint-Venant)").deviation(
        "free rod on a long rod of the same kind: force ZV/2 for one round trip, then none, relative to ZV/2",
        Within(
            1e-9,
            "rounding; 6.4 standard deviations of the Gaussian from the jumps",
        ),
        Ok(deviation(&record, &record.force, &jumps, |t| plateau * step(t)) / plateau),
    );
    let face = |t: f64| {
        if t < 0.0 {
            VELOCITY
        } else {
            0.5 * VELOCITY * step(t)
        }
    };
    // the pulse then travels along the rod
    let delay = transit_time(0.1);
    let later = record.transmitted_force(0, 0.1).unwrap();
    let travelled = |t: f64| plateau * step(t - delay);
    report.deviation(
        "free rod on a long rod of the same kind: velocities of both faces relative to V, force after 0.1 m relative to ZV/2",
        Within(1e-6, "aliasing of e^(-16) in the velocity of a free body"),
        Ok(largest([
            deviation(&record, &record.first_velocity, &jumps, face) / VELOCITY,
            deviation(&record, &record.second_velocity, &jumps, |t| {
                0.5 * VELOCITY * step(t)
            }) / VELOCITY,
            deviation(&record, &later, &[delay, delay + trip], travelled) / plateau,
        ])),
    );
    let mass = 7780.0 * PI / 4.0 * 0.010 * 0.010 * 0.5;
    report
        .by("conservation of momentum: the striker stops")
        .deviation(
            "free rod on a long rod of the same kind: impulse over MV, minus 1",
            Within(5e-8, "aliasing of e^(-16) over the record"),
            Ok(record.impulse() / (mass * VELOCITY) - 1.0),
        );
    // at each of its two jumps, the smoothed pulse loses σ/√π times its squared height in the
    // integral of its square
    let shortfall = 2.0 * 1.25e-6 / PI.sqrt() / trip;
    report
        .by("conservation of energy, less the part removed by the Gaussian")
        .deviation(
            "free rod on a long rod of the same kind: work on the long rod over MV²/2, minus 1",
            Within(5e-7, "next order of the smoothing"),
            Ok(record.work_on_second() / (0.5 * mass * VELOCITY * VELOCITY) - 1.0 + shortfall),
        );
    let (short, long) = (rod(10.0, 0.3), rod(10.0, 0.7));
    let end = match run(&short, &long, 3e-3, 5e-7).end {
        ContactEnd::Separated { time } => time,
        other => panic!("{other:?}"),
    };
    report
        .by("closed form: echo from the far end of the longer rod")
        .claim(
            "free rods of 0.3 and 0.7 m: end of contact",
            "s",
            2.0 * transit_time(0.7),
            Within(16.0 * 5e-7, "width of the Gaussian"),
            Ok(end),
        );
    hold!(report);
}

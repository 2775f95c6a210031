//! Virtual impact of paper E, compared with closed forms and balances.
use std::f64::consts::PI;

use rodwave::chain::{AnalyticChain, Termination};
use rodwave::element::CrossSection;
use rodwave::experiment::impact_of_two_bodies::{
    ContactEnd, GENERATOR, ImpactOfTwoBodies, ImpactRecord,
};
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;

use crate::bodies::{circle, steel};

/// Impact velocity [m/s].
pub(crate) const VELOCITY: f64 = 2.0;

pub(crate) fn impedance(diameter_mm: f64) -> f64 {
    CrossSection::from(circle(1e-3 * diameter_mm)).area() * (206e9_f64 * 7780.0).sqrt()
}

pub(crate) fn transit_time(length: f64) -> f64 {
    length / (206e9_f64 / 7780.0).sqrt()
}

pub(crate) fn rod(diameter_mm: f64, length: f64) -> AnalyticChain {
    AnalyticChain::analytic_from_impact_face()
        .rod(&steel(), circle(1e-3 * diameter_mm), length)
        .end(Termination::Free)
        .unwrap()
}

pub(crate) fn long_rod(diameter_mm: f64) -> AnalyticChain {
    AnalyticChain::analytic_from_impact_face()
        .rod(&steel(), circle(1e-3 * diameter_mm), 0.15)
        .end(Termination::semi_infinite(
            &steel(),
            circle(1e-3 * diameter_mm),
        ))
        .unwrap()
}

pub(crate) fn run<'a>(
    first: &'a AnalyticChain,
    second: &'a AnalyticChain,
    duration: f64,
    interval: f64,
) -> ImpactRecord<'a> {
    let impact = ImpactOfTwoBodies {
        first,
        second,
        velocity: VELOCITY,
    };
    impact.run(duration, interval).unwrap()
}

/// Largest deviation from `exact` at samples that are more than 16 intervals (6.4 standard
/// deviations of the Gaussian) from all `jumps`.
pub(crate) fn deviation(
    record: &ImpactRecord<'_>,
    samples: &[f64],
    jumps: &[f64],
    exact: impl Fn(f64) -> f64,
) -> f64 {
    let times = (0..samples.len()).map(|n| record.start + n as f64 * record.interval);
    times
        .zip(samples)
        .filter(|(time, _)| {
            jumps
                .iter()
                .all(|jump| (time - jump).abs() > 16.0 * record.interval)
        })
        .fold(0.0, |worst, (time, value)| {
            worst.max((value - exact(time)).abs())
        })
}

/// Checks the impact of two free rods of equal cross-section: the shorter rod is stopped. The
/// longer rod takes over the momentum and moves at the mean velocity V L₁/L₂; its face oscillates
/// between 0 and V without decay.
#[test]
fn two_free_elastic_rods() {
    let (short, long) = (rod(10.0, 0.3), rod(10.0, 0.7));
    let record = run(&short, &long, 3e-3, 5e-7);
    assert_eq!(record.generator, GENERATOR);
    let (trip, period) = (2.0 * transit_time(0.3), 2.0 * transit_time(0.7));
    // From 2L₁/c until the force jumps to tension, it is zero: compression in this interval is only
    // rounding.
    let mass = [&short, &long].map(|body| body.free_mass().unwrap());
    assert!((record.impulse() / (mass[0] * VELOCITY) - 1.0).abs() < 1e-6);
    // In the first period of the longer rod, its face moves at V/2 for 2L₁/c; in each later period,
    // the echo moves it at V for 2L₁/c.
    let exact = |t: f64| {
        let phase = t.rem_euclid(period);
        match (t > 0.0, phase < trip, t < period) {
            (false, ..) | (_, false, _) => 0.0,
            (_, _, true) => 0.5 * VELOCITY,
            _ => VELOCITY,
        }
    };
    let jumps: Vec<f64> = (0..12)
        .flat_map(|n| [f64::from(n) * period, f64::from(n) * period + trip])
        .collect();
    let error = deviation(&record, &record.second_velocity, &jumps, exact);
    // After the end of the force, the error is the alias of a velocity that does not decay, 1.1e-7.
    assert!(error < 1e-6 * VELOCITY, "{error}");
    let mean = 0.5 * VELOCITY * 2.0 * trip / period;
    assert!((mean / (mass[0] * VELOCITY / mass[1]) - 1.0).abs() < 1e-12);
}

/// Checks the impact of a mass on a long rod: F = ZV e^{-Zt/M}, which never becomes a tension.
#[test]
fn mass_against_a_long_rod() {
    let (mass, z) = (0.3, impedance(10.0));
    let striker = AnalyticChain::analytic_from_impact_face()
        .end(Termination::Mass(mass))
        .unwrap();
    let long = long_rod(10.0);
    let record = run(&striker, &long, 2e-3, 1e-6);
    assert_eq!(record.end, ContactEnd::InContact);
    // the Gaussian multiplies an exponential by e^{(σZ/M)²/2}, which differs from 1 by 3.5e-4 here
    let rounded = (0.5 * (2.5e-6 * z / mass).powi(2)).exp();
    let decay = |t: f64| {
        if t > 0.0 {
            rounded * (-z * t / mass).exp()
        } else {
            0.0
        }
    };
    let force = deviation(&record, &record.force, &[0.0], |t| z * VELOCITY * decay(t));
    assert!(force < 1e-6 * z * VELOCITY, "{force}");
    for velocity in [&record.first_velocity, &record.second_velocity] {
        let error = deviation(&record, velocity, &[0.0, record.start], |t| {
            if t < 0.0 {
                velocity[0]
            } else {
                VELOCITY * decay(t)
            }
        });
        assert!(error < 1e-6 * VELOCITY, "{error}");
    }
    // tolerance: e^{-Zt/M} has decayed to e^{-20}, and the alias is e^{-16}
    assert!((record.impulse() / (mass * VELOCITY) - 1.0).abs() < 1e-6);
}

/// Checks two masses with a spring between them: the force is half a sine, and the velocities after
/// it are those of an elastic collision.
#[test]
fn masses_with_a_contact_spring() {
    let (m1, m2, stiffness) = (0.2, 0.5, 2e6);
    let reduced = m1 * m2 / (m1 + m2);
    let first = AnalyticChain::analytic_from_impact_face()
        .spring(stiffness)
        .end(Termination::Mass(m1))
        .unwrap();
    let second = AnalyticChain::analytic_from_impact_face()
        .end(Termination::Mass(m2))
        .unwrap();
    let interval = 1e-6;
    let record = run(&first, &second, 5e-3, interval);
    let omega = (stiffness / reduced).sqrt();
    let ContactEnd::Separated { time } = record.end else {
        panic!("{:?}", record.end)
    };
    // tolerance: the linear interpolation of the zero of the sine has an error of at most (ωΔt)²/8
    // of a step
    assert!((time - PI / omega).abs() < 1e-3 * interval, "{time}");
    // the Gaussian multiplies a sine by e^{-(σω)²/2}, which differs from 1 by 2e-5 here
    let rounded = (-0.5 * (2.5 * interval * omega).powi(2)).exp();
    let peak = VELOCITY * (stiffness * reduced).sqrt();
    let exact = |t: f64| {
        if (0.0..time).contains(&t) {
            rounded * peak * (omega * t).sin()
        } else {
            0.0
        }
    };
    let error = deviation(&record, &record.force, &[0.0], exact) / peak;
    assert!(error < 1e-6, "{error}");
    let impulse = 2.0 * reduced * VELOCITY;
    // Tolerance: the smoothed force is cut at its zero, which changes the impulse by the order of
    // (ωσ)².
    assert!((record.impulse() / impulse - 1.0).abs() < (omega * 2.5 * interval).powi(2));
    let after = record.second_velocity.last().unwrap();
    assert!((after / (impulse / m2) - 1.0).abs() < (omega * 2.5 * interval).powi(2));
    // The free end of the spring stops suddenly, and this jump is not smoothed. The velocity rings
    // as 1/(πn) with alternating sign: 3e-4 after 1000 samples, multiplied by e^{at} = 1.5; the
    // mean of two neighbouring samples rings less by the factor 1/n.
    let n = 1000 + record.force.iter().rposition(|&force| force > 0.0).unwrap();
    let after = 0.5 * (record.first_velocity[n] + record.first_velocity[n + 1]);
    let lost = (VELOCITY - after) / (impulse / m1);
    assert!((lost - 1.0).abs() < 1e-3, "{lost}");
}

/// Checks the impact of a damped cone that hits a long steel rod with its narrow end: until the end
/// of the contact, the faces move together. The cone loses the impulse, and its vibration decays to
/// the remaining velocity. The energy in the rod is ∫F²/Z dt.
#[test]
fn balances_of_a_damped_cone() {
    let nylon = Medium::new(1150.0, ConstantQ::new(3.0e9, 0.094, 2e4).unwrap()).unwrap();
    let cone = AnalyticChain::analytic_from_impact_face()
        .cone(&nylon, circle(0.030), circle(0.075), 0.400)
        .end(Termination::Free)
        .unwrap();
    let (long, z) = (long_rod(10.0), impedance(10.0));
    let interval = 2e-6;
    let record = run(&cone, &long, 40e-3, interval);
    let ContactEnd::Separated { time } = record.end else {
        panic!("{:?}", record.end)
    };
    assert!((1.0e-3..1.4e-3).contains(&time), "{time}");
    let peak = record.force.iter().copied().fold(0.0, f64::max);
    let pairs = record.first_velocity.iter().zip(&record.second_velocity);
    for (n, (first, second)) in pairs.enumerate() {
        let t = record.start + n as f64 * interval;
        // after the rounded start of the contact, and before the ringing around the kink at its end
        if t > 32e-6 && t < time - 50e-6 {
            assert!((first - second).abs() < 1e-5 * VELOCITY, "{t}");
        }
        // the response of a long rod is F/Z: no wave returns
        assert!(
            (second - record.force[n] / z).abs() < 1e-6 * peak / z,
            "{t}"
        );
    }
    let mass = cone.free_mass().unwrap();
    let left = VELOCITY - record.impulse() / mass;
    let last = record.first_velocity.last().unwrap();
    // tolerance: the lowest mode, near 2 kHz with a loss factor of 0.094, has decayed to e^{-20};
    // the alias is e^{-16}
    assert!((last - left).abs() < 1e-5 * VELOCITY, "{last} {left}");
    let squares = record.force.iter().map(|force| force * force / z);
    let in_rod = interval * squares.sum::<f64>();
    assert!((record.work_on_second() / in_rod - 1.0).abs() < 1e-6);
    let before = 0.5 * mass * VELOCITY * VELOCITY;
    assert!(in_rod + 0.5 * mass * left * left < before);
}

#[test]
fn impossible_impacts_are_refused() {
    let (striker, long) = (rod(10.0, 0.5), long_rod(10.0));
    let impact = ImpactOfTwoBodies {
        first: &striker,
        second: &long,
        velocity: 0.0,
    };
    assert_eq!(
        impact.run(1e-3, 1e-6).unwrap_err().to_string(),
        "impact velocity [m/s] is 0, expected a finite value above 0"
    );
    let impact = ImpactOfTwoBodies {
        velocity: 1.0,
        ..impact
    };
    assert!(impact.run(10e-6, 1e-6).is_err());
    let record = impact.run(1e-3, 1e-6).unwrap();
    assert!(record.transmitted_force(0, 0.2).is_err());
    assert!(record.transmitted_force(1, 0.0).is_err());
}

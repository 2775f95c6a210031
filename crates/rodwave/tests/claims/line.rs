//! Bodies in a line: closed forms of wave theory, other solvers, balances.

use num_complex::Complex64;
use rodwave::RodwaveError;
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::element::CrossSection;
use rodwave::inelastic::{Elastic, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};
use rodwave::line::{Body, Drive, End, Gauge, Line, LineHistory, Segment};
use rodwave::medium::Medium;
use rodwave::modulus::{GeneralisedMaxwell, MaxwellBranch};
use rodwave::synthesis::DampedSynthesis;

use super::bodies::aluminium;
use testbed::claim::{Claim, Claims, Fallible, Found};
use testbed::difference::largest;
use testbed::hold;

const AREA: f64 = 2e-4;
const SAINT_VENANT: &str = "closed form (de Saint-Venant)";
const ALEMBERT: &str = "closed form (d'Alembert)";

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    pulses(&mut report);
    impacts(&mut report);
    prony_stack(&mut report);
    balances(&mut report);
    hold!(report);
}

fn steel(length: f64, area: f64) -> Fallible<Segment> {
    Ok(Segment::elastic(length, area, 7780.0, 206e9)?)
}

/// A smooth pulse with a maximum of 1 at 50 µs, negligible at time 0.
fn pulse(time: f64) -> f64 {
    (-((time - 50e-6) / 10e-6).powi(2)).exp()
}

fn pushed(segments: impl IntoIterator<Item = Segment>, force: f64) -> Fallible<Line> {
    let line = Line::new([Body::new(segments)?])?;
    Ok(line.with_left_end(End::Force(Drive::of(move |t| force * pulse(t))))?)
}

/// Time of a step.
fn time(history: &LineHistory, step: usize) -> f64 {
    step as f64 * history.grid.time_step
}

fn pulses(report: &mut Claims) {
    let travelled = || -> Fallible<(LineHistory, f64, f64, f64)> {
        let segment = steel(1.0, AREA)?;
        let (z, c) = (segment.impedance(), segment.wave_speed());
        let step = segment.transit_time() / 250.0;
        // at the centre of a cell, where nothing has to be interpolated
        let position = 100.5 / 250.0;
        let gauge = Gauge { body: 0, position };
        let history = pushed([segment], 1000.0)?.run(step * (1.0 + 1e-9), 4.0 / c, &[gauge])?;
        Ok((history, z, c, position))
    };
    report.check(
        Claim::new(
            "pulse in an elastic rod with two echoes: velocity, by the peak",
            ALEMBERT,
        )
        .within(1e-11, "a thousand additions"),
        || {
            let (history, z, c, x) = travelled()?;
            let at = |t: f64| if t > 0.0 { pulse(t) } else { 0.0 };
            let velocity = history.gauges[0].velocity.iter().enumerate();
            Ok(largest(velocity.map(|(step, velocity)| {
                let t = time(&history, step);
                let right = at(t - x / c) + at(t - (x + 2.0) / c);
                let left = at(t - (2.0 - x) / c) + at(t - (4.0 - x) / c);
                velocity * z / 1000.0 - right - left
            })))
        },
    );
    report.check(
        Claim::new(
            "pulse in an elastic rod with two echoes: stress, by the peak",
            ALEMBERT,
        )
        .within(1e-11, "a thousand additions"),
        || {
            let (history, _, c, x) = travelled()?;
            let at = |t: f64| if t > 0.0 { pulse(t) } else { 0.0 };
            let stress = history.gauges[0].stress.iter().enumerate();
            Ok(largest(stress.map(|(step, stress)| {
                let t = time(&history, step);
                let right = at(t - x / c) + at(t - (x + 2.0) / c);
                let left = at(t - (2.0 - x) / c) + at(t - (4.0 - x) / c);
                stress * AREA / 1000.0 + right - left
            })))
        },
    );
    report.check(
        Claim::new(
            "momentum that a blow leaves in a free rod",
            "integral of a Gaussian: √π · 10 µs · 1000 N",
        )
        .expects(std::f64::consts::PI.sqrt() * 1e-2, "N s")
        .within_part(1e-9, "e^(-25) of the pulse is before time 0"),
        || Ok(travelled()?.0.ledger.momentum),
    );
    for (index, name) in ["reflected at", "transmitted through"]
        .into_iter()
        .enumerate()
    {
        report.check(
            Claim::new(
                format!("pulse {name} a step of the impedance: force, by the incident peak"),
                "closed form (Donnell): (z₂ - z₁)/(z₂ + z₁), 2z₂/(z₁ + z₂)",
            )
            .within(
                1e-4,
                "wave speeds moved by 2e-6 for whole cells, 0.6 ns of a slope of 1/10 µs",
            ),
            || impedance_step(index),
        );
    }
    report.check(
        Claim::new(
            "mass at the end of a rod under a step: velocity by that of the wave",
            "closed form 2(1 - e^(-zt/m))",
        )
        .within(3e-4, "means over a step: (z dt/m)²/8 of twice the velocity"),
        || {
            let segment = steel(1.0, AREA)?;
            let (z, transit) = (segment.impedance(), segment.transit_time());
            let mass = z * 20e-6;
            let history = Line::new([Body::new([segment])?])?
                .with_left_end(End::Velocity(Drive::of(|_| 1.0)))?
                .with_right_end(End::Mass(mass))?
                .run(transit / 400.0 * (1.0 + 1e-9), 2.5 * transit, &[])?;
            let end = history.ends[1].velocity.iter().enumerate();
            Ok(largest(end.map(|(step, velocity)| {
                let t = time(&history, step) + 0.5 * history.grid.time_step - transit;
                velocity - 2.0 * (1.0 - (-z * t.max(0.0) / mass).exp())
            })))
        },
    );
}

/// Gauge 0 before the step of the impedance, gauge 1 behind it.
fn impedance_step(gauge: usize) -> Found {
    let (first, second) = (
        steel(1.0, AREA)?,
        Segment::elastic(1.0, 1.7 * AREA, 2700.0, 69e9)?,
    );
    let (z1, z2) = (first.impedance(), second.impedance());
    let (c1, c2) = (first.wave_speed(), second.wave_speed());
    let gauges = [0.5, 1.5].map(|position| Gauge { body: 0, position });
    let history = pushed([first, second], 1.0)?
        .with_right_end(End::Matched)?
        .run(0.2e-6, 450e-6, &gauges)?;
    let (reflected, transmitted) = ((z2 - z1) / (z2 + z1), 2.0 * z2 / (z1 + z2));
    let area = [AREA, 1.7 * AREA][gauge];
    let stress = history.gauges[gauge].stress.iter().enumerate();
    Ok(largest(stress.map(|(step, stress)| {
        let t = time(&history, step);
        // the free face turns what comes back, and that meets the step again
        let expected = if gauge == 0 {
            pulse(t - 0.5 / c1) + reflected * (pulse(t - 1.5 / c1) - pulse(t - 2.5 / c1))
        } else {
            transmitted
                * (pulse(t - 1.0 / c1 - 0.5 / c2) - reflected * pulse(t - 3.0 / c1 - 0.5 / c2))
        };
        -stress * area - expected
    })))
}

fn impacts(report: &mut Claims) {
    let equal = || -> Fallible<(LineHistory, f64, f64, f64)> {
        let (striker, rod) = (steel(0.25, AREA)?, steel(0.5, AREA)?);
        let (z, transit, mass) = (striker.impedance(), striker.transit_time(), striker.mass());
        let bodies = [Body::new([striker])?.moving_at(4.0)?, Body::new([rod])?];
        let step = transit / 100.0 * (1.0 + 1e-9);
        let history = Line::new(bodies)?.run(step, 7.0 * transit, &[])?;
        Ok((history, z, transit, mass))
    };
    report.check(
        Claim::new(
            "rod against a rod twice as long: force zV/2 for 2L/c, then none, by zV/2",
            SAINT_VENANT,
        )
        .within(1e-9, "rounding"),
        || {
            let (history, z, transit, _) = equal()?;
            let force = history.contacts[0].force.iter().enumerate();
            Ok(largest(force.map(|(step, force)| {
                let t = time(&history, step) + 0.5 * history.grid.time_step;
                force / (2.0 * z) - if t < 2.0 * transit { 1.0 } else { 0.0 }
            })))
        },
    );
    report.check(
        Claim::new(
            "rod against a rod twice as long: momentum of all by that of the striker",
            "conservation of momentum",
        )
        .expects(1.0, "1")
        .within(1e-12, "rounding"),
        || {
            let (history, _, _, mass) = equal()?;
            Ok(history.ledger.momentum / (4.0 * mass))
        },
    );
    report.check(
        Claim::new(
            "rod against a rod twice as long: part of the energy lost in the contact",
            SAINT_VENANT,
        )
        .within(1e-12, "elastic waves keep it"),
        || {
            let ledger = equal()?.0.ledger;
            Ok(ledger.lost_in_contact / ledger.initial_energy)
        },
    );
    report.check(
        Claim::new("striker of three times the impedance pushes in steps of (1 - r)/(1 + r): ten trips, by zV", SAINT_VENANT)
            .within(1e-9, "rounding"),
        || {
            let (striker, rod) = (steel(0.25, 3.0 * AREA)?, steel(4.0, AREA)?);
            let (z, transit) = (rod.impedance(), striker.transit_time());
            let bodies = [Body::new([striker])?.moving_at(4.0)?, Body::new([rod])?];
            let step = transit / 40.0 * (1.0 + 1e-9);
            let history = Line::new(bodies)?.run(step, 20.0 * transit, &[])?;
            let r: f64 = 1.0 / 3.0;
            let force = history.contacts[0].force.iter().enumerate();
            Ok(largest(force.map(|(step, force)| {
                let t = time(&history, step) + 0.5 * history.grid.time_step;
                let trips = (t / (2.0 * transit)).floor();
                force / (4.0 * z) - ((1.0 - r) / (1.0 + r)).powf(trips) / (1.0 + r)
            })))
        },
    );
}

fn prony() -> Fallible<GeneralisedMaxwell> {
    let branches = [(0.5e9, 1e-3), (0.9e9, 4e-5)].map(|(modulus, relaxation_time)| MaxwellBranch {
        modulus,
        relaxation_time,
    });
    Ok(GeneralisedMaxwell::new(2.2e9, branches.to_vec())?)
}

fn prony_stack(report: &mut Claims) {
    report.check(
        Claim::new(
            "stack of viscoelastic and elastic parts in the time domain: struck face, by the peak",
            "its transition matrices on a line of the Laplace plane",
        )
        .within(
            1e-3,
            "second order of the grid, 0.2 µs against a pulse of 10 µs",
        ),
        || {
            let duration = 1.5e-3;
            let synthesis = DampedSynthesis::new(duration, 1e-6)?;
            let (medium, metal) = (Medium::new(1140.0, prony()?)?, aluminium()?);
            let chain = AnalyticChain::analytic_from_impact_face()
                .rod(&medium, CrossSection::of_area(AREA), 0.3)
                .rod(&metal, CrossSection::of_area(0.5 * AREA), 0.2)
                .rod(&medium, CrossSection::of_area(AREA), 0.2)
                .end(Termination::Free)?;
            // the pulse of 1 N, whose transform is entire
            let pulse = |s: Complex64| {
                10e-6 * std::f64::consts::PI.sqrt() * (s * s * 25e-12 - s * 50e-6).exp()
            };
            let transform: Result<Vec<Complex64>, _> = synthesis
                .arguments()
                .map(|s| chain.mobility_at_s(s).map(|mobility| mobility * pulse(s)))
                .collect();
            let exact = synthesis.history(&transform?)?;
            let stack = [
                Segment::prony(0.3, AREA, 1140.0, &prony()?)?,
                Segment::elastic(0.2, 0.5 * AREA, 2700.0, 69e9)?,
                Segment::prony(0.2, AREA, 1140.0, &prony()?)?,
            ];
            let gauge = Gauge {
                body: 0,
                position: 0.0,
            };
            let history = pushed(stack, 1.0)?.run(0.2e-6, duration, &[gauge])?;
            let of_line = &history.gauges[0].velocity;
            let peak = largest(exact.samples.iter().copied());
            let mut errors = Vec::new();
            for (base, pair) in of_line.windows(2).enumerate().step_by(5) {
                // the sample of the transform between two steps of the march, on their chord
                let index = (time(&history, base) / 1e-6).ceil();
                let u = (index * 1e-6 - time(&history, base)) / history.grid.time_step;
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "the number of a sample"
                )]
                let sample = exact.samples.get(index as usize);
                if let (Some(sample), true) = (sample, u <= 1.0) {
                    errors.push((pair[0] * (1.0 - u) + pair[1] * u - sample) / peak);
                }
            }
            Ok(largest(errors))
        },
    );
}

/// A striker of two materials against a stack on a mass, with a gap.
fn stack(branch: impl Fn(Segment) -> Result<Segment, RodwaveError>) -> Fallible<Line> {
    let soft = branch(Segment::new(0.2, AREA, 1140.0)?)?.with_branch(0.5e9, Elastic)?;
    let bodies = [
        Body::new([
            steel(0.1, AREA)?,
            Segment::elastic(0.05, 2.0 * AREA, 2700.0, 69e9)?,
        ])?
        .moving_at(5.0)?,
        Body::new([soft, steel(0.3, 0.7 * AREA)?])?,
    ];
    Ok(Line::new(bodies)?
        .with_gap(0, 1e-4)?
        .with_right_end(End::Mass(0.3))?)
}

fn balances(report: &mut Claims) {
    type Stack = fn() -> Fallible<Line>;
    let lines: [(&str, Stack); 3] = [
        ("Maxwell", || {
            stack(|s| s.with_branch(2.2e9, Maxwell::from_reference_rate(2e3, 10e6)?))
        }),
        ("Norton", || {
            stack(|s| s.with_branch(2.2e9, MaxwellNorton::from_reference_rate(2.1, 2e3, 10e6)?))
        }),
        ("Gurevich and Rabinovich", || {
            let law = MaxwellGurevichRabinovich::from_reference_rate(1.4, 2e3, 10e6)?;
            stack(move |s| s.with_branch(2.2e9, law))
        }),
    ];
    for (name, line) in lines {
        report.check(
            Claim::new(
                format!(
                    "impact of stacks, {name} branch, on a mass: energy that is missing, as a part"
                ),
                "balance of energy",
            )
            .within(1e-11, "rounding of thousands of steps"),
            || {
                let ledger = line()?.run(2e-6, 1.5e-3, &[])?.ledger;
                Ok(ledger.energy_residual() / ledger.initial_energy)
            },
        );
        report.check(
            Claim::new(format!("impact of stacks, {name} branch, on a mass: momentum that is missing, as a part"), "balance of momentum")
                .within(1e-11, "rounding of thousands of steps"),
            || {
                let ledger = line()?.run(2e-6, 1.5e-3, &[])?.ledger;
                Ok(ledger.momentum_residual() / ledger.initial_momentum)
            },
        );
    }
}

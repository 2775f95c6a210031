//! Bodies in a line: closed forms of wave theory, and the transform of a stack.

use num_complex::Complex64;
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::element::CrossSection;
use rodwave::line::{Body, Drive, End, Gauge, Line, LineHistory, Segment};
use rodwave::medium::Medium;
use rodwave::synthesis::DampedSynthesis;
use testbed::claim::{Claims, Within};
use testbed::difference::largest;
use testbed::hold;

use crate::bodies;
use crate::line::{AREA, aluminium, closes, line, prony, pulse, pushed, steel};

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    travelling_pulse(&mut report);
    report
        .by("closed form (Donnell): (z₂ - z₁)/(z₂ + z₁), 2z₂/(z₁ + z₂)")
        .deviation(
            "pulse reflected at and transmitted through a step of the impedance: forces, relative to the incident peak",
            Within(
                5e-6,
                "wave speeds changed by less than 2e-6 so that the segments have whole numbers of cells; cubic interpolation in space",
            ),
            Ok(impedance_step()),
        );
    let (coarse, fine) = (mass_at_an_end(200.0), mass_at_an_end(400.0));
    report.by("closed form 2(1 - e^(-zt/m))").deviation(
        "mass at the end of a rod under a step: velocity relative to that of the wave",
        Within(
            3e-4,
            "the velocity is a mean over a step: (z dt/m)²/8 of twice the velocity of the wave",
        ),
        Ok(fine),
    );
    report.claim(
        "mass at the end of a rod under a step: error of a grid divided by that of a grid twice as fine",
        "1",
        4.0,
        Within(0.5, "the next order of the error"),
        Ok(coarse / fine),
    );
    impacts(&mut report);
    report
        .by("transition matrices of the stack on a line of the Laplace plane")
        .deviation(
            "stack of viscoelastic and elastic parts in the time domain: struck face, relative to the peak",
            Within(
                1e-4,
                "second-order error of a grid of 0.2 µs for a pulse of 10 µs",
            ),
            Ok(prony_stack()),
        );
    hold!(report);
}

/// Returns the values at the steps of a history, each with its time.
fn at_steps<'a>(
    history: &LineHistory,
    values: &'a [f64],
    shift: f64,
) -> impl Iterator<Item = (f64, f64)> + use<'a> {
    let step = history.grid.time_step;
    let numbered = values.iter().enumerate();
    numbered.map(move |(index, value)| ((index as f64 + shift) * step, *value))
}

fn travelling_pulse(report: &mut Claims) {
    let segment = steel(1.0, AREA);
    let (z, c) = (segment.impedance(), segment.wave_speed());
    let step = segment.transit_time() / 250.0;
    // at the centre of a cell, where no interpolation is needed
    let x = 100.5 / 250.0;
    let gauge = Gauge {
        body: 0,
        position: x,
    };
    let history = pushed(line([segment]), 1000.0)
        .run(step * (1.0 + 1e-9), 4.0 / c, &[gauge])
        .unwrap();
    closes(&history);
    let at = |t: f64| if t > 0.0 { pulse(t) } else { 0.0 };
    let right = |t: f64| at(t - x / c) + at(t - (x + 2.0) / c);
    let left = |t: f64| at(t - (2.0 - x) / c) + at(t - (4.0 - x) / c);
    let seen = &history.gauges[0];
    let velocity = at_steps(&history, &seen.velocity, 0.0)
        .map(|(t, velocity)| velocity * z / 1000.0 - right(t) - left(t));
    let stress = at_steps(&history, &seen.stress, 0.0)
        .map(|(t, stress)| stress * AREA / 1000.0 + right(t) - left(t));
    report.by("closed form (d'Alembert)").deviation(
        "pulse in an elastic rod with two echoes: velocity and stress, relative to the peak",
        Within(5e-14, "rounding of a thousand additions"),
        Ok(largest(velocity.chain(stress))),
    );
    let impulse = std::f64::consts::PI.sqrt() * 1e-2;
    report
        .by("integral of a Gaussian: √π · 10 µs · 1000 N")
        .claim(
            "momentum of a free rod after a pulse of force",
            "N s",
            impulse,
            Within(
                1e-9 * impulse,
                "the part of the pulse before time 0, e^(-25)",
            ),
            Ok(history.ledger.momentum),
        );
}

fn impedance_step() -> f64 {
    let (first, second) = (steel(1.0, AREA), aluminium(1.0, 1.7 * AREA));
    let (z1, z2) = (first.impedance(), second.impedance());
    let (c1, c2) = (first.wave_speed(), second.wave_speed());
    let gauges = [0.5, 1.5].map(|position| Gauge { body: 0, position });
    let history = pushed(line([first, second]), 1.0)
        .with_right_end(End::Matched)
        .unwrap()
        .run(0.2e-6, 450e-6, &gauges)
        .unwrap();
    closes(&history);
    assert!(
        history
            .grid
            .speed_change
            .iter()
            .all(|change| change.abs() < 2e-6)
    );
    let (reflected, transmitted) = ((z2 - z1) / (z2 + z1), 2.0 * z2 / (z1 + z2));
    // the free face reverses the returning wave, which then reaches the step of the impedance again
    let before = at_steps(&history, &history.gauges[0].stress, 0.0).map(|(t, stress)| {
        let turned = pulse(t - 1.5 / c1) - pulse(t - 2.5 / c1);
        -stress * AREA - pulse(t - 0.5 / c1) - reflected * turned
    });
    let behind = at_steps(&history, &history.gauges[1].stress, 0.0).map(|(t, stress)| {
        let at = t - 0.5 / c2;
        let passed = pulse(at - 1.0 / c1) - reflected * pulse(at - 3.0 / c1);
        -stress * 1.7 * AREA - transmitted * passed
    });
    largest(before.chain(behind))
}

fn mass_at_an_end(cells: f64) -> f64 {
    let segment = steel(1.0, AREA);
    let (z, transit) = (segment.impedance(), segment.transit_time());
    let mass = z * 20e-6;
    let history = line([segment])
        .with_left_end(End::Velocity(Drive::of(|_| 1.0)))
        .unwrap()
        .with_right_end(End::Mass(mass))
        .unwrap()
        .run(transit / cells * (1.0 + 1e-9), 2.5 * transit, &[])
        .unwrap();
    closes(&history);
    let end = at_steps(&history, &history.ends[1].velocity, 0.5);
    largest(end.map(|(t, velocity)| {
        let since = (t - transit).max(0.0);
        velocity - 2.0 * (1.0 - (-z * since / mass).exp())
    }))
}

/// Impact of a `striker` at 4 m/s on a `rod`.
fn struck(striker: Segment, rod: Segment, cells: f64, transits: f64) -> LineHistory {
    let transit = striker.transit_time();
    let bodies = [
        Body::new([striker]).unwrap().moving_at(4.0).unwrap(),
        Body::new([rod]).unwrap(),
    ];
    let step = transit / cells * (1.0 + 1e-9);
    let line = Line::new(bodies).unwrap();
    let history = line.run(step, transits * transit, &[]).unwrap();
    closes(&history);
    history
}

fn impacts(report: &mut Claims) {
    const SAINT_VENANT: &str = "closed form (de Saint-Venant)";
    let striker = steel(0.25, AREA);
    let (z, transit, mass) = (striker.impedance(), striker.transit_time(), striker.mass());
    let history = struck(striker, steel(0.5, AREA), 100.0, 7.0);
    let force = at_steps(&history, &history.contacts[0].force, 0.5);
    let ledger = history.ledger;
    report.by(SAINT_VENANT).deviation(
        "impact of a rod on a rod twice as long: force zV/2 for 2L/c, then none, relative to zV/2; momentum conserved; no energy lost in the contact",
        Within(5e-14, "rounding of sums over hundreds of steps"),
        Ok(largest(
            force
                .map(|(t, force)| force / (2.0 * z) - f64::from(u8::from(t < 2.0 * transit)))
                .chain([
                    ledger.momentum / (4.0 * mass) - 1.0,
                    ledger.lost_in_contact / ledger.initial_energy,
                ]),
        )),
    );
    let history = struck(steel(0.25, 3.0 * AREA), steel(4.0, AREA), 40.0, 20.0);
    let force = at_steps(&history, &history.contacts[0].force, 0.5);
    let r: f64 = 1.0 / 3.0;
    report.by(SAINT_VENANT).deviation(
        "force of a striker of three times the impedance, which falls by (1 - r)/(1 + r) per round trip: ten trips, relative to zV",
        Within(1e-14, "rounding"),
        Ok(largest(force.map(|(t, force)| {
            let trips = (t / (2.0 * transit)).floor();
            force / (4.0 * z) - ((1.0 - r) / (1.0 + r)).powf(trips) / (1.0 + r)
        }))),
    );
}

fn prony_stack() -> f64 {
    let duration = 1.5e-3;
    let synthesis = DampedSynthesis::new(duration, 1e-6).unwrap();
    let medium = Medium::new(1140.0, prony()).unwrap();
    let section = |area: f64| CrossSection::of_area(area);
    let chain = AnalyticChain::analytic_from_impact_face()
        .rod(&medium, section(AREA), 0.3)
        .rod(&bodies::aluminium(), section(0.5 * AREA), 0.2)
        .rod(&medium, section(AREA), 0.2)
        .end(Termination::Free)
        .unwrap();
    // pulse of 1 N, whose transform is entire
    let force =
        |s: Complex64| 10e-6 * std::f64::consts::PI.sqrt() * (s * s * 25e-12 - s * 50e-6).exp();
    let transform: Vec<Complex64> = synthesis
        .arguments()
        .map(|s| chain.mobility_at_s(s).unwrap() * force(s))
        .collect();
    let exact = synthesis.history(&transform).unwrap().samples;
    let stack = [
        Segment::prony(0.3, AREA, 1140.0, &prony()).unwrap(),
        aluminium(0.2, 0.5 * AREA),
        Segment::prony(0.2, AREA, 1140.0, &prony()).unwrap(),
    ];
    let gauge = Gauge {
        body: 0,
        position: 0.0,
    };
    let history = pushed(line(stack), 1.0).run(0.2e-6, duration, &[gauge]);
    let history = history.unwrap();
    closes(&history);
    let peak = largest(exact.iter().copied());
    let of_line = &history.gauges[0].velocity;
    let samples = exact.iter().enumerate().filter_map(|(index, exact)| {
        // linear interpolation between two steps of the march
        let position = index as f64 * 1e-6 / history.grid.time_step;
        let pair = of_line.get(position as usize..)?.get(..2)?;
        let u = position.fract();
        Some((pair[0] * (1.0 - u) + pair[1] * u - exact) / peak)
    });
    largest(samples)
}

//! Pulses, joints, masses and impacts whose solution is known.

use super::*;

/// d'Alembert: an elastic rod hands a pulse on without change, turns it at a free end, and again.
#[test]
fn elastic_pulse_travels_unchanged() {
    let segment = steel(1.0, AREA);
    let (z, c) = (segment.impedance(), segment.wave_speed());
    let cells = 250;
    let step = segment.transit_time() / f64::from(cells);
    // at the centre of a cell, where nothing has to be interpolated
    let position = 100.5 / f64::from(cells);
    let gauge = Gauge { body: 0, position };
    let history = pushed(line([segment]), 1000.0)
        .run(step * (1.0 + 1e-9), 4.0 / c, &[gauge])
        .unwrap();
    let incident = |t: f64| if t > 0.0 { 1000.0 * pulse(t) / z } else { 0.0 };
    for (k, (velocity, stress)) in history.gauges[0]
        .velocity
        .iter()
        .zip(&history.gauges[0].stress)
        .enumerate()
    {
        let time = k as f64 * history.grid.time_step;
        let right = incident(time - position / c) + incident(time - (position + 2.0) / c);
        let left = incident(time - (2.0 - position) / c) + incident(time - (4.0 - position) / c);
        // a thousand additions of numbers of the size of the pulse
        assert!((velocity - right - left).abs() < 1e-12 * 1000.0 / z, "{k}");
        assert!((stress * AREA + z * (right - left)).abs() < 1e-9, "{k}");
    }
    closes(&history);
    // a free rod keeps the impulse √π · 10 µs · 1000 N; the trapezoidal rule is exact for a Gaussian
    let impulse = std::f64::consts::PI.sqrt() * 10e-6 * 1000.0;
    assert!((history.ledger.momentum / impulse - 1.0).abs() < 1e-9);
}

/// Donnell: a step of the impedance reflects (z2 - z1)/(z2 + z1) of the force and transmits 2 z2/(z1 + z2).
#[test]
fn impedance_step_splits_the_pulse() {
    let (first, second) = (steel(1.0, AREA), aluminium(1.0, 1.7 * AREA));
    let (z1, z2) = (first.impedance(), second.impedance());
    let (c1, c2) = (first.wave_speed(), second.wave_speed());
    let gauges = [0.5, 1.5].map(|position| Gauge { body: 0, position });
    let history = pushed(line([first, second]), 1000.0)
        .with_right_end(End::Matched)
        .unwrap()
        .run(0.2e-6, 450e-6, &gauges)
        .unwrap();
    // the two wave speeds were changed by less than this to make whole numbers of cells, and the pulse is delayed by as much
    let change = largest(history.grid.speed_change.iter().copied());
    assert!(change < 2e-6, "{change}");
    let (reflected, transmitted) = ((z2 - z1) / (z2 + z1), 2.0 * z2 / (z1 + z2));
    for k in 0..history.gauges[0].stress.len() {
        let time = k as f64 * history.grid.time_step;
        let force = |at: usize, area: f64| -history.gauges[at].stress[k] * area;
        let once = 1000.0 * pulse(time - 0.5 / c1);
        let turned = 1000.0 * reflected * pulse(time - 1.5 / c1);
        // the free face turns it again
        let again = -1000.0 * reflected * pulse(time - 2.5 / c1);
        let passed = 1000.0 * transmitted * pulse(time - 1.0 / c1 - 0.5 / c2);
        let passed_again = -1000.0 * reflected * transmitted * pulse(time - 3.0 / c1 - 0.5 / c2);
        // speeds to 2e-6 over 300 µs are 0.6 ns, on a slope of 1/10 µs: 6e-5; the cubic in space 1e-7
        assert!((force(0, AREA) - once - turned - again).abs() < 0.1, "{k}");
        assert!(
            (force(1, 1.7 * AREA) - passed - passed_again).abs() < 0.1,
            "{k}"
        );
    }
    closes(&history);
}

/// A mass on the end of a rod is brought to twice the velocity of a step wave as 1 - e^{-zt/m}.
#[test]
fn mass_at_an_end_follows_its_exponential() {
    let error = |cells: f64| -> f64 {
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
        let end = &history.ends[1].velocity;
        let step = history.grid.time_step;
        largest(end.iter().enumerate().map(|(k, velocity)| {
            let time = (k as f64 + 0.5) * step - transit;
            let exact = if time > 0.0 {
                2.0 * (1.0 - (-z * time / mass).exp())
            } else {
                0.0
            };
            velocity - exact
        }))
    };
    // velocities at half steps are means of whole ones: (z dt/m)²/8 of a final velocity of 2
    let (coarse, fine) = (error(200.0), error(400.0));
    let ratio_of_step = steel(1.0, AREA).transit_time() / 200.0 / 20e-6;
    assert!(coarse < 0.3 * ratio_of_step.powi(2), "{coarse}");
    assert!((3.5..4.5).contains(&(coarse / fine)), "{coarse} {fine}");
}

/// de Saint-Venant: a rod that strikes one of its own kind, twice as long, keeps contact for 2 L/c with force zV/2, and stops.
#[test]
fn equal_impedances_exchange_their_motion() {
    let (striker, rod) = (steel(0.25, AREA), steel(0.5, AREA));
    let (z, transit, mass) = (striker.impedance(), striker.transit_time(), striker.mass());
    let bodies = [
        Body::new([striker]).unwrap().moving_at(4.0).unwrap(),
        Body::new([rod]).unwrap(),
    ];
    let history = Line::new(bodies)
        .unwrap()
        .run(transit / 100.0 * (1.0 + 1e-9), 7.0 * transit, &[])
        .unwrap();
    for (k, force) in history.contacts[0].force.iter().enumerate() {
        let time = (k as f64 + 0.5) * history.grid.time_step;
        let expected = if time < 2.0 * transit { 2.0 * z } else { 0.0 };
        assert!((force - expected).abs() < 1e-9 * z, "{time}: {force}");
    }
    let momentum = history.ledger.momentum;
    assert!((momentum / (4.0 * mass) - 1.0).abs() < 1e-12);
    assert!(history.ledger.lost_in_contact < 1e-12 * history.ledger.initial_energy);
    closes(&history);
}

/// A striker of higher impedance pushes in steps: after m passages the force is zV/(1+r) times ((1-r)/(1+r))^m, and reopens not before.
#[test]
fn heavy_striker_pushes_in_steps() {
    let (striker, rod) = (steel(0.25, 3.0 * AREA), steel(4.0, AREA));
    let (z, transit) = (rod.impedance(), striker.transit_time());
    let r: f64 = 1.0 / 3.0;
    let bodies = [
        Body::new([striker]).unwrap().moving_at(4.0).unwrap(),
        Body::new([rod]).unwrap(),
    ];
    let history = Line::new(bodies)
        .unwrap()
        .run(transit / 40.0 * (1.0 + 1e-9), 20.0 * transit, &[])
        .unwrap();
    for (k, force) in history.contacts[0].force.iter().enumerate() {
        let passages = ((k as f64 + 0.5) * history.grid.time_step / (2.0 * transit)).floor();
        let expected = z * 4.0 / (1.0 + r) * ((1.0 - r) / (1.0 + r)).powf(passages);
        assert!(
            (force - expected).abs() < 1e-9 * z,
            "{k}: {force} {expected}"
        );
    }
}

/// A gap delays the contact, and closing it costs less energy the finer the grid.
#[test]
fn a_gap_closes_with_the_relative_velocity() {
    let lost = |step: f64| -> f64 {
        let bodies = [
            Body::new([steel(0.25, AREA)])
                .unwrap()
                .moving_at(4.0)
                .unwrap(),
            Body::new([aluminium(0.5, AREA)]).unwrap(),
        ];
        let history = Line::new(bodies)
            .unwrap()
            .with_gap(0, 0.4137e-3)
            .unwrap()
            .run(step, 0.5e-3, &[])
            .unwrap();
        closes(&history);
        let first = history.contacts[0]
            .force
            .iter()
            .position(|f| *f > 0.0)
            .unwrap();
        let time = first as f64 * history.grid.time_step;
        assert!((time - 0.4137e-3 / 4.0).abs() < 1.1 * step, "{time}");
        history.ledger.lost_in_contact / history.ledger.initial_energy
    };
    let (coarse, fine) = (lost(1e-6), lost(0.25e-6));
    // at most one cell of the striker in 48
    assert!(coarse < 0.05 && fine < 0.0125, "{coarse} {fine}");
}

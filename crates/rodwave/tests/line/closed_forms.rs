//! Contacts, transit times and gaps with known solutions.

use super::*;

/// Checks that a contact opens at the right time within a step: a force applied at the left end
/// reaches the contact one transit time later; the faces separate when it falls to zero.
#[test]
fn f6_a_contact_opens_within_a_step() {
    let (transit, last) = (0.2 / (206e9_f64 / 7780.0).sqrt(), 93.7e-6);
    // the force (1 - t/T)(1 + t/T)^2 t/T is zero at T and has a curvature there
    let force = move |t: f64| {
        let part = t / last;
        if (0.0..2.0).contains(&part) {
            1e4 * part * (1.0 - part) * (1.0 + part).powi(2)
        } else {
            0.0
        }
    };
    let error = |cells: f64| -> f64 {
        let bar = || Body::new([steel(0.2, AREA)]).unwrap();
        let line = Line::new([bar(), bar()])
            .unwrap()
            .with_left_end(End::Force(Drive::of(force)))
            .unwrap()
            .with_right_end(End::Matched)
            .unwrap();
        let history = line
            .run(transit / cells, 1.5 * (transit + last), &[])
            .unwrap();
        let [opens, ..] = history.contacts[0].opens[..] else {
            panic!("the contact opens")
        };
        let closes = history.contacts[0].closes[0];
        assert!(
            (closes - transit).abs() < 1.1 * history.grid.time_step,
            "{closes}"
        );
        (opens - (transit + last)).abs() / history.grid.time_step
    };
    // tolerance, in steps: 5/8 h/T, above the error h F''/(8 F') = h/(2T) of the linear
    // interpolation, which decreases with the step; with the time of the last positive force, the
    // error would be up to a whole step
    for cells in [20.0, 40.0, 80.0, 160.0] {
        let (found, limit) = (error(cells), 0.63 * transit / cells / last);
        assert!(found < 1.05 * limit, "{cells}: {found} {limit}");
    }
}

/// Checks that the rounding of transit times is within the tolerance of the line: three segments
/// with equal impedances and incommensurable transit times only delay the applied velocity.
#[test]
fn f6_the_rounding_of_transit_times_is_what_was_asked_for() {
    let times = [17e-6, 17e-6 * 2.0_f64.sqrt(), 17e-6 * 3.0_f64.sqrt() / 2.0];
    let segments = times.map(|time| {
        // equal impedance by choice of modulus and speed: rho c = 4e7, E = rho c^2
        let speed = 0.1 / time;
        Segment::elastic(0.1, AREA, 4e7 / speed, 4e7 * speed).unwrap()
    });
    let pulse = |t: f64| (-((t - 60e-6) / 15e-6).powi(2)).exp();
    let line = Line::new([Body::new(segments).unwrap()])
        .unwrap()
        .with_left_end(End::Velocity(Drive::of(pulse)))
        .unwrap()
        .with_right_end(End::Matched)
        .unwrap();
    let delay: f64 = times.iter().sum();
    for tolerance in [1e-3, 1e-4, 3e-5] {
        let line = line.clone().with_speed_tolerance(tolerance).unwrap();
        let history = line.run(1e-6, 200e-6, &[]).unwrap();
        let rounding = history.grid.largest_rounding();
        assert!(rounding <= tolerance, "{rounding}");
        let step = history.grid.time_step;
        let velocity = history.ends[1].velocity.iter().enumerate();
        let error = velocity
            .map(|(n, v)| (v - pulse((n as f64 + 0.5) * step - delay)).abs())
            .fold(0.0, f64::max);
        // tolerance: largest slope of the pulse, 0.86/15 µs, times the largest change of the delay
        let limit = 0.86 / 15e-6 * delay * rounding;
        assert!(error < 1.01 * limit + 1e-9, "{tolerance}: {error} {limit}");
    }
}

/// Checks that a gap delays the contact, and that its closing dissipates less energy on a finer
/// grid.
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
    // tolerance: twice the energy of one of the 48 cells of the striker
    assert!(coarse < 0.05 && fine < 0.0125, "{coarse} {fine}");
}

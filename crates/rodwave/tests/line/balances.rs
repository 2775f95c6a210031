//! Energy and momentum of any line.

use super::*;

fn law(choice: u8, rate: f64, shape: f64, segment: Segment, modulus: f64) -> Segment {
    match choice {
        0 => segment.with_branch(modulus, Elastic),
        1 => segment.with_branch(modulus, Maxwell::from_reference_rate(rate, 10e6).unwrap()),
        2 => {
            let law = MaxwellNorton::from_reference_rate(1.0 + shape, rate, 10e6).unwrap();
            segment.with_branch(modulus, law)
        }
        _ => {
            let law = MaxwellGurevichRabinovich::from_reference_rate(shape, rate, 10e6).unwrap();
            segment.with_branch(modulus, law)
        }
    }
    .unwrap()
}

fn any_segment() -> impl Strategy<Value = Segment> {
    let branch = (0_u8..4, 1.0..5e4_f64, 0.0..2.0_f64, 1e9..5e9_f64);
    (
        0.02..0.3_f64,
        1e-5..5e-4_f64,
        900.0..8000.0_f64,
        prop::collection::vec(branch, 1..4),
    )
        .prop_map(|(length, area, density, branches)| {
            branches.into_iter().fold(
                Segment::new(length, area, density).unwrap(),
                |segment, (choice, rate, shape, modulus)| {
                    law(choice, rate, shape, segment, modulus)
                },
            )
        })
}

fn any_end() -> impl Strategy<Value = End> {
    prop_oneof![
        Just(End::Free),
        Just(End::Fixed),
        (1e-3..1.0_f64).prop_map(End::Mass),
        (1.0..1e4_f64).prop_map(End::Dashpot),
        Just(End::Matched),
        (-5.0..5.0_f64).prop_map(|v| End::Velocity(Drive::of(move |t| v * (t * 3e4).sin()))),
        (-5e3..5e3_f64).prop_map(|f| End::Force(Drive::of(move |t| f * (t * 2e4).cos()))),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Checks that the balances of energy and momentum close to rounding for any bodies, laws, ends
    /// and gaps, on any grid.
    #[test]
    fn balances_close(
        bodies in prop::collection::vec((prop::collection::vec(any_segment(), 1..4), -8.0..8.0_f64), 1..4),
        left in any_end(),
        right in any_end(),
        gap in 0.0..1e-3_f64,
        step in 1e-6..8e-6_f64,
    ) {
        let many = bodies.len() > 1;
        let bodies = bodies
            .into_iter()
            .map(|(segments, velocity)| Body::new(segments).unwrap().moving_at(velocity).unwrap());
        let mut line = Line::new(bodies).unwrap();
        if many {
            line = line.with_gap(0, gap).unwrap();
        }
        let line = line
            .with_left_end(left).unwrap()
            .with_right_end(right).unwrap()
            // the grid may change wave speeds: the balances are those of the bodies on the grid
            .with_speed_tolerance(0.2).unwrap();
        let history = line.run(step, 1.5e-3, &[]).unwrap();
        let ledger = history.ledger;
        // tolerance: thousands of steps, each with a rounding error of about 1e-16 of all energy
        // that has entered or left
        let energy = ledger.initial_energy + ledger.supplied.abs() + ledger.stored
            + ledger.dissipated + ledger.radiated + ledger.lost_in_contact;
        prop_assert!(ledger.energy_residual().abs() <= 1e-10 * energy, "{ledger:?}");
        let mass: f64 = line.segments().map(Segment::mass).sum();
        let momentum = ledger.momentum.abs() + ledger.impulse.abs() + (2.0 * mass * energy).sqrt();
        prop_assert!(ledger.momentum_residual().abs() <= 1e-10 * momentum, "{ledger:?}");
        prop_assert!(ledger.dissipated >= 0.0 && ledger.lost_in_contact >= 0.0);
        prop_assert!(ledger.radiated >= -1e-14 * energy);
        for contact in &history.contacts {
            for (force, gap) in contact.force.iter().zip(&contact.gap) {
                prop_assert!(*force >= 0.0 && *gap >= 0.0 && (*force == 0.0 || *gap == 0.0));
            }
        }
    }
}

//! Balances, symmetry and similarity of impacts of random passive bodies.

use impulse::{ContactLaw, Impact, ImpactBody, Prediction, PredictionFlag};
use proptest::prelude::*;

use super::lossy_rod;
use crate::bodies::{impedance, long_rod, mass, rod, wave_speed};

/// A free body by its number: masses and rods, elastic or not.
fn body(kind: usize, size: f64) -> Box<dyn ImpactBody> {
    match kind {
        0 => Box::new(mass(0.1 + size)),
        1 => Box::new(rod(0.012, 0.05 + 0.4 * size)),
        2 => Box::new(lossy_rod(0.02, 0.05 + 0.2 * size, 0.02 + 0.2 * size)),
        _ => Box::new(lossy_rod(0.01, 0.1 + 0.3 * size, 0.01)),
    }
}

fn contact(kind: usize) -> ContactLaw {
    match kind {
        0 => ContactLaw::linear(2e7).unwrap(),
        _ => ContactLaw::hertz(3e9).unwrap(),
    }
}

fn meet(
    first: &dyn ImpactBody,
    second: &dyn ImpactBody,
    velocity: f64,
    law: ContactLaw,
) -> Prediction {
    Impact::between(first, second)
        .at_velocity(velocity)
        .through(law)
        .in_steps_of(2e-6)
        .predict(2e-3)
        .unwrap()
}

fn has_parted(prediction: &Prediction) -> bool {
    !prediction.flags.contains(&PredictionFlag::StillInContact)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Faces never pull, no body generates energy, energy is lost only in the bodies and the
    /// contact, and the pair does not part faster than it met.
    #[test]
    fn passive_bodies_keep_the_balances(
        kinds in [0..4_usize, 0..4_usize],
        sizes in [0.0..1.0_f64, 0.0..1.0_f64],
        law in 0..2_usize,
        velocity in 0.01..20.0_f64,
    ) {
        let [first, second] = [0, 1].map(|k: usize| body(kinds[k], sizes[k]));
        let found = meet(&*first, &*second, velocity, contact(law));
        prop_assert!(found.history.force().iter().all(|f| *f >= 0.0 && f.is_finite()));
        let balance = found.balance();
        // energy is conserved in every step
        prop_assert!(balance.energy_residual.abs() < 1e-9, "{balance:?}");
        let before = balance.energy_before.unwrap();
        // tolerance: rounding of the kernels, which contain an alias of 1.5e-8
        prop_assert!(balance.inner.iter().all(|inner| *inner > -1e-5 * before), "{balance:?}");
        prop_assert!(balance.dissipated_in_contact > -1e-9 * before);
        let [Some(m1), Some(m2)] = [first.free_mass(), second.free_mass()] else { panic!("both are free") };
        let [Some(v1), Some(v2)] = balance.velocity_after else { panic!("both are free") };
        prop_assert!((m1 * v1 + m2 * v2 - m1 * velocity).abs() < 1e-12 * m1 * velocity);
        let restitution = balance.restitution.unwrap();
        if has_parted(&found) {
            prop_assert!((-1e-6..=1.0 + 1e-6).contains(&restitution), "{restitution}");
        } else {
            prop_assert!((-1.0..=1.0 + 1e-6).contains(&restitution));
        }
        let summed: f64 = found.contacts.iter().map(|c| c.impulse).sum();
        prop_assert!((summed - balance.impulse).abs() < 1e-4 * balance.impulse);
    }

    /// The force is the same whichever body is the striker.
    #[test]
    fn the_force_does_not_know_who_came(
        kinds in [0..4_usize, 0..4_usize],
        sizes in [0.0..1.0_f64, 0.0..1.0_f64],
        law in 0..2_usize,
    ) {
        let [first, second] = [0, 1].map(|k: usize| body(kinds[k], sizes[k]));
        let there = meet(&*first, &*second, 1.0, contact(law));
        let back = meet(&*second, &*first, 1.0, contact(law));
        // the sum of two kernels does not depend on their order, to the bit
        prop_assert_eq!(there.history.force(), back.history.force());
        let faces = [&there, &back].map(|p| p.face_velocity.clone());
        for (one, other) in faces[0][0].iter().zip(&faces[1][1]) {
            // v1 = V - u1 here is u2 there, in the frame of the other body
            prop_assert!((one - (1.0 - other)).abs() < 1e-12);
        }
    }

    /// With rigid and linear contacts, forces are proportional to the velocity; with rigid contacts
    /// they agree to the bit for factors that are powers of two.
    #[test]
    fn linear_impacts_scale_with_velocity(
        kinds in [1..4_usize, 1..4_usize],
        sizes in [0.0..1.0_f64, 0.0..1.0_f64],
        is_rigid in any::<bool>(),
        power in -60..60_i32,
    ) {
        let [first, second] = [0, 1].map(|k: usize| body(kinds[k], sizes[k]));
        let law = || if is_rigid { ContactLaw::Rigid } else { contact(0) };
        let factor = 2.0_f64.powi(power);
        let one = meet(&*first, &*second, 1.0, law());
        let other = meet(&*first, &*second, factor, law());
        if is_rigid {
            for (a, b) in one.history.force().iter().zip(other.history.force()) {
                prop_assert_eq!((a * factor).to_bits(), b.to_bits());
            }
        } else {
            let peak = one.peak().force;
            for (a, b) in one.history.force().iter().zip(other.history.force()) {
                // Newton's iteration ends at a relative rounding
                prop_assert!((a * factor - b).abs() < 1e-9 * peak * factor);
            }
        }
        prop_assert_eq!(one.contacts.len(), other.contacts.len());
    }

    /// Two masses and Hertz: peak force as `V^{6/5}`, duration as `V^{-1/5}` (Hertz 1882), and no energy lost.
    #[test]
    fn hertz_scales_with_a_broken_power(masses in [0.01..10.0_f64, 0.01..10.0_f64], velocity in 0.01..10.0_f64) {
        let [first, second] = masses.map(mass);
        let coefficient = 4e9;
        let reduced = 1.0 / (1.0 / masses[0] + 1.0 / masses[1]);
        // δ_max = (5 m V²/4K)^{2/5}, F = K δ^{3/2}, T = 2.94 δ/V
        let depth = (1.25 * reduced * velocity * velocity / coefficient).powf(0.4);
        let exact = coefficient * depth.powf(1.5);
        let duration = 2.943_275 * depth / velocity;
        let found = Impact::between(&first, &second).at_velocity(velocity)
            .through(ContactLaw::hertz(coefficient).unwrap()).predict(1.5 * duration).unwrap();
        // 2700 steps of second order in a contact
        prop_assert!((found.peak().force / exact - 1.0).abs() < 1e-5, "{} {exact}", found.peak().force);
        prop_assert!((found.duration() / duration - 1.0).abs() < 1e-3);
        prop_assert!((found.balance().restitution.unwrap() - 1.0).abs() < 1e-5);
    }

    /// The impulse of a rigid contact is that of the closed form, even if no arrival is at the end
    /// of a step.
    #[test]
    fn steps_need_not_divide_arrivals(length in 0.05..0.5_f64, share in 0.003..0.02_f64) {
        let impedance = impedance(0.01);
        let round_trip = 2.0 * length / wave_speed();
        let (first, second) = (rod(0.01, length), long_rod(impedance));
        let found = Impact::between(&first, &second).at_velocity(1.0)
            .in_steps_of(share * round_trip).predict(1.6 * round_trip).unwrap();
        let exact = 0.5 * impedance * round_trip;
        // After the step in which the front falls, a remainder of the force acts for part of a
        // step. For 9000 step lengths its impulse was at most 0.0058 of that of a whole step; a
        // front that falls in the wrong step would give 1.
        prop_assert!((found.balance().impulse / exact - 1.0).abs() < 0.01 * share, "{}", found.balance().impulse / exact);
        let last = found.contacts.first().unwrap().end.unwrap();
        // The front falls within one step of the round trip; the remainder travels to and fro
        // several times more.
        prop_assert!(last > round_trip - share * round_trip && last < (1.0 + 8.0 * share) * round_trip, "{:?} {}", found.contacts, round_trip);
    }
}

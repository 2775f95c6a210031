//! Compliant faces: springs, Hertz, a curve with another unloading path.

use std::f64::consts::PI;

use impulse::{
    ContactLaw, ElasticMaterial, Impact, ImpulseError, MobilityLaw, Prediction, PredictionFlag,
    TabulatedContact,
};
use num_complex::Complex64;

use crate::bodies::{deviation, endless_rod, impedance, mass, wall};
use testbed::claim::{Claims, Ours, Within, missing, of};
use testbed::difference::largest;
use testbed::hold;

const VELOCITY: f64 = 2.0;
const DURATION: f64 = 1e-3;

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    stiffnesses(claims);
    mass_on_a_spring(claims);
    sphere_on_the_ground(claims);
    sphere_on_an_endless_rod(claims);
    hysteresis(claims);
    two_masses(claims);
    hold!(claims);
}

fn stiffnesses(claims: &mut Claims) {
    let steel = ElasticMaterial {
        modulus: 206e9,
        poisson_ratio: 0.29,
    };
    let nylon = ElasticMaterial {
        modulus: 2.6e9,
        poisson_ratio: 0.4,
    };
    claims.by("k = 2 a E/(1 - nu^2), flat punch of radius a");
    let punch = || -> Ours {
        match ContactLaw::flat_punch(0.005, nylon)? {
            ContactLaw::Linear { stiffness } => Ok(stiffness),
            _ => Err(missing("the stiffness")),
        }
    };
    // 0.01 · 2.6e9/0.84
    claims.claim(
        "stiffness of a punch of 5 mm radius on nylon",
        "N/m",
        30.952_380_952e6,
        Within(1e-2, "the expected value has 11 digits"),
        punch(),
    );
    claims.by("K = 4/3 E* sqrt(R), Hertz");
    let sphere = || -> Ours {
        match ContactLaw::hertz_sphere(0.01, steel, nylon)? {
            ContactLaw::Hertz { coefficient } => Ok(coefficient),
            _ => Err(missing("the coefficient")),
        }
    };
    // (1 - 0.29²)/206e9 + 0.84/2.6e9 = 3.275230396e-10 1/Pa
    claims.claim(
        "Hertz's coefficient of a steel sphere of 10 mm radius on nylon",
        "N/m^1.5",
        4.070_960_428e8,
        Within(1.0, "the expected value has 10 digits"),
        sphere(),
    );
}

fn mass_on_a_spring(claims: &mut Claims) {
    claims.by("F = V sqrt(Mk) sin(omega t), rigid mass on a spring");
    let (kilograms, stiffness) = (0.5_f64, 2e7_f64);
    let omega = (stiffness / kilograms).sqrt();
    let peak = VELOCITY * (kilograms * stiffness).sqrt();
    let exact = |t: f64| {
        if t < PI / omega {
            peak * (omega * t).sin()
        } else {
            0.0
        }
    };
    let as_body = || -> Ours<Prediction> {
        let spring = MobilityLaw::analytic(move |s: Complex64| s / stiffness);
        let striker = mass(kilograms);
        Ok(Impact::between(&striker, &spring)
            .at_velocity(VELOCITY)
            .predict(DURATION)?)
    };
    let as_contact = || -> Ours<Prediction> {
        let (striker, ground) = (mass(kilograms), wall());
        Ok(Impact::between(&striker, &ground)
            .at_velocity(VELOCITY)
            .through(ContactLaw::linear(stiffness)?)
            .predict(DURATION)?)
    };
    let both = || -> Ours<[Prediction; 2]> { Ok([as_body()?, as_contact()?]) };
    let both = both();
    claims.deviation(
        "mass on a spring, as a body and as a contact law: half a sine",
        Within(
            1e-6,
            "means over a step, with an error of (omega h)^2/24 = 1e-7, and as much for the error of the period",
        ),
        of(&both, |both| {
            let jump = [PI / omega];
            largest(both.iter().map(|p| deviation(p, &jump, 2.0, exact) / peak))
        }),
    );
    claims.deviation(
        "mass on a spring, as a body and as a contact law: end of the one contact, relative",
        Within(
            1e-6,
            "the part of the last step in which the contact is open",
        ),
        of(&both, |both| {
            let end = |p: &Prediction| match p.contacts[..] {
                [contact] => contact.end.unwrap_or(f64::NAN),
                _ => f64::NAN,
            };
            largest(both.iter().map(|p| end(p) / (PI / omega) - 1.0))
        }),
    );
    claims.deviation(
        "mass on a spring, as a body and as a contact law: restitution minus 1, also from the velocities of the faces, and remaining momentum",
        Within(1e-6, "the part of the last step in which the contact is open"),
        of(&both, |both| {
            largest(both.iter().flat_map(|p| {
                assert_eq!(p.flags, []);
                let balance = p.balance();
                assert!(balance.energy_residual.abs() < 1e-9, "{balance:?}");
                let lost = balance.dissipated_in_contact.abs();
                assert!(lost < 1e-9 * balance.energy_before.unwrap());
                [
                    balance.restitution.unwrap_or(f64::NAN) - 1.0,
                    balance.observed_restitution.unwrap_or(f64::NAN) - 1.0,
                    balance.momentum_residual.unwrap_or(f64::NAN),
                ]
            }))
        }),
    );
    let damped = || -> Ours {
        let spring = MobilityLaw::analytic(move |s: Complex64| s / stiffness);
        let striker = mass(kilograms);
        let stick = Impact::between(&striker, &spring)
            .at_velocity(VELOCITY)
            .stick_force_damped(DURATION, 1e-7)?;
        let samples = stick.force().iter().enumerate();
        Ok(samples
            .map(|(n, force)| (stick.time_at(n), force))
            .filter(|(t, _)| *t > 20e-7)
            .map(|(t, force)| (force - peak * (omega * t).sin()).abs() / peak)
            .fold(0.0, f64::max))
    };
    claims.deviation(
        "mass on a spring: stick force by the damped transform",
        Within(
            3e-6,
            "the Gaussian reduces the amplitude by (omega sigma)^2/2 = 1e-6",
        ),
        damped(),
    );
}

/// ½ M V² = ⅖ K δ^{5/2}; the contact lasts 2 ∫ dx/√(1 - x^{5/2}) δ/V.
fn sphere_on_the_ground(claims: &mut Claims) {
    claims.by("Hertz's impact of a sphere on an immovable plane");
    let (kilograms, coefficient) = (0.03, 8e9_f64);
    let deepest = (1.25 * kilograms * VELOCITY * VELOCITY / coefficient).powf(0.4);
    let peak = coefficient * deepest.powf(1.5);
    // 2 √π Γ(7/5)/Γ(9/10)
    let lasts = 2.943_275_184_3 * deepest / VELOCITY;
    let found = || -> Ours<Prediction> {
        let (striker, ground) = (mass(kilograms), wall());
        Ok(Impact::between(&striker, &ground)
            .at_velocity(VELOCITY)
            .through(ContactLaw::hertz(coefficient)?)
            .in_steps_of(1e-7)
            .predict(3e-4)?)
    };
    let found = found();
    claims.claim(
        "sphere on a plane: peak force",
        "N",
        peak,
        Within(1e-5 * peak, "means over steps of 1/1700 of the contact"),
        of(&found, |p| p.peak().force),
    );
    claims.claim(
        "sphere on a plane: duration of the contact",
        "s",
        lasts,
        Within(1e-9, "the end within a hundredth of a step"),
        of(&found, |p| p.contacts[0].end.unwrap_or(f64::NAN)),
    );
    claims.claim(
        "sphere on a plane: impulse, twice the momentum",
        "N s",
        2.0 * kilograms * VELOCITY,
        Within(
            2e-7 * kilograms * VELOCITY,
            "the part of the last step in which the contact is open",
        ),
        of(&found, |p| p.balance().impulse),
    );
    claims.claim(
        "sphere on a plane: deepest approach",
        "m",
        deepest,
        Within(
            1e-6 * deepest,
            "the place of the turning point within a step of 1/1700 of the contact",
        ),
        of(&found, |p| p.approach.iter().copied().fold(0.0, f64::max)),
    );
}

/// δ' = V - J/M - F/Z, J' = F = K δ^{3/2}, by the classical rule of Runge and Kutta.
fn sphere_on_an_endless_rod(claims: &mut Claims) {
    claims.by(
        "ordinary differential equation of a sphere on a semi-infinite rod, by Runge and Kutta's rule",
    );
    let (kilograms, z, coefficient) = (0.03, impedance(0.010), 8e9);
    let force = |approach: f64| coefficient * approach.max(0.0).powf(1.5);
    let rate = |[approach, impulse]: [f64; 2]| {
        let force = force(approach);
        [VELOCITY - impulse / kilograms - force / z, force]
    };
    let steps = 20_000_u32;
    let h = DURATION / f64::from(steps);
    let mut state = [0.0, 0.0];
    let mut exact = vec![0.0];
    for _ in 0..steps {
        let after = |k: [f64; 2], part: f64| [state[0] + part * k[0], state[1] + part * k[1]];
        let a = rate(state);
        let b = rate(after(a, 0.5 * h));
        let c = rate(after(b, 0.5 * h));
        let d = rate(after(c, h));
        for (value, i) in state.iter_mut().zip(0..2) {
            *value += h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
        }
        exact.push(force(state[0]));
    }
    let peak = largest(exact.iter().copied());
    let found = |n_steps: usize| -> Ours<Prediction> {
        let (striker, rod) = (mass(kilograms), endless_rod(0.010));
        let prediction = Impact::between(&striker, &rod)
            .at_velocity(VELOCITY)
            .through(ContactLaw::hertz(coefficient)?)
            .in_steps_of(DURATION / n_steps as f64)
            .predict(DURATION)?;
        assert_eq!(prediction.flags, []);
        assert!(prediction.balance().energy_residual.abs() < 1e-12);
        Ok(prediction)
    };
    let both = || -> Ours<[Prediction; 2]> { Ok([found(400)?, found(1000)?]) };
    let found = both();
    // the samples are means over the steps, at the middle of the steps
    let worst = |p: &Prediction, every: usize| {
        let samples = p.history.force().iter().enumerate();
        largest(samples.map(|(n, force)| (force - exact[n * every + every / 2]) / peak))
    };
    claims.claim(
        "sphere on a semi-infinite rod: peak force",
        "N",
        peak,
        Within(
            1e-3 * peak,
            "means over steps of 1 us at the maximum of the force",
        ),
        of(&found, |[_, fine]| fine.peak().force),
    );
    // in the first step the mean of t^{3/2} is 0.4 and its value in the middle 0.354, times (V
    // h)^{3/2} K; the errors of the other steps fall with the square of h
    claims.deviation(
        "sphere on a semi-infinite rod: force in steps of 1 us: largest error, relative to the difference between mean and middle of the first step",
        Within(1.1, "the first step has the largest error, and sets this scale"),
        of(&found, |[_, fine]| {
            worst(fine, 20) / (0.046 * coefficient * (VELOCITY * 1e-6).powf(1.5) / peak)
        }),
    );
    claims.claim(
        "sphere on a semi-infinite rod: largest error of the force in steps of 2.5 us over that in steps of 1 us",
        "1",
        4.6,
        Within(
            1.65,
            "between the power 3/2 of the first step, and 2 of the others",
        ),
        of(&found, |[coarse, fine]| worst(coarse, 50) / worst(fine, 20)),
    );
    claims.deviation(
        "sphere on a semi-infinite rod: impulse of all contacts over the exact one, minus 1, divided by the square of the step in us, for steps of 2.5 and 1 us",
        Within(1e-4, "second order, 1000 steps"),
        of(&found, |[coarse, fine]| {
            let error = |p: &Prediction| p.balance().impulse / state[1] - 1.0;
            largest([error(coarse) / 6.25, error(fine)])
        }),
    );
}

/// Loading absorbs M V²/2 = 0.1 J: 2 mJ up to (10 um, 400 N), and 400 x + (5600 N/90 um) x²/2 over
/// the further approach x.
fn hysteresis(claims: &mut Claims) {
    claims.by("energy between the curves of loading and of unloading");
    let unloading = 2e8;
    let slope = 5600.0 / 9e-5;
    let way = (-400.0 + (400.0_f64.powi(2) + 2.0 * slope * 0.098).sqrt()) / slope;
    let peak = 400.0 + slope * way;
    let returned = 0.5 * peak * peak / unloading;
    let found = || -> Ours<Prediction> {
        let table = TabulatedContact::new(&[(0.0, 0.0), (1e-5, 400.0), (1e-4, 6000.0)])?
            .unloading_with(unloading)?;
        let (striker, ground) = (mass(0.05), wall());
        Ok(Impact::between(&striker, &ground)
            .at_velocity(VELOCITY)
            .through(ContactLaw::Tabulated(table))
            .predict(DURATION)?)
    };
    let found = found().inspect(|p| {
        assert_eq!(p.flags, []);
        assert!(p.balance().energy_residual.abs() < 1e-9);
    });
    claims.claim(
        "contact with hysteresis: peak force",
        "N",
        peak,
        Within(1e-4 * peak, "the peak within a step, (omega h)^2/8"),
        of(&found, |p| p.peak().force),
    );
    claims.claim(
        "contact with hysteresis: energy that stays in the contact",
        "J",
        0.1 - returned,
        Within(1e-6, "the peak within a step"),
        of(&found, |p| p.balance().dissipated_in_contact),
    );
    claims.claim(
        "contact with hysteresis: coefficient of restitution",
        "1",
        (returned / 0.1).sqrt(),
        Within(2e-5, "the peak within a step"),
        of(&found, |p| p.balance().restitution.unwrap_or(f64::NAN)),
    );
}

fn two_masses(claims: &mut Claims) {
    claims.by("J = V (1 + e) M_1 M_2/(M_1 + M_2)");
    let soft = || -> Ours {
        let (first, second) = (mass(0.5), mass(1.0));
        let impact = Impact::between(&first, &second).at_velocity(VELOCITY);
        let prediction = impact.through(ContactLaw::linear(1e7)?).predict(DURATION)?;
        let restitution = prediction.balance().restitution.unwrap_or(f64::NAN);
        assert!((restitution - 1.0).abs() < 1e-6, "{restitution}");
        Ok(prediction.balance().impulse)
    };
    claims.claim(
        "0.5 kg against 1 kg through a spring: impulse",
        "N s",
        2.0 * VELOCITY / 3.0,
        Within(
            2e-7,
            "the part of the last step in which the contact is open",
        ),
        soft(),
    );
}

#[test]
fn two_rigid_masses_need_something_soft_between_them() {
    let (first, second) = (mass(0.5), mass(1.0));
    let impact = Impact::between(&first, &second).at_velocity(VELOCITY);
    assert!(matches!(
        impact.predict(DURATION),
        Err(ImpulseError::RigidFaces { ratio }) if (ratio - 0.1).abs() < 1e-6
    ));
}

#[test]
fn a_stiff_contact_is_flagged_where_steps_are_too_long() {
    let (striker, rod) = (mass(0.1), endless_rod(0.010));
    let impact = Impact::between(&striker, &rod)
        .at_velocity(VELOCITY)
        .through(ContactLaw::linear(1e12).unwrap());
    let flagged = |prediction: &Prediction| {
        let mut flags = prediction.flags.iter();
        flags.any(|flag| matches!(flag, PredictionFlag::UnresolvedContact { .. }))
    };
    assert!(flagged(&impact.predict(DURATION).unwrap()));
    assert!(!flagged(&impact.in_steps_of(1e-9).predict(4e-6).unwrap()));
}

/// A mass of 2 g on a rod, whose force decays within m/Z: if the step is longer, the impulse of the
/// only step with a force is too large, and the contact is flagged.
#[test]
fn a_contact_within_two_steps_is_flagged() {
    let (kilograms, z) = (2e-3, impedance(0.010));
    let decay = kilograms / z;
    let (striker, rod) = (mass(kilograms), endless_rod(0.010));
    let momentum = kilograms * VELOCITY;
    let of_step = |step: f64| {
        let impact = Impact::between(&striker, &rod).at_velocity(VELOCITY);
        let prediction = impact.in_steps_of(step).predict(1000.0 * step).unwrap();
        let mut flags = prediction.flags.iter();
        let is_flagged = flags.any(|f| matches!(f, PredictionFlag::ContactOfFewSteps { .. }));
        (is_flagged, prediction.balance().impulse / momentum)
    };
    let (is_flagged, coarse) = of_step(10.0 * decay);
    assert!(is_flagged && coarse > 1.5, "{coarse}");
    let (is_flagged, fine) = of_step(0.1 * decay);
    // the force is the mean over each step, so that the momentum is conserved to rounding
    assert!(!is_flagged && (fine - 1.0).abs() < 1e-6, "{fine}");
}

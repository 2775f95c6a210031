//! Impacts with a closed form, or an independent solution of their differential equation.

use std::f64::consts::PI;

use impulse::{ContactLaw, Impact, ImpulseError, MobilityLaw, Prediction, Quadrature};
use num_complex::Complex64;
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::element::{Circle, CrossSection};
use rodwave::medium::Medium;
use rodwave::modulus::{Elastic, SpringPot};

const VELOCITY: f64 = 2.0;
const DURATION: f64 = 1e-3;

fn steel() -> Medium<Elastic> {
    Medium::new(7780.0, Elastic::new(206e9).unwrap()).unwrap()
}

fn circle(diameter_mm: f64) -> Circle {
    Circle::of_diameter(1e-3 * diameter_mm).unwrap()
}

fn impedance(diameter_mm: f64) -> f64 {
    CrossSection::from(circle(diameter_mm)).area() * (206e9_f64 * 7780.0).sqrt()
}

fn transit_time(length: f64) -> f64 {
    length / (206e9_f64 / 7780.0).sqrt()
}

fn rod(diameter_mm: f64, length: f64) -> AnalyticChain {
    AnalyticChain::analytic_from_impact_face()
        .rod(&steel(), circle(diameter_mm), length)
        .end(Termination::Free)
        .unwrap()
}

fn long_rod(diameter_mm: f64) -> AnalyticChain {
    AnalyticChain::analytic_from_impact_face()
        .end(Termination::semi_infinite(&steel(), circle(diameter_mm)))
        .unwrap()
}

fn mass(kilograms: f64) -> MobilityLaw<impl Fn(Complex64) -> Complex64> {
    MobilityLaw::analytic(move |s| 1.0 / (kilograms * s))
        .free(kilograms)
        .unwrap()
}

/// Largest deviation from `exact` at samples that are more than `away` steps from all `jumps`.
fn deviation(prediction: &Prediction, jumps: &[f64], away: f64, exact: impl Fn(f64) -> f64) -> f64 {
    let history = &prediction.history;
    let samples = history.force().iter().enumerate();
    samples
        .map(|(index, force)| (history.time_at(index), force))
        .filter(|(time, _)| {
            jumps
                .iter()
                .all(|jump| (time - jump).abs() > away * history.time_step())
        })
        .map(|(time, force)| {
            assert!(force.is_finite());
            (force - exact(time)).abs()
        })
        .fold(0.0, f64::max)
}

#[test]
fn two_endless_rods_press_with_a_constant_force() {
    let (first, second) = (long_rod(10.0), long_rod(14.0));
    let exact = VELOCITY / (1.0 / impedance(10.0) + 1.0 / impedance(14.0));
    for quadrature in [
        Quadrature::CellAverages,
        Quadrature::Bdf2,
        Quadrature::Trapezoid,
    ] {
        let impact = Impact::between(&first, &second).at_velocity(VELOCITY);
        let prediction = impact.by(quadrature).predict(DURATION).unwrap();
        // rounding; convolution quadrature has its weights to the square root of that
        let tolerance = match quadrature {
            Quadrature::CellAverages => 1e-12,
            _ => 1e-7,
        };
        let found = deviation(&prediction, &[], 0.0, |_| exact);
        assert!(found < tolerance * exact, "{quadrature:?} {found}");
        // nothing is free: no restitution, and the contact goes on
        let balance = prediction.balance();
        assert_eq!(balance.restitution, None);
        assert_eq!(prediction.contacts.len(), 1);
        assert_eq!(prediction.contacts[0].end, None);
    }
}

/// De Saint-Venant: rods of one section. The shorter one brings Z V/2 for its own round trip, and is then at rest; the
/// contact stays closed without force until the echo of the longer one comes back and opens it.
#[test]
fn rods_of_different_lengths() {
    let (short, long) = (rod(10.0, 0.3), rod(10.0, 0.7));
    let plateau = 0.5 * impedance(10.0) * VELOCITY;
    let trip = 2.0 * transit_time(0.3);
    let exact = |t: f64| if t < trip { plateau } else { 0.0 };
    // the part of a step that the end of the pulse leaves goes to and fro in the shorter rod
    let jumps: Vec<f64> = (1..9).map(|k| f64::from(k) * trip).collect();
    for (first, second) in [(&short, &long), (&long, &short)] {
        let prediction = Impact::between(first, second)
            .at_velocity(VELOCITY)
            .predict(DURATION)
            .unwrap();
        assert!(prediction.flags.is_empty(), "{:?}", prediction.flags);
        // An echo is smeared over the step that holds it and one beside; what the roll-off of the bands leaves of a kink falls with the
        // fifth power of the distance.
        let found = deviation(&prediction, &jumps, 3.0, exact);
        assert!(found < 2e-3 * plateau, "{}", found / plateau);
        let far = deviation(&prediction, &jumps, 40.0, exact);
        assert!(far < 2e-6 * plateau, "{}", far / plateau);
        let momentum = short.free_mass().unwrap() * VELOCITY;
        let balance = prediction.balance();
        // in the frame of the second body the first gives up the impulse that stops, or starts, the shorter one
        // half a step of the plateau at the end of a pulse of 478 steps
        assert!(
            (balance.impulse / momentum - 1.0).abs() < 1e-3,
            "{balance:?}"
        );
        assert!(balance.energy_residual.abs() < 1e-10, "{balance:?}");
        // e = J (1/M₁ + 1/M₂)/V - 1 = L₁/L₂
        assert!((balance.restitution.unwrap() - 0.3 / 0.7).abs() < 1.5e-3);
    }
}

#[test]
fn two_equal_free_rods() {
    let body = rod(10.0, 0.5);
    let plateau = 0.5 * impedance(10.0) * VELOCITY;
    let trip = 2.0 * transit_time(0.5);
    let impact = Impact::between(&body, &body).at_velocity(VELOCITY);
    // By the damped transform the faces stick, and the force alternates for ever. Plateau to 1e-6, away from what the Gaussian rounds.
    let stick = impact.stick_force_damped(3.0 * trip, 1e-7).unwrap();
    for (index, force) in stick.force().iter().enumerate() {
        let periods = stick.time_at(index) / trip;
        if (periods - periods.round()).abs() * trip < 16e-7 || periods < 0.0 {
            continue;
        }
        let sign = if periods.rem_euclid(2.0) < 1.0 {
            1.0
        } else {
            -1.0
        };
        assert!(
            (force - sign * plateau).abs() < 1e-6 * plateau,
            "{periods} {force}"
        );
    }
    // the same by marching
    let marched = impact.stick_force(3.0 * trip).unwrap();
    for (index, force) in marched.force().iter().enumerate() {
        let periods = marched.time_at(index) / trip;
        let steps = (periods - periods.round()).abs() * trip / marched.time_step();
        if steps > 20.0 {
            let sign = if periods.rem_euclid(2.0) < 1.0 {
                1.0
            } else {
                -1.0
            };
            assert!(
                (force - sign * plateau).abs() < 1e-6 * plateau,
                "{periods} {force}"
            );
        }
    }
    // and with faces that part: the velocities are exchanged, nothing is left behind
    let prediction = impact.predict(DURATION).unwrap();
    let exact = |t: f64| if t < trip { plateau } else { 0.0 };
    let far = deviation(&prediction, &[trip], 40.0, exact);
    assert!(far < 1e-6 * plateau, "{}", far / plateau);
    let balance = prediction.balance();
    // half a step of the plateau at its end, of 796 steps
    assert!((balance.restitution.unwrap() - 1.0).abs() < 1e-3);
    let kinetic = 0.5 * body.free_mass().unwrap() * VELOCITY.powi(2);
    assert!((balance.translation_after[1].unwrap() / kinetic - 1.0).abs() < 2e-3);
    assert!(
        balance
            .inner
            .iter()
            .all(|inner| inner.abs() < 1e-3 * kinetic),
        "{balance:?}"
    );
    assert!(
        (balance.observed_restitution.unwrap() - 1.0).abs() < 1e-3,
        "{balance:?}"
    );
}

#[test]
fn a_mass_on_an_endless_rod() {
    let striker = mass(0.1);
    let rod = long_rod(10.0);
    let z = impedance(10.0);
    let exact = |t: f64| z * VELOCITY * (-z * t / 0.1).exp();
    let run = |steps: f64, quadrature| {
        Impact::between(&striker, &rod)
            .at_velocity(VELOCITY)
            .by(quadrature)
            .in_steps_of(DURATION / steps)
            .predict(DURATION)
            .unwrap()
    };
    for (quadrature, tolerance) in [
        // means of an exponential: (h Z/M)²/12 from the middle, and as much from the trapezium: 1e-6 at 4096 steps
        (Quadrature::CellAverages, 1e-5),
        (Quadrature::Trapezoid, 1e-5),
        // starts with one step of first order
        (Quadrature::Bdf2, 1e-2),
    ] {
        let prediction = run(4096.0, quadrature);
        // below a millionth of the peak it is no contact to speak of: 13.8 time constants
        assert_eq!(prediction.flags, []);
        assert!((prediction.duration() / (1e6_f64.ln() * 0.1 / z) - 1.0).abs() < 1e-2);
        let found = deviation(&prediction, &[], 0.0, exact) / (z * VELOCITY);
        assert!(found < tolerance, "{quadrature:?} {found}");
    }
    // second order
    let error =
        |steps| deviation(&run(steps, Quadrature::CellAverages), &[], 0.0, exact) / (z * VELOCITY);
    let order = (error(256.0) / error(512.0)).log2();
    assert!((order - 2.0).abs() < 0.1, "{order}");
}

/// Endless rods of a spring-pot, E = E₀ (s/ω₀)^{1/2}: 1/Z falls as s^{-1/4}, the kernel is weakly singular, and
/// F = V (Z₀/2) (ω₀t)^{-1/4}/Γ(3/4).
#[test]
fn two_endless_rods_of_a_fractional_material() {
    let (modulus, density, reference) = (2e9, 1100.0, 1e4);
    let law = SpringPot::new(modulus, 0.5, reference).unwrap();
    let polymer = Medium::new(density, law).unwrap();
    let rod = AnalyticChain::analytic_from_impact_face()
        .end(Termination::semi_infinite(&polymer, circle(20.0)))
        .unwrap();
    let z = CrossSection::from(circle(20.0)).area() * (modulus * density).sqrt();
    let gamma_of_three_quarters = 1.225_416_702_465_177_6;
    let exact = |t: f64| 0.5 * VELOCITY * z * (reference * t).powf(-0.25) / gamma_of_three_quarters;
    // relative errors at 1/10 of the duration, for two lengths of the step
    let errors = |quadrature| {
        [(1000.0, 100), (2000.0, 200)].map(|(steps, n): (f64, usize)| {
            let prediction = Impact::between(&rod, &rod)
                .at_velocity(VELOCITY)
                .by(quadrature)
                .in_steps_of(DURATION / steps)
                .predict(DURATION)
                .unwrap();
            let there = prediction.history.time_at(n);
            (prediction.history.force()[n] / exact(there) - 1.0).abs()
        })
    };
    for quadrature in [Quadrature::CellAverages, Quadrature::Bdf2] {
        let [coarse, fine] = errors(quadrature);
        // second order at the hundredth and two-hundredth step of a force that begins infinite: 1e-4 and 2.5e-5 of some tenths
        assert!(
            coarse < 1e-5 && fine < 2.5e-6,
            "{quadrature:?} {coarse} {fine}"
        );
    }
}

/// A rigid mass on a spring that stands on the ground: half a sine, and the mass flies back.
#[test]
fn a_rigid_mass_on_a_spring() {
    let (kilograms, stiffness) = (0.5, 2e7);
    let striker = mass(kilograms);
    let spring = MobilityLaw::analytic(move |s: Complex64| s / stiffness);
    let ground = MobilityLaw::analytic(|_| Complex64::ZERO);
    let omega: f64 = (stiffness / kilograms).sqrt();
    let peak = VELOCITY * (kilograms * stiffness).sqrt();
    let exact = |t: f64| {
        if t < PI / omega {
            peak * (omega * t).sin()
        } else {
            0.0
        }
    };
    let of_body = Impact::between(&striker, &spring).at_velocity(VELOCITY);
    let of_contact = Impact::between(&striker, &ground)
        .at_velocity(VELOCITY)
        .through(ContactLaw::linear(stiffness).unwrap());
    let [of_body, of_contact] =
        [of_body, of_contact].map(|impact| impact.predict(DURATION).unwrap());
    for prediction in [&of_body, &of_contact] {
        assert!(prediction.flags.is_empty(), "{:?}", prediction.flags);
        let found = deviation(prediction, &[], 0.0, exact) / peak;
        // means over a step: (ωh)²/24 = 1e-7, and as much for the period; the parting within a step ωh/2
        assert!(found < 1e-3, "{found}");
        let inside = deviation(prediction, &[PI / omega], 2.0, exact) / peak;
        assert!(inside < 1e-6, "{inside}");
        let contact = prediction.contacts[0];
        assert_eq!(prediction.contacts.len(), 1);
        let step = prediction.history.time_step();
        assert!((contact.end.unwrap() - PI / omega).abs() < step);
        let balance = prediction.balance();
        // elastic: e = 1 to the part of the last step in which the contact is open
        assert!(
            (balance.restitution.unwrap() - 1.0).abs() < 1e-6,
            "{balance:?}"
        );
        assert!(balance.energy_residual.abs() < 1e-9, "{balance:?}");
        assert!(balance.dissipated_in_contact.abs() < 1e-9 * balance.energy_before.unwrap());
        assert!((balance.observed_restitution.unwrap() - 1.0).abs() < 1e-6);
        assert!(
            balance.momentum_residual.unwrap().abs() < 1e-6,
            "{balance:?}"
        );
    }
    // and by the damped transform, while it lasts
    let stick = Impact::between(&striker, &spring)
        .at_velocity(VELOCITY)
        .stick_force_damped(DURATION, 1e-7)
        .unwrap();
    for (index, force) in stick.force().iter().enumerate() {
        let t = stick.time_at(index);
        if t > 20e-7 {
            // the Gaussian takes (ωσ)²/2 = 1e-6 of the amplitude
            assert!(
                (force - peak * (omega * t).sin()).abs() < 3e-6 * peak,
                "{t}"
            );
        }
    }
}

/// Sphere against an endless rod: δ' = V - F/M t - F/Z, integrated by Runge and Kutta's rule of fourth order.
#[test]
fn a_sphere_on_an_endless_rod() {
    let (kilograms, z, coefficient) = (0.03, impedance(10.0), 8e9);
    // state: approach and impulse
    let force = |delta: f64| coefficient * delta.max(0.0).powf(1.5);
    let rate = |[delta, impulse]: [f64; 2]| {
        let force = force(delta);
        [VELOCITY - impulse / kilograms - force / z, force]
    };
    let n_steps = 20_000_u32;
    let h = DURATION / f64::from(n_steps);
    let mut state = [0.0, 0.0];
    let mut exact = vec![0.0];
    for _ in 0..n_steps {
        let add = |a: [f64; 2], b: [f64; 2], c: f64| [a[0] + c * b[0], a[1] + c * b[1]];
        let k1 = rate(state);
        let k2 = rate(add(state, k1, 0.5 * h));
        let k3 = rate(add(state, k2, 0.5 * h));
        let k4 = rate(add(state, k3, h));
        for (i, value) in state.iter_mut().enumerate() {
            *value += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
        exact.push(force(state[0]));
    }
    let peak = exact.iter().copied().fold(0.0, f64::max);
    let striker = mass(kilograms);
    let rod = long_rod(10.0);
    let impact = Impact::between(&striker, &rod)
        .at_velocity(VELOCITY)
        .through(ContactLaw::hertz(coefficient).unwrap());
    let worst = |steps: usize| {
        let prediction = impact
            .clone()
            .in_steps_of(DURATION / steps as f64)
            .predict(DURATION)
            .unwrap();
        assert!(prediction.flags.is_empty(), "{:?}", prediction.flags);
        let balance = prediction.balance();
        assert!(balance.energy_residual.abs() < 1e-9, "{balance:?}");
        // all contacts, by the other solution; second order
        let tolerance = 1e-4 * (1000.0 / steps as f64).powi(2);
        let impulse = balance.impulse / state[1];
        assert!((impulse - 1.0).abs() < tolerance, "{steps} {impulse}");
        let every = 20_000 / steps;
        let samples = prediction.history.force().iter().enumerate();
        samples
            .map(|(n, force)| (force - exact[n * every + every / 2]).abs() / peak)
            .fold(0.0, f64::max)
    };
    // The worst step is the first: its mean of t^{3/2} is 0.4, the middle 0.354, of (V h)^{3/2} K. It falls with that power of h, the
    // other steps with the square.
    let (coarse, fine) = (worst(400), worst(1000));
    let first = 0.046 * coefficient * (VELOCITY * 1e-6).powf(1.5) / peak;
    assert!(fine < 1.1 * first, "{fine} {first}");
    assert!(coarse / fine > 3.0, "{coarse} {fine}");
}

#[test]
fn a_contact_with_hysteresis_keeps_what_the_curves_enclose() {
    let loading = [(0.0, 0.0), (1e-5, 400.0), (1e-4, 6000.0)];
    let table = impulse::TabulatedContact::new(&loading)
        .unwrap()
        .unloading_with(2e8)
        .unwrap();
    let striker = mass(0.05);
    let ground = MobilityLaw::analytic(|_| Complex64::ZERO);
    let prediction = Impact::between(&striker, &ground)
        .at_velocity(VELOCITY)
        .through(ContactLaw::Tabulated(table))
        .predict(DURATION)
        .unwrap();
    assert!(prediction.flags.is_empty(), "{:?}", prediction.flags);
    // loading takes all of M V²/2: 0.1 J; up to (1e-5, 400) 2e-3 J, then 400 x + (5600/9e-5) x²/2 = 0.098 J
    let slope = 5600.0 / 9e-5;
    let way = (-400.0 + (400.0_f64.powi(2) + 2.0 * slope * 0.098).sqrt()) / slope;
    let peak = 400.0 + slope * way;
    let returned = 0.5 * peak * peak / 2e8;
    let balance = prediction.balance();
    // the peak falls within a step of 2.4e-7 s, (ωh)²/8
    assert!(
        (prediction.peak().force / peak - 1.0).abs() < 1e-4,
        "{}",
        prediction.peak().force
    );
    assert!(
        (balance.dissipated_in_contact / (0.1 - returned) - 1.0).abs() < 1e-5,
        "{balance:?}"
    );
    let restitution = (returned / 0.1).sqrt();
    assert!(
        (balance.restitution.unwrap() / restitution - 1.0).abs() < 1e-4,
        "{balance:?}"
    );
    assert!(balance.energy_residual.abs() < 1e-9);
}

#[test]
fn two_rigid_masses_need_something_soft_between_them() {
    let (first, second) = (mass(0.5), mass(1.0));
    let impact = Impact::between(&first, &second).at_velocity(VELOCITY);
    assert!(matches!(
        impact.predict(DURATION),
        Err(ImpulseError::RigidFaces { ratio }) if (ratio - 0.1).abs() < 1e-6
    ));
    let soft = impact
        .through(ContactLaw::linear(1e7).unwrap())
        .predict(DURATION)
        .unwrap();
    assert!((soft.balance().restitution.unwrap() - 1.0).abs() < 1e-6);
    // V (1 + e) M₁M₂/(M₁ + M₂)
    assert!((soft.balance().impulse / (2.0 * VELOCITY / 3.0) - 1.0).abs() < 1e-6);
}

#[test]
fn a_stiff_contact_is_flagged_where_steps_are_too_long() {
    let striker = mass(0.1);
    let rod = long_rod(10.0);
    let impact = Impact::between(&striker, &rod)
        .at_velocity(VELOCITY)
        .through(ContactLaw::linear(1e12).unwrap());
    let flagged = |prediction: &Prediction| {
        prediction
            .flags
            .iter()
            .any(|flag| matches!(flag, impulse::PredictionFlag::UnresolvedContact { .. }))
    };
    assert!(flagged(&impact.predict(DURATION).unwrap()));
    assert!(!flagged(&impact.in_steps_of(1e-9).predict(4e-6).unwrap()));
}

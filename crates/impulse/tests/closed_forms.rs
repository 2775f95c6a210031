//! Impacts of rods and masses whose force has a closed form.

use impulse::{ContactLaw, Impact, Prediction, Quadrature, TabulatedContact};
use num_complex::Complex64;
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::SpringPot;

use crate::bodies::{deviation, endless_rod, impedance, mass, rod, wall, wave_speed};
use testbed::claim::{Claims, Ours, Within, of};
use testbed::difference::largest;
use testbed::hold;

const VELOCITY: f64 = 2.0;
const DURATION: f64 = 1e-3;

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    two_endless_rods(claims);
    mass_on_an_endless_rod(claims);
    rods_of_different_lengths(claims);
    rods_of_equal_length(claims);
    endless_rods_of_a_fractional_material(claims);
    hold!(claims);
}

fn two_endless_rods(claims: &mut Claims) {
    claims.by("F = V/(1/Z_1 + 1/Z_2), d'Alembert");
    let exact = VELOCITY / (1.0 / impedance(0.010) + 1.0 / impedance(0.014));
    let force = |quadrature| -> Ours {
        let (first, second) = (endless_rod(0.010), endless_rod(0.014));
        let impact = Impact::between(&first, &second).at_velocity(VELOCITY);
        let prediction = impact.by(quadrature).predict(DURATION)?;
        // no body is free: there is no restitution, and the contact does not end
        assert_eq!(prediction.balance().restitution, None);
        assert_eq!(prediction.contacts.len(), 1);
        assert_eq!(prediction.contacts[0].end, None);
        Ok(deviation(&prediction, &[], 0.0, |_| exact) / exact)
    };
    let all = || -> Ours {
        let by_means = force(Quadrature::CellAverages)?;
        Ok(largest([
            by_means,
            force(Quadrature::Bdf2)?,
            force(Quadrature::Trapezoid)?,
        ]))
    };
    claims.deviation(
        "two semi-infinite rods, constant force by means over steps and by convolution quadrature, BDF2 and trapezium",
        Within(1e-12, "rounding of sums over 4096 steps"),
        all(),
    );
}

fn mass_on_an_endless_rod(claims: &mut Claims) {
    claims.by("F = Z V exp(-Zt/M), rigid mass on a semi-infinite rod");
    let kilograms = 0.1;
    let z = impedance(0.010);
    let error = |steps, quadrature| -> Ours {
        let (striker, rod) = (mass(kilograms), endless_rod(0.010));
        let prediction = Impact::between(&striker, &rod)
            .at_velocity(VELOCITY)
            .by(quadrature)
            .in_steps_of(DURATION / steps)
            .predict(DURATION)?;
        if steps >= 4096.0 {
            assert_eq!(prediction.flags, []);
            // below a millionth of the peak the contact is negligible: 13.8 time constants
            assert!((prediction.duration() / (1e6_f64.ln() * kilograms / z) - 1.0).abs() < 1e-2);
        }
        let exact = |t: f64| z * VELOCITY * (-z * t / kilograms).exp();
        Ok(deviation(&prediction, &[], 0.0, exact) / (z * VELOCITY))
    };
    let second_order = || -> Ours {
        let by_means = error(4096.0, Quadrature::CellAverages)?;
        Ok(largest([by_means, error(4096.0, Quadrature::Trapezoid)?]))
    };
    claims.deviation(
        "rigid mass on a semi-infinite rod, force by means over steps and by convolution quadrature, trapezium",
        Within(1e-5, "(hZ/M)^2 at 4096 steps"),
        second_order(),
    );
    claims.deviation(
        "rigid mass on a semi-infinite rod, force by convolution quadrature, BDF2",
        Within(
            5e-3,
            "the error of the first step is of first order, hZ/M = 4e-3",
        ),
        error(4096.0, Quadrature::Bdf2),
    );
    let energies = || -> Ours {
        let (striker, rod) = (mass(kilograms), endless_rod(0.010));
        let prediction = Impact::between(&striker, &rod)
            .at_velocity(VELOCITY)
            .in_steps_of(DURATION / 4096.0)
            .predict(DURATION)?;
        let energies = prediction.energies();
        let before = 0.5 * kilograms * VELOCITY * VELOCITY;
        let [Some(striker), None] = &energies.translation else {
            unreachable!("{:?}", energies.translation);
        };
        let steps = striker.iter().zip(&energies.inner[1]).enumerate();
        Ok(largest(steps.map(|(step, (left, taken))| {
            let time = DURATION / 4096.0 * (step as f64 + 1.0);
            let slowed = (-2.0 * z * time / kilograms).exp();
            let away = (left / before - slowed).abs();
            away.max((taken / before - (1.0 - slowed)).abs())
        })))
    };
    claims.deviation(
        "rigid mass on a semi-infinite rod, energy of the mass and of the rod over time",
        Within(1e-5, "(hZ/M)^2 at 4096 steps"),
        energies(),
    );
    let order = || -> Ours {
        let coarse = error(256.0, Quadrature::CellAverages)?;
        Ok((coarse / error(512.0, Quadrature::CellAverages)?).log2())
    };
    claims.claim(
        "rigid mass on a semi-infinite rod, order of the error in the step",
        "1",
        2.0,
        Within(0.1, "the next order at 256 and 512 steps"),
        order(),
    );
    let long = || -> Ours {
        let (striker, rod) = (mass(kilograms), endless_rod(0.010));
        let prediction = Impact::between(&striker, &rod)
            .at_velocity(VELOCITY)
            .predict(1e-2)?;
        Ok(prediction.balance().impulse)
    };
    claims.claim(
        "rigid mass on a semi-infinite rod, total impulse",
        "N s",
        kilograms * VELOCITY,
        Within(
            1e-6 * kilograms * VELOCITY,
            "a force below a millionth of the peak does not count as contact",
        ),
        long(),
    );
}

/// De Saint-Venant: the shorter of two rods of one section exerts Z V/2 for its own round trip and
/// is then at rest.
fn rods_of_different_lengths(claims: &mut Claims) {
    claims.by("De Saint-Venant's impact of two rods of one section, 0.3 m and 0.7 m");
    let (short, long) = (0.3, 0.7);
    let plateau = 0.5 * impedance(0.010) * VELOCITY;
    let trip = 2.0 * short / wave_speed();
    let momentum = impedance(0.010) * short / wave_speed() * VELOCITY;
    let found = |first: f64, second: f64| -> Ours<Prediction> {
        let (first, second) = (rod(0.010, first), rod(0.010, second));
        let impact = Impact::between(&first, &second).at_velocity(VELOCITY);
        let prediction = impact.predict(DURATION)?;
        assert_eq!(prediction.flags, []);
        assert!(prediction.balance().energy_residual.abs() < 1e-12);
        Ok(prediction)
    };
    let both = || -> Ours<[Prediction; 2]> { Ok([found(short, long)?, found(long, short)?]) };
    let found = both();
    let exact = |t: f64| if t < trip { plateau } else { 0.0 };
    // after the pulse, a force over part of a step remains and travels to and fro in the shorter
    // rod
    let echoes: Vec<f64> = (1..9).map(|k| f64::from(k) * trip).collect();
    for (steps, within) in [
        (
            3.0,
            Within(
                2e-3,
                "an echo is smeared over the step that contains it and a neighbouring step",
            ),
        ),
        (
            40.0,
            Within(
                2e-7,
                "residual of the roll-off of the bands, in inverse proportion to the fifth power of the distance",
            ),
        ),
    ] {
        claims.deviation(
            format!("rods of different lengths, either first: plateau Z V/2 and nothing after the round trip of the shorter, {steps} steps from echoes"),
            within,
            of(&found, |found| {
                largest(found.iter().map(|p| deviation(p, &echoes, steps, exact) / plateau))
            }),
        );
    }
    claims.deviation(
        "rods of different lengths, either first: impulse over the momentum of the shorter, minus 1",
        Within(1e-3, "half a step at the end of a pulse of 478 steps"),
        of(&found, |found| {
            largest(found.iter().map(|p| p.balance().impulse / momentum - 1.0))
        }),
    );
    claims.deviation(
        "rods of different lengths, either first: coefficient of restitution minus L_1/L_2",
        Within(1.5e-3, "half a step at the end of the pulse"),
        of(&found, |found| {
            let restitution = |p: &Prediction| p.balance().restitution.unwrap_or(f64::NAN);
            largest(found.iter().map(|p| restitution(p) - short / long))
        }),
    );
}

fn rods_of_equal_length(claims: &mut Claims) {
    claims.by("two equal free rods exchange their velocities, d'Alembert");
    let length = 0.5;
    let plateau = 0.5 * impedance(0.010) * VELOCITY;
    let trip = 2.0 * length / wave_speed();
    let kinetic = 0.5 * impedance(0.010) * length / wave_speed() * VELOCITY.powi(2);
    // between faces that stick, the force alternates between two values without end
    let alternating = |t: f64| {
        if (t / trip).rem_euclid(2.0) < 1.0 {
            plateau
        } else {
            -plateau
        }
    };
    let from_jump = |t: f64| ((t / trip) - (t / trip).round()).abs() * trip;
    let stick = |damped: bool| -> Ours {
        let body = rod(0.010, length);
        let impact = Impact::between(&body, &body).at_velocity(VELOCITY);
        let (history, away) = if damped {
            (impact.stick_force_damped(3.0 * trip, 1e-7)?, 16e-7)
        } else {
            let history = impact.stick_force(3.0 * trip)?;
            let step = history.time_step();
            (history, 20.0 * step)
        };
        let samples = history.force().iter().enumerate();
        Ok(largest(
            samples
                .map(|(n, force)| (history.time_at(n), force))
                .filter(|(t, _)| *t > 0.0 && from_jump(*t) > away)
                .map(|(t, force)| (force - alternating(t)).abs() / plateau),
        ))
    };
    let both = || -> Ours { Ok(largest([stick(true)?, stick(false)?])) };
    claims.deviation(
        "two equal rods: stick force over three round trips, by the damped transform and by marching",
        Within(1e-6, "16 standard deviations of the Gaussian, or 20 steps, from a jump"),
        both(),
    );
    let found = || -> Ours<Prediction> {
        let body = rod(0.010, length);
        Ok(Impact::between(&body, &body)
            .at_velocity(VELOCITY)
            .predict(DURATION)?)
    };
    let found = found();
    let exact = |t: f64| if t < trip { plateau } else { 0.0 };
    claims.deviation(
        "two equal rods: force of one round trip, 40 steps from its end",
        Within(1e-6, "residual of the roll-off of the bands"),
        of(&found, |p| deviation(p, &[trip], 40.0, exact) / plateau),
    );
    claims.deviation(
        "two equal rods: restitution, restitution from the velocities of the faces and kinetic energy of the struck rod, each minus its exact value, and energy of vibration",
        Within(1e-3, "half a step at the end of a pulse of 796 steps"),
        of(&found, |p| {
            let balance = p.balance();
            largest([
                balance.restitution.unwrap_or(f64::NAN) - 1.0,
                balance.observed_restitution.unwrap_or(f64::NAN) - 1.0,
                balance.translation_after[1].unwrap_or(f64::NAN) / kinetic - 1.0,
                largest(balance.inner) / kinetic,
            ])
        }),
    );
}

/// E = E₀ (s/ω₀)^½: 1/Z falls as s^-¼, and F = V (Z₀/2) (ω₀t)^-¼/Γ(¾).
fn endless_rods_of_a_fractional_material(claims: &mut Claims) {
    claims.by(
        "F = V Z_0/2 (omega_0 t)^(-1/4)/Gamma(3/4), semi-infinite rods of a spring-pot of exponent 1/2",
    );
    let (modulus, density, reference, diameter) = (2e9_f64, 1100.0, 1e4, 0.020_f64);
    let z = std::f64::consts::FRAC_PI_4 * diameter.powi(2) * (modulus * density).sqrt();
    let rod = || -> Ours<AnalyticChain> {
        let polymer = Medium::new(density, SpringPot::new(modulus, 0.5, reference)?)?;
        let endless = Termination::semi_infinite(&polymer, Circle::of_diameter(diameter)?);
        Ok(AnalyticChain::analytic_from_impact_face().end(endless)?)
    };
    let error = || -> Ours {
        // Γ(3/4), Abramowitz and Stegun
        let gamma = 1.225_416_702_465_177_6;
        let rod = rod()?;
        let mut errors = Vec::new();
        for quadrature in [Quadrature::CellAverages, Quadrature::Bdf2] {
            for (steps, n) in [(1000.0, 100), (2000.0, 200)] {
                let prediction = Impact::between(&rod, &rod)
                    .at_velocity(VELOCITY)
                    .by(quadrature)
                    .in_steps_of(DURATION / steps)
                    .predict(DURATION)?;
                let history = &prediction.history;
                let slow = (reference * history.time_at(n)).powf(-0.25);
                let exact = 0.5 * VELOCITY * z * slow / gamma;
                errors.push((history.force()[n] / exact - 1.0) * (n as f64).powi(2));
            }
        }
        Ok(largest(errors))
    };
    claims.deviation(
        "semi-infinite rods of a fractional material, weakly singular kernel, by means over steps and BDF2, relative error times n^2 at steps n = 100 and 200",
        Within(0.1, "second order of a force that begins infinite"),
        error(),
    );
    let transform = || -> Ours {
        let rod = rod()?;
        let mut errors = Vec::new();
        for k in 0..20 {
            // a line off the axis
            let s = Complex64::new(5e3, 1e3 * 1.5_f64.powi(k));
            let exact = (s / reference).powf(-0.25) / z;
            errors.push((rod.mobility_at_s(s)? / exact - 1.0).norm());
        }
        Ok(largest(errors))
    };
    claims.deviation(
        "semi-infinite rod of a fractional material: mobility s^(-1/4) in the right half plane",
        Within(5e-15, "rounding of powers"),
        transform(),
    );
}

/// Impacts of a mass on a rigid wall through a linear spring, a Hertzian contact, and a tabulated
/// contact that leaves a dent. The contact lasts half a period, 2.943 times depth over velocity,
/// and the sum of a quarter period of each of the two stiffnesses.
#[test]
fn f6_soft_contacts_end_within_a_step() {
    let (m, v) = (0.3, 1.7);
    let (body, wall) = (mass(m), wall());
    let (k, hertz) = (4e6_f64, 3e9_f64);
    let depth = (1.25 * m * v * v / hertz).powf(0.4);
    let table = TabulatedContact::new(&[(0.0, 0.0), (1.0, k)])
        .unwrap()
        .unloading_with(2.0 * k)
        .unwrap();
    // 4/5 of the Beta function B(2/5, 1/2)
    let hertz_time = 2.943_275_2 * depth / v;
    let quarter = 0.5 * std::f64::consts::PI * (m / k).sqrt();
    for (what, law, time) in [
        ("linear", ContactLaw::linear(k).unwrap(), 2.0 * quarter),
        ("Hertz", ContactLaw::hertz(hertz).unwrap(), hertz_time),
        (
            "dent",
            ContactLaw::Tabulated(table),
            quarter * (1.0 + 0.5_f64.sqrt()),
        ),
    ] {
        // the fractions of a step place the end of the contact at different points of the last step
        let counts = [53.0, 101.3, 203.7]
            .into_iter()
            .chain((0..10).map(|tenth| 4100.0 + 0.1 * f64::from(tenth)));
        for steps in counts {
            let step = time / steps;
            let found = Impact::between(&body, &wall)
                .at_velocity(v)
                .through(law.clone())
                .in_steps_of(step)
                .predict(1.1 * time)
                .unwrap();
            let error = (found.contacts[0].end.unwrap() - time) / step;
            // the error is of second order: in steps, multiplied by the number of steps, it is 0.82
            // to 1.02
            assert!((error * steps - 0.9).abs() < 0.2, "{what} {steps} {error}");
        }
    }
}

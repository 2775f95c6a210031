//! Impacts of rods and masses whose force has a closed form.

use impulse::{Impact, Prediction, Quadrature};
use num_complex::Complex64;
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::SpringPot;

use super::bodies::{deviation, endless_rod, impedance, mass, rod, wave_speed};
use testbed::claim::{Claims, Ours, Within, missing, of};
use testbed::difference::largest;
use testbed::hold;

const VELOCITY: f64 = 2.0;
const DURATION: f64 = 1e-3;

const QUADRATURES: [(&str, Quadrature); 3] = [
    ("means over steps", Quadrature::CellAverages),
    ("convolution quadrature, BDF2", Quadrature::Bdf2),
    ("convolution quadrature, trapezium", Quadrature::Trapezoid),
];

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
    for (name, quadrature) in QUADRATURES {
        let force = || -> Ours {
            let (first, second) = (endless_rod(0.010)?, endless_rod(0.014)?);
            let prediction = Impact::between(&first, &second)
                .at_velocity(VELOCITY)
                .by(quadrature)
                .predict(DURATION)?;
            Ok(deviation(&prediction, &[], 0.0, |_| exact) / exact)
        };
        let within = if quadrature == Quadrature::CellAverages {
            Within(5e-12, "rounding of sums over 4096 steps")
        } else {
            Within(
                1e-7,
                "the weights of a contour integral, to the root of rounding",
            )
        };
        claims.deviation(
            format!("two endless rods, constant force by {name}"),
            within,
            force(),
        );
    }
}

fn mass_on_an_endless_rod(claims: &mut Claims) {
    claims.by("F = Z V exp(-Zt/M), rigid mass on an endless rod");
    let kilograms = 0.1;
    let z = impedance(0.010);
    let run = |steps: f64, quadrature| -> Ours<Prediction> {
        let (striker, rod) = (mass(kilograms)?, endless_rod(0.010)?);
        Ok(Impact::between(&striker, &rod)
            .at_velocity(VELOCITY)
            .by(quadrature)
            .in_steps_of(DURATION / steps)
            .predict(DURATION)?)
    };
    let error = |steps, quadrature| -> Ours {
        let exact = |t: f64| z * VELOCITY * (-z * t / kilograms).exp();
        let prediction = run(steps, quadrature)?;
        Ok(deviation(&prediction, &[], 0.0, exact) / (z * VELOCITY))
    };
    for (name, quadrature) in QUADRATURES {
        let within = if quadrature == Quadrature::Bdf2 {
            Within(1e-2, "begins with one step of first order, hZ/M = 4e-3")
        } else {
            Within(1e-5, "(hZ/M)^2 at 4096 steps")
        };
        claims.deviation(
            format!("rigid mass on an endless rod, force by {name}"),
            within,
            error(4096.0, quadrature),
        );
    }
    let order = || -> Ours {
        let coarse = error(256.0, Quadrature::CellAverages)?;
        Ok((coarse / error(512.0, Quadrature::CellAverages)?).log2())
    };
    claims.claim(
        "rigid mass on an endless rod, order of the error in the step",
        "1",
        2.0,
        Within(0.1, "the next order at 256 and 512 steps"),
        order(),
    );
    let long = || -> Ours {
        let (striker, rod) = (mass(kilograms)?, endless_rod(0.010)?);
        let prediction = Impact::between(&striker, &rod)
            .at_velocity(VELOCITY)
            .predict(1e-2)?;
        Ok(prediction.balance().impulse)
    };
    claims.claim(
        "rigid mass on an endless rod, total impulse",
        "N s",
        kilograms * VELOCITY,
        Within(
            1e-5 * kilograms * VELOCITY,
            "a contact below a millionth of the peak counts as none",
        ),
        long(),
    );
}

/// De Saint-Venant: the shorter of two rods of one section brings Z V/2 for its own round trip and is then at rest.
fn rods_of_different_lengths(claims: &mut Claims) {
    claims.by("De Saint-Venant's impact of two rods of one section, 0.3 m and 0.7 m");
    let (short, long) = (0.3, 0.7);
    let plateau = 0.5 * impedance(0.010) * VELOCITY;
    let trip = 2.0 * short / wave_speed();
    let momentum = impedance(0.010) * short / wave_speed() * VELOCITY;
    let found = || -> Ours<Prediction> {
        let (first, second) = (rod(0.010, short)?, rod(0.010, long)?);
        Ok(Impact::between(&first, &second)
            .at_velocity(VELOCITY)
            .predict(DURATION)?)
    };
    let found = found();
    let exact = |t: f64| if t < trip { plateau } else { 0.0 };
    let echoes: Vec<f64> = (1..9).map(|k| f64::from(k) * trip).collect();
    claims.deviation(
        "rods of different lengths: plateau Z V/2 and nothing after the round trip of the shorter",
        Within(
            2e-6,
            "what the roll-off of the bands leaves 40 steps from an echo",
        ),
        of(&found, |p| deviation(p, &echoes, 40.0, exact) / plateau),
    );
    claims.claim(
        "rods of different lengths: impulse, the momentum of the shorter",
        "N s",
        momentum,
        Within(
            1e-3 * momentum,
            "half a step at the end of a pulse of 478 steps",
        ),
        of(&found, |p| p.balance().impulse),
    );
    claims.claim(
        "rods of different lengths: coefficient of restitution L_1/L_2",
        "1",
        short / long,
        Within(1.5e-3, "half a step at the end of the pulse"),
        of(&found, |p| p.balance().restitution.unwrap_or(f64::NAN)),
    );
    claims.deviation(
        "rods of different lengths: energy before less energy after",
        Within(1e-10, "rounding of the sums of work"),
        of(&found, |p| p.balance().energy_residual.abs()),
    );
}

fn rods_of_equal_length(claims: &mut Claims) {
    claims.by("two equal free rods exchange their velocities, d'Alembert");
    let length = 0.5;
    let plateau = 0.5 * impedance(0.010) * VELOCITY;
    let trip = 2.0 * length / wave_speed();
    let kinetic = 0.5 * impedance(0.010) * length / wave_speed() * VELOCITY.powi(2);
    // while the faces stick, the force alternates for ever
    let alternating = |t: f64| {
        if (t / trip).rem_euclid(2.0) < 1.0 {
            plateau
        } else {
            -plateau
        }
    };
    let from_jump = |t: f64| ((t / trip) - (t / trip).round()).abs() * trip;
    let stick = |damped: bool| -> Ours {
        let body = rod(0.010, length)?;
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
    claims.deviation(
        "two equal rods: stick force over three round trips by the damped transform",
        Within(1e-6, "16 standard deviations of the Gaussian from a jump"),
        stick(true),
    );
    claims.deviation(
        "two equal rods: stick force over three round trips by marching",
        Within(
            1e-6,
            "what the roll-off of the bands leaves 20 steps from a jump",
        ),
        stick(false),
    );
    let found = || -> Ours<Prediction> {
        let body = rod(0.010, length)?;
        Ok(Impact::between(&body, &body)
            .at_velocity(VELOCITY)
            .predict(DURATION)?)
    };
    let found = found();
    claims.claim(
        "two equal rods: coefficient of restitution",
        "1",
        1.0,
        Within(1e-3, "half a step at the end of a pulse of 796 steps"),
        of(&found, |p| p.balance().restitution.unwrap_or(f64::NAN)),
    );
    claims.claim(
        "two equal rods: kinetic energy of the struck one",
        "J",
        kinetic,
        Within(2e-3 * kinetic, "twice half a step of 796"),
        of(&found, |p| {
            p.balance().translation_after[1].unwrap_or(f64::NAN)
        }),
    );
    claims.deviation(
        "two equal rods: energy of vibration after the impact",
        Within(1e-3, "half a step at the end of a pulse of 796 steps"),
        of(&found, |p| {
            largest(p.balance().inner.map(f64::abs)) / kinetic
        }),
    );
}

/// E = E₀ (s/ω₀)^½: 1/Z falls as s^-¼, and F = V (Z₀/2) (ω₀t)^-¼/Γ(¾).
fn endless_rods_of_a_fractional_material(claims: &mut Claims) {
    claims.by(
        "F = V Z_0/2 (omega_0 t)^(-1/4)/Gamma(3/4), endless rods of a spring-pot of exponent 1/2",
    );
    let (modulus, density, reference, diameter) = (2e9_f64, 1100.0, 1e4, 0.020_f64);
    let error = |quadrature| -> Ours {
        let polymer = Medium::new(density, SpringPot::new(modulus, 0.5, reference)?)?;
        let rod = AnalyticChain::analytic_from_impact_face().end(Termination::semi_infinite(
            &polymer,
            Circle::of_diameter(diameter)?,
        ))?;
        let z = std::f64::consts::FRAC_PI_4 * diameter.powi(2) * (modulus * density).sqrt();
        // Γ(3/4), Abramowitz and Stegun
        let gamma = 1.225_416_702_465_177_6;
        let prediction = Impact::between(&rod, &rod)
            .at_velocity(VELOCITY)
            .by(quadrature)
            .in_steps_of(DURATION / 2000.0)
            .predict(DURATION)?;
        let history = &prediction.history;
        let n = history
            .index_near(0.1 * DURATION)
            .ok_or_else(|| missing("the sample at a tenth of the record"))?;
        let exact = 0.5 * VELOCITY * z * (reference * history.time_at(n)).powf(-0.25) / gamma;
        Ok((history.force()[n] / exact - 1.0).abs())
    };
    for (name, quadrature) in &QUADRATURES[..2] {
        claims.deviation(
            format!("endless rods of a fractional material, weakly singular kernel, by {name}"),
            Within(2.5e-6, "second order at the two-hundredth step"),
            error(*quadrature),
        );
    }
    let transform = || -> Ours {
        // the impedance of the rod, against s^(1/4) on a line off the axis
        let polymer = Medium::new(density, SpringPot::new(modulus, 0.5, reference)?)?;
        let rod = AnalyticChain::analytic_from_impact_face().end(Termination::semi_infinite(
            &polymer,
            Circle::of_diameter(diameter)?,
        ))?;
        let z = std::f64::consts::FRAC_PI_4 * diameter.powi(2) * (modulus * density).sqrt();
        let mut worst = 0.0_f64;
        for k in 0..20 {
            let s = Complex64::new(5e3, 1e3 * 1.5_f64.powi(k));
            let exact = (s / reference).powf(-0.25) / z;
            worst = worst.max((rod.mobility_at_s(s)? / exact - 1.0).norm());
        }
        Ok(worst)
    };
    claims.deviation(
        "endless rod of a fractional material: mobility s^(-1/4) in the right half plane",
        Within(1e-13, "rounding of powers"),
        transform(),
    );
}

//! Errors of the stick force and of the end of the contact: linear propagation against draws and
//! against differences.

use std::f64::consts::TAU;

use impulse::{StickForce, StickProblem, StickUncertainty, ZeroLine, separate};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use testbed::claim::{Claims, Ours, Within, missing, of};
use testbed::difference::largest;
use testbed::hold;

const STEP_HZ: f64 = 200.0;
const N_LINES: usize = 257;
const VELOCITY: f64 = 1.5;
const MASS: f64 = 0.3;
const IMPEDANCE: f64 = 900.0;
const DRAWS: usize = 1500;
/// Force below which the faces have parted, in N.
const THRESHOLD: f64 = 20.0;

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    let bodies = Bodies::sprung_mass(STEP_HZ, N_LINES);
    by_draws(claims, &bodies);
    by_differences(claims, &bodies);
    constant_of_the_zero_line(claims);
    hold!(claims);
}

/// A mass behind a spring and a dashpot, and a long rod.
struct Bodies {
    mass: Vec<Complex64>,
    rod: Vec<Complex64>,
}

impl Bodies {
    fn sprung_mass(step_hz: f64, n_lines: usize) -> Self {
        let mobility = |k: usize| {
            let s = Complex64::new(0.0, TAU * step_hz * k as f64);
            1.0 / (s * MASS) + s / 2e6 + 1e-4
        };
        Self {
            mass: (0..n_lines).map(mobility).collect(),
            rod: vec![Complex64::from(1.0 / IMPEDANCE); n_lines],
        }
    }

    fn problem(&self, zero_line: ZeroLine) -> StickProblem<'_> {
        StickProblem {
            first: &self.mass,
            second: &self.rod,
            frequency_step_hz: STEP_HZ,
            impact_velocity: VELOCITY,
            zero_line,
            roll_off_from_hz: Some(25e3),
            interpolation: 1,
            until: None,
        }
    }
}

fn by_draws(claims: &mut Claims, bodies: &Bodies) {
    claims.by("1500 draws of mobilities, scales, velocity and mass");
    let lines = bodies.mass.iter().zip(&bodies.rod);
    let variance: Vec<f64> = lines
        .map(|(a, b)| (0.05 * (a + b).norm()).powi(2))
        .collect();
    let uncertainty = StickUncertainty {
        first_variance: Some(&variance),
        second_variance: None,
        first_scale: 0.01,
        second_scale: 0.02,
        first_delay: 0.0,
        second_delay: 0.0,
        impact_velocity: 0.02,
        effective_mass: 0.003,
    };
    let found = || -> Ours<[f64; 2]> {
        let (mut of_force, mut of_end) = (Vec::new(), Vec::new());
        for zero_line in [ZeroLine::EffectiveMass(MASS), ZeroLine::QuietBeforeContact] {
            let problem = bodies.problem(zero_line);
            let mut random = ChaCha8Rng::seed_from_u64(41);
            let drawn = uncertainty.monte_carlo(&problem, THRESHOLD, DRAWS, &mut random)?;
            let linear = problem.error(&uncertainty)?;
            let pairs = linear.standard_error().iter().zip(&drawn.stick_deviation);
            of_force.extend(pairs.map(|(linear, drawn)| drawn / linear - 1.0));
            let stick = problem.solve()?;
            let impact = separate(&stick.history, THRESHOLD)?;
            let end = linear
                .contact_end(&stick.history, &impact)
                .ok_or_else(|| missing("the end of the contact"))?;
            let ends = &drawn.contact_ends;
            assert_eq!(ends.len(), DRAWS, "draws whose contact ends");
            let mean = ends.iter().sum::<f64>() / ends.len() as f64;
            let squares: f64 = ends.iter().map(|t| (t - mean).powi(2)).sum();
            let scatter = (squares / (ends.len() as f64 - 1.0)).sqrt();
            of_end.push(scatter / end.standard_error - 1.0);
        }
        Ok([largest(of_force), largest(of_end)])
    };
    let found = found();
    claims.deviation(
        "bodies weighed, and quiet before the contact: scatter of the stick force over its standard error, minus 1, at the worst time",
        Within(0.08, "1/sqrt(3000) = 1.8 %, times four, and the second order of 5 %"),
        of(&found, |found| found[0]),
    );
    claims.deviation(
        "bodies weighed, and quiet before the contact: scatter of the end of the contact over its standard error, minus 1",
        Within(0.14, "four times 1.8 %, and as much for interpolation and curvature"),
        of(&found, |found| found[1]),
    );
}

fn by_differences(claims: &mut Claims, bodies: &Bodies) {
    claims.by("differences of the force itself");
    let small = 1e-6;
    let none = StickUncertainty::default();
    let scaled =
        |of: &[Complex64]| -> Vec<Complex64> { of.iter().map(|g| g * (1.0 + small)).collect() };
    let first = Bodies {
        mass: scaled(&bodies.mass),
        rod: bodies.rod.clone(),
    };
    let second = Bodies {
        mass: bodies.mass.clone(),
        rod: scaled(&bodies.rod),
    };
    let weighed = ZeroLine::EffectiveMass(MASS);
    let base = bodies.problem(weighed);
    let faster = StickProblem {
        impact_velocity: VELOCITY + small,
        ..base
    };
    let heavier = bodies.problem(ZeroLine::EffectiveMass(MASS + small));
    let cases = [
        (
            first.problem(weighed),
            StickUncertainty {
                first_scale: small,
                ..none
            },
        ),
        (
            second.problem(weighed),
            StickUncertainty {
                second_scale: small,
                ..none
            },
        ),
        (
            faster,
            StickUncertainty {
                impact_velocity: small,
                ..none
            },
        ),
        (
            heavier,
            StickUncertainty {
                effective_mass: small,
                ..none
            },
        ),
    ];
    let worst = || -> Ours {
        let force = base.solve()?.history;
        let mut errors = Vec::new();
        for (changed, uncertainty) in &cases {
            let moved = changed.solve()?.history;
            let error = base.error(uncertainty)?;
            let size = largest(error.standard_error().iter().copied());
            let stated = error.standard_error().iter().enumerate();
            errors.extend(stated.map(|(n, stated)| {
                let difference = (moved.force()[n] - force.force()[n]).abs();
                (difference - stated) / size
            }));
        }
        Ok(largest(errors))
    };
    claims.deviation(
        "error of the stick force by the scales of both mobilities, the velocity and the weighed mass",
        Within(5e-6, "second order, 1e-6, and rounding over the difference"),
        worst(),
    );
}

/// Leaving out the line at 0 Hz shifts the force by -V M/T. The force, which decays as e^(-1211
/// t/s), has vanished after 20 ms.
fn constant_of_the_zero_line(claims: &mut Claims) {
    claims.by("impulse of a body that is stopped, F(0) = V M");
    let step_hz = 50.0;
    let bodies = Bodies::sprung_mass(step_hz, 1025);
    let solved = |zero_line| -> Ours<StickForce> {
        let problem = StickProblem {
            frequency_step_hz: step_hz,
            ..bodies.problem(zero_line)
        };
        Ok(problem.solve()?)
    };
    let quiet = solved(ZeroLine::QuietBeforeContact);
    claims.claim(
        "sprung mass on a semi-infinite rod: impulse of the stick force, zero before contact",
        "N s",
        VELOCITY * MASS,
        Within(
            1e-8 * VELOCITY * MASS,
            "the force that remains after 20 ms, and smearing by the band limit",
        ),
        of(&quiet, |stick| stick.history.impulse()),
    );
    claims.claim(
        "sprung mass on a semi-infinite rod: constant that makes the force zero before contact, V M/T",
        "N",
        VELOCITY * MASS * step_hz,
        Within(
            1e-8 * VELOCITY * MASS * step_hz,
            "the force that remains after 20 ms, and smearing by the band limit",
        ),
        of(&quiet, |stick| stick.added_constant),
    );
}

//! Wrong roots at low loss: Newton as printed against continuation, without noise and with.

use std::f64::consts::TAU;

use cmod::two_point::EndMassEquation;
use cmod::validity::AcceptanceLimits;
use cmod::{ModulusLine, Solver, Specimen, TwoPoint};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rodwave::medium::Medium;
use rodwave::modulus::PowerLawPropagation;

use super::rod::{acceleration_ratio, circular};

/// A rod of 800 mm with μ = 0.036, of the material of paper E, eq. 7, with a fifth of its damping.
fn specimen() -> Specimen {
    let specimen = Specimen {
        length: 0.8,
        diameter: 0.0107,
        density: 1118.0,
        accelerometer_mass: 1.0,
    };
    Specimen {
        accelerometer_mass: 0.036 / specimen.mass_ratio(),
        ..specimen
    }
}

fn medium() -> Medium<PowerLawPropagation> {
    let law = PowerLawPropagation::new(0.2 * 8.818e-5, 0.894, 8.937e-4, 0.970).unwrap();
    Medium::new(1118.0, law).unwrap()
}

/// The 1572 lines between 362 Hz and 20 kHz.
fn lines() -> Vec<f64> {
    (0..1572)
        .map(|j| 362.0 + (20_000.0 - 362.0) * f64::from(j) / 1571.0)
        .collect()
}

/// What a root is, compared with that of the material.
#[derive(PartialEq)]
enum Root {
    Right,
    Wrong,
    /// Noise has brought two roots so near to each other that nothing tells which is right.
    Ambiguous,
}

/// Where |δΨ f''| < |f'|²/2 at the truth, Newton's iteration surely leads from there to the right root (Kantorovich).
fn judge(line: &ModulusLine, exact: Complex64, ratio: Complex64) -> Root {
    let medium = medium();
    let truth = medium.propagation_coefficient(TAU * line.frequency_hz) * specimen().length;
    let equation = EndMassEquation {
        mass_ratio: specimen().mass_ratio(),
        acceleration_ratio: ratio,
    };
    let (first, second) = (
        equation.derivative(truth),
        equation.second_derivative(truth),
    );
    if (ratio - exact).norm() * second.norm() > 0.5 * first.norm_sqr() {
        return Root::Ambiguous;
    }
    let right = equation.newton(truth).gamma_length;
    if (line.propagation_coefficient * specimen().length - right).norm() < 1e-6 {
        Root::Right
    } else {
        Root::Wrong
    }
}

/// Numbers of wrong and of ambiguous roots.
fn count(exact: &[Complex64], ratio: &[Complex64], noise: f64, solver: Solver) -> (usize, usize) {
    let variance: Vec<f64> = exact
        .iter()
        .map(|ratio| noise * noise * ratio.norm_sqr())
        .collect();
    let estimate = TwoPoint::new(specimen())
        .unwrap()
        .with_limits(AcceptanceLimits::NONE)
        .unwrap()
        .with_solver(solver)
        .estimate(&lines(), ratio, &variance)
        .unwrap();
    let (mut wrong, mut ambiguous) = (estimate.refused().len(), 0);
    for line in estimate.lines() {
        match judge(line, exact[line.index], ratio[line.index]) {
            Root::Right => {}
            Root::Wrong => wrong += 1,
            Root::Ambiguous => {
                ambiguous += 1;
                if solver == Solver::Continuation && line.validity.is_valid() {
                    // whichever root it is, it is within its error: exp(-5²) of all lines are not
                    let truth = medium().propagation_coefficient(TAU * line.frequency_hz);
                    let error = (line.propagation_coefficient - truth).norm();
                    let stated = &line.uncertainty.random.propagation_coefficient;
                    assert!(
                        error < 5.0 * stated.mean_square().sqrt(),
                        "{} Hz: off by {error}",
                        line.frequency_hz
                    );
                }
            }
        }
    }
    (wrong, ambiguous)
}

#[test]
fn continuation_finds_the_root_in_noise_and_newton_does_not() {
    let exact = acceleration_ratio(&medium(), &specimen(), 0.0, &lines());
    // 294 in an independent computation; lines at the border of a basin may fall either way
    let (newton, _) = count(&exact, &exact, 0.0, Solver::Newton);
    assert!(newton.abs_diff(294) <= 3, "{newton} by Newton");
    assert_eq!(count(&exact, &exact, 0.0, Solver::Continuation), (0, 0));
    for noise in [0.005, 0.02] {
        for seed in 0..5 {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let ratio: Vec<Complex64> = exact
                .iter()
                .map(|ratio| ratio + circular(&mut random, noise * noise * ratio.norm_sqr()))
                .collect();
            let (newton, _) = count(&exact, &ratio, noise, Solver::Newton);
            let (continuation, ambiguous) = count(&exact, &ratio, noise, Solver::Continuation);
            let name = format!("noise {noise}, seed {seed}");
            // 289 and 292 in an independent computation with other noise, ambiguous ones included
            assert!(newton.abs_diff(290) <= 20, "{name}: {newton} by Newton");
            assert!(ambiguous < 60, "{name}: {ambiguous} ambiguous");
            assert_eq!(continuation, 0, "{name}");
        }
    }
}

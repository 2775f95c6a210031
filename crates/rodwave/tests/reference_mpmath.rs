//! Chains, lateral inertia, fractional relaxation and the nonlinear laws against 50 digits of mpmath: `fixtures/reference/mpmath`.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a reference that cannot be read must fail the test"
)]

use num_complex::Complex64;
use rodwave::element::Circle;
use rodwave::inelastic::{InelasticLaw, MaxwellGurevichRabinovich, MaxwellNorton, RelaxationFlow};
use rodwave::medium::Medium;
use rodwave::modulus::{Elastic, FractionalZener, PowerLawPropagation, TimeDomainModulus};
use rodwave::slenderness::{PochhammerChree, RodTheory, RoundRod};
use rodwave::{Chain, Termination};

const CHAINS: &str = include_str!("../../../fixtures/reference/mpmath/chains.csv");
const POCHHAMMER: &str = include_str!("../../../fixtures/reference/mpmath/pochhammer.csv");
const FRACTIONAL: &str = include_str!("../../../fixtures/reference/mpmath/fractional_zener.csv");
const RELAXATION: &str = include_str!("../../../fixtures/reference/mpmath/relaxation.csv");

/// First cell and the numbers behind it; all numbers if there is no name.
fn rows(table: &str) -> Vec<(&str, Vec<f64>)> {
    table
        .lines()
        .skip(1)
        .map(|line| {
            let (name, rest) = match line.split_once(',') {
                Some((name, rest)) if name.parse::<f64>().is_err() => (name, rest),
                _ => ("", line),
            };
            let numbers = rest.split(',').map(|cell| cell.parse().unwrap());
            (name, numbers.collect())
        })
        .collect()
}

fn relative(found: Complex64, expected: Complex64) -> f64 {
    (found - expected).norm() / expected.norm()
}

/// The bodies of paper E from 50 Hz to 10 kHz.
#[test]
fn chains_are_those_of_mpmath() {
    let law = PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970).unwrap();
    let nylon = Medium::new(1150.0, law).unwrap();
    let aluminium = Medium::new(2700.0, Elastic::new(69e9).unwrap()).unwrap();
    let steel = Medium::new(7780.0, Elastic::new(206e9).unwrap()).unwrap();
    let circle = |diameter| Circle::of_diameter(diameter).unwrap();
    let cone = Chain::from_impact_face()
        .cone(&nylon, circle(0.030), circle(0.075), 0.400)
        .end(Termination::Free)
        .unwrap();
    let face = circle(0.032);
    let cylinder = Chain::from_impact_face()
        .rod(&nylon, face, 0.125)
        .rod(&aluminium, face, 0.125)
        .rod(&nylon, face, 0.125)
        .rod(&aluminium, face, 0.125)
        .end(Termination::Free)
        .unwrap();
    let long_rod = Chain::from_impact_face()
        .end(Termination::semi_infinite(&steel, circle(0.010)))
        .unwrap();
    let rows = rows(CHAINS);
    assert_eq!(rows.len(), 91);
    for (quantity, row) in rows {
        let [omega, re, im] = row[..] else {
            panic!("{quantity}: three numbers");
        };
        let expected = Complex64::new(re, im);
        let (found, tolerance) = match quantity {
            // near a resonance the rounding of γL, some 1e-15, grows with its sharpness, some ten
            "TCA" => (cone.mobility(omega).unwrap(), 2e-14),
            "TCB" => (cone.far_face_mobility(omega).unwrap(), 2e-14),
            "CCA" => (cylinder.mobility(omega).unwrap(), 2e-14),
            "CCB" => (cylinder.far_face_mobility(omega).unwrap(), 2e-14),
            "LCR" => (long_rod.mobility(omega).unwrap(), 1e-15),
            // two powers of a number of order 1e4: its logarithm, 10, costs a digit
            "nylon gamma" => (nylon.propagation_coefficient(omega), 4e-15),
            "nylon specific impedance" => (nylon.specific_characteristic_impedance(omega), 4e-15),
            other => panic!("no such quantity: {other}"),
        };
        let error = relative(found, expected);
        assert!(
            error < tolerance,
            "{quantity} at {omega} rad/s: {found} instead of {expected}, {error:e}"
        );
    }
}

/// First branch for elastic and lossy rods, λ from 50 D to 1.4 D, in both directions.
#[test]
fn roots_of_pochhammer_and_chree_are_those_of_mpmath() {
    let rows = rows(POCHHAMMER);
    assert_eq!(rows.len(), 43);
    let (density, diameter, bar) = (1200.0, 0.016, 2.5e9);
    let radius = 0.5 * diameter;
    for (_, row) in rows {
        let [poisson_ratio, share, loss_factor, frequency, re, im] = row[..] else {
            panic!("six numbers");
        };
        let theory = PochhammerChree::new(RoundRod {
            density,
            diameter,
            poisson_ratio,
        })
        .unwrap();
        let what = format!("nu = {poisson_ratio}, D/lambda = {share}, tan d = {loss_factor}");
        let omega = frequency * (bar / density).sqrt() / radius;
        let modulus = Complex64::new(bar, bar * loss_factor);
        let expected = Complex64::new(re, im) / radius;
        let found = theory.propagation_coefficient(modulus, omega).unwrap();
        let error = relative(found.found().unwrap(), expected);
        // Some roundings: the terms of the frequency equation that cancel where waves are long are cancelled on paper.
        assert!(error < 5e-15, "{what}: gamma, {error:e}");
        let found = theory.modulus(expected, omega).unwrap();
        let error = relative(found.found().unwrap().modulus, modulus);
        assert!(error < 5e-15, "{what}: modulus, {error:e}");
    }
}

/// Twelve decades about the relaxation time, orders from 0.1 to 1.
#[test]
fn fractional_relaxation_and_creep_are_those_of_mpmath() {
    let rows = rows(FRACTIONAL);
    assert_eq!(rows.len(), 78);
    for (_, row) in rows {
        let [
            relaxed,
            unrelaxed,
            relaxation_time,
            exponent,
            time,
            relaxation,
            creep,
        ] = row[..]
        else {
            panic!("seven numbers");
        };
        let law = FractionalZener::new(relaxed, unrelaxed, relaxation_time, exponent).unwrap();
        let what = format!("order {exponent} at {time} s");
        // A few 1e-15 of E₁ - E₀ and 1/E₀ - 1/E₁ are promised; those of E₁ and of 1/E₀ are a third more.
        let error = (law.relaxation_modulus(time).unwrap() - relaxation).abs() / unrelaxed;
        assert!(error < 5e-15, "E, {what}: {error:e}");
        let error = (law.creep_compliance(time).unwrap() - creep).abs() * relaxed;
        assert!(error < 5e-15, "J, {what}: {error:e}");
    }
}

/// The exact flows of the second and third law, from steps of 1e-7 relaxation times to 30.
#[test]
fn relaxed_stresses_are_those_of_mpmath() {
    let rows = rows(RELAXATION);
    assert_eq!(rows.len(), 40);
    for (law, row) in rows {
        let [first, second, modulus, stress, duration, expected] = row[..] else {
            panic!("six numbers");
        };
        let found = match law {
            "gurevich" => MaxwellGurevichRabinovich::new(first, second)
                .unwrap()
                .flow(modulus, duration)
                .relax(stress),
            "norton" => MaxwellNorton::new(first, second)
                .unwrap()
                .flow(modulus, duration)
                .relax(stress),
            other => panic!("no such law: {other}"),
        };
        let error = (found / expected - 1.0).abs();
        // Rates are held at 10 MPa: B and η are multiplied by powers and exponentials of that, whose arguments of order 30 cost
        // a digit and a half: 30 roundings of 2e-16, three times.
        assert!(
            error < 2e-14,
            "{law}, {stress} Pa, {duration} s: {found} {expected}, {error:e}"
        );
    }
}

//! E(ω), E(t) and J(t) of a law are one: relaxation and creep against the numerical inversion of E(s)/s and 1/(sE(s)).
#![allow(
    clippy::unwrap_used,
    reason = "in a test, a refusal where none is expected is a failure"
)]

use std::f64::consts::PI;

use num_complex::Complex64;
use rodwave::modulus::{
    ConstantQ, Elastic, FractionalZener, GeneralisedMaxwell, KelvinVoigt, LaplaceModulus, Maxwell,
    MaxwellBranch, SpringPot, TimeDomainModulus, Zener,
};

/// Inverse Laplace transform at time t on the fixed contour of Talbot, by the trapezoidal rule (Abate & Valkó, *Int. J.
/// Numer. Meth. Engng* **60** (2004) 979).
///
/// With M points the truncation error is 10^{-0.6 M} and the rounding error e^{0.4 M} units in the last place: for M = 20
/// both are of order 1e-12.
fn inverse_laplace(time: f64, transform: impl Fn(Complex64) -> Complex64) -> f64 {
    const POINTS: u32 = 20;
    let m = f64::from(POINTS);
    let r = 0.4 * m / time;
    let first = 0.5 * (transform(Complex64::from(r)) * (r * time).exp()).re;
    let others: f64 = (1..POINTS)
        .map(|k| {
            let theta = f64::from(k) * PI / m;
            let cot = 1.0 / theta.tan();
            let s = r * theta * Complex64::new(cot, 1.0);
            let sigma = theta + (theta * cot - 1.0) * cot;
            ((s * time).exp() * transform(s) * Complex64::new(1.0, sigma)).re
        })
        .sum();
    r / m * (first + others)
}

fn laws() -> Vec<(&'static str, Box<dyn TimeDomainModulus>)> {
    let mut laws: Vec<(&'static str, Box<dyn TimeDomainModulus>)> = vec![
        ("elastic", Box::new(Elastic::new(2.7e9).unwrap())),
        ("Maxwell", Box::new(Maxwell::new(2.7e9, 2.7e5).unwrap())),
        (
            "Kelvin-Voigt",
            Box::new(KelvinVoigt::new(2.7e9, 2.7e4).unwrap()),
        ),
        ("Zener", Box::new(Zener::new(0.5e9, 2.9e9, 1e-4).unwrap())),
        (
            "constant Q",
            Box::new(ConstantQ::new(2.7e9, 0.1, 1e4).unwrap()),
        ),
        ("Prony series, solid", Box::new(prony(0.4e9))),
        ("Prony series, fluid", Box::new(prony(0.0))),
    ];
    for exponent in [0.06, 0.4, 0.9] {
        laws.push((
            "spring-pot",
            Box::new(SpringPot::new(2.7e9, exponent, 1e4).unwrap()),
        ));
    }
    for exponent in [0.1, 0.3, 0.5, 0.8, 0.95, 1.0] {
        laws.push((
            "fractional Zener",
            Box::new(FractionalZener::new(0.5e9, 2.9e9, 1e-4, exponent).unwrap()),
        ));
    }
    laws
}

/// Unordered, with two branches of one relaxation time and a weak one.
fn prony(equilibrium_modulus: f64) -> GeneralisedMaxwell {
    let branches = [
        (0.3e9, 1e-3),
        (0.4e9, 1e-5),
        (1e3, 2e-4),
        (0.5e9, 1e-3),
        (0.6e9, 1e-4),
    ];
    let branches = branches.map(|(modulus, relaxation_time)| MaxwellBranch {
        modulus,
        relaxation_time,
    });
    GeneralisedMaxwell::new(equilibrium_modulus, branches.to_vec()).unwrap()
}

/// From 10 ns, the hundredth of a relaxation time or less, to 1 s.
fn times() -> impl Iterator<Item = f64> {
    (0..=32).map(|j| 1e-8 * 10f64.powf(0.25 * f64::from(j)))
}

#[test]
fn relaxation_and_creep_are_the_inverse_transforms_of_the_modulus() {
    for (name, law) in laws() {
        let (mut worst_relaxation, mut worst_creep) = (0.0_f64, 0.0_f64);
        for time in times() {
            let relaxation = law.relaxation_modulus(time).unwrap();
            let inverse = inverse_laplace(time, |s| law.at_s(s) / s);
            // Of a fluid after many relaxation times nothing is left; the inversion has its rounding error of what was.
            let scale = relaxation.max(1e-3 * law.at(1.0 / time).norm());
            worst_relaxation = worst_relaxation.max((inverse - relaxation).abs() / scale);
            let creep = law.creep_compliance(time).unwrap();
            let inverse = inverse_laplace(time, |s| (s * law.at_s(s)).inv());
            worst_creep = worst_creep.max((inverse / creep - 1.0).abs());
        }
        println!("{name}: relaxation {worst_relaxation:.1e}, creep {worst_creep:.1e}");
        // Both errors of the inversion are near 1e-12; 1e-8 leaves room for what cancels on the contour, E(s)/s of the
        // Kelvin-Voigt law above all, whose constant part η transforms to nothing after t = 0.
        assert!(worst_relaxation < 1e-8, "{name}: {worst_relaxation:e}");
        assert!(worst_creep < 1e-8, "{name}: {worst_creep:e}");
    }
}

/// E decreases and J grows, and E(t) J(t) <= 1 (Zener, *Elasticity and Anelasticity of Metals*, 1948).
#[test]
fn relaxation_and_creep_are_monotonic_and_bound_each_other() {
    for (name, law) in laws() {
        let all: Vec<(f64, f64)> = times()
            .map(|t| {
                (
                    law.relaxation_modulus(t).unwrap(),
                    law.creep_compliance(t).unwrap(),
                )
            })
            .collect();
        for (relaxation, creep) in &all {
            // Rounding of half a dozen operations.
            assert!(relaxation * creep <= 1.0 + 1e-14, "{name}");
            assert!(*relaxation >= 0.0 && *creep > 0.0, "{name}");
        }
        for pair in all.windows(2) {
            assert!(pair[1].0 <= pair[0].0 * (1.0 + 1e-14), "{name}");
            assert!(pair[1].1 >= pair[0].1 * (1.0 - 1e-14), "{name}");
        }
    }
}

/// The chain of Kelvin-Voigt models has the compliance 1/E(s) everywhere, and its compliances add up to the limits.
#[test]
fn retardation_spectrum_is_the_same_material() {
    for equilibrium_modulus in [0.0, 1.0, 0.4e9, 1e15] {
        let law = prony(equilibrium_modulus);
        let chain = law.retardation_spectrum();
        // four distinct relaxation times; a solid has as many retardation times, a fluid one less
        let expected = if equilibrium_modulus > 0.0 { 4 } else { 3 };
        assert_eq!(chain.elements.len(), expected);
        for element in &chain.elements {
            assert!(element.compliance > 0.0 && element.retardation_time > 0.0);
        }
        for j in -20..=40 {
            let omega = 1e4 * 10f64.powf(0.25 * f64::from(j));
            for s in [Complex64::new(0.0, omega), Complex64::new(omega, omega)] {
                let compliance = chain
                    .elements
                    .iter()
                    .map(|element| element.compliance / (1.0 + s * element.retardation_time))
                    .sum::<Complex64>()
                    + chain.instantaneous_compliance
                    + chain.fluidity / s;
                // The zeros are found to a rounding of their distance to the next pole: 1e-16 of the compliance, a few
                // times over.
                let error = (compliance * law.at_s(s) - 1.0).norm();
                assert!(
                    error < 1e-12,
                    "E∞ = {equilibrium_modulus} at {s}: {error:e}"
                );
            }
        }
    }
}

#[test]
fn times_up_to_the_step_are_refused() {
    for (name, law) in laws() {
        for time in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(law.relaxation_modulus(time).is_err(), "{name} at {time}");
            assert!(law.creep_compliance(time).is_err(), "{name} at {time}");
        }
    }
}

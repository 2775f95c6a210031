//! E(t) and J(t) of the linear laws: monotonicity, E(t) J(t) <= 1, and times at and before the
//! step, which are rejected.

use rodwave::modulus::{
    ConstantQ, Elastic, FractionalZener, GeneralisedMaxwell, KelvinVoigt, Maxwell, SpringPot,
    TimeDomainModulus, Zener,
};

use crate::bodies;

pub(crate) fn laws() -> Vec<(&'static str, Box<dyn TimeDomainModulus>)> {
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

/// Prony series in no particular order, with two branches of equal relaxation time and a weak
/// branch.
pub(crate) fn prony(equilibrium_modulus: f64) -> GeneralisedMaxwell {
    let branches = [
        (0.3e9, 1e-3),
        (0.4e9, 1e-5),
        (1e3, 2e-4),
        (0.5e9, 1e-3),
        (0.6e9, 1e-4),
    ];
    bodies::prony(equilibrium_modulus, &branches)
}

/// Times from 10 ns, which is at most a hundredth of every relaxation time, to 1 s.
pub(crate) fn times() -> impl Iterator<Item = f64> {
    (0..=32).map(|j| 1e-8 * 10f64.powf(0.25 * f64::from(j)))
}

/// Checks that E decreases and J grows, and that E(t) J(t) <= 1 (Zener, *Elasticity and
/// Anelasticity of Metals*, 1948).
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
            // Tolerance: rounding of about six operations.
            assert!(relaxation * creep <= 1.0 + 1e-14, "{name}");
            assert!(*relaxation >= 0.0 && *creep > 0.0, "{name}");
        }
        for pair in all.windows(2) {
            assert!(pair[1].0 <= pair[0].0 * (1.0 + 1e-14), "{name}");
            assert!(pair[1].1 >= pair[0].1 * (1.0 - 1e-14), "{name}");
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

//! Tests of one material at several temperatures.

use crate::virtual_tests::{MODULUS, by_the_chain, noisy};

use maxwellid::selection::{Candidate, Selection};
use maxwellid::{Fit, Law, MaxwellidError, RodTest, Verdict};
use rodwave::inelastic::MaxwellNorton;

const REFERENCE: f64 = 293.15;
const ENERGY: f64 = 80e3;
const KAPPA: f64 = 2.0;
const RATE: f64 = 6.0;

/// A test of a Norton rod whose rate depends on `temperature` by the law of Arrhenius.
fn test(velocity: f64, temperature: f64, seed: u64) -> RodTest {
    let rate = RATE * (-ENERGY / 8.314_462_618 * (1.0 / temperature - 1.0 / REFERENCE)).exp();
    let law = MaxwellNorton::from_reference_rate(KAPPA, rate, 10e6).unwrap();
    noisy(&by_the_chain(&law, velocity), 0.01, seed)
}

/// Checks that the law, its parameters at the reference temperature and the activation energy are
/// found from three tests at two temperatures within their errors, and that no law is named if the
/// temperatures are ignored.
#[test]
fn an_activation_energy_is_found_with_the_law() {
    let conditions = [(5.0, 293.15), (20.0, 293.15), (10.0, 318.15)];
    let tests: Vec<RodTest> = conditions
        .iter()
        .zip(1..)
        .map(|((velocity, temperature), seed)| {
            let test = test(*velocity, *temperature, seed);
            test.at_temperature(*temperature).unwrap()
        })
        .collect();
    let activated = |law| Candidate::of(law).with_activation(REFERENCE).unwrap();
    let laws = [Law::Elastic, Law::Maxwell, Law::ConstantQ, Law::Norton];
    let compared = |candidates: Vec<Candidate>| {
        let selection = Selection::new(candidates).unwrap();
        selection.with_cell(8e-3).unwrap().compare(&tests).unwrap()
    };
    let comparison = compared(laws.map(activated).to_vec());
    let named = comparison.law().unwrap();
    assert_eq!(named.law, Some(Law::Norton), "{:?}", comparison.decision);
    assert!(named.adequacy.unwrap() > 1e-3);
    // with laws that do not depend on the temperature: the true rates differ by a factor of 13
    let without = compared(laws.map(Candidate::of).to_vec());
    assert!(without.law().is_none(), "{:?}", without.decision);

    let norton = activated(Law::Norton);
    let fit = Fit::of(norton.model().clone());
    let (found, profiles) = fit.with_profiles(&norton, &tests).unwrap();
    let estimates = found
        .identifiability(maxwellid::Noise::Stated)
        .unwrap()
        .estimates;
    for (name, truth) in [
        ("Young's modulus", MODULUS),
        ("exponent", KAPPA),
        ("inelastic strain rate at 10 MPa", RATE),
        ("activation energy", ENERGY),
    ] {
        let estimate = estimates
            .iter()
            .find(|estimate| estimate.name == name)
            .unwrap();
        let relative = match estimate.scale {
            maxwellid::Scale::Ratio => (estimate.value / truth).ln(),
            maxwellid::Scale::Difference => estimate.value - truth,
        };
        assert!(
            relative.abs() < 3.0 * estimate.standard_error && estimate.standard_error < 0.1,
            "{estimate:?}"
        );
        assert_eq!(estimate.verdict, Verdict::Identified, "{estimate:?}");
    }
    let of_energy = profiles.last().unwrap();
    assert_eq!(of_energy.parameter, "activation_energy");
    assert!(of_energy.contains(ENERGY), "{}", of_energy.reason());

    let mut untold = tests;
    untold.push(test(30.0, 293.15, 9));
    let refused = fit.to(&untold).unwrap_err();
    assert!(
        matches!(refused, MaxwellidError::TemperatureUnknown { .. }),
        "{refused}"
    );
    let refused = Selection::new(vec![norton])
        .unwrap()
        .compare(&untold)
        .unwrap_err();
    assert!(
        matches!(refused, MaxwellidError::TemperatureUnknown { .. }),
        "{refused}"
    );
}

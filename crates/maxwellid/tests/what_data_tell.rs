//! Tests of the planning of further tests, and of the paper's classifier, on virtual tests.

use crate::virtual_tests;

use maxwellid::adequacy::{Basis, Weights};
use maxwellid::conformal::p_values;
use maxwellid::design::{Design, Estimated, PlannedTest};
use maxwellid::samples::{Pattern, StandardSamples};
use maxwellid::selection::Candidate;
use maxwellid::{Law, MaxwellidError};
use rodwave::inelastic::MaxwellNorton;
use virtual_tests::{by_the_chain, noisy};

#[test]
fn a_faster_test_separates_what_a_repetition_does_not() {
    let truth = MaxwellNorton::from_reference_rate(2.0, 8.0, 10e6).unwrap();
    let exact = by_the_chain(&truth, 10.0);
    let tests = [noisy(&exact, 0.01, 1)];
    let design = Design {
        tests: &tests,
        cell: 8e-3,
    };
    let norton = Candidate::of(Law::Norton);
    let parameters = [2.6e9_f64.ln(), 2.0, 8.0_f64.ln()];
    let law = Estimated {
        candidate: &norton,
        parameters: &parameters,
    };
    let rival = Candidate::of(Law::GurevichRabinovich);
    let planned = [10.0, 5.0, 25.0].map(|v| PlannedTest::at_velocity(&tests[0], v).unwrap());
    let ranked = design.rank(law, &rival, &planned).unwrap();
    let repetition = ranked.iter().find(|(index, _)| *index == 0).unwrap().1;
    let alone = design.separation(law, &rival, &[]).unwrap();
    // a repetition doubles the information, and with it the separation
    assert!(
        (repetition / alone - 2.0).abs() < 0.3,
        "{repetition} {alone}"
    );
    assert_eq!(ranked[0].0, 2, "{ranked:?}");
    // the test at 25 m/s separates the laws most; at half the velocity a power law of κ = 2 damps
    // only half as much
    assert!(ranked[0].1 > 3.0 * repetition, "{ranked:?}");

    // a repetition divides an error by √2; a second velocity reduces the error of the exponent by
    // more
    let before = design.deviations(law, &[]).unwrap();
    let repeated = design.deviations(law, &planned[..1]).unwrap();
    let faster = design.deviations(law, &planned[2..]).unwrap();
    // a repetition adds the information I of the first test again, but not the prior P: A = P + I
    // becomes 2A - P. The ratio of variances is between 2 - λ and 2, with λ the largest eigenvalue
    // of P A⁻¹, which is less than its trace
    let priors = [0.15, 3.5 / 4.0, 1e6_f64.ln() / 4.0];
    let trace: f64 = before
        .iter()
        .zip(priors)
        .map(|(b, p)| (b / p).powi(2))
        .sum();
    assert!(trace < 0.2, "{before:?}");
    for (before, repeated) in before.iter().zip(&repeated) {
        let ratio = (before / repeated).powi(2);
        assert!(
            (2.0 - trace..2.0 + 1e-6).contains(&ratio),
            "{ratio} {trace}"
        );
    }
    assert!(faster[1] < 0.7 * repeated[1], "{faster:?} {repeated:?}");
    // three repetitions multiply the information by four
    let thrice = vec![planned[0].clone(); 3];
    let three = design.deviations(law, &thrice).unwrap();
    for (before, three) in before.iter().zip(&three) {
        let ratio = (before / three).powi(2);
        assert!(
            (4.0 - 3.0 * trace..4.0 + 1e-6).contains(&ratio),
            "{ratio} {trace}"
        );
    }
    assert!(PlannedTest::at_velocity(&tests[0], 0.0).is_err());
}

/// Checks that the paper's classifier, with sixty standard samples per law as in the paper, is
/// often wrong, and that conformal p-values reject a pattern that belongs to no law.
#[test]
fn the_classifier_of_the_paper_is_what_it_is() {
    let exact = by_the_chain(
        &MaxwellNorton::from_reference_rate(2.0, 8.0, 10e6).unwrap(),
        10.0,
    );
    let tests = [noisy(&exact, 0.01, 1)];
    let laws = [Law::Maxwell, Law::Norton, Law::GurevichRabinovich].map(Candidate::of);
    let samples = StandardSamples::of(&laws, &tests, 60, Pattern::Absolute).unwrap();
    assert_eq!(samples.patterns.len(), 180);
    let projection = samples.projection(6).unwrap();
    let projected: Vec<Vec<f64>> = samples
        .patterns
        .iter()
        .map(|p| projection.project(p).unwrap())
        .collect();
    let features: Vec<Vec<f64>> = projected.iter().map(|z| Basis::Linear.of(z)).collect();
    let limit = Weights::least_squares(&features, &samples.class_of, 0.0).unwrap();
    let measured = projection.project(&samples.measured(&tests)).unwrap();
    // with a linear basis, fewer than two thirds of the samples are assigned to their own law
    let right = features
        .iter()
        .zip(&samples.class_of)
        .filter(|(phi, class)| {
            let p = limit.adequacies(phi).unwrap();
            (0..3).max_by(|a, b| p[*a].total_cmp(&p[*b])) == Some(**class)
        })
        .count();
    assert!(right < 120, "{right} of 180");

    let p = p_values(&projected, &samples.class_of, &measured).unwrap();
    assert!(
        p.iter().all(|p| (1.0 / 61.0 - 1e-12..=1.0).contains(p)),
        "{p:?}"
    );
    let none = samples.patterns[0]
        .iter()
        .map(|v| v + 1.0)
        .collect::<Vec<_>>();
    let rejected = p_values(&samples.patterns, &samples.class_of, &none).unwrap();
    assert!(rejected.iter().all(|p| *p < 0.02), "{rejected:?}");
    assert!(matches!(
        samples.projection(1000),
        Err(MaxwellidError::TooManyComponents {
            requested: 1000,
            ..
        })
    ));
}

//! Profiles, advice on the next test, and the paper's classifier on virtual tests.

use crate::virtual_tests;

use maxwellid::adequacy::{Basis, RobbinsMonro, Weights};
use maxwellid::conformal::p_values;
use maxwellid::design::{Design, Estimated, PlannedTest};
use maxwellid::profile::{Profile, profiles};
use maxwellid::samples::{Pattern, StandardSamples};
use maxwellid::selection::Candidate;
use maxwellid::{Law, MaxwellidError, RodTest, Verdict};
use rodwave::inelastic::{Elastic, Maxwell, MaxwellNorton};
use virtual_tests::{by_the_chain, noisy};

fn profile(law: Law, tests: &[RodTest], index: usize) -> Profile {
    profiles(&Candidate::of(law), tests, 8e-3)
        .unwrap()
        .swap_remove(index)
}

/// A linear rod fitted with the power law: the linear limit κ = 1 is inside the interval.
#[test]
fn the_interval_of_a_linear_rod_contains_the_linear_limit() {
    let exact = by_the_chain(&Maxwell::new(2e6).unwrap(), 10.0);
    let kappa = profile(Law::Norton, &[noisy(&exact, 0.01, 5)], 1);
    assert_eq!(kappa.verdict, Verdict::Identified, "{}", kappa.reason());
    assert!(kappa.contains(1.0), "{}", kappa.reason());
    let (lower, upper) = (kappa.lower.unwrap(), kappa.upper.unwrap());
    // the linearised errors of such a test are of order 0.1
    assert!(
        upper - lower > 0.05 && upper - lower < 1.5,
        "{lower} {upper}"
    );
}

/// An elastic rod with two per cent of noise: a relaxation time is excluded below a bound, none
/// above it, and no exponent at all.
#[test]
fn damping_that_is_not_there_is_bounded_on_one_side() {
    let exact = by_the_chain(&Elastic, 10.0);
    let test = [noisy(&exact, 0.02, 8)];
    let time = profile(Law::Maxwell, &test, 1);
    let Verdict::BoundedBelow(least) = time.verdict else {
        panic!("{}", time.reason())
    };
    // the window is 2.8 ms: a relaxation time of the same length would take a tenth of a wave on
    // its way
    assert!(least > 1e-3_f64.ln() && least < 1.0_f64.ln(), "{least}");
    let kappa = profile(Law::Norton, &test, 1);
    assert_eq!(
        kappa.verdict,
        Verdict::NotIdentifiable,
        "{}",
        kappa.reason()
    );
}

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
    // twice the data have twice the information
    assert!(
        (repetition / alone - 2.0).abs() < 0.3,
        "{repetition} {alone}"
    );
    assert_eq!(ranked[0].0, 2, "{ranked:?}");
    // at half the velocity a power law of κ = 2 damps half as much: less than a repetition
    assert!(ranked[0].1 > 3.0 * repetition, "{ranked:?}");

    // a repetition reduces an error by the root of two, a second velocity reduces that of the
    // exponent by more
    let before = design.deviations(law, &[]).unwrap();
    let repeated = design.deviations(law, &planned[..1]).unwrap();
    let faster = design.deviations(law, &planned[2..]).unwrap();
    // a repetition adds as much information as there is, but the prior P not again: from A to 2A -
    // P, where A = P + I. The ratio of variances is between 2 - λ and 2, λ the largest
    // eigenvalue of P A⁻¹, which is less than its trace
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
    // three more tests of the same kind: four times the information
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

/// Sixty standard samples per law, as in the paper: the meaning of the numbers and its limits.
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
    let adequacies = limit.adequacies(&Basis::Linear.of(&measured)).unwrap();
    assert!(
        (adequacies.iter().sum::<f64>() - 1.0).abs() < 1e-10,
        "{adequacies:?}"
    );
    let found =
        Weights::robbins_monro(&features, &samples.class_of, &RobbinsMonro::default()).unwrap();
    let by_recursion = found.adequacies(&Basis::Linear.of(&measured)).unwrap();
    for (a, b) in by_recursion.iter().zip(&adequacies) {
        assert!((a - b).abs() < 0.02, "{by_recursion:?} {adequacies:?}");
    }
    // with a linear basis, sixty samples are separated hardly better than by chance
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

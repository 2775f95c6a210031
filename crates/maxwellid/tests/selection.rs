//! Tests of the selection of a law: the right law is named from two impact velocities, and doubts
//! are stated where the data do not decide.

use crate::virtual_tests;

use maxwellid::selection::{Advice, Candidate, Decision, Doubt, Selection};
use maxwellid::{Law, MaxwellidError};
use rodwave::inelastic::{Maxwell, MaxwellNorton};
use testbed::noise::draws;
use virtual_tests::{
    by_the_chain, by_the_line, compare, constant_q_stack, in_parallel, named, noisy, sampled_fast,
};

/// A law of polypropylene with a relaxation time of 0.5 ms at 10 MPa.
fn norton() -> MaxwellNorton {
    MaxwellNorton::from_reference_rate(2.0, 8.0, 10e6).unwrap()
}

/// Checks that Norton's law is named from one test at 3 m/s and one at 27 m/s. At 4 and 24 m/s χ²
/// of the law of Gurevich and Rabinovich would exceed that of Norton's law by only about 15, at 5
/// and 15 m/s by 6. `claims/selection.rs` has five more draws.
#[test]
fn a_norton_law_is_named_from_two_velocities() {
    let exact = [3.0, 27.0].map(|velocity| by_the_chain(&norton(), velocity));
    let seeds: Vec<u64> = (0..draws(4)).collect();
    let comparisons = in_parallel(&seeds, |seed| compare(Candidate::standard(), &exact, *seed));
    let names: Vec<String> = comparisons.iter().map(named).collect();
    let right = names.iter().filter(|name| *name == "Maxwell-Norton");
    // at least nine of ten draws, which means all of the default four
    assert!(10 * right.count() >= 9 * names.len(), "{names:?}");
    for comparison in &comparisons {
        let law = &comparison.laws[6];
        // tolerance: four standard errors of 0.05
        assert!(
            (law.parameters[1] - 2.0).abs() < 0.2,
            "{:?}",
            law.parameters
        );
        // 288 samples minus 3 parameters; tolerance: four standard deviations of 24
        assert!((law.chi_square - 285.0).abs() < 96.0, "{}", law.chi_square);
        assert!(comparison.advice.is_empty(), "{:?}", comparison.advice);
    }
}

/// Checks that from one velocity a nonlinear law is named only if every linear law of flat loss is
/// refuted, and that the advice is given where nonlinear laws are probable.
#[test]
fn one_velocity_is_not_enough_while_a_linear_law_explains_the_data() {
    let mild = MaxwellNorton::from_reference_rate(2.0, 2.0, 10e6).unwrap();
    for (law, seed) in [(mild, 3), (norton(), 4)] {
        let exact = [by_the_chain(&law, 10.0)];
        let comparison = compare(Candidate::standard(), &exact, seed);
        let flat = comparison.laws.iter().filter(|law| law.is_flat_loss);
        let explains = flat.map(|law| law.adequacy.unwrap()).fold(0.0, f64::max) >= 1e-3;
        assert!(
            !(comparison.is_nonlinear_verdict() && explains),
            "{comparison:?}"
        );
        if comparison.nonlinear_probability > 0.05 {
            let advice = Advice::SecondVelocity { present: 10.0 };
            assert!(comparison.advice.contains(&advice), "{comparison:?}");
        }
    }
}

/// Checks comparisons without linear laws of flat loss, as in the paper: for data of a constant-Q
/// rod all laws are refuted, and for data of a Norton rod no law is named.
#[test]
fn without_linear_competitors_nothing_is_called_nonlinear() {
    let only =
        |laws: &[Law]| -> Vec<Candidate> { laws.iter().map(|l| Candidate::of(*l)).collect() };
    let laws = [Law::Maxwell, Law::Norton, Law::GurevichRabinovich];
    let exact = [by_the_line(&constant_q_stack(0.07), 10.0)];
    let comparison = compare(only(&laws), &exact, 1);
    assert!(
        matches!(comparison.decision, Decision::NoneOfThese { adequacy, .. } if adequacy < 1e-6),
        "{:?}",
        comparison.decision
    );
    let exact = [by_the_chain(&norton(), 15.0)];
    let comparison = compare(only(&[Law::Maxwell, Law::Norton]), &exact, 1);
    assert!(
        matches!(
            comparison.decision,
            Decision::CannotTell {
                reason: Doubt::NoFlatLossCompetitor,
                ..
            }
        ),
        "{:?}",
        comparison.decision
    );
}

/// Checks that no law has an adequacy if the level of the noise is unknown, and that laws are
/// refuted less strongly if the level is estimated from 20 samples than if it is known.
#[test]
fn noise_that_is_not_known_refutes_less() {
    let exact = by_the_line(&constant_q_stack(0.07), 10.0);
    // the stated noise is half of the true noise
    let test = noisy(&exact, 0.01, 9).with_noise(0.05, 0.05).unwrap();
    let laws = || vec![Candidate::of(Law::Maxwell), Candidate::of(Law::ConstantQ)];
    let known = Selection::new(laws()).unwrap();
    let with = |samples: f64| known.clone().with_noise_of(samples).unwrap();
    let tests = [test];
    let unknown = with(0.0).compare(&tests).unwrap();
    assert!(unknown.laws.iter().all(|law| law.adequacy.is_none()));
    let estimated = with(20.0).compare(&tests).unwrap();
    assert!(estimated.laws[1].adequacy.unwrap() < 1e-3, "{estimated:?}");
    let of_known = known.compare(&tests).unwrap();
    // with half of the noise stated, χ² is about four times the number of samples
    assert!(of_known.laws[1].adequacy.unwrap() < estimated.laws[1].adequacy.unwrap());
}

#[test]
fn requests_without_sense_are_refused() {
    assert!(matches!(
        Selection::new(Vec::new()),
        Err(MaxwellidError::NoCandidate)
    ));
    let selection = Selection::new(Candidate::standard()).unwrap();
    assert!(matches!(
        selection.compare(&[]),
        Err(MaxwellidError::NoTest)
    ));
    assert!(selection.clone().with_cell(0.0).is_err());
    assert!(selection.clone().with_levels(0.4, 0.01).is_err());
    assert!(selection.clone().with_noise_of(-1.0).is_err());
    assert!(Candidate::of(Law::Elastic).with_prior_weight(0.0).is_err());
    assert!(Candidate::inelastic(norton(), &[(2.0, 1.0)]).is_err());
    assert!(Candidate::inelastic(norton(), &[]).is_err());
    assert!(Candidate::inelastic(Maxwell::new(4e6).unwrap(), &[]).is_ok());
    let exact = by_the_chain(&norton(), 10.0);
    let error = selection
        .compare(&[virtual_tests::without_stated_noise(&exact)])
        .unwrap_err();
    assert_eq!(
        error.to_string(),
        "test `10 m/s` does not state the noise of its histories, without which laws cannot be distinguished"
    );
}

/// Checks that the true law is named or remains in question for records with 3 % of noise in which
/// three quarters of the frequencies have no signal. If the excitation were not limited to the band
/// of the signal, a law that filters the noise of the excitation would be preferred, and Maxwell's
/// law would be excluded in seven of 24 such tests.
#[test]
fn noise_beyond_the_signal_does_not_choose_a_law() {
    let laws = [
        Law::Elastic,
        Law::Maxwell,
        Law::TwoMaxwellBranches,
        Law::ThreeMaxwellBranches,
        Law::Zener,
        Law::ConstantQ,
    ];
    let seeds: Vec<u64> = (0..draws(6)).collect();
    let is_left = in_parallel(&seeds, |seed| {
        let test = sampled_fast(&Maxwell::new(1.5e6).unwrap(), 0.03, 100 + seed);
        let candidates = laws.map(Candidate::of).to_vec();
        let found = Selection::new(candidates).unwrap().compare(&[test]);
        let found = found.unwrap();
        match &found.decision {
            Decision::Law { candidate, .. } => *candidate == 1,
            Decision::CannotTell { between, .. } => between.contains(&1),
            _ => false,
        }
    });
    assert!(is_left.iter().all(|left| *left), "{is_left:?}");
}

//! Confusion matrix and calibration of probabilities on data of independent generators, at two
//! velocities, with one draw for each true law or `SEEDS` draws.

use crate::virtual_tests;

use std::collections::BTreeMap;

use maxwellid::selection::Candidate;
use rodwave::inelastic::{Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};
use testbed::noise::draws;
use virtual_tests::{
    Exact, by_the_chain, by_the_line, compare, constant_q_stack, in_parallel, named,
};

/// Records of rods of four laws at 4 and 24 m/s, with the name of the law.
fn truths() -> Vec<(&'static str, [Exact; 2])> {
    let maxwell = Maxwell::new(2e6).unwrap();
    let norton = MaxwellNorton::from_reference_rate(2.0, 8.0, 10e6).unwrap();
    let gurevich = MaxwellGurevichRabinovich::from_reference_rate(1.4, 6.0, 10e6).unwrap();
    let stack = constant_q_stack(0.05);
    vec![
        ("Maxwell", [4.0, 24.0].map(|v| by_the_chain(&maxwell, v))),
        (
            "Maxwell-Norton",
            [4.0, 24.0].map(|v| by_the_chain(&norton, v)),
        ),
        (
            "Maxwell-Gurevich-Rabinovich",
            [4.0, 24.0].map(|v| by_the_chain(&gurevich, v)),
        ),
        ("constant Q", [4.0, 24.0].map(|v| by_the_line(&stack, v))),
    ]
}

#[test]
fn laws_are_confused_with_their_limits_only_and_probabilities_are_honest() {
    let truths = truths();
    let cases: Vec<(usize, u64)> = (0..truths.len())
        .flat_map(|truth| (0..draws(1)).map(move |seed| (truth, 100 + seed)))
        .collect();
    let comparisons = in_parallel(&cases, |(truth, seed)| {
        compare(Candidate::standard(), &truths[*truth].1, *seed)
    });
    let mut confusion: BTreeMap<(&str, String), usize> = BTreeMap::new();
    let (mut score, mut of_truth) = (0.0, 0.0);
    for ((truth, _), comparison) in cases.iter().zip(&comparisons) {
        let truth = truths[*truth].0;
        *confusion.entry((truth, named(comparison))).or_default() += 1;
        for law in &comparison.laws {
            let target = f64::from(u8::from(law.name == truth));
            score += (law.probability - target).powi(2);
            of_truth += law.probability * target;
        }
    }
    let count = cases.len() as f64;
    // tolerance: the Brier score is 0.4 if one answer in five is certain and wrong; it is 0.875 for
    // eight equal probabilities
    assert!(score / count < 0.4, "{} {confusion:?}", score / count);
    assert!(of_truth / count > 0.6, "{} {confusion:?}", of_truth / count);
    // no linear law is named for nonlinear data, and no nonlinear law for linear data
    let nonlinear = |name: &str| name.contains("Norton") || name.contains("Gurevich");
    for (truth, verdict) in confusion.keys() {
        let is_named = !(verdict == "cannot tell" || verdict == "none");
        assert!(
            !is_named || nonlinear(truth) == nonlinear(verdict),
            "{confusion:?}"
        );
    }
}

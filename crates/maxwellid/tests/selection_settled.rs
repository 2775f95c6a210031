//! Tests that a comparison does not depend on the order of tests or candidates, and that no law
//! fits worse than its special cases.

use crate::virtual_tests;

use maxwellid::selection::{Candidate, ComparedLaw, Comparison, Decision, Selection};
use maxwellid::{Law, RodTest};
use rodwave::inelastic::{Maxwell, MaxwellNorton};
use rodwave::modulus::{GeneralisedMaxwell, MaxwellBranch};
use virtual_tests::{by_the_chain, by_the_line, constant_q_stack, in_parallel, noisy};

const NOISE: f64 = 0.008;

fn compare(candidates: Vec<Candidate>, tests: &[RodTest]) -> Comparison {
    Selection::new(candidates)
        .unwrap()
        .with_cell(8e-3)
        .unwrap()
        .compare(tests)
        .unwrap()
}

fn linear() -> Vec<Candidate> {
    let mut all = Candidate::standard();
    all.retain(|candidate| candidate.model().is_linear());
    all
}

fn law(comparison: &Comparison, wanted: Law) -> &ComparedLaw {
    let mut laws = comparison.laws.iter();
    laws.find(|law| law.law == Some(wanted)).unwrap()
}

/// The kind of a decision, and the names of its laws in alphabetical order.
fn decided(comparison: &Comparison) -> (&'static str, Vec<String>) {
    let (kind, indices) = match &comparison.decision {
        Decision::Law { candidate, .. } => ("law", vec![*candidate]),
        Decision::CannotTell { between, .. } => ("cannot tell", between.clone()),
        Decision::NoneOfThese { best, .. } => ("none", vec![*best]),
        other => unreachable!("{other:?}"),
    };
    let name = |i: &usize| comparison.laws.get(*i).unwrap().name.clone();
    let names = indices.iter().map(name);
    let mut names: Vec<String> = names.collect();
    names.sort();
    (kind, names)
}

fn assert_same(one: &Comparison, other: &Comparison) {
    assert_eq!(decided(one), decided(other));
    for a in &one.laws {
        let b = law(other, a.law.unwrap());
        assert!(
            (a.ln_evidence - b.ln_evidence).abs() < 0.05,
            "{}: {} {}",
            a.name,
            a.ln_evidence,
            b.ln_evidence
        );
    }
}

/// Checks rods of constant loss factor, each test alone and any two together in both orders: the
/// law is never excluded, and χ² of two tests together exceeds the sum of their own χ² by no more
/// than chance permits for the two shared parameters.
#[test]
fn r01_constant_q_is_named_by_tests_alone_and_together_in_any_order() {
    let exact = [3.0, 10.0, 27.0].map(|v| by_the_line(&constant_q_stack(0.07), v));
    let tests: Vec<RodTest> = exact
        .iter()
        .zip(0..)
        .map(|(exact, seed)| noisy(exact, NOISE, 40 + seed))
        .collect();
    let alone = in_parallel(&tests, |test| compare(linear(), std::slice::from_ref(test)));
    for (first, second) in [(0, 1), (0, 2), (1, 2)] {
        let pair = [tests[first].clone(), tests[second].clone()];
        let exchanged = [tests[second].clone(), tests[first].clone()];
        let mut reversed = linear();
        reversed.reverse();
        let together = compare(linear(), &pair);
        let (kind, names) = decided(&together);
        assert!(
            kind != "none" && names.contains(&"constant Q".to_owned()),
            "{together}"
        );
        assert_same(&together, &compare(reversed, &exchanged));
        let of = |comparison: &Comparison| law(comparison, Law::ConstantQ).chi_square;
        let sum = of(&alone[first]) + of(&alone[second]);
        // tolerance: chi-square with two degrees of freedom exceeds 2 ln(1/p) with the probability
        // p = 1e-4
        let allowed = 2.0 * 1e4_f64.ln();
        assert!(of(&together) < sum + allowed, "{} {sum}", of(&together));
        let counts = |law: &&ComparedLaw| law.probability > 0.01;
        let mut laws = together.laws.iter().filter(counts);
        assert!(laws.all(|law| law.is_settled), "{together}");
    }
}

/// Checks, for data of three laws, that χ² of a general law does not exceed that of its special
/// cases.
#[test]
fn r01_no_law_is_worse_than_its_special_case() {
    let zener = GeneralisedMaxwell::new(
        2.2e9,
        vec![MaxwellBranch {
            modulus: 0.4e9,
            relaxation_time: 60e-6,
        }],
    )
    .unwrap();
    let norton = MaxwellNorton::from_reference_rate(3.0, 20.0, 10e6).unwrap();
    // for the first and the last record, fits of two branches from their own starts would miss the
    // minimum of one branch
    let data = [
        (NOISE, 100, by_the_chain(&Maxwell::new(2e6).unwrap(), 10.0)),
        (NOISE, 20, by_the_line(&zener, 10.0)),
        (4.0 * NOISE, 101, by_the_chain(&norton, 15.0)),
    ];
    let comparisons = in_parallel(&data, |(level, seed, exact)| {
        let mut candidates = Candidate::standard();
        candidates.push(Candidate::of(Law::ZenerNorton));
        compare(candidates, &[noisy(exact, *level, *seed)])
    });
    for comparison in &comparisons {
        for (general, special) in [
            (Law::Maxwell, Law::Elastic),
            (Law::TwoMaxwellBranches, Law::Maxwell),
            (Law::TwoMaxwellBranches, Law::Zener),
            (Law::ThreeMaxwellBranches, Law::TwoMaxwellBranches),
            (Law::Zener, Law::Maxwell),
            (Law::ConstantQ, Law::Elastic),
            (Law::Norton, Law::Maxwell),
            (Law::GurevichRabinovich, Law::Maxwell),
            (Law::ZenerNorton, Law::Norton),
            (Law::ZenerNorton, Law::Zener),
        ] {
            let (general, special) = (law(comparison, general), law(comparison, special));
            assert!(
                general.chi_square < special.chi_square + 0.5,
                "{} {} {comparison}",
                general.name,
                special.name
            );
        }
    }
    // for data of a Zener rod, two branches with one unbounded relaxation time are equivalent to
    // the law Zener
    let two = law(&comparisons[1], Law::TwoMaxwellBranches);
    assert_eq!(
        two.with_limit(),
        "two Maxwell branches, of which one has an unbounded relaxation time, which is the law Zener"
    );
    // for data of a Norton rod, the spring in parallel is not needed
    let solid = law(&comparisons[2], Law::ZenerNorton);
    assert_eq!(
        solid
            .limits
            .iter()
            .find(|limit| limit.special == "Maxwell-Norton"),
        Some(&solid.limits[0]),
        "{:?}",
        solid.limits
    );
}

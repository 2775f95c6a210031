//! Which law: the right one from two impact velocities, and doubts where they belong.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a failing test should say so at once"
)]

mod virtual_tests;

use std::collections::BTreeMap;

use maxwellid::selection::{Candidate, Comparison, Decision, Doubt, Selection};
use rodwave::inelastic::{Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};
use virtual_tests::{Exact, by_the_chain, in_parallel, noisy};

/// With cells of 8 mm the scheme errs by less than 1e-3 of V0, a tenth of the noise.
fn compare(exact: &[Exact], seed: u64) -> Comparison {
    let count = u64::try_from(exact.len()).unwrap();
    let tests: Vec<_> = exact
        .iter()
        .zip(0..)
        .map(|(exact, k)| noisy(exact, 0.01, count * seed + k))
        .collect();
    Selection::new(Candidate::standard())
        .unwrap()
        .with_cell(8e-3)
        .unwrap()
        .compare(&tests)
        .unwrap()
}

fn named(comparison: &Comparison) -> String {
    match &comparison.decision {
        Decision::Law { candidate, .. } => comparison.laws[*candidate].name.clone(),
        Decision::NoneOfThese { .. } => "none".into(),
        _ => "cannot tell".into(),
    }
}

fn counts(verdicts: &[String]) -> BTreeMap<&str, usize> {
    let mut counts = BTreeMap::new();
    for verdict in verdicts {
        *counts.entry(verdict.as_str()).or_default() += 1;
    }
    counts
}

/// Polypropylene of Table 4 with damping that acts, but κ = 2: a relaxation time of 0.5 ms at 10 MPa.
fn norton() -> MaxwellNorton {
    MaxwellNorton::from_reference_rate(2.0, 8.0, 10e6).unwrap()
}

/// At 5 and 20 m/s the exponential law imitates the power law to about one part in e^6 of probability, at 4 and 24 m/s to e^13.
#[test]
fn a_norton_law_is_named_from_two_velocities() {
    let exact = [by_the_chain(&norton(), 4.0), by_the_chain(&norton(), 24.0)];
    let seeds: Vec<u64> = (0..20).collect();
    let t = std::time::Instant::now();
    let verdicts = in_parallel(&seeds, |seed| {
        let comparison = compare(&exact, *seed);
        let law = &comparison.laws[6];
        (
            named(&comparison),
            law.parameters[1],
            law.chi_square,
            comparison.laws[7].chi_square,
        )
    });
    println!("{verdicts:?} {:?}", t.elapsed());
    let names: Vec<String> = verdicts.iter().map(|v| v.0.clone()).collect();
    println!("{:?}", counts(&names));
    let right = names
        .iter()
        .filter(|name| *name == "Maxwell-Norton")
        .count();
    assert!(right >= 19, "{:?}", counts(&names));
    for (_, kappa, ..) in &verdicts {
        assert!((kappa - 2.0).abs() < 0.2, "{kappa}");
    }
}

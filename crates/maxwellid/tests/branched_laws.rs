//! Nonlinear laws with an equilibrium: named where the data ask for them, with errors that cover.

use crate::virtual_tests;

use maxwellid::selection::{Candidate, Comparison, Decision, Selection};
use maxwellid::{Fit, Law, Noise};
use rodwave::inelastic::{InelasticLaw, MaxwellNorton};
use testbed::noise::draws;
use virtual_tests::{Exact, by_the_chain, in_parallel, noisy, with_spring};

/// Noise over V0. With 1 % the law without a spring keeps 6 % of the probability of one draw.
const NOISE: f64 = 0.005;

fn norton(rate: f64) -> MaxwellNorton {
    MaxwellNorton::from_reference_rate(2.0, rate, 10e6).unwrap()
}

/// The same law at 3 and at 27 m/s.
fn at_two_velocities(of: impl Fn(f64) -> Exact) -> [Exact; 2] {
    [of(3.0), of(27.0)]
}

fn compare(exact: &[Exact; 2], seed: u64) -> Comparison {
    let noisy = |(exact, k)| noisy(exact, NOISE, 2 * seed + k);
    let tests: Vec<_> = exact.iter().zip(0..).map(noisy).collect();
    let selection = Selection::new(Candidate::standard()).unwrap();
    let selection = selection.with_further(Candidate::with_equilibrium());
    selection.compare(&tests).unwrap()
}

fn left(comparison: &Comparison) -> Vec<Law> {
    let places = match &comparison.decision {
        Decision::Law { candidate, .. } => vec![*candidate],
        Decision::CannotTell { between, .. } => between.clone(),
        _ => Vec::new(),
    };
    let laws = places
        .iter()
        .filter_map(|place| comparison.laws[*place].law);
    laws.collect()
}

/// A third and three fifths of the modulus in the spring: with three fifths Norton's law alone explains
/// the data by a misfit of some per cent, and was named as long as no law had an equilibrium.
#[test]
fn a_solid_with_an_equilibrium_is_named() {
    for share in [0.3, 0.6] {
        let exact = at_two_velocities(|velocity| with_spring(&norton(60.0), share, velocity));
        let seeds: Vec<u64> = (0..draws(2)).collect();
        for comparison in in_parallel(&seeds, |seed| compare(&exact, *seed)) {
            assert_eq!(left(&comparison), [Law::ZenerNorton], "{comparison}");
        }
    }
}

/// A law without a spring is still named, or left beside the one that contains it.
#[test]
fn a_law_without_an_equilibrium_is_not_lost() {
    let exact = at_two_velocities(|velocity| by_the_chain(&norton(8.0), velocity));
    let seeds: Vec<u64> = (0..draws(2)).collect();
    for comparison in in_parallel(&seeds, |seed| compare(&exact, *seed)) {
        let left = left(&comparison);
        assert_eq!(left.first(), Some(&Law::Norton), "{comparison}");
        let others = left.iter().skip(1);
        assert!(
            others.into_iter().all(|law| *law == Law::ZenerNorton),
            "{comparison}"
        );
    }
}

/// Errors of the parameters over 20 draws: squares of z scores about 1, E and the exponent by the
/// values, share and rate by their logarithms.
#[test]
fn errors_of_a_solid_cover() {
    fn scores<L: InelasticLaw>(law: &L, share: f64, truth: [f64; 4]) -> Vec<[f64; 4]> {
        let exact = at_two_velocities(|velocity| with_spring(law, share, velocity));
        let seeds: Vec<u64> = (0..draws(20)).collect();
        in_parallel(&seeds, |seed| {
            let noisy = |(exact, k)| noisy(exact, NOISE, 100 + 2 * seed + k);
            let tests: Vec<_> = exact.iter().zip(0..).map(noisy).collect();
            let fit = Fit::of(Law::ZenerNorton).to(&tests).unwrap();
            let found = fit.identifiability(Noise::Stated).unwrap();
            let mut scores = [0.0; 4];
            let places = scores.iter_mut().zip(&truth).zip(&found.estimates);
            for ((score, truth), estimate) in places {
                let off = match estimate.scale {
                    maxwellid::Scale::Ratio => (estimate.value / truth).ln(),
                    maxwellid::Scale::Difference => estimate.value - truth,
                };
                *score = off / estimate.standard_error;
            }
            scores
        })
    }
    let truth = [virtual_tests::MODULUS, 0.3, 2.0, 60.0];
    let found = scores(&norton(60.0), 0.3, truth);
    let count = found.len() as f64;
    for parameter in 0..4 {
        let squares = found.iter().map(|scores| scores[parameter].powi(2));
        let mean = squares.sum::<f64>() / count;
        // 20 squares have a mean of 1 ± 0.32; three of them
        assert!((0.2..2.0).contains(&mean), "{parameter}: {mean} {found:?}");
    }
}

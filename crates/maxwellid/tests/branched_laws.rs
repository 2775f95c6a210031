//! Tests of nonlinear laws with an equilibrium: they are named where the data require them, and
//! their errors have the right size.

use crate::virtual_tests;

use maxwellid::selection::{Candidate, Comparison, Decision, Selection};
use maxwellid::{Estimate, Fit, Law, Noise, Scale};
use rodwave::inelastic::{InelasticLaw, MaxwellNorton};
use rodwave::modulus::{GeneralisedMaxwell, MaxwellBranch};
use testbed::noise::draws;
use virtual_tests::{
    Exact, MODULUS, beside_a_branch, by_the_chain, constant_q_stack, in_parallel, noisy,
    with_spring,
};

/// Noise divided by V0. With 1 % the law without a spring has a probability of 6 % in one draw, so
/// that it is not excluded.
const NOISE: f64 = 0.005;

fn norton(rate: f64) -> MaxwellNorton {
    MaxwellNorton::from_reference_rate(2.0, rate, 10e6).unwrap()
}

/// Error of an estimate divided by its standard error.
fn score(estimate: &Estimate, truth: f64) -> f64 {
    let off = match estimate.scale {
        Scale::Ratio => (estimate.value / truth).ln(),
        Scale::Difference => estimate.value - truth,
    };
    off / estimate.standard_error
}

/// Returns a rod of one law at 3 and at 27 m/s.
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

/// Checks that the law of a solid with 0.3 or 0.6 of the modulus in the spring is named. With 0.6
/// Norton's law alone has an adequacy of some per cent, and would be named if no candidate had an
/// equilibrium.
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

/// Checks that a law without a spring is named, or remains in question together with the law that
/// contains it.
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

/// Checks that the mean square of error over standard error of each parameter is about 1 over 20
/// draws.
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
                *score = self::score(estimate, *truth);
            }
            scores
        })
    }
    let truth = [MODULUS, 0.3, 2.0, 60.0];
    let found = scores(&norton(60.0), 0.3, truth);
    let count = found.len() as f64;
    for parameter in 0..4 {
        let squares = found.iter().map(|scores| scores[parameter].powi(2));
        let mean = squares.sum::<f64>() / count;
        // tolerance: the mean of 20 squares has a standard deviation of 0.32
        assert!((0.2..2.0).contains(&mean), "{parameter}: {mean} {found:?}");
    }
}

/// Checks the errors of the quantities in `truths` over 4 draws, for the linear `material` in
/// parallel with a Norton branch of modulus [`MODULUS`], computed by `rodwave::line` at two
/// velocities.
fn check_beside_a_branch(material: &GeneralisedMaxwell, law: Law, truths: &[(&str, f64)]) {
    let branch = (MODULUS, norton(60.0));
    let exact = at_two_velocities(|velocity| beside_a_branch(material, branch, velocity));
    let seeds: Vec<u64> = (0..draws(4)).collect();
    let found = in_parallel(&seeds, |seed| {
        let noisy = |(exact, k)| noisy(exact, NOISE, 300 + 2 * seed + k);
        let tests: Vec<_> = exact.iter().zip(0..).map(noisy).collect();
        let fit = Fit::of(law).with_cell(4e-3).to(&tests).unwrap();
        let estimates = fit.identifiability(Noise::Stated).unwrap().estimates;
        let of = |(symbol, truth): &(&str, f64)| {
            let mut all = estimates.iter();
            score(all.find(|one| one.symbol == *symbol).unwrap(), *truth)
        };
        truths.iter().map(of).collect::<Vec<_>>()
    });
    for (index, (symbol, _)) in truths.iter().enumerate() {
        let squares = found.iter().map(|scores| scores[index].powi(2));
        let mean = squares.sum::<f64>() / found.len() as f64;
        // tolerance: the mean of four squares has a standard deviation of 0.71, and the limit is 1
        // plus three of these
        assert!(mean < 3.1, "{law:?}, {symbol}: {mean} {found:?}");
    }
}

/// Checks a flat loss factor of 0.05, simulated with 22 branches. E is not compared, because the
/// branches of the simulation and of the law end at different frequencies.
#[test]
fn a_flat_loss_beside_a_nonlinear_branch_is_recovered() {
    let truths = [("tan delta", 0.05), ("kappa", 2.0), ("F(10 MPa)", 60.0)];
    check_beside_a_branch(&constant_q_stack(0.05), Law::FlatLossAndNorton, &truths);
}

/// Checks a spring, a linear branch with a relaxation time of 20 us and Norton's branch in
/// parallel.
#[test]
fn an_equilibrium_a_fast_branch_and_a_nonlinear_one_are_recovered() {
    let fast = MaxwellBranch {
        modulus: 0.5 * MODULUS,
        relaxation_time: 2e-5,
    };
    let material = GeneralisedMaxwell::new(1.5 * MODULUS, vec![fast]).unwrap();
    let truths = [
        ("E", 3.0 * MODULUS),
        ("w_0", 0.5),
        ("w_1", 0.5 / 3.0),
        ("tau_1", 2e-5),
        ("kappa", 2.0),
        ("F(10 MPa)", 60.0),
    ];
    check_beside_a_branch(&material, Law::ZhuWangTangNorton, &truths);
}

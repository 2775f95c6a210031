//! Tests of the starts, of the convergence of χ², and of the choice between minima.

use rodwave::inelastic::{Elastic, Maxwell};

use super::*;
use crate::catalogue::Law;
use crate::selection::Ground;
use crate::selection::tests::test_of;

#[test]
fn a_misfit_is_settled_by_a_hundredth_of_evidence_or_a_ten_thousandth_of_itself() {
    assert!(is_settled(100.0, 100.019) && !is_settled(100.0, 100.021));
    assert!(is_settled(100.021, 100.002) && !is_settled(100.021, 100.0));
    assert!(is_settled(10_000.0, 10_000.9) && !is_settled(10_000.0, 10_001.1));
}

/// Checks that with a very high noise level the misfit of a start is that of the prior alone, 2² at
/// two standard deviations, and that the misfit of the records is inversely proportional to the
/// square of the noise level.
#[test]
fn a_start_is_judged_by_the_records_and_by_the_prior() {
    let test = test_of(&Elastic, 0.005, 3);
    let ground = Ground::of(std::slice::from_ref(&test)).unwrap();
    let candidate = Candidate::of(Law::Elastic);
    let prior = candidate.prior(ground.modulus, ground.duration);
    let start = [prior.mean[0] + 2.0 * prior.deviation[0]];
    let contest = Contest::of(
        &candidate,
        &prior,
        (std::slice::from_ref(&test), &ground.times),
        8e-3,
    );
    let misfit = |level: f64| contest.rough_misfit(&start, &[level]).unwrap();
    assert!((misfit(1e9) - 4.0).abs() < 1e-9);
    let ratio = (misfit(0.1) - 4.0) / (misfit(0.2) - 4.0);
    assert!((ratio - 4.0).abs() < 1e-9, "{ratio}");
    // at the start the pulse of 8 m/s arrives at a wrong time, at the true modulus at the right
    // time
    let at_truth = contest.rough_misfit(&[3e9_f64.ln()], &[0.1]).unwrap();
    let at_start = misfit(0.1);
    assert!(at_truth < 0.1 * at_start, "{at_truth} {at_start}");
}

/// Checks that a special case from which no better minimum is found does not replace the result,
/// even if its stated χ² is 0, and that no search starts from a case whose stated χ² is not below
/// the result.
#[test]
fn the_likeliest_parameters_are_those_of_the_least_misfit() {
    let tests = [test_of(&Maxwell::new(1.5e6).unwrap(), 0.005, 20)];
    let ground = Ground::of(&tests).unwrap();
    let candidate = Candidate::of(Law::Maxwell);
    let prior = candidate.prior(ground.modulus, ground.duration);
    let contest = Contest::of(&candidate, &prior, (&tests, &ground.times), 8e-3);
    let truth = vec![3e9_f64.ln(), (1.5e6_f64 / 3e9).ln()];
    let probable = contest.from(&truth).unwrap().unwrap();
    let alone = contest.likeliest(&probable, &[]).unwrap().unwrap();
    let limiting = |parameters: Vec<f64>, chi_square: f64| Limiting {
        parameters,
        chi_square,
        probable: Some(&probable),
    };
    let promised = [limiting(truth.clone(), 0.0)];
    let found = contest.likeliest(&probable, &promised).unwrap().unwrap();
    assert_eq!(found.of_case, None);
    // the same minimum from two starts; tolerance: each is found to 1e-6 of χ²
    assert!((found.chi_square - alone.chi_square).abs() < 2.0 * REDUCTION * alone.chi_square);
    for (a, b) in found.parameters.iter().zip(&alone.parameters) {
        assert!((a - b).abs() < 1e-4, "{a} {b}");
    }
    // no search starts from this case, whose stated χ² is that of the result
    let worse = [limiting(vec![0.0, 0.0], alone.chi_square)];
    let found = contest.likeliest(&probable, &worse).unwrap().unwrap();
    assert_eq!(found.parameters, alone.parameters);
}

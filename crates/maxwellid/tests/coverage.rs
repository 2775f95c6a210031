//! Intervals of 95 % cover the truth: 200 virtual tests of each law, of another solver, with noise on both histories.

use crate::virtual_rod;

use maxwellid::{Fit, IdentifiableLaw, Noise, RodModel, RodTest};
use rodwave::inelastic::{Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};
use virtual_rod::{V0, struck};

const LENGTH: f64 = 0.4;
/// Noise of either history: 1 % of V0.
const NOISE: f64 = 0.1;
const SEEDS: u64 = 200;

/// Of the θ of `truth`, the share of tests whose interval covers it, the mean error in standard errors, and its mean square.
fn coverage<L: IdentifiableLaw>(modulus: f64, truth: &L, start: &L) -> Vec<(f64, f64, f64)> {
    let rod = struck(LENGTH, V0, modulus, truth, 88);
    let expected = RodModel::stated(truth, &RodModel::parameters(truth, modulus));
    let mut counts = vec![(0.0, 0.0, 0.0); expected.len()];
    for seed in 0..SEEDS {
        let test = RodTest::new(rod.noisy(NOISE, seed))
            .unwrap()
            .with_noise(NOISE, NOISE)
            .unwrap();
        // of this smooth excitation the error on a grid of 8 mm is below a third of a standard error, 0.01 · 0.3/√104
        let fit = Fit::of(start.clone()).with_cell(8e-3).to(&[test]).unwrap();
        assert!(fit.grid_difference() < 3e-4, "{}", fit.grid_difference());
        assert!(fit.termination().was_successful(), "seed {seed}");
        let judged = fit.identifiability(Noise::Stated).unwrap();
        for ((estimate, truth), count) in judged.estimates.iter().zip(&expected).zip(&mut counts) {
            let (low, high) = estimate.interval_95();
            let error = match estimate.scale {
                maxwellid::Scale::Ratio => (estimate.value / truth.value).ln(),
                maxwellid::Scale::Difference => estimate.value - truth.value,
            } / estimate.standard_error;
            count.0 += f64::from(u8::from(low <= truth.value && truth.value <= high));
            count.1 += error;
            count.2 += error * error;
        }
    }
    let n = SEEDS as f64;
    counts
        .into_iter()
        .map(|(covered, sum, squares)| (covered / n, sum / n, squares / n))
        .collect()
}

/// 200 tests of a probability 0.95 have a standard deviation of 1.5 %: the aim of 3 % is two of them. The errors in standard errors also
/// have to be those of a normal distribution: a mean of 0 to 0.3, since the noise of the excitation must not bias, and a mean square
/// of 1 to 0.4.
fn assert_covered(name: &str, coverage: &[(f64, f64, f64)]) {
    for (covered, mean, mean_square) in coverage {
        assert!((covered - 0.95).abs() <= 0.03, "{name}: {coverage:.3?}");
        assert!(mean.abs() < 0.3, "{name}: {coverage:.3?}");
        assert!((mean_square - 1.0).abs() < 0.4, "{name}: {coverage:.3?}");
    }
}

#[test]
fn maxwell_is_covered() {
    let truth = Maxwell::new(4e6).unwrap();
    let found = coverage(3.0e9, &truth, &Maxwell::new(1e6).unwrap());
    assert_covered("Maxwell", &found);
}

#[test]
fn norton_is_covered() {
    let truth = MaxwellNorton::new(2.108, 7e13).unwrap();
    let start = MaxwellNorton::from_reference_rate(1.2, 1.0, 10e6).unwrap();
    assert_covered("Norton", &coverage(2.58e9, &truth, &start));
}

#[test]
fn gurevich_rabinovich_is_covered() {
    let truth = MaxwellGurevichRabinovich::new(3.5e6, 7.08e6).unwrap();
    let start = MaxwellGurevichRabinovich::from_reference_rate(0.2, 1.0, 10e6).unwrap();
    assert_covered("Gurevich-Rabinovich", &coverage(2.107e9, &truth, &start));
}

/// The parameters of polypropylene as Table 4 prints them, read literally: an elastic rod. What the noise of both histories makes of it is
/// no law: where the search ends at its bound, nothing but E is identified.
#[test]
fn noise_on_both_histories_is_no_law() {
    let truth = MaxwellNorton::new(2.108, 38.16e18).unwrap();
    let rod = struck(LENGTH, V0, 2.58e9, &truth, 88);
    let start = MaxwellNorton::from_reference_rate(1.2, 1.0, 10e6).unwrap();
    let mut at_bound = 0;
    let mut named = 0;
    for seed in 0..40 {
        let test = RodTest::new(rod.noisy(NOISE, seed))
            .unwrap()
            .with_noise(NOISE, NOISE)
            .unwrap();
        let fit = Fit::of(start).with_cell(8e-3).to(&[test]).unwrap();
        at_bound += usize::from(!fit.termination().was_successful());
        let judged = fit.identifiability(Noise::Stated).unwrap();
        named += usize::from(
            judged
                .estimates
                .iter()
                .skip(1)
                .any(|estimate| estimate.verdict == maxwellid::Verdict::Identified),
        );
    }
    assert!(at_bound > 0, "no fit ends at a bound");
    assert_eq!(named, 0);
}

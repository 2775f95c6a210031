//! Tests of quantities on which an identification must not depend.

use maxwellid::selection::{Candidate, Selection};
use maxwellid::{Fit, Identification, Law, RodModel, RodTest};
use rodwave::inelastic::{Maxwell, MaxwellNorton};

use super::{MODULUS, data, excitation, test_of};

fn maxwell() -> Maxwell {
    Maxwell::from_reference_rate(20.0, 10e6).unwrap()
}

/// Two tests of a rod, whose response has a disturbance that differs from sample to sample.
fn tests() -> Vec<RodTest> {
    [10.0, 16.0]
        .map(|velocity| {
            let model = maxwell();
            let exact = test_of(&model, &model.parameters(MODULUS), velocity);
            let length = excitation(velocity).len();
            let mut response: Vec<f64> = exact.response().to_vec();
            response.resize(length, response[response.len() - 1]);
            for (k, v) in response.iter_mut().enumerate().skip(1) {
                *v += 0.01 * velocity * (1.7 * (k * k) as f64).sin();
            }
            RodTest::new(data(velocity, response)).unwrap()
        })
        .to_vec()
}

fn with_noise(tests: &[RodTest]) -> Vec<RodTest> {
    tests
        .iter()
        .zip([10.0, 16.0])
        .map(|(test, velocity)| {
            test.clone()
                .with_noise(0.007 * velocity, 0.007 * velocity)
                .unwrap()
        })
        .collect()
}

fn fitted(tests: &[RodTest]) -> Identification<Maxwell> {
    Fit::of(maxwell()).with_cell(8e-3).to(tests).unwrap()
}

/// Checks that the order of the tests changes the parameters only by rounding.
#[test]
fn the_order_of_tests_is_lost_in_rounding() {
    let there = tests();
    let back: Vec<RodTest> = there.iter().rev().cloned().collect();
    for (there, back) in [
        (there.clone(), back.clone()),
        (
            with_noise(&there),
            back.iter().rev().cloned().collect::<Vec<_>>(),
        ),
    ] {
        let back = if there[0].noise().is_some() {
            let mut noisy = with_noise(&back);
            noisy.reverse();
            noisy
        } else {
            back
        };
        let (a, b) = (fitted(&there), fitted(&back));
        for (a, b) in a.parameters().iter().zip(b.parameters()) {
            // tolerance: the iteration ends where the sum of squares no longer falls, which
            // determines half of the digits of the parameters
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
    }
}

/// Checks that the parameters of a linear law do not change if all velocities are twice as large.
#[test]
fn the_unit_of_velocity_is_no_part_of_a_linear_law() {
    let plain = fitted(&tests());
    let scaled: Vec<RodTest> = tests()
        .iter()
        .zip([10.0, 16.0])
        .map(|(test, velocity)| {
            let mut response: Vec<f64> = test.response().iter().map(|v| 2.0 * v).collect();
            response.resize(excitation(velocity).len(), response[response.len() - 1]);
            RodTest::new(data(2.0 * velocity, response)).unwrap()
        })
        .collect();
    for (a, b) in plain.parameters().iter().zip(fitted(&scaled).parameters()) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
}

/// Checks that no digit depends on the number of threads: results of several threads are collected
/// in the order of their items.
#[cfg(feature = "rayon")]
#[test]
fn one_thread_and_many_give_the_same_digits() {
    let noisy = with_noise(&tests());
    let norton = MaxwellNorton::from_reference_rate(1.5, 10.0, 10e6).unwrap();
    let candidates = || {
        vec![
            Candidate::of(Law::Elastic),
            Candidate::inelastic(maxwell(), &[]).unwrap(),
        ]
    };
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let fit = Fit::of(norton)
                .with_cell(8e-3)
                .with_starts(3)
                .to(&noisy)
                .unwrap();
            let comparison = Selection::new(candidates())
                .unwrap()
                .with_cell(8e-3)
                .unwrap()
                .compare(&noisy)
                .unwrap();
            let residuals: Vec<u64> = fit.residuals().flatten().map(|r| r.to_bits()).collect();
            let parameters: Vec<u64> = fit.parameters().iter().map(|p| p.to_bits()).collect();
            (
                parameters,
                residuals,
                fit.starts().to_vec(),
                format!("{comparison:?}"),
            )
        })
    };
    let one = run(1);
    for threads in [2, 5] {
        assert!(run(threads) == one, "{threads} threads");
    }
}

#[cfg(not(feature = "rayon"))]
#[test]
fn a_selection_repeats_itself() {
    let noisy = with_noise(&tests());
    let run = || {
        let candidates = vec![
            Candidate::of(Law::Elastic),
            Candidate::inelastic(maxwell(), &[]).unwrap(),
        ];
        Selection::new(candidates)
            .unwrap()
            .with_cell(8e-3)
            .unwrap()
            .compare(&noisy)
            .unwrap()
    };
    assert_eq!(format!("{:?}", run()), format!("{:?}", run()));
    let norton = MaxwellNorton::from_reference_rate(1.5, 10.0, 10e6).unwrap();
    assert!(Fit::of(norton).with_cell(8e-3).to(&noisy).is_ok());
}

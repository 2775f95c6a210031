//! Random materials, rods, noise, frequencies and gaps, to search for lines that are silently
//! wrong.

use std::cell::Cell;
use std::ops::Range;

use cmod::branch::{BranchDoubt, BranchTracker, FreeEnd, PhaseObservation, PhaseRecord};
use num_complex::Complex64;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::rig::{Clean, Rod};
use crate::materials::flat;

/// Creates a runner with the same cases on every run. The confidence required of a line allows one
/// wrong line in 10 000, so with random cases one run in many would fail.
fn runner(cases: u32) -> TestRunner {
    TestRunner::new_with_rng(
        Config::with_cases(cases),
        TestRng::deterministic_rng(RngAlgorithm::ChaCha),
    )
}

fn rods() -> impl Strategy<Value = Rod> {
    (0.1..1.0, 0.008..0.02, 900.0..1300.0, 0.0..5e-3).prop_map(
        |(length, diameter, density, accelerometer)| Rod {
            length,
            diameter,
            density,
            accelerometer,
        },
    )
}

/// Increasing frequencies from `first_hz`, with steps between half and twice the mean step, and one
/// long gap.
fn frequencies(first_hz: f64, step_hz: f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut f = first_hz;
    (0..400)
        .map(|j| {
            f += step_hz * (0.5 + 1.5 * random.random::<f64>());
            if j == 150 {
                f += 30.0 * step_hz * random.random::<f64>();
            }
            f
        })
        .collect()
}

#[test]
fn no_line_is_silently_wrong() {
    let strategy = (
        rods(),
        (0.002..0.3, 0.0..0.08, 0.0..0.4),
        (0.0..4000.0, 5.0..60.0),
        any::<u64>(),
    );
    runner(160)
        .run(
            &strategy,
            |(rod, (loss, noise, missing), (first, step), seed)| {
                let clean = Clean::of(
                    &flat(rod.density, loss),
                    rod,
                    frequencies(first, step, seed),
                );
                let measured = clean.measured(noise, missing, seed);
                let lines = &measured.tracked(&BranchTracker::new(), &clean).records[0];
                for line in lines {
                    prop_assert!(line.expected.im.is_finite());
                    prop_assert!((0.0..=1.0).contains(&line.confidence));
                }
                prop_assert_eq!(measured.silently_wrong(&clean, lines), None);
                Ok(())
            },
        )
        .unwrap();
}

/// Arbitrary input, including NaN and infinities, gives a result in which at most one line in fifty
/// has a root that is not doubted.
#[test]
fn numbers_without_meaning_are_not_believed() {
    let number = prop_oneof![
        12 => -2.0..2.0,
        1 => Just(f64::NAN),
        1 => Just(f64::INFINITY),
        1 => -1e300..1e300
    ];
    let pair = (number.clone(), number).prop_map(|(re, im)| Complex64::new(re, im));
    let strategy = (proptest::collection::vec(pair, 60), rods());
    let believed = Cell::new(0);
    let cases = 100;
    runner(cases)
        .run(&strategy, |(observed, rod)| {
            let lines: Vec<f64> = (1..=60).map(|j| 40.0 * f64::from(j)).collect();
            let mut clean = Clean::of(&flat(rod.density, 0.05), rod, lines);
            clean.ratio = observed;
            let measured = clean.measured(0.0, 0.0, 1);
            let tracked = measured.tracked(&BranchTracker::new(), &clean);
            for line in &tracked.records[0] {
                prop_assert!((0.0..=1.0).contains(&line.confidence));
                prop_assert!(line.root.is_none_or(|root| root.is_finite()));
                let is_believed = line.root.is_some() && line.doubt.is_none();
                believed.set(believed.get() + u32::from(is_believed));
            }
            Ok(())
        })
        .unwrap();
    // the limit is above 0, because the estimated noise may be as large as the signal, and some
    // material then fits a few lines
    assert!(believed.get() < 60 * cases / 50, "{}", believed.get());
}

/// Free end that counts the requests for roots.
struct Counting(Cell<usize>);

impl PhaseObservation for Counting {
    fn expand(&self, x: Complex64) -> [Complex64; 3] {
        FreeEnd.expand(x)
    }

    fn visit_roots(
        &self,
        observed: Complex64,
        phases: Range<f64>,
        visit: &mut dyn FnMut(Complex64),
    ) {
        FreeEnd.visit_roots(observed, phases, &mut |root| {
            self.0.set(self.0.get() + 1);
            visit(root);
        });
    }

    fn nearest_roots(&self, observed: Complex64, expected: Complex64) -> Option<[Complex64; 2]> {
        FreeEnd.nearest_roots(observed, expected)
    }
}

/// A mistyped frequency, 199999999999 Hz after 6 kHz, with 10^8 waves in between: this line
/// gets a low confidence, and the search does not try all counts.
#[test]
fn a_line_beyond_all_others_is_doubted_and_not_searched() {
    let counting = Counting(Cell::new(0));
    let track = |frequency_hz: &[f64]| {
        let phase =
            |f: f64| Complex64::new(0.03, 1.0) * (0.8 * 2.0 * std::f64::consts::PI * f / 1700.0);
        let observed: Vec<Complex64> = frequency_hz
            .iter()
            .map(|&f| phase(f.min(8000.0)).cosh())
            .collect();
        let variance = vec![1e-6; observed.len()];
        let record = PhaseRecord {
            observation: &counting,
            length: 0.8,
            frequency_hz,
            observed: &observed,
            variance: Some(&variance),
        };
        BranchTracker::new().track(&[record]).unwrap()
    };
    let mut frequency_hz: Vec<f64> = (1..=60).map(|line| 100.0 * f64::from(line)).collect();
    let alone = track(&frequency_hz);
    frequency_hz.push(199_999_999_999.0);
    let with_slip = track(&frequency_hz);
    for (line, other) in alone.records[0].iter().zip(&with_slip.records[0]) {
        assert_eq!(line.root, other.root);
        assert!(line.doubt.is_none() && other.doubt.is_none());
    }
    assert!(with_slip.records[0][60].confidence < 0.9);
    // an offset of 2e11 Hz on all frequencies
    let beyond: Vec<f64> = frequency_hz.iter().map(|f| f + 2e11).collect();
    let lost = track(&beyond[..60]);
    for line in &lost.records[0] {
        assert_eq!(line.doubt, Some(BranchDoubt::Undetermined));
    }
    // some 5500 roots for each of the 181 lines of the three records
    let visited = counting.0.get();
    assert!(visited < 1_000_000, "{visited} roots");
}

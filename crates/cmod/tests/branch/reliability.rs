//! Calibration of the confidence of lines: of the lines with a confidence of p, the fraction p is
//! right.

use std::f64::consts::TAU;

use cmod::branch::BranchTracker;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::rig::{ACCELEROMETER, Clean, Rod, is_right};
use crate::materials::flat;

/// Lower limits of the bins in which lines with a confidence of 0.5 or more are counted.
const EDGES: [f64; 6] = [0.5, 0.6, 0.7, 0.8, 0.9, 0.99];

/// Lines with a confidence in one bin, and sums over them.
#[derive(Default, Clone, Copy)]
struct Bin {
    count: f64,
    stated: f64,
    right: f64,
}

struct Reliability {
    bins: [Bin; EDGES.len()],
    expected_wrong: f64,
    wrong: f64,
}

impl Reliability {
    /// Checks that each bin has more than `least` lines, and that the fraction of right lines
    /// differs from the mean stated confidence by at most three standard errors plus the margin
    /// `below` or `above`.
    fn check(&self, least: f64, below: f64, above: f64) {
        for (edge, bin) in EDGES.iter().zip(&self.bins) {
            let (stated, right) = (bin.stated / bin.count, bin.right / bin.count);
            assert!(bin.count > least, "from {edge}: {} lines", bin.count);
            let scatter = 3.0 * (stated * (1.0 - stated) / bin.count).sqrt();
            assert!(
                stated - scatter - below < right && right < stated + scatter + above,
                "from {edge}: {right:.3} of {} lines are right, {stated:.3} stated",
                bin.count
            );
        }
    }
}

/// Collects the lines of records of random materials, rods, noise and gaps, in which kL advances
/// from line to line by an amount between two limits.
fn reliability(advance: (f64, f64), most_missing: f64, records: u64) -> Reliability {
    let mut random = ChaCha8Rng::seed_from_u64(1993);
    let mut found = Reliability {
        bins: [Bin::default(); EDGES.len()],
        expected_wrong: 0.0,
        wrong: 0.0,
    };
    for seed in 0..records {
        let mut between = |low: f64, high: f64| low * (high / low).powf(random.random::<f64>());
        let rod = Rod {
            length: between(0.2, 0.8),
            diameter: between(0.01, 0.02),
            density: between(900.0, 1200.0),
            accelerometer: ACCELEROMETER,
        };
        let medium = flat(rod.density, between(0.005, 0.05));
        // steps of kL, with c = 1600 m/s
        let step = between(advance.0, advance.1) * 1600.0 / (TAU * rod.length);
        let noise = between(0.01, 0.1);
        let missing = between(0.05, most_missing);
        let lines = (1..=500).map(|j| 300.0 + step * f64::from(j)).collect();
        let clean = Clean::of(&medium, rod, lines);
        let measured = clean.measured(noise, missing, seed);
        let observation = rod.observation();
        let tracked = measured.tracked(&BranchTracker::new(), &clean);
        for (line, (exact, observed)) in tracked.records[0]
            .iter()
            .zip(clean.exact.iter().zip(&measured.observed))
        {
            let Some(root) = line.root else { continue };
            let right = is_right(&observation, root, *exact, *observed);
            found.expected_wrong += 1.0 - line.confidence;
            found.wrong += f64::from(!right);
            let edge = EDGES.partition_point(|edge| *edge <= line.confidence);
            if let Some(bin) = edge
                .checked_sub(1)
                .and_then(|edge| found.bins.get_mut(edge))
            {
                bin.count += 1.0;
                bin.stated += line.confidence;
                bin.right += f64::from(right);
            }
        }
    }
    found
}

#[test]
fn of_lines_with_confidence_p_a_share_p_is_right() {
    let found = reliability((0.01, 0.05), 0.3, 600);
    // margins: the filter allows the modulus to vary more with frequency than it does in these
    // materials
    found.check(200.0, 0.05, 0.05);
    // ratio of the number of wrong lines to the sum of the probabilities of being wrong, over all
    // lines
    let ratio = found.wrong / found.expected_wrong;
    assert!((0.6..1.2).contains(&ratio), "{ratio}");
}

/// Confidences of lines that are far apart may be stated too low, but never too high: such lines
/// are smoothed only by the assumed variation of the slope, which is larger than that of these
/// materials.
#[test]
fn lines_far_apart_are_not_trusted_too_much() {
    let found = reliability((0.05, 0.4), 0.5, 400);
    found.check(100.0, 0.02, f64::INFINITY);
    assert!(found.wrong < 1.1 * found.expected_wrong);
}

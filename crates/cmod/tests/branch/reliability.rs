//! A stated confidence of p means that a share p is right.

use cmod::branch::BranchTracker;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::rig::{ACCELEROMETER, Clean, Rod, flat, is_right};

/// Records of random materials, rods, noise and gaps; lines sorted by their confidence.
#[test]
fn of_lines_with_confidence_p_a_share_p_is_right() {
    const EDGES: [f64; 6] = [0.5, 0.6, 0.7, 0.8, 0.9, 0.99];
    let mut random = ChaCha8Rng::seed_from_u64(1993);
    let mut table = [(0.0, 0.0, 0.0); EDGES.len()];
    let (mut expected_wrong, mut wrong) = (0.0, 0.0);
    for seed in 0..600 {
        let mut between = |low: f64, high: f64| low * (high / low).powf(random.random::<f64>());
        let rod = Rod {
            length: between(0.2, 0.8),
            diameter: between(0.01, 0.02),
            density: between(900.0, 1200.0),
            accelerometer: ACCELEROMETER,
        };
        let medium = flat(rod.density, between(0.005, 0.05));
        let step = between(10.0, 40.0);
        let noise = between(0.01, 0.1);
        let missing = between(0.05, 0.4);
        let lines = (1..=500).map(|j| 300.0 + step * f64::from(j)).collect();
        let clean = Clean::of(&medium, rod, lines);
        let measured = clean.measured(noise, missing, seed);
        let observation = rod.observation();
        let tracked = BranchTracker::new()
            .track(&[measured.record(&clean, &observation)])
            .unwrap();
        for (line, (exact, observed)) in tracked.records[0]
            .iter()
            .zip(clean.exact.iter().zip(&measured.observed))
        {
            let Some(root) = line.root else { continue };
            let right = is_right(&observation, root, *exact, *observed);
            expected_wrong += 1.0 - line.confidence;
            wrong += f64::from(!right);
            let bin = EDGES.partition_point(|edge| *edge <= line.confidence);
            if let Some(entry) = bin.checked_sub(1).and_then(|bin| table.get_mut(bin)) {
                entry.0 += 1.0;
                entry.1 += line.confidence;
                entry.2 += f64::from(right);
            }
        }
    }
    for (edge, (count, confidence, right)) in EDGES.iter().zip(table) {
        let (stated, found) = (confidence / count, right / count);
        assert!(count > 200.0, "from {edge}: {count} lines");
        // Three standard errors of a share, and 0.04 for the spread of the smooth curve, which the filter states with the
        // wandering that it allows any material, more than that of these.
        let tolerance = 3.0 * (stated * (1.0 - stated) / count).sqrt() + 0.04;
        assert!(
            (found - stated).abs() < tolerance,
            "from {edge}: {found:.3} of {count} lines are right, {stated:.3} stated"
        );
    }
    // All lines together: the number of wrong ones is the sum of their probabilities.
    assert!(
        (0.7..1.2).contains(&(wrong / expected_wrong)),
        "{wrong} wrong, {expected_wrong} expected"
    );
}

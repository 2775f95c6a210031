//! Anchors (a known wave speed, branch, wave number or second specimen) for lines that do not
//! determine the count of waves, and phases other than that of a free end.

use std::f64::consts::TAU;

use cmod::branch::{
    Branch, BranchDoubt, BranchTracker, EndMass, PhaseRecord, TrackedBranches, Travel,
};
use rodwave::chain::{Chain, Termination};
use rodwave::element::Circle;

use super::rig::{Clean, Measured, is_doubted, rods_of_paper_a};
use crate::materials::flat;

/// Returns Test 6 of paper A, restricted to 17 to 17.2 kHz: the lines begin above 15 half waves and
/// extend over a sixth of a half wave.
fn narrow_band() -> (Clean, Measured) {
    let rod = rods_of_paper_a()[5];
    let lines = (0..32).map(|j| 17_000.0 + 6.0 * f64::from(j)).collect();
    let clean = Clean::of(&flat(rod.density, 0.02), rod, lines);
    let measured = clean.measured(0.02, 0.1, 3);
    (clean, measured)
}

fn doubted(tracked: &TrackedBranches, record: usize) -> (usize, usize) {
    let lines = tracked.records[record]
        .iter()
        .filter(|line| line.root.is_some());
    let doubted = lines.clone().filter(|line| is_doubted(line));
    (doubted.count(), lines.count())
}

fn assert_counted(tracked: &TrackedBranches, clean: &Clean, record: usize) {
    for (line, exact) in tracked.records[record].iter().zip(&clean.exact) {
        assert!(
            (line.expected - exact).norm() < 0.3,
            "{line:?} instead of {exact}"
        );
    }
    let (doubted, all) = doubted(tracked, record);
    assert!(
        doubted < all / 4,
        "{doubted} of {all}, {:?}, {:?}",
        tracked.hypotheses,
        tracked.records[record][3]
    );
}

#[test]
fn a_narrow_band_behind_many_waves_is_doubted() {
    let (clean, measured) = narrow_band();
    let tracked = measured.tracked(&BranchTracker::new(), &clean);
    let (doubted, all) = doubted(&tracked, 0);
    assert_eq!(doubted, all);
    let several = |line: &&cmod::branch::TrackedLine| {
        matches!(line.doubt, Some(BranchDoubt::SeveralSpeeds { .. }))
    };
    assert!(
        tracked.records[0].iter().filter(several).count() > all / 2,
        "{:?}",
        tracked.hypotheses
    );
    // the right speed is among the hypotheses, and the sum of their probabilities is 1
    let speed = TAU * 17_000.0 * clean.rod.length / clean.exact[0].im;
    let sum: f64 = tracked.hypotheses.iter().map(|h| h.probability).sum();
    assert!((0.99..1.0 + 1e-12).contains(&sum), "{sum}");
    assert!(
        tracked
            .hypotheses
            .iter()
            .any(|h| (h.wave_speed / speed - 1.0).abs() < 0.02 && h.probability > 0.05),
        "{speed}: {:?}",
        tracked.hypotheses
    );
}

#[test]
fn a_wave_speed_decides() {
    let (clean, measured) = narrow_band();
    let speed = TAU * 17_000.0 * clean.rod.length / clean.exact[0].im;
    let tracker = BranchTracker::new()
        .with_wave_speed(1.01 * speed, 0.01)
        .unwrap();
    assert_counted(&measured.tracked(&tracker, &clean), &clean, 0);
    // a wave speed with a large error does not determine the count of waves
    let tracker = BranchTracker::new().with_wave_speed(speed, 0.3).unwrap();
    let tracked = measured.tracked(&tracker, &clean);
    let (doubted, all) = doubted(&tracked, 0);
    assert_eq!(doubted, all);
}

#[test]
fn a_known_branch_decides() {
    let (clean, measured) = narrow_band();
    let exact = clean.exact[10].im;
    let branch = Branch::in_quadrant((exact / std::f64::consts::FRAC_PI_2) as u32);
    let tracker = BranchTracker::new()
        .with_branch(clean.frequency_hz[10], branch, clean.rod.length)
        .unwrap();
    assert_counted(&measured.tracked(&tracker, &clean), &clean, 0);
    // the wave number at a frequency slightly below the band, for example from a resonance
    let k = flat(clean.rod.density, 0.02).wave_number(TAU * 16_800.0);
    let tracker = BranchTracker::new()
        .with_wave_number(16_800.0, k, 0.01 * k)
        .unwrap();
    assert_counted(&measured.tracked(&tracker, &clean), &clean, 0);
}

/// Tracks a second, shorter specimen of the same material, with fewer waves below the first line.
#[test]
fn two_lengths_decide_together() {
    let (long, seen_long) = narrow_band();
    let mut rod = rods_of_paper_a()[4];
    rod.density = long.rod.density;
    rod.length = 0.173;
    let short = Clean::of(&flat(rod.density, 0.02), rod, long.frequency_hz.clone());
    let seen_short = short.measured(0.02, 0.1, 4);
    let observations = [long.rod.observation(), short.rod.observation()];
    let together = BranchTracker::new()
        .track(&[
            seen_long.record(&long, &observations[0]),
            seen_short.record(&short, &observations[1]),
        ])
        .unwrap();
    assert_counted(&together, &long, 0);
    assert_counted(&together, &short, 1);
}

/// Tracks three lengths, each with its own lines, noise and gaps.
#[test]
fn records_of_any_lines_share_one_material() {
    let records: Vec<(Clean, Measured, EndMass)> = [3, 4, 5]
        .iter()
        .map(|test| {
            let mut rod = rods_of_paper_a()[*test];
            rod.density = 912.0;
            let step = 11.0 + *test as f64;
            let lines = (0..900).map(|j| 200.0 + step * f64::from(j)).collect();
            let clean = Clean::of(&flat(912.0, 0.07), rod, lines);
            let measured = clean.measured(0.05, 0.2, *test as u64);
            (clean, measured, rod.observation())
        })
        .collect();
    let views: Vec<PhaseRecord<'_>> = records
        .iter()
        .map(|(clean, measured, observation)| measured.record(clean, observation))
        .collect();
    let tracked = BranchTracker::new().track(&views).unwrap();
    for (index, (clean, measured, _)) in records.iter().enumerate() {
        let lines = &tracked.records[index];
        assert_eq!(lines.len(), 900);
        assert_eq!(measured.silently_wrong(clean, lines), None);
        let (doubted, all) = doubted(&tracked, index);
        assert!(doubted < all / 50, "{doubted} of {all}");
    }
}

/// Unwraps the phase of a wave that passes two sections of a long rod: velocities by the chain,
/// with Ψ = v₂/v₁ = e^{-γd}.
#[test]
fn the_phase_of_a_travelling_wave_is_unwrapped() {
    let medium = flat(912.0, 0.07);
    let section = Circle::of_diameter(0.016).unwrap();
    let distance = 0.6;
    let chain = Chain::from_impact_face()
        .rod(&medium, section, 1.0)
        .end(Termination::semi_infinite(&medium, section))
        .unwrap();
    // the first line has more than two waves over this distance
    let frequency_hz: Vec<f64> = (0..400).map(|j| 6_000.0 + 20.0 * f64::from(j)).collect();
    let observed = frequency_hz.iter().map(|f| {
        let velocity = |x: f64| {
            chain
                .section(0, x)
                .unwrap()
                .state(TAU * f)
                .unwrap()
                .velocity
        };
        velocity(0.2 + distance) / velocity(0.2)
    });
    let observed: Vec<_> = observed.collect();
    let variance: Vec<f64> = observed
        .iter()
        .map(|ratio| 1e-4 * ratio.norm_sqr())
        .collect();
    let tracked = BranchTracker::new()
        .track(&[PhaseRecord {
            observation: &Travel,
            length: distance,
            frequency_hz: &frequency_hz,
            observed: &observed,
            variance: Some(&variance),
        }])
        .unwrap();
    for (line, f) in tracked.records[0].iter().zip(&frequency_hz) {
        let exact = medium.propagation_coefficient(TAU * f) * distance;
        assert!((line.root.unwrap() - exact).norm() < 1e-10, "{f} Hz");
        assert_eq!(line.doubt, None);
        assert!(line.confidence > 0.9999);
    }
}

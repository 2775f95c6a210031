//! Pulses longer than the way from the gauge to the specimen and back, evaluated with two gauges, a
//! free end, or the force of the other face.

use impulse::hopkinson::{Finding, HopkinsonTest, WaveSeparation};
use testbed::hopkinson::HopkinsonRig;

use super::rig;

/// A pulse of 1.5 ms on nylon bars, longer than the transit time of a bar.
fn long_pulse(gauges: [Vec<f64>; 2]) -> HopkinsonRig {
    HopkinsonRig {
        gauges,
        pulse: [80e-6, 1.5e-3, 80e-6],
        force: 3.5e3,
        after: 3.5e-3,
        ..rig::nylon()
    }
}

/// Worst differences of stress and strain from the truth, relative to the largest value; duration
/// of the loading in the result \[s\]; findings.
fn worst(rig: &HopkinsonRig, change: impl Fn(&mut HopkinsonTest)) -> ([f64; 2], f64, Vec<Finding>) {
    let (specimen, diameter) = (rig::norton(), 0.014);
    let length = specimen.length();
    let truth = rig.shot(Some(specimen)).unwrap();
    let record = rig::record(&truth, &rig::quiet(rig, 1e-9), 2);
    let mut test = rig::test_of(rig, length, diameter);
    change(&mut test);
    let result = rig::evaluated(&test, &record);
    let time = result.loaded.len() as f64 * result.time_step;
    let worst = rig::worst(&truth, &result, length, diameter);
    (worst, time, result.findings)
}

#[test]
fn hopkinson_two_gauges_follow_overlapping_waves() {
    let rig = long_pulse([vec![1.1, 0.5], vec![0.3, 0.8]]);
    let (worst, time, _) = worst(&rig, |_| {});
    // tolerance: the march rounds wave speeds by 2e-4, over about ten passages between two gauges
    assert!(
        worst[0] < 0.02 && worst[1] < 0.02 && time > 1.3e-3,
        "{worst:?} {time}"
    );
}

#[test]
fn hopkinson_one_gauge_a_bar_with_a_free_end_goes_beyond_one_transit() {
    let rig = long_pulse([vec![0.5], vec![0.3]]);
    let (far, time, findings) = worst(&rig, |test| {
        test.separation = [WaveSeparation::Balanced, WaveSeparation::FreeEnd];
    });
    // tolerance: the forces of both faces are assumed equal, which neglects the transit through the
    // specimen
    assert!(
        far[0] < 0.05 && far[1] < 0.05 && time > 1.3e-3,
        "{far:?} {time}"
    );
    assert!(
        findings.contains(&Finding::EquilibriumSupposed),
        "{findings:?}"
    );

    // if the waves are separated by their arrivals at one gauge, the result is short and has a
    // finding
    let (_, short, findings) = worst(&rig, |_| {});
    assert!(short < 0.7e-3, "{short}");
    assert!(
        findings.iter().any(|f| matches!(f, Finding::Overlap { .. })
            && f.forbids()
            && f.to_string().contains("a second gauge")),
        "{findings:?}"
    );
}

//! Bars, specimens and evaluations of the tests.

use std::sync::Arc;

use impulse::hopkinson::{
    BarGauge, BarMaterial, Curve, HopkinsonBar, HopkinsonRecord, HopkinsonResult, HopkinsonTest,
    Known, Loading, StressFrom, TestSpecimen, WaveSeparation,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rodwave::inelastic::{Elastic, MaxwellNorton};
use rodwave::line::Segment;
use rodwave::modulus::GeneralisedMaxwell;
use testbed::hopkinson::{HopkinsonRig, HopkinsonTruth, RecorderErrors};

/// Sampling rate of the virtual recorder \[Hz\].
pub(crate) const RATE: f64 = 1e6;

pub(crate) fn nylon() -> HopkinsonRig {
    HopkinsonRig::nylon().unwrap()
}

/// Bars of steel.
pub(crate) fn steel() -> HopkinsonRig {
    HopkinsonRig {
        law: GeneralisedMaxwell::new(206e9, Vec::new()).unwrap(),
        density: 7800.0,
        diameter: 0.02,
        lengths: [1.8, 1.6],
        gauges: [vec![0.7], vec![0.4]],
        pulse: [40e-6, 180e-6, 40e-6],
        force: 60e3,
        step: 0.25e-6,
        before: 100e-6,
        after: 0.75e-3,
    }
}

/// A specimen 6 mm long and 14 mm in diameter, whose creep rate is a power of the stress.
pub(crate) fn norton() -> Segment {
    let law = MaxwellNorton::from_reference_rate(4.0, 300.0, 25e6).unwrap();
    Segment::new(0.006, area(0.014), 1100.0)
        .unwrap()
        .with_branch(1.2e9, law)
        .unwrap()
}

/// A metal specimen 5 mm long and 10 mm in diameter, with a yield stress that increases with strain
/// and strain rate.
pub(crate) fn hardening() -> Segment {
    let law = MaxwellNorton::from_reference_rate(20.0, 1000.0, 200e6).unwrap();
    Segment::new(0.005, area(0.010), 2700.0)
        .unwrap()
        .with_branch(68e9, law)
        .unwrap()
        .with_branch(1.5e9, Elastic)
        .unwrap()
}

/// A specimen of soft plastic 6 mm long and 14 mm in diameter, with a yield stress that increases
/// with strain and strain rate.
pub(crate) fn soft_hardening() -> Segment {
    let law = MaxwellNorton::from_reference_rate(15.0, 500.0, 15e6).unwrap();
    Segment::new(0.006, area(0.014), 1200.0)
        .unwrap()
        .with_branch(2e9, law)
        .unwrap()
        .with_branch(60e6, Elastic)
        .unwrap()
}

pub(crate) fn area(diameter: f64) -> f64 {
    0.25 * std::f64::consts::PI * diameter * diameter
}

/// The test of a rig with its exact properties and a specimen of this length and diameter.
pub(crate) fn test_of(rig: &HopkinsonRig, length: f64, diameter: f64) -> HopkinsonTest {
    let material = BarMaterial::new(rig.density, Arc::new(rig.law.clone())).unwrap();
    let bar = |at: usize| HopkinsonBar {
        material: material.clone(),
        diameter: Known::exactly(rig.diameter),
        length: Known::exactly(rig.lengths[at]),
        poisson_ratio: None,
        gauges: rig.gauges[at].iter().map(|d| BarGauge::at(*d)).collect(),
    };
    let separation = |at: usize| match rig.gauges[at].len() {
        1 => WaveSeparation::Windows,
        _ => WaveSeparation::TwoGauges,
    };
    HopkinsonTest {
        bars: [bar(0), bar(1)],
        specimen: TestSpecimen {
            length: Known::exactly(length),
            diameter: Known::exactly(diameter),
            wall: None,
        },
        loading: Loading::Compression,
        separation: [separation(0), separation(1)],
        stress: StressFrom::Both,
        band_hz: None,
        align_arrivals: false,
        monte_carlo: None,
        variations: Vec::new(),
    }
}

/// A recorder without systematic errors, with this standard deviation of its strain noise.
pub(crate) fn quiet(rig: &HopkinsonRig, noise: f64) -> RecorderErrors {
    let gains = |at: usize| vec![1.0; rig.gauges[at].len()];
    RecorderErrors {
        gains: [gains(0), gains(1)],
        delays: [0.0; 2],
        noise,
        converter_step: 0.0,
    }
}

pub(crate) fn record(
    truth: &HopkinsonTruth,
    errors: &RecorderErrors,
    seed: u64,
) -> HopkinsonRecord {
    HopkinsonRecord {
        rate_hz: RATE,
        gauges: truth.recorded(RATE, errors, seed),
        // the pulse reaches no gauge before this time
        silent: (0.9 * truth.before * RATE) as usize,
    }
}

pub(crate) fn evaluated(test: &HopkinsonTest, record: &HopkinsonRecord) -> HopkinsonResult {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    test.evaluate(record, &mut random).unwrap()
}

/// The sample in the middle of the loading.
pub(crate) fn middle(result: &HopkinsonResult) -> usize {
    result.loaded.start + result.loaded.len() / 2
}

/// Largest differences of stress and strain from the truth over the loaded time, relative to the
/// largest value.
pub(crate) fn worst(
    truth: &HopkinsonTruth,
    result: &HopkinsonResult,
    length: f64,
    diameter: f64,
) -> [f64; 2] {
    let exact_strain = truth.strain(length);
    let (mut worst, mut largest) = ([0.0_f64; 2], [0.0_f64; 2]);
    for at in result.loaded.clone() {
        let time = result.time_at(at);
        let [f1, f2] = [0, 1].map(|face| truth.seen(&truth.force[face], RATE, time));
        let exact = [
            0.5 * (f1 + f2) / area(diameter),
            truth.seen(&exact_strain, RATE, time),
        ];
        let found = [Curve::Stress, Curve::Strain].map(|curve| result.curves.of(curve)[at]);
        for i in 0..2 {
            worst[i] = worst[i].max((found[i] - exact[i]).abs());
            largest[i] = largest[i].max(exact[i].abs());
        }
    }
    [worst[0] / largest[0], worst[1] / largest[1]]
}

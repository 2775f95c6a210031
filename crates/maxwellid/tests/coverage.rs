//! Intervals of 95 % cover the truth: 200 virtual tests of each law, of another solver, with noise on both histories.
#![allow(
    clippy::unwrap_used,
    clippy::cast_precision_loss,
    reason = "a failing test should say so at once, and counts are small"
)]

use maxwellid::{Fit, IdentifiableLaw, Noise, Provenance, RodModel, RodTest, RodTestData};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use rodwave::InelasticRod;
use rodwave::band_limited::Recorder;
use rodwave::experiment::Acquisition;
use rodwave::impact::{ImpactTest, Striker};
use rodwave::inelastic::{Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};
use rodwave::lumped::{self, LumpedRod};

const LENGTH: f64 = 0.4;
const DENSITY: f64 = 1100.0;
const V0: f64 = 10.0;
/// Noise of either history: 1 % of V0.
const NOISE: f64 = 0.1;
const SEEDS: u64 = 200;

/// A noise-free test: the excitation that the striker gives through the recorder, and the chain's response to just that, from two
/// grids extrapolated.
fn noise_free<L: IdentifiableLaw>(modulus: f64, law: &L) -> RodTestData {
    let record = ImpactTest {
        striker: Striker::PAPER_D,
        rod: InelasticRod::new(LENGTH + 0.008, DENSITY, modulus, law.clone()).unwrap(),
        diameter: 0.016,
        section_distance: LENGTH,
    }
    .record(
        &Acquisition {
            recorder: Recorder {
                rate_hz: 51_200.0,
                cutoff_hz: 16_000.0,
            },
            samples_before: 32,
            samples_after: 88,
            transducer_range: 0.02,
        },
        1e-3,
    )
    .unwrap();
    let times: Vec<f64> = (0..record.excitation.len())
        .map(|k| k as f64 / record.sampling_rate_hz)
        .collect();
    let rod = InelasticRod::new(LENGTH, DENSITY, modulus, law.clone()).unwrap();
    let chain = |cells| {
        LumpedRod::new(&rod, cells, 0.5)
            .unwrap()
            .free_end_velocity(&record.excitation_before_sampling, &times)
            .unwrap()
    };
    let response = chain(300)
        .iter()
        .zip(chain(600))
        .map(|(coarse, fine)| fine + (fine - coarse) / 3.0)
        .collect();
    RodTestData {
        name: "virtual rod".into(),
        length: LENGTH,
        density: DENSITY,
        impact_velocity: V0,
        sampling_rate_hz: record.sampling_rate_hz,
        excitation: record.excitation,
        response,
        provenance: Provenance::Virtual {
            generator: lumped::GENERATOR.into(),
        },
    }
}

/// Of the θ of `truth`, the share of tests whose interval covers it, the mean error in standard errors, and its mean square.
fn coverage<L: IdentifiableLaw>(modulus: f64, truth: &L, start: &L) -> Vec<(f64, f64, f64)> {
    let data = noise_free(modulus, truth);
    let expected = RodModel::stated(truth, &RodModel::parameters(truth, modulus));
    let white = Normal::new(0.0, NOISE).unwrap();
    let mut counts = vec![(0.0, 0.0, 0.0); expected.len()];
    for seed in 0..SEEDS {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        let mut noisy = data.clone();
        for v in noisy.excitation.iter_mut().chain(&mut noisy.response) {
            *v += white.sample(&mut generator);
        }
        let test = RodTest::new(noisy)
            .unwrap()
            .with_noise(NOISE, NOISE)
            .unwrap();
        let fit = Fit::of(start.clone()).to(&[test]).unwrap();
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

fn assert_covered(name: &str, coverage: &[(f64, f64, f64)]) {
    eprintln!("{name}: {coverage:.3?}");
    for (covered, _, _) in coverage {
        assert!((covered - 0.95).abs() <= 0.03, "{name}: {coverage:.3?}");
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

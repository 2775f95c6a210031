//! Virtual measurements of the loss factor. They are computed by integrating the dashpot, not by
//! the closed form that is fitted to them.

use cmod::recovery::{LossFactorReadings, RecoveryTest};

use super::super::Error;
use testbed::noise::Noise;
use testbed::papers::paper_c::PaperC;

/// Recovery times of the measurements, in s.
pub(crate) const TIMES: [f64; 12] = [
    60.0, 120.0, 200.0, 300.0, 450.0, 700.0, 1100.0, 1800.0, 3000.0, 5000.0, 9000.0, 18000.0,
];

/// Standard error of a loss factor: 5 % of the loss factor of the virgin material, which is about
/// the scatter of Figure 2.
pub(crate) const STANDARD_ERROR: f64 = 1.25e-3;

pub(crate) const SEED: u64 = 1993;

/// Returns the strain of the dashpot, and of the spring parallel to it, after `duration` under
/// `stress`, starting from `strain`; by the midpoint rule.
fn march(paper: &PaperC, mut strain: f64, stress: f64, duration: f64) -> f64 {
    let rate = |strain: f64| {
        let of_dashpot = stress - paper.parallel_modulus * strain;
        paper.coefficient * of_dashpot.abs().powf(paper.exponent) * of_dashpot
    };
    let steps = 5000_u32;
    let h = duration / f64::from(steps);
    for _ in 0..steps {
        strain += h * rate(strain + 0.5 * h * rate(strain));
    }
    strain
}

/// Returns the creep tests, with noisy loss factors.
pub(crate) fn of_creep_tests(paper: &PaperC) -> Result<Vec<RecoveryTest>, Error> {
    let mut random = Noise::seeded(SEED);
    let mut tests = Vec::new();
    for load in &paper.tests {
        if load.stress_amplitude.is_some() {
            continue;
        }
        let mut strain = march(paper, 0.0, load.mean_stress, load.duration);
        let mut before = 0.0;
        let mut change = Vec::new();
        for t in TIMES {
            strain = march(paper, strain, 0.0, t - before);
            before = t;
            let fluidity = paper.coefficient
                * (paper.exponent + 1.0)
                * (paper.parallel_modulus * strain).powf(paper.exponent);
            change.push(
                paper.series_modulus * fluidity / paper.omega() + STANDARD_ERROR * random.normal(),
            );
        }
        tests.push(RecoveryTest::new(
            format!("Test {}", load.test),
            paper.load_history(load)?,
            paper.frequency_hz,
            LossFactorReadings {
                time: &TIMES,
                change: &change,
                standard_error: &[STANDARD_ERROR; TIMES.len()],
                virgin_standard_error: 0.0,
            },
        )?);
    }
    Ok(tests)
}

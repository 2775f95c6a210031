//! Loss factor of polyoximethylene after the creep loads of paper C: noisy readings and the joint
//! fit of all tests.
//!
//! ```text
//! cargo run --release --package cmod --example creep_recovery_of_pom
//! ```
//!
//! The program prints what five tests together and one test alone determine, and writes
//! `target/examples/creep_recovery_of_pom.svg`.
#![allow(
    clippy::print_stdout,
    reason = "an example prints its results to the standard output"
)]

use std::error::Error;
use std::f64::consts::TAU;

use cmod::recovery::fit::{ErrorScale, RecoveryFit, SeriesModulus, paper_procedure};
use cmod::recovery::{
    LoadHistory, LoadSegment, LossFactorReadings, RecoveryTest, ThreeElementParameters,
};
use rodfigure::{Axis, Figure, Mark, Panel, Role};
use testbed::noise::Noise;

const FREQUENCY_HZ: f64 = 10e3;
const VIRGIN_LOSS_FACTOR: f64 = 0.025;
/// Standard error of a loss factor: 5 % of the virgin loss factor.
const STANDARD_ERROR: f64 = 1.25e-3;
const TIMES: [f64; 12] = [
    60.0, 120.0, 200.0, 300.0, 450.0, 700.0, 1100.0, 1800.0, 3000.0, 5000.0, 9000.0, 18000.0,
];
const TESTS: [(&str, f64, f64); 5] = [
    ("Test 1", 45e6, 1800.0),
    ("Test 2", 32e6, 1800.0),
    ("Test 3", 19e6, 1800.0),
    ("Test 4", 32e6, 10800.0),
    ("Test 5", 32e6, 300.0),
];

const PRINTED: ThreeElementParameters = ThreeElementParameters {
    series_modulus: 3100e6,
    parallel_modulus: 13100.0,
    coefficient: 4.55e-21,
    exponent: 1.8,
};

/// Returns the strain of the dashpot after `duration` under `stress`, by the midpoint rule. The
/// readings are thus computed from the differential equation and not from the closed form that is
/// fitted to them.
fn march(mut strain: f64, stress: f64, duration: f64) -> f64 {
    let rate = |strain: f64| {
        let s = stress - PRINTED.parallel_modulus * strain;
        PRINTED.coefficient * s.abs().powf(PRINTED.exponent) * s
    };
    let steps = 5000_u32;
    let h = duration / f64::from(steps);
    for _ in 0..steps {
        strain += h * rate(strain + 0.5 * h * rate(strain));
    }
    strain
}

fn main() -> Result<(), Box<dyn Error>> {
    let omega = TAU * FREQUENCY_HZ;
    let mut random = Noise::seeded(1993);
    let mut tests = Vec::new();
    for (name, stress, duration) in TESTS {
        let load = LoadHistory::creep(stress, duration)?;
        let mut strain = march(0.0, stress, duration);
        let mut before = 0.0;
        let mut change = Vec::new();
        for t in TIMES {
            strain = march(strain, 0.0, t - before);
            before = t;
            let fluidity = PRINTED.coefficient
                * (PRINTED.exponent + 1.0)
                * (PRINTED.parallel_modulus * strain).powf(PRINTED.exponent);
            let error = STANDARD_ERROR * random.normal();
            change.push(PRINTED.series_modulus * fluidity / omega + error);
        }
        let readings = LossFactorReadings {
            time: &TIMES,
            change: &change,
            standard_error: &[STANDARD_ERROR; TIMES.len()],
            virgin_standard_error: 0.0,
        };
        tests.push(RecoveryTest::new(name, load, FREQUENCY_HZ, readings)?);
    }
    let modulus = SeriesModulus {
        value: 3100e6,
        standard_error: 50e6,
    };
    let fit = RecoveryFit::new(&tests, modulus, ErrorScale::Stated)?;
    println!("five tests: {fit}\n");
    let one = RecoveryFit::new(tests.get(1..2).unwrap_or(&[]), modulus, ErrorScale::Stated)?;
    println!("Test 2 alone: {one}\n");
    let paper = paper_procedure(&tests, 1, modulus.value, (0.2, 5.0))?;
    println!("procedure of the paper: {:?}\n", paper.parameters);

    let percent = 100.0 / VIRGIN_LOSS_FACTOR;
    let curve = |load: &LoadHistory| -> Result<Vec<(f64, f64)>, cmod::CmodError> {
        let recovery = fit.model.recovery(load)?;
        let times = (0..=200_u32).map(|i| 50.0 * 400.0_f64.powf(f64::from(i) / 200.0));
        Ok(times
            .map(|t| (t, percent * recovery.loss_factor_change(omega, t)))
            .collect())
    };
    let mut marks = Vec::new();
    for (index, (test, (name, ..))) in tests.iter().zip(TESTS).enumerate() {
        let role = Role::of_series(index);
        let change = test.change().iter().map(|change| percent * change);
        let measured = test.time().iter().copied().zip(change);
        marks.push(Mark::line(name, role, curve(test.load())?));
        marks.push(Mark::points("", role, measured));
    }
    let periodic = LoadHistory::new(vec![LoadSegment::Periodic {
        mean: 32e6,
        amplitude: 13e6,
        frequency_hz: 4.0,
        duration: 1800.0,
    }])?;
    let predicted = curve(&periodic)?;
    marks.push(Mark::line("Test 6, predicted", Role::Reference, predicted));
    let panel = Panel::new(
        Axis::logarithmic("recovery time", "s"),
        ("change of the loss factor by its virgin value", "%"),
        marks,
    );
    let title = "Recovery of polyoximethylene after the loads of paper C";
    let path = Figure::new("creep_recovery_of_pom", title, vec![panel]).write_to(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../target/examples"
    ))?;
    println!("figure in {}", path.display());
    Ok(())
}

//! Loss factor of polyoximethylene after the creep loads of paper C: noisy readings and the joint
//! fit of all tests.
//!
//! ```text
//! cargo run --release --package cmod --example creep_recovery_of_pom
//! ```
//!
//! prints what five tests and one test determine, and writes
//! `target/examples/creep_recovery_of_pom.svg`.
#![allow(
    clippy::print_stdout,
    reason = "an example talks to the one who runs it"
)]

mod figure;

use std::error::Error;
use std::f64::consts::TAU;

use cmod::recovery::fit::{ErrorScale, RecoveryFit, SeriesModulus, paper_procedure};
use cmod::recovery::{
    LoadHistory, LoadSegment, LossFactorReadings, RecoveryTest, ThreeElementParameters,
};
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::plots::Plot;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const FREQUENCY_HZ: f64 = 10e3;
const VIRGIN_LOSS_FACTOR: f64 = 0.025;
/// Standard error of a loss factor, 5 % of the virgin one.
const STANDARD_ERROR: f64 = 1.25e-3;
const TIMES: [f64; 12] = [
    60.0, 120.0, 200.0, 300.0, 450.0, 700.0, 1100.0, 1800.0, 3000.0, 5000.0, 9000.0, 18000.0,
];
const TESTS: [(&str, f64, f64, &str); 5] = [
    ("Test 1", 45e6, 1800.0, "#c2410c"),
    ("Test 2", 32e6, 1800.0, "#1d4ed8"),
    ("Test 3", 19e6, 1800.0, "#15803d"),
    ("Test 4", 32e6, 10800.0, "#7e22ce"),
    ("Test 5", 32e6, 300.0, "#0e7490"),
];

const PRINTED: ThreeElementParameters = ThreeElementParameters {
    series_modulus: 3100e6,
    parallel_modulus: 13100.0,
    coefficient: 4.55e-21,
    exponent: 1.8,
};

/// Strain of the dashpot after `duration` under `stress`, by the midpoint rule: the readings come
/// from the differential equation and not from the closed form that is fitted to them.
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
    let mut random = ChaCha8Rng::seed_from_u64(1993);
    let mut tests = Vec::new();
    for (name, stress, duration, _) in TESTS {
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
            let noise: f64 = StandardNormal.sample(&mut random);
            change.push(PRINTED.series_modulus * fluidity / omega + STANDARD_ERROR * noise);
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
    let mut plots = Vec::new();
    for (test, (name, .., colour)) in tests.iter().zip(TESTS) {
        let recovery = fit.model.recovery(test.load())?;
        let curve: Vec<(f64, f64)> = (0..=200_u32)
            .map(|i| {
                let t = 50.0 * 400.0_f64.powf(f64::from(i) / 200.0);
                (t.log10(), percent * recovery.loss_factor_change(omega, t))
            })
            .collect();
        let measured: Vec<(f64, f64)> = test
            .time()
            .iter()
            .zip(test.change())
            .map(|(t, change)| (t.log10(), percent * change))
            .collect();
        plots.push(Plot::Line(
            LinePlot::new()
                .with_data(curve)
                .with_color(colour)
                .with_legend(name),
        ));
        plots.push(Plot::Scatter(
            ScatterPlot::new().with_data(measured).with_color(colour),
        ));
    }
    let periodic = LoadHistory::new(vec![LoadSegment::Periodic {
        mean: 32e6,
        amplitude: 13e6,
        frequency_hz: 4.0,
        duration: 1800.0,
    }])?;
    let recovery = fit.model.recovery(&periodic)?;
    let curve: Vec<(f64, f64)> = (0..=200_u32)
        .map(|i| {
            let t = 50.0 * 400.0_f64.powf(f64::from(i) / 200.0);
            (t.log10(), percent * recovery.loss_factor_change(omega, t))
        })
        .collect();
    plots.push(Plot::Line(
        LinePlot::new()
            .with_data(curve)
            .with_color("#777777")
            .with_legend("Test 6, predicted"),
    ));
    let layout = figure::layout(
        &plots,
        "Recovery of polyoximethylene after the loads of paper C",
        [
            "log10 of recovery time, s",
            "change of the loss factor, % of its virgin value",
        ],
    );
    let figure = Figure::new(1, 1)
        .with_plots(vec![plots])
        .with_layouts(vec![layout])
        .with_cell_size(760.0, 480.0);
    let path = figure::written(figure, "creep_recovery_of_pom.svg")?;
    println!("figure in {}", path.display());
    Ok(())
}

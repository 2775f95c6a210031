//! Linearity: three swing angles for one specimen.

use cmod::Solver;
use rodwave::digits::significant;
use serde::Serialize;

use super::super::number::above;
use super::super::{Error, Table, table_of};
use super::rig::{SEED, VirtualTest};
use testbed::papers::paper_a::PaperA;

/// Gravity in m/s².
const GRAVITY: f64 = 9.81;

/// Comparison of the results at one swing angle with those at the usual one.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Row {
    degrees: f64,
    /// Velocity of the hammer, in m/s.
    velocity: f64,
    /// Greatest relative difference of Ψ from that at the usual swing angle, without noise.
    pub(crate) at_rounding: f64,
    pub(crate) valid: usize,
    /// Mean of the relative difference of E', and root mean square of this difference over its
    /// standard error, over the lines that are valid for both angles.
    mean: f64,
    pub(crate) over_error: f64,
}

pub(crate) fn all(paper: &PaperA) -> Result<Vec<Row>, Error> {
    let test = super::named(paper, "6")?;
    let rig = VirtualTest::new(paper, test, test.law()?)?;
    let velocity =
        |angle: f64| 2.0 * (0.5 * angle).sin() * (GRAVITY * paper.pendulum_length).sqrt();
    let [_, usual, _] = paper.swing_angles;
    let exact = rig.ratio_without_noise(1.0)?;
    // the reference is a repetition at the usual swing angle, with other noise
    let reference = rig.estimate(&rig.ratio(1.0, SEED + 200)?, Solver::Continuation)?;
    paper
        .swing_angles
        .into_iter()
        .zip(SEED + 201..)
        .map(|(angle, seed)| {
            let strength = velocity(angle) / velocity(usual);
            let estimate = rig.estimate(&rig.ratio(strength, seed)?, Solver::Continuation)?;
            let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
            for line in estimate.valid() {
                let Some(other) = reference.valid().find(|other| other.index == line.index) else {
                    continue;
                };
                let difference = line.modulus.re - other.modulus.re;
                let variance = line.standard_error.storage_modulus.powi(2)
                    + other.standard_error.storage_modulus.powi(2);
                sum += difference / other.modulus.re;
                squares += difference * difference / variance;
                count += 1.0;
            }
            Ok(Row {
                degrees: angle.to_degrees().round(),
                velocity: velocity(angle),
                at_rounding: exact
                    .difference(&rig.ratio_without_noise(strength)?, paper.highest_hz),
                valid: estimate.valid().count(),
                mean: sum / count,
                over_error: (squares / count).sqrt(),
            })
        })
        .collect()
}

pub(crate) fn table(rows: &[Row]) -> Table {
    table_of!(rows, |row|
        "swing angle, °" => row.degrees,
        "hammer, m/s" => significant(row.velocity, 3),
        "difference of Ψ from that at 10°, without noise" => above(row.at_rounding, 1e-9),
        "valid lines" => row.valid,
        "mean difference of E', %" => significant(100.0 * row.mean, 1),
        "r.m.s. difference over its standard error" => format!("{:.2}", row.over_error),
    )
}

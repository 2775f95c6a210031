//! Modulus from three gauges in each mounting, and from the end accelerations of the dismounted
//! bar.

use std::f64::consts::TAU;

use cmod::validity::AcceptanceLimits;
use cmod::{
    GaugeSpectra, GaugedRod, ModulusEstimate, ModulusLine, ThreePoint, TwoPoint, two_point,
};
use num_complex::Complex64;
use serde::Serialize;

use super::super::Error;
use super::super::coverage::within;
use super::rig::{
    ACCELEROMETER, GAUGE_DISTANCE, Mounting, SEED, STRAIN_NOISE, acceleration_ratios, measured,
    polypropylene, positions, strains,
};
use testbed::papers::paper_b::PaperB;

/// Spacing of the computed lines, in Hz.
const STEP_HZ: f64 = 125.0;

/// Result of one measurement method.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Series {
    pub(crate) way: String,
    pub(crate) lines: Vec<Line>,
    /// Number of lines that fulfil every condition.
    pub(crate) valid: usize,
    /// Fraction of the values E' and E'' of valid lines within one and within two standard errors
    /// of the material.
    pub(crate) within_one: f64,
    pub(crate) within_two: f64,
}

/// Modulus at one frequency, in Pa, with standard errors.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Line {
    pub(crate) frequency_hz: f64,
    pub(crate) storage_modulus: f64,
    pub(crate) loss_modulus: f64,
    pub(crate) storage_error: f64,
    pub(crate) loss_error: f64,
    pub(crate) valid: bool,
    #[serde(skip)]
    pub(crate) truth: Complex64,
}

pub(crate) fn frequencies(paper: &PaperB) -> Vec<f64> {
    let count = ((paper.highest_hz - paper.lowest_hz) / STEP_HZ).round() as u32;
    (0..=count)
        .map(|j| paper.lowest_hz + STEP_HZ * f64::from(j))
        .collect()
}

pub(crate) fn all(paper: &PaperB) -> Result<Vec<Series>, Error> {
    let mut series = Vec::new();
    for (mounting, seed) in Mounting::ALL.into_iter().zip(SEED..) {
        let estimate = in_situ(paper, mounting, GAUGE_DISTANCE, seed)?;
        let way = format!("{}, three strains", mounting.name());
        series.push(collect(paper, way, &estimate)?);
    }
    let frequency_hz = frequencies(paper);
    let (ratios, variance) = acceleration_ratios(paper, &frequency_hz, tests(paper))?;
    let estimate = TwoPoint::new(two_point::Specimen {
        length: paper.length,
        diameter: paper.diameter,
        density: paper.density,
        accelerometer_mass: ACCELEROMETER,
    })?
    .with_limits(AcceptanceLimits::NONE)?
    .estimate(&frequency_hz, &ratios, &variance)?;
    series.push(collect(
        paper,
        "dismounted, end accelerations".into(),
        &estimate,
    )?);
    Ok(series)
}

fn tests(paper: &PaperB) -> usize {
    paper.averaged as usize
}

/// Evaluates ten hits measured by three gauges at the spacing `distance`.
pub(crate) fn in_situ(
    paper: &PaperB,
    mounting: Mounting,
    distance: f64,
    seed: u64,
) -> Result<ModulusEstimate, Error> {
    let frequency_hz = frequencies(paper);
    let positions = positions(paper, distance);
    let clean = strains(paper, mounting, &positions, &frequency_hz)?;
    let largest = clean
        .iter()
        .flatten()
        .map(|strain| strain.norm())
        .fold(0.0, f64::max);
    let noise = STRAIN_NOISE * largest;
    let blows = measured(&clean, noise, tests(paper), seed);
    let blows: Vec<&[Vec<Complex64>]> = blows.iter().map(Vec::as_slice).collect();
    Ok(ThreePoint::new(GaugedRod {
        positions: positions.to_vec(),
        diameter: paper.diameter,
        density: paper.density,
    })?
    // only the conditions of the paper: errors are shown and therefore not limited
    .with_limits(AcceptanceLimits::NONE)?
    .estimate(&GaugeSpectra {
        frequency_hz: &frequency_hz,
        tests: &blows,
        noise: &vec![vec![noise; frequency_hz.len()]; positions.len()],
    })?)
}

fn collect(paper: &PaperB, way: String, estimate: &ModulusEstimate) -> Result<Series, Error> {
    let medium = polypropylene(paper)?;
    let exact = |line: &ModulusLine| medium.modulus(TAU * line.frequency_hz);
    let lines: Vec<Line> = estimate
        .lines()
        .iter()
        .map(|line| Line {
            frequency_hz: line.frequency_hz,
            storage_modulus: line.modulus.re,
            loss_modulus: line.modulus.im,
            storage_error: line.standard_error.storage_modulus,
            loss_error: line.standard_error.loss_modulus,
            valid: line.validity.is_valid(),
            truth: exact(line),
        })
        .collect();
    Ok(Series {
        way,
        valid: lines.iter().filter(|line| line.valid).count(),
        within_one: within(estimate, &exact, 1.0),
        within_two: within(estimate, &exact, 2.0),
        lines,
    })
}

/// Returns the root mean square of the difference between two series relative to its standard
/// error, over the lines that are valid in both. It is 1 if the series differ by noise alone.
pub(crate) fn difference(first: &Series, second: &Series) -> f64 {
    let mut squares = Vec::new();
    for a in first.lines.iter().filter(|line| line.valid) {
        let same = |line: &&Line| (line.frequency_hz - a.frequency_hz).abs() < 1e-6;
        let Some(b) = second.lines.iter().find(same).filter(|line| line.valid) else {
            continue;
        };
        squares.push(
            (a.storage_modulus - b.storage_modulus).powi(2)
                / (a.storage_error.powi(2) + b.storage_error.powi(2)),
        );
        squares.push(
            (a.loss_modulus - b.loss_modulus).powi(2)
                / (a.loss_error.powi(2) + b.loss_error.powi(2)),
        );
    }
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

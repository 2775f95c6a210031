//! Comparison method of Figures 3a and 4: the rods of Tests 3 and 10, measured by a pulse that
//! passes two sections (after Blanc).

use std::f64::consts::TAU;

use cmod::validity::AcceptanceLimits;
use cmod::{ModulusEstimate, PulsedRod, RatioOfSpectra, SeparatePulses};
use labio::noise_of_cut_pulse;
use num_complex::Complex64;
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::digits::significant;
use rodwave::element::Circle;
use rodwave::experiment::end_accelerations::{Pulse, RaisedCosine};
use rodwave::medium::Medium;
use rodwave::synthesis::DampedSynthesis;
use serde::Serialize;

use super::super::{Error, Table, table_of};
use super::rig::{BLOW, NOISE, SEED};
use super::room_temperature::{Evaluated, valid_band};
use testbed::noise::Noise;
use testbed::papers::paper_a::PaperA;

/// Distances of the two sections from the struck end, in m. These and the constants below are not
/// stated in the paper.
const SECTIONS: [f64; 2] = [0.100, 0.400];
/// Interval of the records, in s.
const INTERVAL: f64 = 2e-6;
/// Duration of the records, in s.
const DURATION: f64 = 2e-3;
/// Spacing of the lines, in Hz.
const STEP_HZ: f64 = 500.0;
/// Length of the window as a fraction of the time until the echo from the free end arrives.
const BEFORE_ECHO: f64 = 0.95;

/// Comparison of the two methods on one rod.
#[derive(Debug)]
pub(crate) struct Comparison {
    pub(crate) row: Row,
    pub(crate) estimate: ModulusEstimate,
}

#[derive(Debug, Clone, Serialize)]
pub(crate) struct Row {
    pub(crate) test: String,
    valid: usize,
    lowest_hz: f64,
    highest_hz: f64,
    /// Greatest relative errors of E' and the loss factor by the pulse method, on its valid lines.
    pub(crate) worst: [f64; 2],
    /// Root mean square difference between the methods over its standard error, for E' and E''.
    pub(crate) over_error: [f64; 2],
}

pub(crate) fn all(paper: &PaperA, tests: &[Evaluated]) -> Result<Vec<Comparison>, Error> {
    ["3", "10"]
        .iter()
        .filter_map(|name| tests.iter().find(|test| test.row.test == *name))
        .zip(SEED + 300..)
        .map(|(test, seed)| compare(paper, test, seed))
        .collect()
}

fn compare(paper: &PaperA, test: &Evaluated, seed: u64) -> Result<Comparison, Error> {
    let medium: &Medium<_> = &test.medium;
    let chain = AnalyticChain::analytic_from_impact_face()
        .rod(medium, Circle::of_diameter(test.diameter)?, test.length)
        .end(Termination::Free)?;
    let blow = RaisedCosine::new(BLOW.0, BLOW.1)?;
    let synthesis = DampedSynthesis::new(DURATION, INTERVAL)?.smoothed(2.5 * INTERVAL)?;
    // the fastest waves of the band determine the arrival of the echo
    let speed = medium.phase_velocity(TAU * paper.highest_hz);
    let count = (paper.highest_hz / STEP_HZ).round() as u32;
    let frequency_hz: Vec<f64> = (2..=count).map(|j| STEP_HZ * f64::from(j)).collect();
    let mut random = Noise::seeded(seed);
    let (mut spectra, mut noises) = (Vec::new(), Vec::new());
    for distance in SECTIONS {
        let section = chain.section(0, distance)?;
        let transform: Vec<Complex64> = synthesis
            .arguments()
            .map(|s| Ok(blow.transform(s) * section.state_at_s(s)?.normal_force))
            .collect::<Result<_, Error>>()?;
        let history = synthesis.history(&transform)?;
        let echo = (2.0 * test.length - distance) / speed;
        let until = ((BEFORE_ECHO * echo - history.start) / INTERVAL) as usize;
        let clean = &history.samples[..until.min(history.samples.len())];
        let peak = clean
            .iter()
            .fold(0.0_f64, |peak, value| peak.max(value.abs()));
        let of_mean = NOISE * peak / paper.averaged.sqrt();
        let window = random.added_to(clean, of_mean);
        spectra.push(
            frequency_hz
                .iter()
                .map(|f| {
                    let terms = window.iter().enumerate().map(|(n, value)| {
                        let time = history.start + n as f64 * INTERVAL;
                        Complex64::cis(-TAU * f * time) * (value * INTERVAL)
                    });
                    terms.sum::<Complex64>()
                })
                .collect::<Vec<Complex64>>(),
        );
        let random_part = of_mean * INTERVAL * (window.len() as f64).sqrt();
        let cut = clean.last().copied().unwrap_or(0.0);
        noises.push(noise_of_cut_pulse(random_part, [0.0, cut], &frequency_hz)?);
    }
    let [near, far] = [&spectra[0], &spectra[1]];
    let ratio = RatioOfSpectra::new(&[far], &[near], &noises[1], &noises[0])?;
    let estimate = SeparatePulses::new(PulsedRod {
        distance: SECTIONS[1] - SECTIONS[0],
        diameter: test.diameter,
        density: medium.density(),
    })?
    .with_limits(AcceptanceLimits::ONE_DIMENSIONAL)?
    .estimate(&frequency_hz, &ratio.ratio, &ratio.variance)?;

    let mut worst = [0.0_f64; 2];
    let (mut squares, mut pairs) = ([0.0; 2], 0.0);
    for line in estimate.valid() {
        let exact = medium.modulus(TAU * line.frequency_hz);
        worst[0] = worst[0].max((line.modulus.re / exact.re - 1.0).abs());
        worst[1] = worst[1].max((line.loss_factor * exact.re / exact.im - 1.0).abs());
        // the nearest line of the two-point method: its lines are 16 Hz apart
        let distance = |other: &&cmod::ModulusLine| (other.frequency_hz - line.frequency_hz).abs();
        let Some(other) = test
            .estimate
            .valid()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .filter(|other| distance(other) < 16.0)
        else {
            continue;
        };
        let difference = line.modulus - other.modulus;
        let (a, b) = (&line.standard_error, &other.standard_error);
        squares[0] +=
            difference.re.powi(2) / (a.storage_modulus.powi(2) + b.storage_modulus.powi(2));
        squares[1] += difference.im.powi(2) / (a.loss_modulus.powi(2) + b.loss_modulus.powi(2));
        pairs += 1.0;
    }
    let [lowest_hz, highest_hz] = valid_band(&estimate);
    Ok(Comparison {
        row: Row {
            test: test.row.test.clone(),
            valid: estimate.valid().count(),
            lowest_hz,
            highest_hz,
            worst,
            over_error: squares.map(|sum: f64| (sum / pairs).sqrt()),
        },
        estimate,
    })
}

pub(crate) fn table(comparisons: &[Comparison]) -> Table {
    table_of!(comparisons, |Comparison { row, .. }|
        "rod of test" => row.test,
        "valid lines of the pulse method" => row.valid,
        "from, Hz" => format!("{:.0}", row.lowest_hz),
        "to, Hz" => format!("{:.0}", row.highest_hz),
        "greatest error of its E', %" => significant(100.0 * row.worst[0], 2),
        "of E''/E', %" => significant(100.0 * row.worst[1], 2),
        "difference from the two-point method over its standard error: E'" =>
            format!("{:.2}", row.over_error[0]),
        "E''" => format!("{:.2}", row.over_error[1]),
    )
}

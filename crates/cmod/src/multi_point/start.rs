//! Where the wave number starts: one wave speed for the first lines together.
//!
//! On a single line V(γ) has many minima. But a speed that is nearly constant over the first wavelengths explains many
//! lines at once, and no other does: of a row of speeds the one is taken at which the misfit, averaged over lines with up
//! to one wavelength between the outermost gauges, is least. The misfit enters by its logarithm, so that a few bad lines
//! cannot decide.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::projection::Projection;
use super::spectra::{GaugeSpectra, WhiteLine};
use crate::branch::BranchDoubt;

/// Speeds that are tried without a guess [m/s], from soft rubber to beyond any solid in a rod.
const SLOWEST: f64 = 20.0;
const FASTEST: f64 = 20e3;
/// Within this factor of a guess.
const GUESS_FACTOR: f64 = 1.5;
/// Ratio of neighbouring speeds: a third of a radian at one wavelength.
const SPEED_RATIO: f64 = 1.055;
/// α/k that are tried: loss factors of about 0, 0.12 and 0.4.
const DAMPING: [f64; 3] = [0.0, 0.06, 0.2];
/// Lines that are compared at each speed.
const LINES: usize = 16;
/// What one speed and one damping for all lines cannot explain, by the root mean square of the gauges.
const MODEL_ERROR: f64 = 0.02;
/// Two speeds with mean log misfits closer than this are not told apart.
const TOO_CLOSE: f64 = 0.1;

/// γ by ω of the first lines [s/m], and what speaks against it.
pub(super) struct Start {
    pub(super) slowness: Complex64,
    pub(super) doubt: Option<BranchDoubt>,
}

/// Compares speeds over the `usable` lines (their indices); `None` if there is no line.
pub(super) fn wave_speed(
    projection: &mut Projection,
    spectra: &GaugeSpectra<'_>,
    usable: &[usize],
    aperture: f64,
    guess: Option<f64>,
) -> Option<Start> {
    let (slowest, fastest) = guess.map_or((SLOWEST, FASTEST), |speed| {
        (speed / GUESS_FACTOR, speed * GUESS_FACTOR)
    });
    let mut line = WhiteLine::for_spectra(spectra, projection.n_gauges());
    let mut speed = slowest;
    let mut scores: Vec<(f64, f64, Complex64)> = Vec::new();
    while speed <= fastest {
        let mut best = (f64::INFINITY, Complex64::ZERO);
        for damping in DAMPING {
            let slowness = Complex64::new(damping, 1.0) / speed;
            let score = score(projection, spectra, usable, aperture, slowness, &mut line);
            if score < best.0 {
                best = (score, slowness);
            }
        }
        scores.push((best.0, speed, best.1));
        speed *= SPEED_RATIO;
    }
    let chosen = scores.iter().min_by(|a, b| a.0.total_cmp(&b.0)).copied()?;
    let rival = scores
        .iter()
        .filter(|(_, speed, _)| (speed / chosen.1).ln().abs() > 0.3)
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let doubt = rival
        .filter(|(score, _, _)| *score < chosen.0 + TOO_CLOSE)
        .map(|(_, other, _)| BranchDoubt::SeveralSpeeds {
            chosen: chosen.1,
            other: *other,
        });
    chosen.0.is_finite().then_some(Start {
        slowness: chosen.2,
        doubt,
    })
}

/// Mean log of the misfit, by noise and [`MODEL_ERROR`], at one slowness.
fn score(
    projection: &mut Projection,
    spectra: &GaugeSpectra<'_>,
    usable: &[usize],
    aperture: f64,
    slowness: Complex64,
    line: &mut WhiteLine,
) -> f64 {
    let highest = 1.0 / (slowness.im * aperture);
    let frequency = |index: &usize| spectra.frequency_hz.get(*index).copied().unwrap_or(0.0);
    let below = usable.partition_point(|index| frequency(index) <= highest);
    let within = usable
        .get(..below.max(LINES / 2).min(usable.len()))
        .unwrap_or_default();
    let stride = within.len().div_ceil(LINES).max(1);
    let (mut sum, mut count) = (0.0, 0.0);
    for index in within.iter().rev().step_by(stride) {
        if line.load(spectra, *index).is_err() {
            continue;
        }
        let gamma = slowness * (TAU * frequency(index));
        let Some(misfit) = projection.misfit(gamma, line) else {
            return f64::INFINITY;
        };
        let freedom = (line.n_tests() * (line.weights.len() - 2)) as f64;
        let expected = line.variance + MODEL_ERROR * MODEL_ERROR * line.mean_power();
        sum += (misfit / freedom / expected).ln_1p();
        count += 1.0;
    }
    if count > 0.0 {
        sum / count
    } else {
        f64::INFINITY
    }
}

//! Starting value of γ: one wave speed for all first lines together.
//!
//! A single ratio has many roots, but the speed that explains all lines with up to one wavelength
//! over the distance of the sections is unique. A second speed with almost the same misfit is
//! reported as a doubt on every line.

use num_complex::Complex64;

use super::{MeasuredRatio, SectionRatio, Settings};
use crate::branch::wave_speed::{
    Start, TOO_CLOSE, about, few_lines, mean_of_better, minima, try_speeds,
};
use crate::branch::{BranchDoubt, FASTEST_WAVE, SLOWEST_WAVE};
use crate::median::median;

/// Ratio of neighbouring speeds, which changes the phase by a fifth of a radian at one wavelength
/// over the distance. The ratio is closer to 1 if lines beyond one wavelength are compared.
const SPEED_RATIO: f64 = 1.03;
/// Maximum number of lines compared at each speed.
const LINES: usize = 24;
/// Minimum number of lines compared, even if they are beyond one wavelength over the distance. It
/// is smaller with a known delay, because dispersion over many waves then has a greater effect than
/// the number of lines.
const FEWEST_COMPARED: usize = LINES / 2;
const FEWEST_COMPARED_WITH_DELAY: usize = 4;
/// Misfit allowed because one speed and one damping are used for all lines, relative to the size of
/// the ratio.
const MODEL_ERROR: f64 = 0.05;
/// Logarithm of the ratio of two speeds above which they are distinct.
const DISTINCT: f64 = 0.2;

/// Finds the wave speed by comparing speeds; `None` if there is no line.
pub(super) fn wave_speed(
    equation: &impl SectionRatio,
    measured: &[MeasuredRatio<'_>],
    settings: &Settings,
) -> Option<Start> {
    let guess = settings.wave_speed;
    let distance = equation.distance();
    let step_hz = median_step(measured);
    let (slowest, fastest) = match (guess, settings.delay) {
        (Some(speed), _) => about(speed),
        // with a known delay, the travel time may differ from the delay by half a turn of the phase
        // per line, at most by a third of the delay
        (None, Some(delay)) => {
            let unknown = (0.5 / step_hz).min(delay / 3.0);
            (distance / (delay + unknown), distance / (delay - unknown))
        }
        // at a lower speed the phase advances by more than half a turn per line, and equidistant
        // lines give the same ratios for a higher speed
        (None, None) => (SLOWEST_WAVE.max(2.0 * step_hz * distance), FASTEST_WAVE),
    };
    let mut misfits = Vec::with_capacity(LINES);
    let fewest = match settings.delay {
        Some(_) => FEWEST_COMPARED_WITH_DELAY,
        None => FEWEST_COMPARED,
    };
    // number of waves over the distance at the last of the lines that are compared at every speed
    let last = measured.get(..fewest).unwrap_or(measured).last();
    let waves = last.map_or(1.0, |line| line.frequency_hz * distance / slowest);
    let ratio = match settings.delay {
        Some(_) => 1.0 + (SPEED_RATIO - 1.0) / waves.max(1.0),
        None => SPEED_RATIO,
    };
    let tried = try_speeds((slowest, fastest), ratio, |slowness| {
        score(equation, measured, (slowness, fewest), &mut misfits)
    });
    let chosen = tried.iter().min_by(|a, b| a.score.total_cmp(&b.score))?;
    if !chosen.score.is_finite() {
        return None;
    }
    let speed_of = |slowness: Complex64| slowness.im.recip();
    let is_guided = guess.is_some() || settings.delay.is_some();
    let few = few_lines(measured.len()).filter(|_| !is_guided);
    let doubt = few.or_else(|| {
        // A rival speed must be another minimum, not on the flank of the chosen minimum.
        minima(&tried)
            .filter(|other| (other.slowness.im / chosen.slowness.im).ln().abs() > DISTINCT)
            .min_by(|a, b| a.score.total_cmp(&b.score))
            .filter(|rival| rival.score < chosen.score + TOO_CLOSE)
            .map(|rival| BranchDoubt::SeveralSpeeds {
                chosen: speed_of(chosen.slowness),
                other: speed_of(rival.slowness),
            })
    });
    Some(Start {
        slowness: chosen.slowness,
        doubt,
    })
}

/// Returns the median distance of neighbouring lines [Hz]; 0 for a single line.
fn median_step(measured: &[MeasuredRatio<'_>]) -> f64 {
    let mut steps: Vec<f64> = measured
        .iter()
        .zip(measured.iter().skip(1))
        .map(|(line, next)| next.frequency_hz - line.frequency_hz)
        .collect();
    median(&mut steps).unwrap_or(0.0)
}

/// Returns the mean logarithm of the misfit, relative to the noise and [`MODEL_ERROR`], over the
/// better two thirds of the lines.
fn score(
    equation: &impl SectionRatio,
    measured: &[MeasuredRatio<'_>],
    (slowness, fewest): (Complex64, usize),
    misfits: &mut Vec<f64>,
) -> f64 {
    let highest_hz = 1.0 / (slowness.im * equation.distance());
    let below = measured.partition_point(|line| line.frequency_hz <= highest_hz);
    let within = measured
        .get(..below.max(fewest).min(measured.len()))
        .unwrap_or_default();
    let stride = within.len().div_ceil(LINES).max(1);
    misfits.clear();
    for line in within.iter().rev().step_by(stride) {
        let omega = line.omega();
        let [first, second] = equation.jets(slowness * omega, omega);
        let predicted = line.ratio * second.value;
        let expected = line.whole_variance() * second.value.norm_sqr()
            + MODEL_ERROR * MODEL_ERROR * (predicted.norm_sqr() + first.value.norm_sqr());
        let misfit = (predicted - first.value).norm_sqr() / expected;
        if !misfit.is_finite() {
            return f64::INFINITY;
        }
        misfits.push(misfit.ln_1p());
    }
    mean_of_better(misfits)
}

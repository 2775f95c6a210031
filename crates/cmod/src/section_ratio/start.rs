//! Starting value of γ: one wave speed for all first lines together.
//!
//! A single ratio has many roots, but the speed that explains all lines with up to one wavelength
//! over the distance of the sections is unique. The logarithm of the misfit is averaged without the
//! worst third of the lines, to exclude outliers. A second speed with almost the same misfit is
//! reported as a doubt on every line.

use num_complex::Complex64;

use super::{MeasuredRatio, SectionRatio, Settings};
use crate::branch::BranchDoubt;

/// Speeds tried without a guess [m/s], from the speed in soft rubber to above the speed in any
/// solid rod.
const SLOWEST: f64 = 20.0;
const FASTEST: f64 = 20e3;
/// Factor from a guess to either end of the searched range.
const GUESS_FACTOR: f64 = 1.5;
/// Ratio of neighbouring speeds, which changes the phase by a fifth of a radian at one wavelength
/// over the distance. The ratio is closer to 1 if lines beyond one wavelength are compared.
const SPEED_RATIO: f64 = 1.03;
/// Values of α/k tried: loss factors of about 0, 0.12 and 0.4.
const DAMPING: [f64; 3] = [0.0, 0.06, 0.2];
/// Number of lines compared at each speed.
const LINES: usize = 24;
/// Minimum number of lines compared, even if they are beyond one wavelength over the distance. It
/// is smaller with a known delay, because dispersion over many waves then has a greater effect than
/// the number of lines.
const FEWEST_COMPARED: usize = LINES / 2;
const FEWEST_COMPARED_WITH_DELAY: usize = 4;
/// Minimum number of lines for distinguishing speeds without a guess.
const FEWEST_LINES: usize = 8;
/// Misfit allowed because one speed and one damping are used for all lines, relative to the size of
/// the ratio.
const MODEL_ERROR: f64 = 0.05;
/// Logarithm of the ratio of two speeds above which they are distinct.
const DISTINCT: f64 = 0.2;
/// Difference of mean log misfits below which the data do not distinguish two speeds.
const TOO_CLOSE: f64 = 0.1;

/// Slowness γ/ω of the first lines [s/m], and the doubt about it.
pub(super) struct Start {
    pub(super) slowness: Complex64,
    pub(super) doubt: Option<BranchDoubt>,
}

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
        (Some(speed), _) => (speed / GUESS_FACTOR, speed * GUESS_FACTOR),
        // a known delay is equivalent to a guess of the speed within half a turn per line to either
        // side
        (None, Some(delay)) => {
            let unknown = (0.5 / step_hz).min(delay / 3.0);
            (distance / (delay + unknown), distance / (delay - unknown))
        }
        // below this speed, two speeds have the same ratios on equidistant lines
        (None, None) => (SLOWEST.max(2.0 * step_hz * distance), FASTEST),
    };
    let mut misfits = Vec::with_capacity(LINES);
    let mut tried: Vec<(f64, Complex64)> = Vec::new();
    let fewest = match settings.delay {
        Some(_) => FEWEST_COMPARED_WITH_DELAY,
        None => FEWEST_COMPARED,
    };
    // number of waves over the distance at the last line that is compared at all speeds
    let last = measured.get(..fewest).unwrap_or(measured).last();
    let waves = last.map_or(1.0, |line| line.frequency_hz * distance / slowest);
    let ratio = match settings.delay {
        Some(_) => 1.0 + (SPEED_RATIO - 1.0) / waves.max(1.0),
        None => SPEED_RATIO,
    };
    let mut speed = slowest;
    while speed <= fastest {
        let best = DAMPING
            .iter()
            .map(|damping| Complex64::new(*damping, 1.0) / speed)
            .map(|slowness| {
                (
                    score(equation, measured, (slowness, fewest), &mut misfits),
                    slowness,
                )
            })
            .min_by(|a, b| a.0.total_cmp(&b.0));
        tried.extend(best);
        let next = speed * ratio;
        // a speed at the limits of the double range stops growing, or becomes infinite
        if next <= speed || next == f64::INFINITY {
            break;
        }
        speed = next;
    }
    let chosen = tried.iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
    if !chosen.0.is_finite() {
        return None;
    }
    let speed_of = |slowness: Complex64| slowness.im.recip();
    let is_guided = guess.is_some() || settings.delay.is_some();
    let doubt = if !is_guided && measured.len() < FEWEST_LINES {
        Some(BranchDoubt::FewLines {
            found: measured.len(),
            expected: FEWEST_LINES,
        })
    } else {
        // A rival speed must be another minimum, not on the flank of the chosen minimum.
        let is_minimum = |index: usize| {
            let score = |index: usize| tried.get(index).map_or(f64::INFINITY, |t| t.0);
            score(index) <= score(index.wrapping_sub(1)) && score(index) <= score(index + 1)
        };
        tried
            .iter()
            .enumerate()
            .filter(|(index, _)| is_minimum(*index))
            .map(|(_, tried)| tried)
            .filter(|(_, slowness)| (slowness.im / chosen.1.im).ln().abs() > DISTINCT)
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .filter(|(score, _)| *score < chosen.0 + TOO_CLOSE)
            .map(|(_, other)| BranchDoubt::SeveralSpeeds {
                chosen: speed_of(chosen.1),
                other: speed_of(*other),
            })
    };
    Some(Start {
        slowness: chosen.1,
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
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).map_or(0.0, |step| *step)
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
    misfits.sort_by(f64::total_cmp);
    let kept = (2 * misfits.len()).div_ceil(3);
    let better = misfits.get(..kept).unwrap_or_default();
    if better.is_empty() {
        f64::INFINITY
    } else {
        better.iter().sum::<f64>() / kept as f64
    }
}

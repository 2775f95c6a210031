//! Step averages of the response to a force that is constant in a step.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;

use super::{Front, TimeGrid, Weights};
use crate::error::check_enough;
use crate::{Domain, ImpactBody, ImpulseError, fourier};

/// Number of Nyquist bands of the time step whose lines are summed. The averages decrease as the
/// square of the frequency and have a double zero at the end of every second band. From the middle
/// of the bands to their end they are rolled off, which adds a zero of second order at either end
/// of the roll-off. The truncation changes a kink of the averages, such as at an echo, by 3 % of
/// the kink; the change decreases with the fifth power of the distance from the kink.
pub(super) const BANDS: usize = 8;

/// Damping aT_p over the period on the line Re s = a: the alias of the next period is e^{-18} =
/// 1.5e-8, and the rounding grows by e^9 up to the middle of the period, where the weights end.
const DAMPING_OVER_PERIOD: f64 = 18.0;

/// Number of steps over which the roll-off of the bands smears events at time 0.
const SMEARED: usize = 16;

/// Period of the transform, in multiples of the duration, for a body known only on the frequency
/// axis. Free vibrations may take three durations to decay.
const AXIS_PERIODS: usize = 8;

/// Largest number of points of the period of a measured body, which take one gibibyte.
const MOST_POINTS: f64 = 134_217_728.0;

pub(super) fn weights<B: ImpactBody + ?Sized>(
    body: &B,
    grid: TimeGrid,
    front: Front,
) -> Result<Weights, ImpulseError> {
    let TimeGrid { time_step, n_steps } = grid;
    let n_points = match body.domain() {
        Domain::RightHalfPlane => 2 * n_steps,
        Domain::FrequencyAxis => AXIS_PERIODS * n_steps,
        Domain::Lines {
            frequency_step_hz, ..
        } => measured_points(frequency_step_hz, grid)?,
    };
    let period = n_points as f64 * time_step;
    let damping = match body.domain() {
        Domain::RightHalfPlane => DAMPING_OVER_PERIOD / period,
        _ => 0.0,
    };
    let rigid = match body.domain() {
        Domain::RightHalfPlane => None,
        _ => body.free_mass(),
    };
    let n_lines = match body.domain() {
        Domain::Lines { n_lines, .. } => n_lines.min(BANDS * n_points / 2 + 1),
        _ => BANDS * n_points / 2 + 1,
    };
    let mut activity = 0.0_f64;
    let mut folded = vec![Complex64::ZERO; n_points / 2 + 1];
    for line in 0..n_lines {
        let s = Complex64::new(damping, TAU * line as f64 / period);
        let mobility = match (rigid, line) {
            // without its rigid-body motion, a free body does not move at 0 Hz
            (Some(_), 0) => Complex64::ZERO,
            (Some(mass), _) => body.mobility_at(s)? - 1.0 / (s * mass),
            (None, _) => body.mobility_at(s)?,
        };
        if !mobility.is_finite() {
            return Err(ImpulseError::InfiniteMobility {
                body: "impacting",
                s,
            });
        }
        if mobility.re < 0.0 {
            activity = activity.max(-mobility.re / mobility.norm());
        }
        let remainder = mobility - front.conductance - s * front.compliance;
        let value = remainder * average(s, time_step, line, n_points) * roll_off(line, n_points);
        fold(&mut folded, n_points, line, value);
    }
    let mut weights = fourier::to_samples(&folded, n_points);
    let scale = time_step / period;
    for (index, weight) in weights.iter_mut().enumerate() {
        *weight *= scale * (damping * time_step * index as f64).exp();
    }
    let ahead = match body.domain() {
        // the last weights are at times just before 0, amplified over a whole period
        Domain::RightHalfPlane => {
            let unwind = (-DAMPING_OVER_PERIOD).exp();
            rms(weights.get(n_points - 4..).unwrap_or_default()) * unwind
        }
        _ => rms(weights.get(n_points / 2..).unwrap_or_default()),
    };
    let ringing = match body.domain() {
        Domain::RightHalfPlane => 0.0,
        _ => ringing(&weights, n_steps),
    };
    match body.domain() {
        Domain::RightHalfPlane => {
            // only the smearing by the roll-off is before time 0, amplified over a period
            let near = SMEARED.min(n_steps / 2);
            mirror(&mut weights, near, (-DAMPING_OVER_PERIOD).exp());
        }
        _ => mirror(&mut weights, n_steps, 1.0),
    }
    weights.truncate(n_steps);
    if let Some(mass) = rigid {
        let drift = time_step / mass;
        for (index, weight) in weights.iter_mut().enumerate() {
            *weight += if index == 0 { 0.5 * drift } else { drift };
        }
    }
    if let Some(first) = weights.first_mut() {
        *first += front.conductance;
    }
    Ok(Weights {
        weights,
        acausal: ahead,
        ringing,
        activity,
    })
}

/// Adds the value at each time before 0 to the value at the same time after 0.
///
/// This preserves the real part of every line, which determines the causal response: a step smeared
/// about time 0 by the band limit becomes a step again, and with $`\operatorname{Re} G \ge 0`$ the
/// kernel is passive. Discarding the values before 0 would lose part of the response: 1.4 % of 1/Z
/// for a cone measured up to 20 kHz. `scale` undoes the damping at the end of the period.
fn mirror(weights: &mut [f64], n_steps: usize, scale: f64) {
    let n_points = weights.len();
    for step in 1..n_steps {
        let ahead = weights.get(n_points - step).copied().unwrap_or(0.0);
        if let Some(weight) = weights.get_mut(step) {
            *weight += scale * ahead;
        }
    }
}

/// Returns the number of time steps in the period of a measured body, which must be whole within
/// rounding.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a positive count below 2^32, checked"
)]
fn measured_points(frequency_step_hz: f64, grid: TimeGrid) -> Result<usize, ImpulseError> {
    let points = 1.0 / (frequency_step_hz * grid.time_step);
    let whole = points.round();
    if whole > MOST_POINTS {
        return Err(ImpulseError::NonPhysical {
            quantity: "ratio of the period of the measured lines to the time step",
            value: points,
            expected: "at most 2^27",
        });
    }
    if (points / whole - 1.0).abs() > 1e-9 {
        return Err(ImpulseError::NonPhysical {
            quantity: "ratio of the period of the measured lines to the time step",
            value: points,
            expected: "a whole number",
        });
    }
    let points = whole as usize;
    // the second half of the period is the time before the impulse
    check_enough(
        "period of the measured lines, in time steps,",
        points,
        2 * grid.n_steps,
    )?;
    Ok(points)
}

/// $`(2\sinh(sh/2)/(sh))^2`$, without cancellation at low frequency and with exact zeros at high
/// frequency.
fn average(s: Complex64, time_step: f64, line: usize, n_points: usize) -> Complex64 {
    let half = 0.5 * s * time_step;
    if half == Complex64::ZERO {
        return Complex64::ONE;
    }
    // the imaginary part is π line/n_points; its sine is computed from the remainder, as the
    // argument reaches hundreds
    let turns = line % (2 * n_points);
    let (sin, cos) = (PI * turns as f64 / n_points as f64).sin_cos();
    let sine = Complex64::new(half.re.sinh() * cos, half.re.cosh() * sin);
    (sine / half).powu(2)
}

/// Returns 1 over the lower half of the bands, then half a period of a cosine down to 0.
fn roll_off(line: usize, n_points: usize) -> f64 {
    let last = BANDS * n_points / 2;
    if 2 * line <= last {
        1.0
    } else {
        let fraction = 2.0 * line as f64 / last as f64 - 1.0;
        0.5 + 0.5 * (PI * fraction).cos()
    }
}

/// Adds a line and its conjugate to their alias positions for `n_points` samples.
fn fold(folded: &mut [Complex64], n_points: usize, line: usize, value: Complex64) {
    let index = line % n_points;
    let mut add = |index: usize, value: Complex64| {
        if let Some(slot) = folded.get_mut(index) {
            *slot += value;
        }
    };
    if line == 0 {
        add(0, value);
        return;
    }
    // the last line coincides with its mirror image, and half of the value is added for each
    let weight = if line == BANDS * n_points / 2 {
        0.5
    } else {
        1.0
    };
    add(index, weight * value);
    add((n_points - index) % n_points, weight * value.conj());
}

/// Returns the root mean square velocity that a unit force over `n_steps` still causes about half a
/// period later. Noise largely cancels in the sum over so many steps.
fn ringing(weights: &[f64], n_steps: usize) -> f64 {
    let n_points = weights.len();
    let middle = 3 * n_points / 8..5 * n_points / 8;
    let mut sum = 0.0;
    let sums: Vec<f64> = std::iter::once(0.0)
        .chain(weights.get(middle).unwrap_or_default().iter().map(|w| {
            sum += w;
            sum
        }))
        .collect();
    let pairs = sums.iter().zip(sums.iter().skip(n_steps));
    let over: Vec<f64> = pairs.map(|(from, to)| to - from).collect();
    rms(&over)
}

fn rms(values: &[f64]) -> f64 {
    let square = values.iter().map(|value| value * value).sum::<f64>();
    (square / values.len().max(1) as f64).sqrt()
}

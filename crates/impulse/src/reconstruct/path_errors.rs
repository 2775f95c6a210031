//! Errors of a measured frequency response in the normal equations of a force on a support.

use super::lines::{Transformed, weight};
use crate::interpolation::at_place;

/// Fewest lines over which a share is estimated.
const FEWEST_LINES: usize = 9;
/// Most lines over which a share is estimated: more lines only cost time.
const MOST_LINES: usize = 513;
/// Number of standard deviations by which the mean square of a frequency response must exceed that
/// of its errors to be significant.
const TELLS: f64 = 4.0;

/// Errors of frequency responses, and the assumed force where the frequency responses are not
/// significant.
///
/// With a measured $`H = H_0 + \delta H`$ the sum of $`w|H|^2`$ over the lines of a support is too
/// large by the sum of $`w\,\mathrm{var} H`$, and the force too small. Without this part the sum is
/// unbiased, but not positive where $`H`$ is only error. Lines are therefore weighted by the share
/// $`S = \mathrm{SNR}/(1+\mathrm{SNR})`$, with the signal-to-noise ratio averaged over as many
/// lines as the support cannot resolve, and each component of the force is weighted by its
/// information. The undetermined part, mainly the force beyond the band of the hammer, is assumed
/// to be that of a blow like the calibration blows ([`super::supposed`]) or, without them, to have
/// zero mean.
pub(super) struct PathErrors {
    /// Share S of every sensor and line.
    pub(super) shares: Vec<Vec<f64>>,
    /// Inverse of the assumed power of every line, for a sum over all lines.
    pub(super) prior: Vec<f64>,
    /// Share of the record in which the force acts.
    part: f64,
    /// Lines on either side that a force on the support cannot resolve.
    half: usize,
}

#[allow(
    clippy::indexing_slicing,
    reason = "shares, blows and sensors have one entry per line, and `line` is the index of a line"
)]
impl PathErrors {
    /// Creates the errors for a support of `length` samples; `None` if no frequency response has
    /// errors, or the noise is not known.
    pub(super) fn of(
        transformed: &Transformed<'_>,
        length: usize,
        blows: Option<&[f64]>,
    ) -> Option<Self> {
        let n_lines = transformed.grid.n_lines();
        let has_errors = transformed.sensors.iter().any(|sensor| {
            sensor.noise_at(0).is_some()
                && sensor
                    .variance
                    .is_some_and(|lines| lines.iter().any(|v| *v > 0.0))
        });
        if !has_errors {
            return None;
        }
        let n_samples = transformed.grid.n_samples;
        let half = (n_samples / length).clamp(FEWEST_LINES, MOST_LINES) / 2;
        let shares: Vec<Vec<f64>> = transformed
            .sensors
            .iter()
            .map(|sensor| {
                let used = |line: usize| transformed.uses(sensor, line);
                let of = |value: &dyn Fn(usize) -> f64| {
                    let lines = (0..n_lines).map(|line| if used(line) { value(line) } else { 0.0 });
                    mean_about(&lines.collect::<Vec<_>>(), half)
                };
                let power = of(&|line| sensor.frequency_response[line].norm_sqr());
                let errors = of(&|line| sensor.variance_at(line));
                let count = of(&|_| 1.0);
                let of_line = |line: usize| {
                    let n = count[line] * (2 * half + 1) as f64;
                    let ratio = power[line] / errors[line];
                    if errors[line] <= 0.0 {
                        1.0
                    } else if ratio > 1.0 + TELLS / n.max(1.0).sqrt() {
                        1.0 - 1.0 / ratio
                    } else {
                        0.0
                    }
                };
                (0..n_lines).map(of_line).collect()
            })
            .collect();
        let power = match blows {
            Some(blows) => {
                let scale = energy_over(transformed, &shares, blows);
                let power = of_other_durations(blows);
                power.into_iter().map(|power| scale * power).collect()
            }
            // the power of the calibration blows is the noise of the responses divided by the
            // variance of H that the noise has caused
            None => (0..n_lines)
                .map(|line| {
                    let sensors = transformed.sensors.iter();
                    let powers = sensors
                        .filter(|sensor| transformed.uses(sensor, line))
                        .map(|s| s.noise_at(line).unwrap_or(0.0) / s.variance_at(line));
                    powers.fold(0.0, f64::max)
                })
                .collect::<Vec<f64>>(),
        };
        let part = length as f64 / n_samples as f64;
        let prior = mean_about(&power, half)
            .into_iter()
            .map(|power| if power > 0.0 { part / power } else { 0.0 })
            .collect();
        Some(Self {
            shares,
            prior,
            part,
            half,
        })
    }

    /// Returns the assumed power of the force on every line.
    pub(super) fn assumed_power(&self) -> Vec<f64> {
        let of = |inverse: &f64| {
            if *inverse > 0.0 {
                self.part / inverse
            } else {
                0.0
            }
        };
        self.prior.iter().map(of).collect()
    }

    /// Returns the power of a force on every line, as the mean over the neighbouring lines that its
    /// support cannot resolve.
    pub(super) fn resolved_power(&self, power: &[f64]) -> Vec<f64> {
        mean_about(power, self.half)
    }
}

/// Returns the inverse of the assumed power of the force on every line, from the power of `blows`.
pub(super) fn of_lines(transformed: &Transformed<'_>, blows: &[f64]) -> Vec<f64> {
    let shares = vec![vec![1.0; blows.len()]; transformed.sensors.len()];
    let scale = energy_over(transformed, &shares, blows);
    let inverse = |power: &f64| {
        let power = scale * power;
        if power > 0.0 { 1.0 / power } else { 0.0 }
    };
    blows.iter().map(inverse).collect()
}

/// Returns the energy of the force divided by that of `blows`, from the part of the responses
/// beyond their noise.
#[allow(
    clippy::indexing_slicing,
    reason = "shares, blows and responses have one entry per line, and `line` is the index of a line"
)]
pub(super) fn energy_over(
    transformed: &Transformed<'_>,
    shares: &[Vec<f64>],
    blows: &[f64],
) -> f64 {
    let (mut found, mut scatter, mut expected) = (0.0, 0.0, 0.0);
    let sensors = transformed.sensors.iter().zip(&transformed.responses);
    for ((sensor, response), shares) in sensors.zip(shares) {
        for line in (0..blows.len()).filter(|line| transformed.uses(sensor, *line)) {
            let by = transformed.grid.sides(line) * shares[line] * weight(sensor, line, None);
            let noise = sensor.noise_at(line).unwrap_or(0.0);
            found += by * (response[line].norm_sqr() - noise);
            scatter += (by * noise).powi(2);
            let told = sensor.frequency_response[line].norm_sqr() - sensor.variance_at(line);
            expected += by * told * blows[line];
        }
    }
    // noise may make the sum small or negative: it is at least two standard deviations of the noise
    let found = found.max(2.0 * scatter.sqrt());
    if expected > 0.0 {
        found / expected
    } else {
        // the responses determine no force, so the assumed power is unlimited
        f64::INFINITY
    }
}

/// Largest relative difference of durations from those of the calibration blows over which their
/// spectrum is averaged.
const DURATIONS: f64 = 0.3;
/// Number of durations on either side.
const N_DURATIONS: i32 = 10;

/// Smallest ratio of the assumed power to its largest value: a thousandth of the amplitude is not
/// known for any force.
const LEAST_SHARE: f64 = 1e-6;

/// Returns the mean spectrum of the energy of blows of other durations than `blows`: a zero in the
/// spectrum of one blow is not a zero of all blows.
fn of_other_durations(blows: &[f64]) -> Vec<f64> {
    let longer = (-N_DURATIONS..=N_DURATIONS)
        .map(|n| 1.0 + DURATIONS * f64::from(n) / f64::from(N_DURATIONS));
    let count = f64::from(2 * N_DURATIONS + 1);
    let least = LEAST_SHARE * blows.iter().copied().fold(0.0, f64::max);
    (0..blows.len())
        .map(|line| {
            let power = longer.clone().map(|by| at_place(blows, by * line as f64));
            (power.sum::<f64>() / count).max(least)
        })
        .collect()
}

/// Returns the mean over `half` lines on either side and the line itself, mirrored at the ends.
#[allow(
    clippy::indexing_slicing,
    reason = "a mirrored index is below the number of lines"
)]
pub(super) fn mean_about(lines: &[f64], half: usize) -> Vec<f64> {
    let n = lines.len();
    let half = half.min(n.saturating_sub(1));
    let mirrored = |place: usize| {
        let place = place.abs_diff(half);
        lines[if place < n {
            place
        } else {
            2 * (n - 1) - place
        }]
    };
    (0..n)
        .map(|line| {
            let window = line..=line + 2 * half;
            window.map(mirrored).sum::<f64>() / (2 * half + 1) as f64
        })
        .collect()
}

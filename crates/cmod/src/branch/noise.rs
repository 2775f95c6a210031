//! Noise level of the lines, from the stated variance and from their scatter.
//!
//! A stated noise that is too low, or 0 for noisy data, would start courses at random roots.
//! Therefore it is compared with the scatter of each line about the straight line through its
//! neighbours before tracking, and with the misfit of the best course afterwards. Only one factor
//! for all lines is determined in this way.

use std::f64::consts::LN_2;

use num_complex::Complex64;

use super::forward::LineAt;
use super::tracked::Place;
use crate::median::median;

/// Noise assumed if no noise is stated, divided by (½ + |Ψ|²)^½; only the dependence of the noise
/// on Ψ matters.
const ASSUMED: f64 = 0.03;
/// Lower limit of the noise, divided by (¼ + |Ψ|²)^½; it applies even if the stated noise is lower.
const LEAST: f64 = 1e-4;
/// Upper limit of the noise that is inferred from neighbouring lines, divided by (¼ + |Ψ|²)^½.
/// Larger differences between neighbours may be the signal.
const MOST: f64 = 0.1;
/// Scatter of neighbouring lines, as a ratio of variances, up to which the stated noise is
/// accepted.
const SCATTER: f64 = 2.0;
/// Misfit of a course relative to the stated variance up to which the noise level is kept: `EXCESS`
/// at first, `SETTLED` after an adjustment.
const EXCESS: f64 = 1.3;
const SETTLED: f64 = 1.1;
/// Additional tolerance in standard errors of the misfit.
const STANDARD_ERRORS: f64 = 4.0;

pub(super) fn assumed_variance(observed: Complex64) -> f64 {
    ASSUMED * ASSUMED * (0.5 + observed.norm_sqr())
}

pub(super) fn least_variance(observed: Complex64) -> f64 {
    LEAST * LEAST * (0.25 + observed.norm_sqr())
}

/// Noise level: a common factor on the variances of all lines.
pub(super) struct NoiseLevel {
    variance: Vec<f64>,
    stated: bool,
    factor: f64,
    adjusted: bool,
}

impl NoiseLevel {
    /// Returns a first estimate of the noise level from neighbouring lines.
    pub(super) fn of(lines: &[LineAt<'_>], places: &[Place], stated: bool) -> Self {
        let mut scatter = Vec::with_capacity(lines.len());
        let mut row: [Option<(usize, &LineAt<'_>)>; 2] = [None, None];
        for (line, place) in lines.iter().zip(places) {
            if line.missing {
                continue;
            }
            if let [Some((_, first)), Some((_, middle))] = row
                && row
                    .iter()
                    .flatten()
                    .all(|(record, _)| *record == place.record)
            {
                scatter.extend(deviation(first, middle, line));
            }
            row = [row[1], Some((place.record, line))];
        }
        let found = median(&mut scatter).map_or(1.0, |scatter| scatter / LN_2);
        let factor = if stated && found <= SCATTER {
            1.0
        } else {
            let relative = |line: &LineAt<'_>| {
                line.sight.variance / least_variance(line.sight.observed) * LEAST * LEAST
            };
            let usable = lines.iter().filter(|line| !line.missing);
            let mut relative: Vec<f64> = usable.map(relative).collect();
            let most = median(&mut relative).map_or(1.0, |relative| MOST * MOST / relative);
            found.min(most).max(if stated { 1.0 } else { 0.0 })
        };
        Self {
            variance: lines.iter().map(|line| line.sight.variance).collect(),
            stated,
            factor,
            adjusted: false,
        }
    }

    pub(super) fn apply(&self, lines: &mut [LineAt<'_>]) {
        for (line, variance) in lines.iter_mut().zip(&self.variance) {
            line.sight.variance = (self.factor * variance).max(least_variance(line.sight.observed));
        }
    }

    /// Adjusts the level to the misfit of a course over `count` lines; returns true if the level
    /// has changed.
    pub(super) fn adjust(&mut self, (count, excess): (usize, f64)) -> bool {
        // the median of n exponential variables has a relative standard error of 1/(ln 2 √n)
        let spread = STANDARD_ERRORS / (LN_2 * (count as f64).sqrt());
        let limit = if self.adjusted { SETTLED } else { EXCESS };
        let lowest = if self.stated { 1.0 } else { 0.0 };
        let too_high = excess > limit.max(1.0 + spread);
        let too_low = excess < (1.0 / limit).min(1.0 - spread) && self.factor > lowest;
        if !(too_high || too_low) {
            return false;
        }
        self.factor = (self.factor * excess).max(lowest).max(f64::MIN_POSITIVE);
        self.adjusted = true;
        true
    }

    /// Returns the factor on amplitudes.
    pub(super) fn factor(&self) -> f64 {
        self.factor.sqrt()
    }
}

/// Returns the squared distance of a line from the straight line through its neighbours, divided by
/// its expectation for noise alone.
fn deviation(first: &LineAt<'_>, middle: &LineAt<'_>, last: &LineAt<'_>) -> Option<f64> {
    let width = last.omega - first.omega;
    if width <= 0.0 {
        return None;
    }
    let weight = (middle.omega - first.omega) / width;
    let between = first.sight.observed * (1.0 - weight) + last.sight.observed * weight;
    let expected = middle.sight.variance
        + (1.0 - weight).powi(2) * first.sight.variance
        + weight.powi(2) * last.sight.variance;
    Some((middle.sight.observed - between).norm_sqr() / expected)
}

#[cfg(test)]
mod tests;

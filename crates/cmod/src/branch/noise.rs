//! How noisy the lines are, by what is stated and by what they scatter.
//!
//! A noise that is stated too low, or as 0 for data that have some, would let chance decide where courses begin. So it is compared
//! with the scatter of each line about the straight line through its neighbours before anything else, and with the misfit
//! of the best course afterwards. Only one factor for all lines is found in this way.

use std::f64::consts::LN_2;

use num_complex::Complex64;

use super::forward::LineAt;
use super::tracker::Place;

/// Noise that is assumed if none is stated, by (½ + |Ψ|²)^½; only its form matters.
const ASSUMED: f64 = 0.03;
/// No line is trusted beyond this, by (¼ + |Ψ|²)^½, however low its stated noise.
const LEAST: f64 = 1e-4;
/// Noise beyond this, by (¼ + |Ψ|²)^½, is not inferred from neighbours, whose differences may be the signal.
const MOST: f64 = 0.1;
/// Scatter of neighbours, as a variance, that is not yet more than was stated.
const SCATTER: f64 = 2.0;
/// Misfit of a course, as a variance, by what was stated, that is not yet too high; once adjusted, that is not yet settled.
const EXCESS: f64 = 1.3;
const SETTLED: f64 = 1.1;
/// Standard errors of the misfit that are granted beside.
const STANDARD_ERRORS: f64 = 4.0;

pub(super) fn assumed_variance(observed: Complex64) -> f64 {
    ASSUMED * ASSUMED * (0.5 + observed.norm_sqr())
}

pub(super) fn least_variance(observed: Complex64) -> f64 {
    LEAST * LEAST * (0.25 + observed.norm_sqr())
}

/// A factor on the variance of all lines.
pub(super) struct NoiseLevel {
    variance: Vec<f64>,
    stated: bool,
    factor: f64,
    adjusted: bool,
}

impl NoiseLevel {
    /// First guess from neighbouring lines.
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

    /// Takes notice of the misfit of a course over so many lines; returns whether the level has changed.
    pub(super) fn adjust(&mut self, (count, excess): (usize, f64)) -> bool {
        // the median of n exponential variables has a standard error of 1/(ln 2 √n) of itself
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

    /// As an amplitude.
    pub(super) fn factor(&self) -> f64 {
        self.factor.sqrt()
    }
}

/// Square of the distance of a line from the straight line through its neighbours, by its expectation if all of it is noise.
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

fn median(values: &mut [f64]) -> Option<f64> {
    let half = values.len() / 2;
    if values.is_empty() {
        return None;
    }
    let (_, median, _) = values.select_nth_unstable_by(half, f64::total_cmp);
    Some(*median)
}

#[cfg(test)]
mod tests;

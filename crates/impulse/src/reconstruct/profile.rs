//! Profile intervals of linear functions of a force without tension.

#![allow(
    clippy::indexing_slicing,
    reason = "matrix, right side, weights and force have an element for each sample of the support"
)]

use faer::Mat;

use super::non_negative;
use super::outcome::{PivotingEnd, ProfileInterval};

/// First multiplier, as a fraction of that of one standard error of an uncorrelated sample.
const LITTLE: f64 = 1e-6;
/// Largest number of increases of the multiplier until the limit is passed or the force vanishes.
const GROWTHS: usize = 40;
/// Largest number of secant steps.
const STEPS: usize = 40;
/// Relative accuracy at which the search ends.
const ACCURACY: f64 = 1e-5;

/// A least-squares problem without tension, $`\frac12 f^T A f - b^T f`$, and its solution.
pub(super) struct Constrained {
    pub(super) matrix: Mat<f64>,
    pub(super) right_side: Vec<f64>,
    pub(super) force: Vec<f64>,
}

impl Constrained {
    /// Returns the interval of $`l^Tf`$ for non-negative weights l. It contains the values t for
    /// which the least $`f^TAf - 2b^Tf`$ with $`f \ge 0`$ and $`l^Tf = t`$ exceeds the least
    /// without the condition on t by at most the square of a standard normal quantile, where noise
    /// has the weighted variance `noise`. The interval is widened by the `bias` of the number.
    ///
    /// Every t belongs to a multiplier $`\nu`$: t is $`l^Tf`$ at the minimum with $`b + \nu l`$ in
    /// place of b. If samples are held at zero, the exact limit is a quantile of a mixture of
    /// chi-square distributions and is smaller than the limit used here.
    pub(super) fn interval(
        &self,
        weights: &[f64],
        noise: f64,
        bias: f64,
    ) -> Option<ProfileInterval> {
        let value = dot(weights, &self.force);
        let least = self.cost(&self.force);
        let of = |quantile: f64| -> Option<[f64; 2]> {
            let limit = quantile * quantile * noise;
            let low = self.end(weights, (least, limit), -1.0)?;
            let high = self.end(weights, (least, limit), 1.0)?;
            let wider = |end: f64| (end - value).hypot(quantile * bias);
            Some([(value - wider(low)).max(0.0), value + wider(high)])
        };
        Some(ProfileInterval {
            value,
            standard: of(1.0)?,
            wide: of(1.959_963_984_540_054)?,
        })
    }

    /// Returns the value at which the cost is `limit` above the `least`, on the side of `sign`; the
    /// last value found if the cost does not reach this limit.
    fn end(&self, weights: &[f64], (least, limit): (f64, f64), sign: f64) -> Option<f64> {
        let at = |price: f64| -> Option<(f64, f64)> {
            let sides = self.right_side.iter().zip(weights);
            let side: Vec<f64> = sides.map(|(b, l)| b + sign * price * l).collect();
            let (force, report) = non_negative::minimise(&self.matrix, &side, &self.force);
            (report.end == PivotingEnd::Converged)
                .then(|| (dot(weights, &force), self.cost(&force) - least))
        };
        // the cost grows as the square of the multiplier, in proportion to the variance of the
        // number, until a sample becomes zero or ceases to be zero
        let curvature: f64 = (0..weights.len())
            .map(|i| weights[i] * weights[i] * self.matrix[(i, i)])
            .sum::<f64>()
            / dot(weights, weights).powi(2);
        let little = LITTLE * (limit * curvature).sqrt();
        let (aside, _) = at(little)?;
        let variance = (aside - dot(weights, &self.force)).abs() / little;
        let mut high = if variance > 0.0 {
            (limit / variance).sqrt()
        } else {
            little
        };
        let mut found = at(high)?;
        let mut low = (0.0, 0.0);
        for _ in 0..GROWTHS {
            if found.1 >= limit {
                break;
            }
            if found.0 <= 0.0 {
                return Some(found.0);
            }
            low = (high, found.1.max(0.0).sqrt());
            high *= 1.3;
            found = at(high)?;
        }
        let mut top = (high, found.1.sqrt());
        for _ in 0..STEPS {
            if (found.1 / limit - 1.0).abs() < ACCURACY || top.0 - low.0 < ACCURACY * top.0 {
                break;
            }
            let part = (limit.sqrt() - low.1) / (top.1 - low.1);
            // a secant step, limited away from the ends
            let price = low.0 + part.clamp(0.1, 0.9) * (top.0 - low.0);
            found = at(price)?;
            let place = (price, found.1.max(0.0).sqrt());
            if found.1 < limit {
                low = place;
            } else {
                top = place;
            }
        }
        Some(found.0)
    }

    fn cost(&self, force: &[f64]) -> f64 {
        let n = force.len();
        let quadratic: f64 = (0..n)
            .map(|i| {
                let row = (0..n).map(|j| self.matrix[(i, j)] * force[j]);
                force[i] * row.sum::<f64>()
            })
            .sum();
        quadratic - 2.0 * dot(&self.right_side, force)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

//! The profile of χ²: how far a parameter can go if all others follow.

use super::data::ModulusData;
use super::least_squares::{Effort, minimise};
use super::model::Model;

/// A parameter is followed this far on its scale, a factor of 1e5 for a logarithm; without an end until there it has none.
const RANGE: f64 = 11.5;

/// What lies on one side of the minimum.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum End {
    /// χ² has risen by the threshold at this coordinate.
    At(f64),
    /// It has not within [`RANGE`].
    Open,
    /// χ² has fallen: the start of the profile was no global minimum.
    LowerMinimum(Vec<f64>),
}

/// Searches for the coordinate `index` from the minimum `at` in the direction of the sign of `first_step`.
#[allow(
    clippy::indexing_slicing,
    reason = "`index` is that of a parameter of the model, and `at` and the minima have one coordinate for each"
)]
pub(super) fn end<M: Model + ?Sized>(
    model: &M,
    data: &ModulusData,
    at: &[f64],
    chi_squared: f64,
    index: usize,
    first_step: f64,
    threshold: f64,
) -> End {
    let here = at[index];
    let mut inside = at.to_vec();
    let mut rise_inside = 0.0;
    let mut step = first_step;
    let rise_at = |coordinate: f64, start: &[f64]| {
        let mut start = start.to_vec();
        start[index] = coordinate;
        minimise(model, data, &start, Some(index), Effort::Comparison)
            .map(|minimum| (minimum.chi_squared - chi_squared, minimum.at))
    };
    let mut distance: f64 = 0.0;
    let (mut outside, mut rise_outside) = loop {
        distance += step;
        if distance.abs() > RANGE {
            return End::Open;
        }
        // where there is no law, there is an end
        let Some((rise, point)) = rise_at(here + distance, &inside) else {
            break (here + distance, f64::INFINITY);
        };
        if rise < -2e-2 * threshold {
            return End::LowerMinimum(point);
        }
        if rise > threshold {
            break (here + distance, rise);
        }
        inside = point;
        rise_inside = rise;
        step *= 1.6;
    };
    // χ² is nearly a parabola in the coordinate: its root is nearly a straight line
    for _ in 0..20 {
        let (low, high) = (rise_inside.max(0.0).sqrt(), rise_outside.sqrt());
        let share = if high.is_finite() {
            ((threshold.sqrt() - low) / (high - low)).clamp(0.05, 0.95)
        } else {
            0.5
        };
        let middle = inside[index] + share * (outside - inside[index]);
        match rise_at(middle, &inside) {
            Some((rise, _)) if rise > threshold => {
                outside = middle;
                rise_outside = rise;
            }
            Some((rise, point)) => {
                inside = point;
                rise_inside = rise;
            }
            None => {
                outside = middle;
                rise_outside = f64::INFINITY;
            }
        }
        let close = (rise_inside - threshold)
            .abs()
            .min((rise_outside - threshold).abs());
        if close < 1e-2 * threshold || (outside - inside[index]).abs() < 1e-3 {
            break;
        }
    }
    if (rise_outside - threshold).abs() < (threshold - rise_inside).abs() {
        End::At(outside)
    } else {
        End::At(inside[index])
    }
}

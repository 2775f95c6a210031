//! Data sets that contain the times of the other data sets.

use labio::{Ordinate, Series};

/// Tolerance of a time, as a fraction of the step, because times may be written with few digits.
const OFF: f64 = 0.1;
/// Minimum number of values; fewer may be evenly spaced by chance.
const FEWEST: usize = 16;

/// Returns the step of increasing, evenly spaced values; `None` for other values, for fewer than
/// [`FEWEST`] values, and for a data set with a unit.
pub(super) fn step_of(series: &Series) -> Option<f64> {
    let Ordinate::Real(values) = &series.ordinate else {
        return None;
    };
    let (first, last) = (*values.first()?, *values.last()?);
    if values.len() < FEWEST || series.ordinate_axis.unit.is_some() {
        return None;
    }
    let step = (last - first) / (values.len() - 1) as f64;
    let even = step > 0.0
        && step.is_finite()
        && values
            .iter()
            .enumerate()
            .all(|(index, value)| (value - (first + index as f64 * step)).abs() <= OFF * step);
    even.then_some(step)
}

//! Data sets that are the times of the others.

use labio::{Ordinate, Series};

/// How far from its place a time may be, as part of the step: times are written with few digits.
const OFF: f64 = 0.1;
/// Fewer values can grow evenly by chance.
const FEWEST: usize = 16;

/// The step of values that grow evenly; none for anything else, or for a data set with a unit.
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

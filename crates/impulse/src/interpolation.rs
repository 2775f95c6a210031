//! Linear interpolation between equidistant values.

/// Returns the value at `place`, a fractional index of at least 0. Beyond the last value it returns
/// the last value, or 0 if there are no values.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a place among the values, at least 0"
)]
pub(crate) fn at_place(values: &[f64], place: f64) -> f64 {
    let (below, share) = (place as usize, place.fract());
    let at = |index: usize| values.get(index).or(values.last()).copied().unwrap_or(0.0);
    (1.0 - share) * at(below) + share * at(below + 1)
}

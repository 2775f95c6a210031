//! Times of a history of a force, and columns of its bands.

use impulse::{ForceBand, ForceHistory};

use crate::outcome::Table;

/// Returns the times of the samples \[s\].
pub(super) fn times(history: &ForceHistory) -> impl Iterator<Item = f64> {
    (0..history.force().len()).map(|n| history.time_at(n))
}

/// Returns the times of the samples \[ms\].
pub(super) fn milliseconds(history: &ForceHistory) -> Vec<f64> {
    times(history).map(|time| 1e3 * time).collect()
}

/// Returns `table` with columns for the limits of a band of the force.
pub(super) fn with_band(table: Table, name: &str, band: &ForceBand) -> Table {
    table
        .numbers(format!("{name}, lower"), "N", &band.lower)
        .numbers(format!("{name}, upper"), "N", &band.upper)
}

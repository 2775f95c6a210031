//! Errors at the level of rounding.

/// Formats an error with one digit; below `limit`, where its digits depend on the machine, as the
/// limit.
pub(crate) fn above(error: f64, limit: f64) -> String {
    if error < limit {
        format!("< {limit:e}")
    } else {
        format!("{error:.0e}")
    }
}

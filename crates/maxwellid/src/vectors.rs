//! Sums over histories, with the vector instructions of the processor.

use faer::ColRef;

/// Σ aᵢ bᵢ over the length of the shorter one.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len().min(b.len());
    match (a.get(..count), b.get(..count)) {
        (Some(a), Some(b)) => ColRef::from_slice(a).transpose() * ColRef::from_slice(b),
        _ => 0.0,
    }
}

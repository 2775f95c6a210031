//! Parallel evaluation of independent items: the results and their order are those of a plain loop.

/// Returns `f` of each item, in their order; with the feature `rayon` on several threads.
#[cfg(feature = "rayon")]
pub(crate) fn map_in_order<T: Sync, R: Send>(items: &[T], f: impl Fn(&T) -> R + Sync) -> Vec<R> {
    use rayon::prelude::*;
    items.par_iter().map(&f).collect()
}

/// Returns `f` of each item, in their order.
#[cfg(not(feature = "rayon"))]
pub(crate) fn map_in_order<T: Sync, R: Send>(items: &[T], f: impl Fn(&T) -> R + Sync) -> Vec<R> {
    items.iter().map(f).collect()
}

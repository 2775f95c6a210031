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

/// Returns `f` of each place below `count`, in their order; `None` if one result is `None`.
#[cfg(feature = "rayon")]
pub(crate) fn all_in_order<R: Send>(
    count: usize,
    f: impl Fn(usize) -> Option<R> + Sync,
) -> Option<Vec<R>> {
    use rayon::prelude::*;
    (0..count).into_par_iter().map(&f).collect()
}

/// Returns `f` of each place below `count`, in their order; `None` if one result is `None`.
#[cfg(not(feature = "rayon"))]
pub(crate) fn all_in_order<R: Send>(
    count: usize,
    f: impl Fn(usize) -> Option<R> + Sync,
) -> Option<Vec<R>> {
    (0..count).map(f).collect()
}

//! Choice of the lines of a response that are drawn, common to all of its curves.
//!
//! All curves of a response are thinned to the same lines before the phase is interrupted where it
//! wraps. Otherwise each curve would be thinned by itself when it is drawn.

/// Returns the indices of the lines that are drawn. In each of `n_buckets` intervals of equal width
/// on a logarithmic axis of the increasing `x`, these are the first and the last line and, for each
/// curve, the lines with its smallest and its largest ordinate. Values of `x` that are not positive
/// form an interval of their own. All lines are kept if there are at most `4 * n_buckets`.
#[allow(
    clippy::indexing_slicing,
    reason = "x and every curve have the same length, and the indices are below it"
)]
pub(super) fn logarithmically(x: &[f64], curves: &[&[f64]], n_buckets: usize) -> Vec<usize> {
    let n = x.len();
    if n <= 4 * n_buckets {
        return (0..n).collect();
    }
    let ends = x
        .iter()
        .map(|x| x.ln())
        .filter(|x| x.is_finite())
        .fold(None, |ends: Option<(f64, f64)>, x| {
            Some(ends.map_or((x, x), |(first, _)| (first, x)))
        });
    let Some((first, last)) = ends else {
        return (0..n).collect();
    };
    let width = (last - first) / n_buckets as f64;
    let bucket = |index: usize| ((x[index].ln() - first) / width).floor();
    let mut kept = Vec::new();
    let mut start = 0;
    while start < n {
        let here = bucket(start);
        let mut end = start + 1;
        // the logarithm of 0 Hz is not finite, and this line forms a bucket of its own
        while end < n && bucket(end).total_cmp(&here).is_eq() {
            end += 1;
        }
        kept.extend([start, end - 1]);
        for curve in curves {
            let finite = (start..end).filter(|index| curve[*index].is_finite());
            let by = |a: &usize, b: &usize| curve[*a].total_cmp(&curve[*b]);
            kept.extend(finite.clone().min_by(by));
            kept.extend(finite.max_by(by));
        }
        start = end;
    }
    kept.sort_unstable();
    kept.dedup();
    kept
}

/// Returns the values at `indices`.
#[allow(
    clippy::indexing_slicing,
    reason = "`indices` are places in `values`, or in a list of the same lines or samples"
)]
pub(super) fn at(values: &[f64], indices: &[usize]) -> Vec<f64> {
    indices.iter().map(|index| values[*index]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_peak_survives_and_a_short_curve_is_whole() {
        let x: Vec<f64> = (0..10_000_u32).map(f64::from).collect();
        let mut y = vec![0.0; x.len()];
        y[4321] = 1.0;
        y[7777] = f64::NAN;
        let kept = logarithmically(&x, &[&y], 100);
        assert!(kept.contains(&4321) && kept.contains(&0) && kept.contains(&9999));
        assert!(kept.len() <= 410 && kept.is_sorted(), "{}", kept.len());
        assert_eq!(logarithmically(&x[..50], &[&y[..50]], 100).len(), 50);
        // all lines at the same frequency
        assert!(!logarithmically(&[1.0; 50], &[&[0.0; 50]], 2).is_empty());
    }
}

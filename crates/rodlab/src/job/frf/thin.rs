//! Fewer points for a figure, with every peak kept.

/// Indices of a curve that has at most about four times `n_buckets` points: first and last, smallest and largest ordinate of each
/// bucket of equal width of `x`, which grows. A curve of fewer points is kept whole.
pub(super) fn evenly(x: &[f64], curves: &[&[f64]], n_buckets: usize) -> Vec<usize> {
    by_bucket(x, curves, n_buckets, |x| x)
}

/// The same with buckets of equal width on a logarithmic axis; what is not positive is in the first.
pub(super) fn logarithmically(x: &[f64], curves: &[&[f64]], n_buckets: usize) -> Vec<usize> {
    by_bucket(x, curves, n_buckets, f64::ln)
}

fn by_bucket(
    x: &[f64],
    curves: &[&[f64]],
    n_buckets: usize,
    scale: impl Fn(f64) -> f64,
) -> Vec<usize> {
    let n = x.len();
    if n <= 4 * n_buckets {
        return (0..n).collect();
    }
    let ends = x
        .iter()
        .map(|x| scale(*x))
        .filter(|x| x.is_finite())
        .fold(None, |ends: Option<(f64, f64)>, x| {
            Some(ends.map_or((x, x), |(first, _)| (first, x)))
        });
    let Some((first, last)) = ends else {
        return (0..n).collect();
    };
    let width = (last - first) / n_buckets as f64;
    let bucket = |index: usize| ((scale(x[index]) - first) / width).floor();
    let mut kept = Vec::new();
    let mut start = 0;
    while start < n {
        let here = bucket(start);
        let mut end = start + 1;
        // not finite (0 Hz on a logarithmic axis) is a bucket by itself
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

/// The values at `indices`.
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
        for kept in [evenly(&x, &[&y], 100), logarithmically(&x, &[&y], 100)] {
            assert!(kept.contains(&4321) && kept.contains(&0) && kept.contains(&9999));
            assert!(kept.len() <= 410 && kept.is_sorted(), "{}", kept.len());
        }
        assert_eq!(evenly(&x[..50], &[&y[..50]], 100).len(), 50);
        // an axis without length
        assert!(!evenly(&[1.0; 50], &[&[0.0; 50]], 2).is_empty());
    }
}

//! Reduction of the number of points in a figure, which keeps all peaks.

/// Returns the indices of a curve reduced to about four times `n_buckets` points: the first and the
/// last point, and the points with the smallest and the largest ordinate, in each of `n_buckets`
/// intervals of equal width of the increasing `x`. A curve with fewer points is kept whole.
pub(super) fn evenly(x: &[f64], curves: &[&[f64]], n_buckets: usize) -> Vec<usize> {
    by_bucket(x, curves, n_buckets, |x| x)
}

/// Returns indices like [`evenly`], with intervals of equal width on a logarithmic axis; values
/// that are not positive form an interval of their own.
pub(super) fn logarithmically(x: &[f64], curves: &[&[f64]], n_buckets: usize) -> Vec<usize> {
    by_bucket(x, curves, n_buckets, f64::ln)
}

#[allow(
    clippy::indexing_slicing,
    reason = "x and every curve have the same length, and the indices are below it"
)]
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
        // values that are not finite (0 Hz on a logarithmic axis) form a bucket of their own
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

/// Returns the indices of a curve that runs back and forth: points separated by more than
/// `fraction` of its extent, and the first of every part between points that are not finite.
#[allow(
    clippy::indexing_slicing,
    reason = "the indices are below the lengths of both lists"
)]
pub(super) fn along(x: &[f64], y: &[f64], fraction: f64) -> Vec<usize> {
    let extent = |values: &[f64]| {
        let finite = values.iter().copied().filter(|value| value.is_finite());
        let (least, greatest) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), value| {
            (a.min(value), b.max(value))
        });
        (greatest - least).max(0.0)
    };
    let apart = fraction * extent(x).max(extent(y));
    let finite = |index: usize| x[index].is_finite() && y[index].is_finite();
    let mut kept: Vec<usize> = Vec::new();
    for index in 0..x.len().min(y.len()) {
        let keep = match kept.last() {
            None => true,
            Some(&last) if finite(last) && finite(index) => {
                (x[index] - x[last]).hypot(y[index] - y[last]) > apart
            }
            Some(&last) => finite(last) || finite(index),
        };
        if keep {
            kept.push(index);
        }
    }
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
    fn a_circle_stays_round_and_an_interruption_stays_one() {
        let turns: Vec<f64> = (0..20_000_u32).map(|k| f64::from(k) * 1e-3).collect();
        let x: Vec<f64> = turns.iter().map(|t| t.cos()).collect();
        let mut y: Vec<f64> = turns.iter().map(|t| t.sin()).collect();
        y[500..600].fill(f64::NAN);
        let kept = along(&x, &y, 0.01);
        // an arc of 20 rad with radius 1, in steps of hardly more than 2/100
        assert!((900..1010).contains(&kept.len()), "{}", kept.len());
        assert_eq!(kept.iter().filter(|index| y[**index].is_nan()).count(), 1);
    }

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
        // an axis of length zero
        assert!(!evenly(&[1.0; 50], &[&[0.0; 50]], 2).is_empty());
    }
}

//! Median of a list.

/// Returns the median of `values`, whose order changes; for an even number of values, the upper of
/// the two middle ones.
pub(crate) fn median(values: &mut [f64]) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    let (_, median, _) = values.select_nth_unstable_by(values.len() / 2, f64::total_cmp);
    Some(*median)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_median_is_the_middle() {
        let found = [
            &mut [][..],
            &mut [5.0, -1.0, 3.0],
            &mut [4.0, 1.0, 3.0, 2.0],
        ]
        .map(median);
        assert_eq!(found, [None, Some(3.0), Some(3.0)]);
    }
}

//! Numbers in messages, rounded to a given number of significant digits.

/// Returns `value` as text with `digits` significant digits, with an exponent only below 1e-4 and
/// from 1e7 on.
///
/// ```
/// use rodwave::digits::significant;
///
/// assert_eq!(significant(12.9187, 3), "12.9");
/// assert_eq!(significant(1.5e-7, 2), "1.5e-7");
/// ```
#[must_use]
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let exponential = format!("{value:.*e}", digits.saturating_sub(1));
    let exponent: i32 = exponential
        .split_once('e')
        .and_then(|(_, exponent)| exponent.parse().ok())
        .unwrap_or(0);
    if !(-4..7).contains(&exponent) {
        return exponential;
    }
    let wanted = i32::try_from(digits).unwrap_or(i32::MAX);
    let decimals = usize::try_from((wanted - 1).saturating_sub(exponent)).unwrap_or(0);
    // the rounded number, so that 9996 to three digits is 10000 and not 9996
    let rounded: f64 = exponential.parse().unwrap_or(value);
    format!("{rounded:.decimals$}")
}

/// Returns a fraction as text in per cent, with two significant digits.
#[must_use]
pub fn percent(relative: f64) -> String {
    format!("{} %", significant(100.0 * relative, 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_those_that_are_meant() {
        let three = |value| significant(value, 3);
        let words = [0.0, 2.612, 0.071_23, 9996.0, 1.5e-7, 2.6e9, -41.26, 999.96].map(three);
        assert_eq!(
            words,
            [
                "0", "2.61", "0.0712", "10000", "1.50e-7", "2.60e9", "-41.3", "1000"
            ]
        );
        assert_eq!(significant(f64::NAN, 3), "NaN");
        assert_eq!(percent(0.004_04), "0.40 %");
    }
}

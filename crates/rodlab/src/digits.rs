//! Numbers in sentences and words.

/// `value` to `digits` significant digits, with an exponent only where zeros would have to be
/// counted.
#[must_use]
pub(crate) fn significant(value: f64, digits: usize) -> String {
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

/// A relative standard error in per cent, to two digits.
#[must_use]
pub(crate) fn percent(relative: f64) -> String {
    format!("{} %", significant(100.0 * relative, 2))
}

/// `value` to four digits without trailing zeros, and to all digits before the point.
#[must_use]
pub(crate) fn short(value: f64) -> String {
    let magnitude = value.abs();
    if !value.is_finite() || (magnitude > 0.0 && !(1e-3..1e5).contains(&magnitude)) {
        return format!("{value:.3e}");
    }
    let text = if magnitude < 1e3 {
        significant(value, 4)
    } else {
        format!("{value:.0}")
    };
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// A frequency, in Hz or kHz.
#[must_use]
pub(crate) fn hertz(frequency_hz: f64) -> String {
    if frequency_hz < 1000.0 {
        format!("{} Hz", short(frequency_hz))
    } else {
        format!("{} kHz", short(frequency_hz / 1000.0))
    }
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

    #[test]
    fn numbers_are_short() {
        let numbers = [
            0.0,
            0.012345,
            1.0,
            12.3456,
            999.96,
            16_384.0,
            51_200.0,
            1e-7,
            f64::NAN,
        ];
        let texts = numbers.map(short).join(" ");
        assert_eq!(texts, "0 0.01235 1 12.35 1000 16384 51200 1.000e-7 NaN");
        assert_eq!(hertz(51_200.0), "51.2 kHz");
    }
}

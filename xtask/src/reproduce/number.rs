//! Human-readable numbers.

/// Formats a number with a given count of significant digits; an exponent is used only if the
/// number would be hard to read without it.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let text = format!("{:.*e}", digits - 1, value);
    let exponent: i32 = text
        .split_once('e')
        .and_then(|(_, exponent)| exponent.parse().ok())
        .unwrap_or(0);
    if (-4..6).contains(&exponent) {
        let decimals =
            usize::try_from(i32::try_from(digits).unwrap_or(0) - 1 - exponent).unwrap_or(0);
        // converted from the rounded text, so that the requested digits are shown
        format!("{:.*}", decimals, text.parse::<f64>().unwrap_or(value))
    } else {
        text
    }
}

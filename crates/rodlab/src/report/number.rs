//! Numbers as a reader wants them: no digits that mean nothing.

/// `value` with its standard error, both to the second digit of the error; without one, to five digits.
///
/// Large and small numbers have one power of ten for both: `(2.612 ± 0.014)×10⁹`.
pub(super) fn with_error(value: Option<f64>, error: Option<f64>) -> String {
    let Some(value) = value.filter(|value| value.is_finite()) else {
        return "none".to_owned();
    };
    let Some(error) = error.filter(|error| error.is_finite() && *error >= 0.0) else {
        return alone(value);
    };
    if error <= 0.0 {
        return format!("{} ± 0", alone(value));
    }
    // rounding may carry into the next power: 0.0996 is 0.10
    let last = exponent(rounded(error, exponent(error) - 1.0)) - 1.0;
    let leading = exponent(value.abs().max(error));
    let power = if (-4.0..6.0).contains(&leading) && last <= 0.0 {
        0.0
    } else {
        leading
    };
    let scale = 10_f64.powf(power);
    let digits = places(power - last);
    let pair = format!(
        "{:.digits$} ± {:.digits$}",
        rounded(value, last) / scale,
        rounded(error, last) / scale
    );
    minus(&if power.abs() < 0.5 {
        pair
    } else {
        format!("({pair})×10{}", superscript(power))
    })
}

/// `value` to five digits.
pub(super) fn alone(value: f64) -> String {
    if !value.is_finite() {
        return String::new();
    }
    if value.abs() <= 0.0 {
        return "0".to_owned();
    }
    let leading = exponent(value);
    if (-4.0..6.0).contains(&leading) {
        let text = format!("{:.*}", places(4.0 - leading), value);
        return minus(trimmed(&text));
    }
    let mantissa = format!("{:.4}", value / 10_f64.powf(leading));
    minus(&format!(
        "{}×10{}",
        trimmed(&mantissa),
        superscript(leading)
    ))
}

fn trimmed(text: &str) -> &str {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        text
    }
}

fn minus(text: &str) -> String {
    text.replace('-', "−")
}

fn exponent(value: f64) -> f64 {
    (value.abs().log10() + 1e-12).floor()
}

fn rounded(value: f64, last: f64) -> f64 {
    let unit = 10_f64.powf(last);
    (value / unit).round() * unit
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a number of decimal places from 0 to 17"
)]
fn places(count: f64) -> usize {
    count.clamp(0.0, 17.0).round() as usize
}

fn superscript(power: f64) -> String {
    crate::figure::superscript(power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_says_how_many_digits_the_value_has() {
        let shown = [
            (2.61234, 0.01412),
            (2.61234, 0.0996),
            (2.61234, 14.0),
            (0.070012, 0.00041),
            (2.61234e9, 1.412e7),
            (-1.5e-7, 2.3e-9),
            (799.0, 0.3),
            (123_456.0, 21.0),
            (123_456.0, 2100.0),
            (0.0, 0.02),
        ]
        .map(|(value, error)| with_error(Some(value), Some(error)))
        .join("\n");
        insta::assert_snapshot!(shown, @r"
        2.612 ± 0.014
        2.61 ± 0.10
        3 ± 14
        0.07001 ± 0.00041
        (2.612 ± 0.014)×10⁹
        (−1.500 ± 0.023)×10⁻⁷
        799.00 ± 0.30
        123456 ± 21
        (1.235 ± 0.021)×10⁵
        0.000 ± 0.020
        ");
    }

    #[test]
    fn a_number_without_error_has_five_digits() {
        let shown = [
            1.0,
            1.0 / 3.0,
            51_200.0,
            2.6e9,
            -1.23456789e-6,
            0.0,
            123_456.7,
        ]
        .map(alone)
        .join(" ");
        assert_eq!(shown, "1 0.33333 51200 2.6×10⁹ −1.2346×10⁻⁶ 0 123457");
        assert_eq!(with_error(None, Some(1.0)), "none");
        assert_eq!(with_error(Some(1.5), None), "1.5");
    }
}

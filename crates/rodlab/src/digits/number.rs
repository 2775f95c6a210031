//! Numbers for tables and sentences, without meaningless digits.

use rodfigure::superscript;

use super::{prefix_for, trimmed};

/// Returns `value` with its standard error, both rounded to the second significant digit of the
/// error. Without an error the value has five digits.
///
/// Large and small numbers share a power of ten with their error: `(2.612 ± 0.014)×10⁹`.
pub(crate) fn with_error(value: Option<f64>, error: Option<f64>) -> String {
    let Some(value) = value.filter(|value| value.is_finite()) else {
        return "none".to_owned();
    };
    let Some(error) = error.filter(|error| error.is_finite() && *error >= 0.0) else {
        return alone(value);
    };
    if error <= 0.0 {
        return format!("{} ± 0", alone(value));
    }
    // rounding may carry into the next power of ten: 0.0996 becomes 0.10
    let last = exponent(rounded(error, exponent(error) - 1.0)) - 1.0;
    let leading = exponent(value.abs().max(error));
    let power = if (-3.0..6.0).contains(&leading) && (-7.0..=1.0).contains(&last) {
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

/// Returns `value` in `unit`, with the prefix that suits the larger of value and standard error:
/// `(2.012 ± 0.021) kN`, or `2.0118 kN` without an error.
pub(crate) fn with_unit(value: f64, error: Option<f64>, unit: &str) -> String {
    let error = error.filter(|error| error.is_finite() && *error > 0.0);
    let (size, prefix) = prefix_for(value.abs().max(error.unwrap_or(0.0)), unit);
    let number = match error {
        Some(error) => match with_error(Some(value / size), Some(error / size)) {
            pair if pair.starts_with('(') => pair,
            pair => format!("({pair})"),
        },
        None => alone(value / size),
    };
    format!("{} {prefix}{unit}", number.replace('−', "-"))
}

/// Returns `value` to five significant digits without trailing zeros; numbers from 1e5 to 1e6 are
/// rounded to whole numbers.
pub(crate) fn alone(value: f64) -> String {
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

/// Returns the numbers of one column; values that are not finite are empty. If the greatest is
/// between 1e-3 and 1e7 and at most 1000 times the least, all numbers have the same number of
/// decimals: the greatest has at least five digits, or six from 1000 on, and decimals that are zero
/// in all numbers are omitted. Otherwise each number has five significant digits.
pub(crate) fn in_line(values: &[f64]) -> Vec<String> {
    let sizes = || {
        values
            .iter()
            .map(|value| value.abs())
            .filter(|size| size.is_finite() && *size > 0.0)
    };
    let (least, greatest) = (
        sizes().fold(f64::INFINITY, f64::min),
        sizes().fold(0.0, f64::max),
    );
    let leading = exponent(greatest);
    if !(1e-3..1e7).contains(&greatest) || greatest > 1e3 * least {
        return values.iter().copied().map(alone).collect();
    }
    let most = places(if leading >= 3.0 { 5.0 } else { 4.0 } - leading);
    let written = |digits: usize| -> Vec<String> {
        values
            .iter()
            .map(|value| {
                if value.is_finite() {
                    minus(&format!(
                        "{:.digits$}",
                        if value.abs() > 0.0 { *value } else { 0.0 }
                    ))
                } else {
                    String::new()
                }
            })
            .collect()
    };
    // trailing decimals that are zero in all numbers are omitted
    let full = written(most);
    let needed = full
        .iter()
        .filter_map(|text| trimmed(text).split_once('.'))
        .map(|(_, decimals)| decimals.len())
        .max();
    written(needed.unwrap_or(0))
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
            (411.0, 160.0),
            (7.264_74e-4, 8.6e-8),
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
        410 ± 160
        (7.26474 ± 0.00086)×10⁻⁴
        123456 ± 21
        (1.235 ± 0.021)×10⁵
        0.000 ± 0.020
        ");
    }

    #[test]
    fn a_unit_has_the_prefix_of_its_number() {
        assert_eq!(with_unit(2011.8, Some(20.51), "N"), "(2.012 ± 0.021) kN");
        assert_eq!(with_unit(58.2e-6, None, "s"), "58.2 us");
        assert_eq!(
            with_unit(-3.2737, Some(0.2479), "N s"),
            "(-3.27 ± 0.25) N s"
        );
        assert_eq!(with_unit(0.0, Some(0.0), "N"), "0 N");
    }

    #[test]
    fn the_points_of_a_column_are_in_line() {
        let shown = |values: &[f64]| in_line(values).join(" ");
        assert_eq!(shown(&[2.643_04, -2.66119, f64::NAN]), "2.6430 −2.6612 ");
        assert_eq!(shown(&[250.0, 373.418, 10_000.0]), "250.0 373.4 10000.0");
        assert_eq!(shown(&[125.0, 250.0, 375.0]), "125 250 375");
        assert_eq!(shown(&[1e-9, 2.0]), "1×10⁻⁹ 2");
        assert_eq!(shown(&[0.0, 0.5]), "0.0 0.5");
        assert_eq!(shown(&[]), "");
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

//! Numbers as they are written in sentences.

mod number;

pub(crate) use number::{alone, in_line, with_error, with_unit};
pub(crate) use rodwave::digits::{percent, significant};

/// Returns `value` to four significant digits without trailing zeros; from 1e3 to 1e5 as a whole
/// number; below 1e-3 and from 1e5 on in exponential notation.
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
    trimmed(&text).to_owned()
}

/// Returns `value` rounded to the second significant digit of its standard error, but with at least
/// three significant digits.
#[must_use]
pub(crate) fn to_error(value: f64, error: f64) -> String {
    let orders = value.abs().log10().floor() - error.abs().log10().floor();
    let digits = if orders.is_finite() {
        orders + 2.0
    } else {
        3.0
    };
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a number of digits from 3 to 12"
    )]
    significant(value, digits.clamp(3.0, 12.0) as usize)
}

/// Prefixes from 10⁻⁹ to 10⁹.
const PREFIXES: [(f64, &str); 7] = [
    (1e9, "G"),
    (1e6, "M"),
    (1e3, "k"),
    (1.0, ""),
    (1e-3, "m"),
    (1e-6, "u"),
    (1e-9, "n"),
];

/// Returns the size and the symbol of the largest prefix with which the absolute value is at least
/// 1. No prefix is returned for a value below 10⁻⁹ or a unit that is not used with prefixes.
#[must_use]
pub(crate) fn prefix_for(value: f64, unit: &str) -> (f64, &'static str) {
    let is_prefixed = matches!(
        unit,
        "Pa" | "Pa s" | "s" | "Hz" | "N" | "J" | "m" | "J/m3" | "J/m^3" | "J/mol"
    );
    let fits = |(size, _): &&(f64, &str)| value.abs() >= *size;
    let largest = PREFIXES.iter().find(fits).filter(|_| is_prefixed);
    largest.copied().unwrap_or((1.0, ""))
}

/// Returns a frequency in Hz or, from 1000 Hz on, in kHz.
#[must_use]
pub(crate) fn hertz(frequency_hz: f64) -> String {
    if frequency_hz < 1000.0 {
        format!("{} Hz", short(frequency_hz))
    } else {
        format!("{} kHz", short(frequency_hz / 1000.0))
    }
}

/// Returns a sampling rate in Hz to six digits, without trailing zeros.
pub(crate) fn rate(rate_hz: f64) -> String {
    trimmed(&significant(rate_hz, 6)).to_owned()
}

/// Returns the number without trailing zeros after the decimal point.
fn trimmed(text: &str) -> &str {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

//! Conversion of columns to numbers.

use std::borrow::Cow;

/// Parses the number in `field`, correctly rounded. Blanks around it are ignored; `None` if the
/// field is blank or not a number.
///
/// The exponent may be written with `E`, `D` or `Q` in upper or lower case, or with its sign alone
/// (`1.5-101`), as Fortran writes exponents of three digits. `NaN` and `Infinity` are numbers.
pub(in crate::format::uff58) fn parse(field: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(field.trim_ascii()).ok()?;
    let value: f64 = text.parse().ok().or_else(|| respelt(text)?.parse().ok())?;
    let has_overflowed = !value.is_finite() && text.bytes().any(|byte| byte.is_ascii_digit());
    (!has_overflowed).then_some(value)
}

/// Returns half a unit of the last digit of the number in `field`, its largest rounding error.
pub(in crate::format::uff58) fn half_unit(field: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(field.trim_ascii()).ok()?;
    let text = respelt(text).map_or(Cow::Borrowed(text), Cow::Owned);
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((&text, "0"));
    let decimals = mantissa
        .split_once('.')
        .map_or(0, |(_, digits)| digits.len());
    let power = exponent
        .parse::<i32>()
        .ok()?
        .checked_sub(i32::try_from(decimals).ok()?)?;
    let half: f64 = format!("0.5e{power}").parse().ok()?;
    half.is_finite().then_some(half)
}

/// Respells an exponent that is written without `E`; `None` if there is none.
fn respelt(text: &str) -> Option<String> {
    if text.contains(['e', 'E']) {
        return None;
    }
    let at = text.get(1..)?.find(['D', 'd', 'Q', 'q', '+', '-'])? + 1;
    let (mantissa, exponent) = text.split_at(at);
    let exponent = exponent
        .strip_prefix(['D', 'd', 'Q', 'q'])
        .unwrap_or(exponent);
    Some(format!("{mantissa}e{exponent}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn every_spelling_of_an_exponent_is_read() {
        let cases: [(&str, f64); 12] = [
            (" -1.47553E-02", -1.47553e-2),
            ("1.5D+03", 1500.0),
            ("1.5d3", 1500.0),
            ("1.5Q-3", 0.0015),
            ("1.5-101", 1.5e-101),
            ("1.5+101", 1.5e101),
            ("5.00000E-005", 5e-5),
            ("  17", 17.0),
            (".5", 0.5),
            ("-5.E1 ", -50.0),
            (
                "0.0000000000000000000000001234567890123456789",
                1.234567890123456789e-25,
            ),
            ("1.234567890123E-15", 1.234567890123e-15),
        ];
        for (text, expected) in cases {
            assert_eq!(
                parse(text.as_bytes()).map(f64::to_bits),
                Some(expected.to_bits()),
                "{text}"
            );
        }
        assert!(parse(b" NaN ").unwrap().is_nan());
        assert_eq!(parse(b"-Infinity"), Some(f64::NEG_INFINITY));
    }

    #[test]
    fn the_last_digit_tells_the_rounding() {
        assert_eq!(half_unit(b" 1.52588E-05"), Some(0.5e-10));
        assert_eq!(half_unit(b"-1.0D0"), Some(0.05));
        assert_eq!(half_unit(b"2"), Some(0.5));
    }

    #[test]
    fn what_is_no_number_is_none() {
        for text in [
            "", "    ", "1.5E", "1.5E+", "1 5", "1.5.0", "*****", "E5", "-", "1.5F3", "1.5E3 2",
            "0x10", "1e999999",
        ] {
            assert_eq!(parse(text.as_bytes()), None, "{text}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn any_double_is_read_as_the_standard_library_reads_it(bits: u64) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            for text in [format!("{value:e}"), format!("{value:.12E}"), format!("{value:.5E}")] {
                let expected: f64 = text.parse().unwrap();
                prop_assert_eq!(parse(text.as_bytes()).map(f64::to_bits), Some(expected.to_bits()));
                prop_assert_eq!(parse(text.replace(['e', 'E'], "D").as_bytes()).map(f64::to_bits), Some(expected.to_bits()));
            }
        }
    }
}

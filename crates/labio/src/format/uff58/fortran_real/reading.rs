//! Conversion of columns to numbers.

use super::digit;

/// The powers of ten that are exact as `f64`.
const POWERS_OF_TEN: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// Parses the number in `field`, correctly rounded. Blanks around it are ignored; `None` if the
/// field is blank or not a number.
///
/// The exponent may be written with `E`, `D` or `Q` in upper or lower case, or with its sign alone
/// (`1.5-101`), as Fortran writes exponents of three digits.
pub(in crate::format::uff58) fn parse(field: &[u8]) -> Option<f64> {
    let text = field.trim_ascii();
    let (negative, digits) = match text.split_first()? {
        (b'-', rest) => (true, rest),
        (b'+', rest) => (false, rest),
        _ => (false, text),
    };
    let mut mantissa: u64 = 0;
    let mut n_digits = 0_usize;
    let mut decimals: i32 = 0;
    let mut after_point = false;
    let mut rest = digits;
    while let Some((&byte, tail)) = rest.split_first() {
        match byte {
            b'0'..=b'9' => {
                n_digits += 1;
                // 19 digits fit; numbers with more digits are left to the standard library below
                mantissa = mantissa
                    .wrapping_mul(10)
                    .wrapping_add(u64::from(byte - b'0'));
                decimals += i32::from(after_point);
            }
            b'.' if !after_point => after_point = true,
            _ => break,
        }
        rest = tail;
    }
    if n_digits == 0 {
        return word(text);
    }
    let written_exponent = exponent(rest)?;
    let power = written_exponent - decimals;
    let exact_power = usize::try_from(power.unsigned_abs())
        .ok()
        .and_then(|p| POWERS_OF_TEN.get(p));
    if let (true, Some(scale)) = (n_digits <= 19 && mantissa < (1 << 53), exact_power) {
        // both factors are exact doubles, so that only one rounding occurs
        let mantissa = mantissa as f64;
        let magnitude = if power < 0 {
            mantissa / scale
        } else {
            mantissa * scale
        };
        return Some(if negative { -magnitude } else { magnitude });
    }
    let digits = digits.get(..digits.len() - rest.len())?;
    by_standard_library(negative, digits, written_exponent)
}

/// Returns half a unit of the last digit of the number in `field`, its largest rounding error.
pub(in crate::format::uff58) fn half_unit(field: &[u8]) -> Option<f64> {
    let text = field.trim_ascii();
    let unsigned = text
        .strip_prefix(b"-")
        .or(text.strip_prefix(b"+"))
        .unwrap_or(text);
    let end = unsigned
        .iter()
        .position(|byte| !matches!(byte, b'0'..=b'9' | b'.'));
    let (digits, rest) = unsigned.split_at(end.unwrap_or(unsigned.len()));
    let point = digits.iter().position(|byte| *byte == b'.');
    let decimals = point.map_or(0, |point| digits.len() - point - 1);
    let power = exponent(rest)?.checked_sub(i32::try_from(decimals).ok()?)?;
    by_standard_library(false, b"0.5", power)
}

/// Parses the exponent in `rest`; an empty text means 0.
fn exponent(rest: &[u8]) -> Option<i32> {
    let (&first, tail) = match rest.split_first() {
        None => return Some(0),
        Some(split) => split,
    };
    let signed = match first {
        b'E' | b'e' | b'D' | b'd' | b'Q' | b'q' => tail,
        b'+' | b'-' => rest,
        _ => return None,
    };
    let (negative, digits) = match signed.split_first()? {
        (b'-', digits) => (true, digits),
        (b'+', digits) => (false, digits),
        _ => (false, signed),
    };
    if digits.is_empty() || digits.len() > 5 {
        return None;
    }
    let mut value = 0_i32;
    for byte in digits {
        if !byte.is_ascii_digit() {
            return None;
        }
        value = value * 10 + i32::from(byte - b'0');
    }
    Some(if negative { -value } else { value })
}

/// Converts numbers with many digits or a large exponent; `None` on overflow.
fn by_standard_library(negative: bool, digits: &[u8], exponent: i32) -> Option<f64> {
    let mut text = Vec::with_capacity(digits.len() + 8);
    if negative {
        text.push(b'-');
    }
    text.extend(digits);
    text.push(b'e');
    if exponent < 0 {
        text.push(b'-');
    }
    let mut place = 10_000;
    while place > 0 {
        text.push(digit(u64::from(exponent.unsigned_abs() / place % 10)));
        place /= 10;
    }
    let value: f64 = std::str::from_utf8(&text).ok()?.parse().ok()?;
    value.is_finite().then_some(value)
}

/// Recognises Fortran's words for non-finite values.
fn word(text: &[u8]) -> Option<f64> {
    let is = |word: &str| text.eq_ignore_ascii_case(word.as_bytes());
    if is("nan") {
        Some(f64::NAN)
    } else if is("inf") || is("+inf") || is("infinity") || is("+infinity") {
        Some(f64::INFINITY)
    } else if is("-inf") || is("-infinity") {
        Some(f64::NEG_INFINITY)
    } else {
        None
    }
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

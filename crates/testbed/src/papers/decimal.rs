//! Exact decimal arithmetic on printed digits.
//!
//! For example, `40.85 GPa s` becomes 40.85·10⁹ Pa s by a shift of the decimal point, not by a
//! product of binary numbers. Only the conversion of the result to the nearest `f64` rounds.

/// Number `digits` · 10^`exponent`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Decimal {
    digits: i128,
    exponent: i32,
}

impl Decimal {
    /// Creates the number `digits` · 10^`exponent`.
    pub const fn new(digits: i128, exponent: i32) -> Self {
        Self { digits, exponent }
    }

    /// Reads numbers such as `38.16`, `-1`, `4.55e-21`. Trailing zeros are kept as printed digits.
    pub fn parse(text: &str) -> Option<Self> {
        let (mantissa, exponent) = match text.split_once('e') {
            Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
            None => (text, 0),
        };
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let all_digits = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
        let unsigned = whole.strip_prefix('-').unwrap_or(whole);
        if unsigned.is_empty()
            || !all_digits(unsigned)
            || !all_digits(fraction)
            || mantissa.ends_with('.')
        {
            return None;
        }
        let places = i32::try_from(fraction.len()).ok()?;
        Some(Self {
            digits: format!("{whole}{fraction}").parse().ok()?,
            exponent: exponent.checked_sub(places)?,
        })
    }

    /// Returns half a unit of the last printed digit.
    pub fn half_unit_of_last_digit(self) -> Self {
        Self::new(5, self.exponent.saturating_sub(1))
    }

    /// Returns the exact product; `None` if it has more than 38 digits.
    pub fn times(self, other: Self) -> Option<Self> {
        Some(Self {
            digits: self.digits.checked_mul(other.digits)?,
            exponent: self.exponent.checked_add(other.exponent)?,
        })
    }

    /// Returns the exact sum; `None` if it has more than 38 digits.
    pub fn plus(self, other: Self) -> Option<Self> {
        let exponent = self.exponent.min(other.exponent);
        let shifted = |term: Self| {
            let places = u32::try_from(term.exponent.checked_sub(exponent)?).ok()?;
            term.digits.checked_mul(10_i128.checked_pow(places)?)
        };
        Some(Self {
            digits: shifted(self)?.checked_add(shifted(other)?)?,
            exponent,
        })
    }

    /// Returns the nearest `f64`.
    #[expect(
        clippy::expect_used,
        reason = "an integer, the letter e and an integer are always the text of a float"
    )]
    pub fn to_f64(self) -> f64 {
        format!("{}e{}", self.digits, self.exponent)
            .parse()
            .expect("digits and exponent are integers")
    }
}

#[cfg(test)]
#[expect(
    clippy::float_cmp,
    reason = "the digits are shifted as text: each value is the float of the written number"
)]
mod tests {
    use super::*;

    #[test]
    fn keeps_every_printed_digit() {
        assert_eq!(Decimal::parse("2.580"), Some(Decimal::new(2580, -3)));
        assert_eq!(Decimal::parse("4.55e-21"), Some(Decimal::new(455, -23)));
        assert_eq!(Decimal::parse("-1"), Some(Decimal::new(-1, 0)));
        assert_eq!(Decimal::parse("-0.5"), Some(Decimal::new(-5, -1)));
        assert_eq!(Decimal::parse("0.0405"), Some(Decimal::new(405, -4)));
    }

    #[test]
    fn refuses_what_is_not_a_printed_number() {
        for text in [
            "", ".", "1.", ".5", "1,5", "1.2.3", "1e", "1e0.5", "+1", "--1", "1.-5", "—", "NaN",
            "inf", "2 5",
        ] {
            assert_eq!(Decimal::parse(text), None, "{text}");
        }
        assert_eq!(
            Decimal::parse(&"9".repeat(60)),
            None,
            "more digits than fit"
        );
    }

    #[test]
    fn a_shift_of_the_point_gives_the_float_of_the_written_number() {
        // the product of floats is inexact, as the last assertion shows
        let shift = |text: &str, exponent| {
            Decimal::parse(text)
                .and_then(|number| number.times(Decimal::new(1, exponent)))
                .map(Decimal::to_f64)
        };
        assert_eq!(shift("7.917", 18), Some(7.917e18));
        assert_eq!(shift("16.1", -3), Some(0.0161));
        assert_eq!(shift("1.90", -2), Some(0.019));
        assert_ne!(16.1 * 1e-3, 0.0161);
    }

    #[test]
    fn sums_and_half_units_are_exact() {
        let celsius = Decimal::new(213, -1);
        assert_eq!(
            celsius.plus(Decimal::new(27315, -2)),
            Some(Decimal::new(29445, -2))
        );
        assert_eq!(celsius.half_unit_of_last_digit().to_f64(), 0.05);
        assert_eq!(
            Decimal::new(1, 0).plus(Decimal::new(1, -40)),
            None,
            "too many digits"
        );
        assert_eq!(Decimal::new(i128::MAX, 0).times(Decimal::new(2, 0)), None);
    }
}

//! Conversion of numbers to columns.

use super::{digit, half_unit, parse};

/// Appends `value` right-aligned in `WIDTH` columns with `DIGITS` significant digits, for example
/// `-1.23456E+00`; a tie between two decimal numbers goes to the even one, as in C and in the
/// standard library.
///
/// `WIDTH` must be at least `DIGITS + 7`, for a sign and three digits of exponent.
pub(in crate::format::uff58) fn push<const WIDTH: usize, const DIGITS: u32>(
    output: &mut Vec<u8>,
    value: f64,
) {
    const { assert!(WIDTH - 7 >= DIGITS as usize && DIGITS >= 2 && DIGITS <= 17) };
    let mut field = [b' '; WIDTH];
    let (mut digits, exponent) = match decimal::<DIGITS>(value) {
        Some(decimal) => decimal,
        None => {
            let text = if value.is_finite() {
                by_formatter(value, DIGITS)
            } else if value.is_nan() {
                "NaN".to_owned()
            } else if value > 0.0 {
                "Inf".to_owned()
            } else {
                "-Inf".to_owned()
            };
            output.extend(std::iter::repeat_n(b' ', WIDTH.saturating_sub(text.len())));
            output.extend(text.as_bytes());
            return;
        }
    };
    let mut end = WIDTH;
    let mut rest = exponent.unsigned_abs();
    if rest >= 100 {
        end -= 1;
        put(&mut field, end, [digit(u64::from(rest % 10))]);
        rest /= 10;
    }
    end -= 2;
    put(&mut field, end, pair(u64::from(rest)));
    end -= 2;
    put(
        &mut field,
        end,
        [b'E', if exponent < 0 { b'-' } else { b'+' }],
    );
    for _ in 0..(DIGITS - 1) / 2 {
        end -= 2;
        put(&mut field, end, pair(digits % 100));
        digits /= 100;
    }
    if DIGITS.is_multiple_of(2) {
        end -= 1;
        put(&mut field, end, [digit(digits % 10)]);
        digits /= 10;
    }
    end -= 2;
    put(&mut field, end, [digit(digits), b'.']);
    if value.is_sign_negative() {
        end -= 1;
        put(&mut field, end, [b'-']);
    }
    output.extend_from_slice(&field);
}

/// Writes `bytes` to `field`, starting at column `at`, counted from 0.
#[inline]
fn put<const N: usize>(field: &mut [u8], at: usize, bytes: [u8; N]) {
    if let Some(columns) = field
        .get_mut(at..)
        .and_then(|tail| tail.first_chunk_mut::<N>())
    {
        *columns = bytes;
    }
}

/// Returns the two digits of a number below 100.
#[inline]
fn pair(value: u64) -> [u8; 2] {
    [digit(value / 10), digit(value % 10)]
}

/// Converts a number exactly by the standard library, with the exponent in Fortran's form.
fn by_formatter(value: f64, n_digits: u32) -> String {
    let decimals = usize::try_from(n_digits.saturating_sub(1)).unwrap_or(0);
    let text = format!("{value:.decimals$e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let (sign, exponent) = match exponent.strip_prefix('-') {
        Some(digits) => ('-', digits),
        None => ('+', exponent),
    };
    format!("{mantissa}E{sign}{exponent:0>2}")
}

/// Powers of ten as `significand * 2^exponent` with the significand's top bit set, each smaller
/// than the power by less than one part in 2^63.
struct ScaledPowers {
    significand: [u64; Self::N],
    exponent: [i32; Self::N],
}

#[expect(
    clippy::cast_sign_loss,
    reason = "a table made by the compiler, from numbers that are in range"
)]
#[allow(
    clippy::indexing_slicing,
    reason = "a table made by the compiler, which would refuse an index beyond it"
)]
impl ScaledPowers {
    const FIRST: i32 = -330;
    const LAST: i32 = 350;
    const N: usize = (Self::LAST - Self::FIRST) as usize + 1;

    const fn table() -> Self {
        let mut table = Self {
            significand: [0; Self::N],
            exponent: [0; Self::N],
        };
        // 128 bits are carried, so that 64 bits are still right after 350 truncations
        let mut upward = (1_u128 << 127, -127);
        let mut p = 0;
        while p <= Self::LAST {
            let slot = (p - Self::FIRST) as usize;
            table.significand[slot] = (upward.0 >> 64) as u64;
            table.exponent[slot] = upward.1 + 64;
            // times 10 = 5 times 2; the shift prevents an overflow of the product
            let mut product = (upward.0 >> 3) * 5;
            let mut shift = 4;
            while product >> 127 == 0 {
                product <<= 1;
                shift -= 1;
            }
            upward = (product, upward.1 + shift);
            p += 1;
        }
        let mut downward = (1_u128 << 127, -127);
        let mut p = -1;
        while p >= Self::FIRST {
            let mut quotient = downward.0 / 5;
            let mut remainder = downward.0 % 5;
            let mut shift = 1;
            while quotient >> 127 == 0 {
                // the division continues into the bits that the shift frees
                remainder *= 2;
                quotient = (quotient << 1) | (remainder / 5);
                remainder %= 5;
                shift += 1;
            }
            downward = (quotient, downward.1 - shift);
            let slot = (p - Self::FIRST) as usize;
            table.significand[slot] = (downward.0 >> 64) as u64;
            table.exponent[slot] = downward.1 + 64;
            p -= 1;
        }
        table
    }

    fn get(&self, power: i32) -> Option<(u64, i32)> {
        let slot = usize::try_from(power - Self::FIRST).ok()?;
        Some((*self.significand.get(slot)?, *self.exponent.get(slot)?))
    }
}

static SCALED_POWERS: ScaledPowers = ScaledPowers::table();

/// Returns `|value|` as `DIGITS` decimal digits and the exponent of the first digit, correctly
/// rounded; `None` if 128 bits do not decide the rounding (ties, and about one number in 10^5), for
/// numbers near the ends of the range and for non-finite ones.
fn decimal<const DIGITS: u32>(value: f64) -> Option<(u64, i32)> {
    let bits = value.to_bits() & !(1 << 63);
    if bits == 0 {
        return Some((0, 0));
    }
    let biased = i32::try_from(bits >> 52).ok()?;
    if biased == 0 || biased == 0x7ff {
        return None;
    }
    let mantissa = ((bits & ((1 << 52) - 1)) | (1 << 52)) << 11;
    let binary = biased - 1023 - 63; // value = mantissa * 2^binary
    let limit = const { 10_u64.pow(DIGITS) };
    // floor of log10(2) times the binary exponent: the place of the first digit or one below it
    let mut place = ((biased - 1023) * 78913) >> 18;
    for _ in 0..2 {
        let (significand, exponent) = SCALED_POWERS.get(DIGITS.cast_signed() - 1 - place)?;
        let product = u128::from(mantissa) * u128::from(significand);
        let shift = u32::try_from(-(binary + exponent))
            .ok()
            .filter(|shift| (66..128).contains(shift))?;
        let whole = u64::try_from(product >> shift).ok()?;
        if whole >= limit {
            place += 1;
            continue;
        }
        let fraction = product & ((1_u128 << shift) - 1);
        let half = 1_u128 << (shift - 1);
        // the product is too small by less than 2^66
        if fraction.abs_diff(half) <= 1 << 66 {
            return None;
        }
        let rounded = whole + u64::from(fraction > half);
        if rounded < limit / 10 {
            return None;
        }
        return Some(if rounded == limit {
            (limit / 10, place + 1)
        } else {
            (rounded, place)
        });
    }
    None
}

/// Writes `value` in at most `width` columns: with the digits for which half a unit of the last
/// digit is `known_to`, if they give `value` exactly, else with as many digits as fit; `None` if
/// not even two fit. Used in the header, whose readers accept any number of digits if the decimal
/// point is written.
pub(in crate::format::uff58) fn compact(value: f64, known_to: f64, width: usize) -> Option<String> {
    if !value.is_finite() {
        return None;
    }
    let texts = || {
        (1..=16_usize)
            .map(|decimals| format!("{value:.decimals$E}"))
            .take_while(|text| text.len() <= width)
    };
    let as_known = texts().find(|text| {
        half_unit(text.as_bytes()) == Some(known_to)
            && parse(text.as_bytes()).map(f64::to_bits) == Some(value.to_bits())
    });
    as_known.or_else(|| texts().last())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn written<const WIDTH: usize, const DIGITS: u32>(value: f64) -> String {
        let mut output = Vec::new();
        push::<WIDTH, DIGITS>(&mut output, value);
        String::from_utf8(output).unwrap()
    }

    fn agrees<const WIDTH: usize, const DIGITS: u32>(value: f64) -> Result<(), TestCaseError> {
        let ours = written::<WIDTH, DIGITS>(value);
        prop_assert_eq!(ours.len(), WIDTH);
        prop_assert_eq!(ours.trim(), by_formatter(value, DIGITS));
        Ok(())
    }

    #[test]
    fn numbers_are_written_as_fortran_does() {
        let fields = [
            written::<13, 6>(0.0),
            written::<13, 6>(-0.0),
            written::<13, 6>(-1.47553e-2),
            written::<13, 6>(9.999996e9),
            written::<13, 6>(-1.5e-101),
            written::<13, 6>(f64::NAN),
            written::<13, 6>(f64::NEG_INFINITY),
            written::<20, 13>(1.0 / 3.0),
            written::<20, 13>(-f64::MAX),
            written::<20, 13>(5e-324),
        ]
        .map(|field| field + "|")
        .join("\n");
        // a bar closes each field, since blanks at the end of a line could not be seen
        insta::assert_snapshot!(fields, @r"
          0.00000E+00|
         -0.00000E+00|
         -1.47553E-02|
          1.00000E+10|
        -1.50000E-101|
                  NaN|
                 -Inf|
          3.333333333333E-01|
        -1.797693134862E+308|
         4.940656458412E-324|
        ");
    }

    #[test]
    fn the_exact_conversion_is_needed_for_ties_alone() {
        assert_eq!(decimal::<6>(0.1), Some((100_000, -1)));
        assert_eq!(
            decimal::<13>(-9.99999999999999e22),
            Some((1_000_000_000_000, 23))
        );
        assert_eq!(decimal::<6>(1_234_565.0), None);
    }

    #[test]
    fn ties_go_to_the_even_digit() {
        // 1234565 and 1234575 are exact doubles halfway between two numbers of six digits
        assert_eq!(written::<13, 6>(1_234_565.0).trim(), "1.23456E+06");
        assert_eq!(written::<13, 6>(1_234_575.0).trim(), "1.23458E+06");
    }

    #[test]
    fn the_header_keeps_as_many_digits_as_have_room_or_as_are_known() {
        let text = |value, half_unit| compact(value, half_unit, 12);
        assert_eq!(text(1.953125e-5, 0.0).unwrap(), "1.9531250E-5");
        assert_eq!(text(1.0 / 30_000.0, 0.0).unwrap(), "3.3333333E-5");
        assert_eq!(text(-1.0 / 3e150, 0.0).unwrap(), "-3.3333E-151");
        assert_eq!(text(1.52588e-5, 5e-11).unwrap(), "1.52588E-5");
        // a half unit is ignored if the value has digits below it
        assert_eq!(text(1.953125e-5, 5e-11).unwrap(), "1.9531250E-5");
        assert_eq!(text(f64::NAN, 0.0), None);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn any_double_is_written_as_the_standard_library_rounds_it(bits: u64) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            agrees::<20, 13>(value)?;
            agrees::<13, 6>(value)?;
        }

        #[test]
        fn numbers_of_a_laboratory_are_written_as_the_standard_library_rounds_them(mantissa in -99_999_999_i32..99_999_999, power in -18_i32..6) {
            let value = f64::from(mantissa) * 10_f64.powi(power);
            agrees::<20, 13>(value)?;
            agrees::<13, 6>(value)?;
        }
    }
}

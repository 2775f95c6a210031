//! Text of a laboratory file: its encoding, its lines, and numbers as written by instruments.

use std::borrow::Cow;

use memchr::{memchr, memchr_iter};
use num_complex::Complex64;

use crate::error::malformed;
use crate::{LabioError, Place, SeriesAxis, Unit};

/// Greatest number of characters of a file that an error quotes.
const LONGEST_QUOTE: usize = 40;

/// The sign between integer part and fraction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum DecimalMark {
    /// `1.5`
    Point,
    /// `1,5`
    Comma,
}

/// Encoding of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Encoding {
    Utf8,
    Utf16,
    Latin1,
}

impl Encoding {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Utf8 => "UTF-8",
            Self::Utf16 => "UTF-16",
            Self::Latin1 => "ISO-8859-1",
        }
    }
}

/// Decodes `bytes`: UTF-16 if they begin with its byte-order mark, otherwise UTF-8 if they are
/// valid, otherwise ISO-8859-1, in which every byte is a character. A byte-order mark is not part
/// of the text.
pub(crate) fn decode<'a>(
    bytes: &'a [u8],
    format: &'static str,
) -> Result<(Cow<'a, str>, Encoding), LabioError> {
    let utf16 = |body: &[u8], unit: fn([u8; 2]) -> u16| {
        let malformed = || {
            let found = "unpaired bytes after a UTF-16 byte-order mark";
            malformed(format, Place::Byte(0), "text", found, "UTF-16")
        };
        let (pairs, rest) = body.as_chunks::<2>();
        if !rest.is_empty() {
            return Err(malformed());
        }
        char::decode_utf16(pairs.iter().map(|&pair| unit(pair)))
            .collect::<Result<String, _>>()
            .map(|text| (Cow::Owned(text), Encoding::Utf16))
            .map_err(|_| malformed())
    };
    match bytes {
        [0xff, 0xfe, body @ ..] => utf16(body, u16::from_le_bytes),
        [0xfe, 0xff, body @ ..] => utf16(body, u16::from_be_bytes),
        _ => {
            let body = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
            Ok(match std::str::from_utf8(body) {
                Ok(text) => (Cow::Borrowed(text), Encoding::Utf8),
                Err(_) => (
                    Cow::Owned(body.iter().copied().map(char::from).collect()),
                    Encoding::Latin1,
                ),
            })
        }
    }
}

/// Returns the lines of `text` with their numbers from 1. LF, CR LF and CR end a line.
pub(crate) fn lines(text: &str) -> impl Iterator<Item = (u64, &str)> {
    let old_mac = memchr(b'\n', text.as_bytes()).is_none();
    let mut rest = Some(text);
    let mut number = 0;
    std::iter::from_fn(move || {
        let current = rest?;
        let end = memchr(if old_mac { b'\r' } else { b'\n' }, current.as_bytes());
        let (line, next) = match end {
            Some(end) => (current.get(..end)?, current.get(end + 1..)),
            None => (current, None),
        };
        rest = next;
        if next.is_none() && line.is_empty() {
            return None;
        }
        number += 1;
        Some((number, line.strip_suffix('\r').unwrap_or(line)))
    })
}

/// Removes the blanks around `text`; a cell of a table rarely has any.
pub(crate) fn trimmed(text: &str) -> &str {
    let bare = |byte: Option<&u8>| byte.is_some_and(u8::is_ascii_graphic);
    if bare(text.as_bytes().first()) && bare(text.as_bytes().last()) {
        text
    } else {
        text.trim()
    }
}

/// Splits a line at `sign`, an ASCII byte, into cells without the blanks around them.
pub(crate) fn cells(line: &str, sign: u8) -> impl Iterator<Item = &str> {
    let ends = memchr_iter(sign, line.as_bytes()).chain([line.len()]);
    ends.scan(0, move |begin, end| {
        let cell = line.get(*begin..end)?;
        *begin = end + 1;
        Some(trimmed(cell))
    })
}

/// Returns a piece of a file as quoted in an error.
pub(crate) fn quoted(found: &str) -> String {
    let mut shown = String::new();
    for (count, c) in found.chars().enumerate() {
        if count == LONGEST_QUOTE {
            shown.push_str("...");
            break;
        }
        if c.is_control() {
            shown.extend(c.escape_default());
        } else {
            shown.push(c);
        }
    }
    format!("`{shown}`")
}

/// Magnitude below all numbers that mark a lost sample.
const BELOW_MARKS: f64 = 9.8e34;

/// Words that instruments write for a signal beyond the range, in any case of letters.
const OVERLOADS: [&str; 6] = ["OL", "OVER", "OVLD", "OVERLOAD", "OVERFLOW", "OVERRANGE"];

/// Parses a real number; blanks around it are allowed. The exponent letter may be Fortran's `D`,
/// and the minus sign may be that of Unicode. Infinity and NaN may be words, [marks](of_mark), or
/// written as by the C library of Windows (`1.#INF`).
pub(crate) fn real(text: &str, mark: DecimalMark) -> Option<f64> {
    let text = trimmed(text);
    let value = match text.bytes().find(|byte| !matches!(byte, b'+' | b'-'))? {
        b'0'..=b'9' | b'.' | b',' => plain(text, mark),
        _ => special(text),
    };
    let value = value.or_else(|| respelt(text, mark))?;
    Some(if value.abs() < BELOW_MARKS {
        value
    } else {
        of_mark(value)
    })
}

fn plain(text: &str, mark: DecimalMark) -> Option<f64> {
    match mark {
        DecimalMark::Point => text.parse().ok(),
        DecimalMark::Comma => {
            if text.contains('.') {
                return None;
            }
            let mut point = [0_u8; 64];
            let place = point.get_mut(..text.len())?;
            for (to, from) in place.iter_mut().zip(text.bytes()) {
                *to = if from == b',' { b'.' } else { from };
            }
            std::str::from_utf8(place).ok()?.parse().ok()
        }
    }
}

/// Parses a number with an exponent letter or a minus sign that Rust does not know, or a special
/// value of the C library of Windows, such as `-1.#IND00`.
fn respelt(text: &str, mark: DecimalMark) -> Option<f64> {
    let (negative, unsigned) = signed(text);
    if let Some((_, word)) = unsigned
        .split_once('#')
        .filter(|(one, _)| matches!(*one, "1." | "1,"))
    {
        let value = match word {
            _ if word.starts_with("INF") => f64::INFINITY,
            _ if ["QNAN", "SNAN", "NAN", "IND"]
                .iter()
                .any(|nan| word.starts_with(nan)) =>
            {
                f64::NAN
            }
            _ => return None,
        };
        return Some(if negative { -value } else { value });
    }
    if !text.contains(['d', 'D', '\u{2212}']) {
        return None;
    }
    plain(
        &text.replace(['d', 'D'], "e").replace('\u{2212}', "-"),
        mark,
    )
}

/// Returns the special value that a number beyond any measurement stands for: the infinity 9.9E37
/// and the not-a-number 9.91E37 of instruments (SCPI-99, vol. 1, 7.2.1), the missing value 9.9E34
/// of DIAdem, and the greatest number of single precision, by which programs in C mark an overload.
/// A mark may have passed through single precision. Other numbers are returned unchanged.
#[allow(
    clippy::cast_possible_truncation,
    reason = "marks are compared in single precision"
)]
fn of_mark(value: f64) -> f64 {
    let printed = 3.402_82e38..3.402_824e38;
    match value.abs() as f32 {
        9.9e37 => f64::INFINITY.copysign(value),
        9.91e37 | 9.9e34 => f64::NAN,
        _ if printed.contains(&value.abs()) => f64::INFINITY.copysign(value),
        _ => value,
    }
}

/// Splits off the sign; true for minus.
fn signed(text: &str) -> (bool, &str) {
    match text.strip_prefix('-') {
        Some(unsigned) => (true, unsigned),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    }
}

fn special(text: &str) -> Option<f64> {
    let (negative, word) = signed(text);
    let value = match word {
        "NaN" | "nan" | "NAN" => f64::NAN,
        "inf" | "Inf" | "INF" | "Infinity" | "\u{221e}" => f64::INFINITY,
        _ if OVERLOADS
            .iter()
            .any(|known| word.eq_ignore_ascii_case(known)) =>
        {
            f64::INFINITY
        }
        _ => return None,
    };
    Some(if negative { -value } else { value })
}

/// Parses a complex number: `1.5e-3-2j`, with `i` or `j`, in parentheses or not.
pub(crate) fn complex(text: &str, mark: DecimalMark) -> Option<Complex64> {
    let (re, im) = parts(text)?;
    // NumPy writes 1+-2j
    let im = im
        .strip_prefix("+-")
        .map_or(Cow::Borrowed(im), |digits| Cow::Owned(format!("-{digits}")));
    Some(Complex64::new(real(re, mark)?, real(&im, mark)?))
}

/// Returns the text of the real part of a complex number.
pub(crate) fn real_part(text: &str) -> Option<&str> {
    parts(text).map(|(re, _)| re)
}

fn parts(text: &str) -> Option<(&str, &str)> {
    let text = text.trim();
    let text = text
        .strip_prefix('(')
        .and_then(|inner| inner.strip_suffix(')'))
        .unwrap_or(text);
    let body = text.strip_suffix(['j', 'i'])?;
    let bytes = body.as_bytes();
    let split = (1..bytes.len()).rev().find(|&at| {
        matches!(bytes.get(at), Some(b'+' | b'-'))
            && !matches!(
                at.checked_sub(1).and_then(|before| bytes.get(before)),
                Some(b'e' | b'E' | b'd' | b'D' | b'+' | b'-')
            )
    })?;
    Some((body.get(..split)?, body.get(split..)?))
}

/// Creates an axis, with its unit if the text is a known one; an empty text is not a unit.
pub(crate) fn axis(label: impl Into<String>, unit_text: impl Into<String>) -> SeriesAxis {
    let unit_text = unit_text.into();
    SeriesAxis {
        label: label.into(),
        unit: known_unit(&unit_text),
        unit_text,
    }
}

/// Returns the unit written as `text`, if it is a known one.
pub(crate) fn known_unit(text: &str) -> Option<Unit> {
    Unit::parse(text).ok().filter(|_| !text.is_empty())
}

/// Returns half a unit of the last written digit of a finite number: the largest rounding error. A
/// zero with an exponent counts as exact, because any other number would be written with a nonzero
/// first digit.
pub(crate) fn half_unit(text: &str, mark: DecimalMark) -> f64 {
    let point = match mark {
        DecimalMark::Point => b'.',
        DecimalMark::Comma => b',',
    };
    let text = trimmed(text);
    let end = text
        .bytes()
        .position(|byte| matches!(byte, b'e' | b'E' | b'd' | b'D'));
    let (mantissa, exponent) = text.as_bytes().split_at(end.unwrap_or(text.len()));
    let exponent = match exponent {
        [] => 0,
        _ if mantissa.iter().all(|b| !matches!(b, b'1'..=b'9')) => return 0.0,
        [_, exponent @ ..] => std::str::from_utf8(exponent)
            .ok()
            .and_then(|exponent| {
                let respelt = || exponent.replace('\u{2212}', "-").parse().ok();
                exponent.parse().ok().or_else(respelt)
            })
            .unwrap_or(0_i32),
    };
    let decimals = match mantissa.iter().position(|byte| *byte == point) {
        Some(place) => mantissa.len() - place - 1,
        None => 0,
    };
    let decimals = i32::try_from(decimals).unwrap_or(i32::MAX);
    0.5 * 10_f64.powi(exponent.saturating_sub(decimals))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_encoding_is_found_by_the_bytes() {
        let (text, encoding) = decode(b"\xef\xbb\xbfa\xc2\xb5", "csv").unwrap();
        assert_eq!((&*text, encoding), ("a\u{b5}", Encoding::Utf8));
        let (text, encoding) = decode(b"25 \xb0C", "csv").unwrap();
        assert_eq!((&*text, encoding), ("25 \u{b0}C", Encoding::Latin1));
        let (text, encoding) = decode(b"\xff\xfea\x00\x1e\x22", "csv").unwrap();
        assert_eq!((&*text, encoding), ("a\u{221e}", Encoding::Utf16));
        let (text, _) = decode(b"\xfe\xff\x00a", "csv").unwrap();
        assert_eq!(&*text, "a");
        assert!(decode(b"\xff\xfea", "csv").is_err());
        assert!(decode(b"\xff\xfe\x00\xd8", "csv").is_err());
    }

    #[test]
    fn lines_are_numbered_whatever_ends_them() {
        let all = |text| lines(text).collect::<Vec<_>>();
        assert_eq!(all("a\r\n\nb"), [(1, "a"), (2, ""), (3, "b")]);
        assert_eq!(all("a\rb\r"), [(1, "a"), (2, "b")]);
        assert_eq!(all(""), []);
    }

    #[test]
    fn cells_are_what_stands_between_the_signs() {
        let all = |line| cells(line, b';').collect::<Vec<_>>();
        assert_eq!(all("1;2"), ["1", "2"]);
        assert_eq!(all(" 1 ;;\u{a0}\u{b5}m\t;"), ["1", "", "\u{b5}m", ""]);
        assert_eq!(all(""), [""]);
        for text in ["a", " a", "a ", "\u{a0}a", "\u{e9}", "", " "] {
            assert_eq!(trimmed(text), text.trim());
        }
    }

    #[test]
    fn numbers_of_instruments_are_numbers() {
        use DecimalMark::{Comma, Point};
        assert_eq!(real(" -1.5E-3 ", Point), Some(-1.5e-3));
        assert_eq!(real("-1,5E-3", Comma), Some(-1.5e-3));
        assert_eq!(real("-\u{221e}", Point), Some(f64::NEG_INFINITY));
        assert!(real("NaN", Comma).unwrap().is_nan());
        for text in ["1.5", "1,000,000", "infinity", "", "e5", "1 2"] {
            assert_eq!(real(text, Comma), None, "{text}");
        }
        assert_eq!(real("1,5", Point), None);
        // 65 digits are more than the parser accepts with a decimal comma
        assert_eq!(real(&"1".repeat(65), Comma), None);
    }

    #[test]
    fn exponents_of_fortran_and_the_minus_of_unicode_are_read() {
        use DecimalMark::{Comma, Point};
        for (text, mark) in [
            ("-1.234D-05", Point),
            ("-1.234d-5", Point),
            ("\u{2212}1.234E\u{2212}05", Point),
            ("\u{2212}1,234D-05", Comma),
        ] {
            assert_eq!(real(text, mark), Some(-1.234e-5), "{text}");
            // half a unit of the third decimal of the mantissa; powers of ten are exact within a
            // unit in the last place
            let half = half_unit(text, mark);
            assert!((half / 0.5e-8 - 1.0).abs() < 1e-15, "{text}: {half}");
        }
        for text in ["D5", "1D", "1.5DD2", "Load", "-"] {
            assert_eq!(real(text, Point), None, "{text}");
        }
        let both = Complex64::new(1.5e3, -2e-3);
        assert_eq!(complex("1.5D+3-2D-3j", Point), Some(both));
    }

    #[test]
    fn complex_numbers_are_read_in_one_cell() {
        let point = |text| complex(text, DecimalMark::Point);
        assert_eq!(point("1.5e-3-2.0E+1j"), Some(Complex64::new(1.5e-3, -20.0)));
        assert_eq!(point("(-1+-2j)"), Some(Complex64::new(-1.0, -2.0)));
        assert_eq!(
            point("1-infi"),
            Some(Complex64::new(1.0, f64::NEG_INFINITY))
        );
        assert_eq!(point("5"), None);
        assert_eq!(point("j"), None);
        assert_eq!(
            complex("1,5+2,5j", DecimalMark::Comma),
            Some(Complex64::new(1.5, 2.5))
        );
    }

    #[test]
    fn the_last_digit_says_how_far_a_number_was_rounded() {
        // powers of ten are exact within a unit in the last place
        let close = |text: &str, unit: f64| {
            let found = half_unit(text, DecimalMark::Point);
            assert!((found / unit - 1.0).abs() < 1e-15, "{text}: {found}");
        };
        close("0.000117", 0.5e-6);
        close("-1.98E-04", 0.5e-6);
        close("12", 0.5);
        assert_eq!(half_unit("-0.00E+0", DecimalMark::Point).to_bits(), 0);
        assert!((half_unit("3,906250E-5", DecimalMark::Comma) / 0.5e-11 - 1.0).abs() < 1e-15);
    }
}

//! Fast writing of decimal numbers with few digits, of which a report contains a hundred thousand.

/// Appends `mantissa` divided by ten to the power `places`, at most 30, without trailing zeros.
#[allow(
    clippy::indexing_slicing,
    reason = "31 digits and the point are the most, and there is room for 40"
)]
pub fn push_decimal(text: &mut String, mantissa: i64, places: u32) {
    let (mut mantissa, mut places) = (mantissa, places.min(30));
    while places > 0 && mantissa % 10 == 0 {
        mantissa /= 10;
        places -= 1;
    }
    if mantissa < 0 {
        text.push('-');
    }
    let mut rest = mantissa.unsigned_abs();
    // digits and decimal point, written from the last to the first
    let mut digits = [b'0'; 40];
    let mut at = digits.len();
    let mut count = 0;
    while rest > 0 || count <= places {
        if count == places && places > 0 {
            at -= 1;
            digits[at] = b'.';
        }
        at -= 1;
        digits[at] = b'0' + u8::try_from(rest % 10).unwrap_or(0);
        rest /= 10;
        count += 1;
    }
    for &digit in &digits[at..] {
        text.push(char::from(digit));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_point_stands_where_it_belongs() {
        let shown: Vec<String> = [
            (0, 0),
            (0, 3),
            (7, 0),
            (-7, 1),
            (1234, 2),
            (1200, 2),
            (1200, 3),
            (5, 4),
            (-10, 1),
            (i64::MIN, 18),
            (-1, 30),
        ]
        .map(|(mantissa, places)| {
            let mut text = String::new();
            push_decimal(&mut text, mantissa, places);
            text
        })
        .into();
        assert_eq!(
            shown.join(" "),
            "0 0 7 -0.7 12.34 12 1.2 0.0005 -1 -9.223372036854775808 -0.000000000000000000000000000001"
        );
    }
}

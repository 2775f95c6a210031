//! Units in typographic form.

/// Returns `unit` with superscript powers, such as `m/s²` for `m/s^2`, and with the symbols for
/// degree and micro. Files contain the ASCII form.
#[must_use]
pub fn unit_as_read(unit: &str) -> String {
    match unit {
        "deg" => return "°".to_owned(),
        "degC" => return "°C".to_owned(),
        "um" => return "µm".to_owned(),
        "us" => return "µs".to_owned(),
        _ => {}
    }
    let mut read = String::with_capacity(unit.len());
    let mut rest = unit;
    while let Some((before, after)) = rest.split_once('^') {
        read.push_str(before);
        let sign = usize::from(after.starts_with('-'));
        let digits = after[sign..]
            .find(|c: char| !c.is_ascii_digit())
            .unwrap_or(after.len() - sign);
        if digits == 0 {
            read.push('^');
            rest = after;
        } else {
            read.extend(after[..sign + digits].chars().map(raised));
            rest = &after[sign + digits..];
        }
    }
    read.push_str(rest);
    read
}

/// Returns a digit or a minus sign as superscript.
pub(super) fn raised(c: char) -> char {
    match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        _ => '⁰',
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_stand_above_the_line_and_degrees_have_their_sign() {
        let shown = [
            "m/s^2",
            "Pa^-(m+1) s^-1",
            "kg m^-3",
            "GPa",
            "s^p/m",
            "m^2/s^10",
            "^",
            "degC",
            "us",
        ]
        .map(unit_as_read)
        .join(", ");
        assert_eq!(
            shown,
            "m/s², Pa^-(m+1) s⁻¹, kg m⁻³, GPa, s^p/m, m²/s¹⁰, ^, °C, µs"
        );
    }
}

//! Compact form of figures for the script of the report.
//!
//! `x` contains the different abscissae, and `p` the panels. A panel has the axes `x` and `y`
//! (label, unit, 1 for logarithmic, range), `e` (1 for equal axes), `g` (greyed ranges with
//! reasons) and `m` (marks). A mark has the kind `t` (`l`, `p`, `b` or `a` for line, points, band
//! and vertical line), the name `n`, the role `r` from 0, the number `x` of its abscissae, the
//! ordinates `y` and `z` (`z`: bars, or upper edge), and the place `v` of a vertical line.

use std::fmt::Write;

use rodfigure::{Axis, Figure, Mark, Panel, Role, Scale, push_decimal, unit_as_read};

/// Number of digits of abscissae and of ordinates.
const DIGITS: [i32; 2] = [7, 6];

/// Returns `figure` as JSON that is valid inside a page, that is, without `<`.
pub(super) fn json_of(figure: &Figure) -> String {
    let mut abscissae: Vec<&[f64]> = Vec::new();
    let mut panels = String::new();
    for (index, panel) in figure.panels.iter().enumerate() {
        comma(&mut panels, index);
        write_panel(&mut panels, panel, &mut abscissae);
    }
    let mut json = String::with_capacity(2 * panels.len());
    json.push_str("{\"x\":[");
    for (index, values) in abscissae.iter().enumerate() {
        comma(&mut json, index);
        numbers(&mut json, values, DIGITS[0]);
    }
    json.push_str("],\"p\":[");
    json.push_str(&panels);
    json.push_str("]}");
    json
}

fn write_panel<'a>(json: &mut String, panel: &'a Panel, abscissae: &mut Vec<&'a [f64]>) {
    json.push_str("{\"x\":");
    axis(json, &panel.x);
    json.push_str(",\"y\":");
    axis(json, &panel.y);
    _ = write!(json, ",\"e\":{},\"g\":[", u8::from(panel.equal_axes));
    for (index, greyed) in panel.greyed.iter().enumerate() {
        comma(json, index);
        json.push('[');
        number(json, greyed.from, DIGITS[0]);
        json.push(',');
        number(json, greyed.to, DIGITS[0]);
        json.push(',');
        text(json, &greyed.because);
        json.push(']');
    }
    json.push_str("],\"m\":[");
    for (index, mark) in panel.marks.iter().enumerate() {
        comma(json, index);
        write_mark(json, mark, abscissae);
    }
    json.push_str("]}");
}

fn write_mark<'a>(json: &mut String, mark: &'a Mark, abscissae: &mut Vec<&'a [f64]>) {
    let (kind, name, role, x, y, z): (_, _, _, &'a [f64], &[f64], &[f64]) = match mark {
        Mark::Line { name, role, x, y } => ('l', name, role, x, y, &[]),
        Mark::Points {
            name,
            role,
            x,
            y,
            error,
        } => ('p', name, role, x, y, error),
        Mark::Band {
            name,
            role,
            x,
            lower,
            upper,
        } => ('b', name, role, x, lower, upper),
        Mark::At { name, x } => {
            json.push_str("{\"t\":\"a\",\"n\":");
            text(json, name);
            json.push_str(",\"v\":");
            number(json, *x, DIGITS[0]);
            json.push('}');
            return;
        }
    };
    let which = abscissae
        .iter()
        .position(|known| same(known, x))
        .unwrap_or_else(|| {
            abscissae.push(x);
            abscissae.len() - 1
        });
    _ = write!(
        json,
        "{{\"t\":\"{kind}\",\"r\":{},\"n\":",
        role_number(*role)
    );
    text(json, name);
    _ = write!(json, ",\"x\":{which},\"y\":");
    numbers(json, y, DIGITS[1]);
    if !z.is_empty() {
        json.push_str(",\"z\":");
        numbers(json, z, DIGITS[1]);
    }
    json.push('}');
}

/// Returns true if the values are equal bit by bit; a NaN is then equal to itself.
fn same(one: &[f64], other: &[f64]) -> bool {
    one.len() == other.len()
        && one
            .iter()
            .zip(other)
            .all(|(a, b)| a.to_bits() == b.to_bits())
}

fn role_number(role: Role) -> u8 {
    match role {
        Role::First => 0,
        Role::Second => 1,
        Role::Third => 2,
        Role::Fourth => 3,
        Role::Fifth => 4,
        Role::Reference => 5,
        Role::Faint => 6,
    }
}

fn axis(json: &mut String, axis: &Axis) {
    json.push_str("{\"l\":");
    text(json, &axis.label);
    json.push_str(",\"u\":");
    text(json, &unit_as_read(&axis.unit));
    _ = write!(
        json,
        ",\"s\":{}",
        u8::from(axis.scale == Scale::Logarithmic)
    );
    if let Some(range) = axis.range {
        json.push_str(",\"r\":");
        numbers(json, &range, DIGITS[0]);
    }
    json.push('}');
}

fn numbers(json: &mut String, values: &[f64], digits: i32) {
    json.push('[');
    for (index, &value) in values.iter().enumerate() {
        comma(json, index);
        number(json, value, digits);
    }
    json.push(']');
}

/// Writes `value` with this number of digits, in as few characters as possible; `null` if it is not
/// finite.
#[expect(
    clippy::cast_possible_truncation,
    reason = "the power of ten of a number lies between -324 and 308, and seven digits are far below the greatest integer"
)]
fn number(json: &mut String, value: f64, digits: i32) {
    if !value.is_finite() {
        json.push_str("null");
        return;
    }
    if value.abs() < 1e-290 {
        json.push('0');
        return;
    }
    let places = digits - 1 - value.abs().log10().floor() as i32;
    let mantissa = if places < 0 {
        value / 10_f64.powi(-places)
    } else {
        value * 10_f64.powi(places)
    };
    let mantissa = mantissa.round() as i64;
    match u32::try_from(places) {
        Ok(few @ 0..=9) => push_decimal(json, mantissa, few),
        _ => {
            let (mut mantissa, mut power) = (mantissa, -places);
            while mantissa % 10 == 0 {
                mantissa /= 10;
                power += 1;
            }
            push_decimal(json, mantissa, 0);
            _ = write!(json, "e{power}");
        }
    }
}

fn text(json: &mut String, text: &str) {
    json.push('"');
    for c in text.chars() {
        match c {
            '"' => json.push_str("\\\""),
            '\\' => json.push_str("\\\\"),
            // these characters are escaped, because `</script>` and `<!--` end or change a script
            // of any type
            '<' | '>' | '&' | '\0'..='\u{1f}' => {
                _ = write!(json, "\\u{:04x}", u32::from(c));
            }
            c => json.push(c),
        }
    }
    json.push('"');
}

fn comma(json: &mut String, index: usize) {
    if index > 0 {
        json.push(',');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(value: f64, digits: i32) -> String {
        let mut json = String::new();
        number(&mut json, value, digits);
        json
    }

    #[test]
    fn a_number_is_written_by_its_digits_alone() {
        let shown = [
            1.0 / 3.0,
            2.0e9 / 3.0,
            1e-9 / 3.0,
            -51_200.123_456,
            0.1 + 0.2,
            1.5e-40,
            2.5e300,
            0.0,
            -0.0,
            f64::NAN,
            f64::NEG_INFINITY,
        ]
        .map(|value| written(value, 6))
        .join(" ");
        assert_eq!(
            shown,
            "0.333333 666667e3 333333e-15 -51200.1 0.3 15e-41 25e299 0 0 null null"
        );
    }

    #[test]
    fn rounding_is_to_half_of_the_last_digit_whatever_the_number() {
        proptest::proptest!(|(mantissa in 1.0_f64..10.0, power in -15_i32..15)| {
            let value = mantissa * 10_f64.powi(power);
            let read: f64 = written(value, 6).parse().unwrap();
            proptest::prop_assert!((read / value - 1.0).abs() <= 5.1e-6, "{value} is written as {read}");
            proptest::prop_assert!(written(value, 6).len() <= 13, "{}", written(value, 6));
        });
    }

    #[test]
    fn no_text_ends_a_script() {
        let mut json = String::new();
        text(&mut json, "</script><!-- \"\\ & \u{7}");
        assert!(!json.contains('<') && !json.contains('&'), "{json}");
        let read: String = serde_json::from_str(&json).unwrap();
        assert_eq!(read, "</script><!-- \"\\ & \u{7}");
    }
}

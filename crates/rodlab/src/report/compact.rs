//! Compact form of figures for the script of the report.
//!
//! `x` contains the different abscissae, and `p` the panels. A panel has the axes `x` and `y`
//! (label, unit, 1 for logarithmic, range), `e` (1 for equal axes), `g` (greyed ranges with
//! reasons) and `m` (marks). A mark has the kind `t` (`l`, `p`, `b` or `a` for line, points, band
//! and vertical line), the name `n`, the role `r` from 0, the number `x` of its abscissae, the
//! ordinates `y` and `z` (`z`: bars, or upper edge), and the place `v` of a vertical line.

use std::fmt::Write;

use rodfigure::{Axis, Figure, Mark, Panel, Scale, push_decimal, unit_as_read};

/// Number of digits of abscissae and of ordinates.
const DIGITS: [i32; 2] = [7, 6];

/// Returns `figure` as JSON that is valid inside a page, that is, without `<`.
pub(super) fn json_of(figure: &Figure) -> String {
    let mut abscissae = Vec::new();
    let panels = figure.panels.iter();
    let panels = list(panels.map(|panel| of_panel(panel, &mut abscissae)));
    let abscissae = abscissae.into_iter();
    let abscissae = list(abscissae.map(|values| numbers(values, DIGITS[0])));
    format!(r#"{{"x":{abscissae},"p":{panels}}}"#)
}

fn list(items: impl Iterator<Item = String>) -> String {
    format!("[{}]", items.collect::<Vec<_>>().join(","))
}

fn of_panel<'a>(panel: &'a Panel, abscissae: &mut Vec<&'a [f64]>) -> String {
    let (x, y) = (axis(&panel.x), axis(&panel.y));
    let equal = u8::from(panel.equal_axes);
    let greyed = list(panel.greyed.iter().map(|greyed| {
        let [from, to] = [greyed.from, greyed.to].map(|end| number(end, DIGITS[0]));
        format!("[{from},{to},{}]", text(&greyed.because))
    }));
    let marks = list(panel.marks.iter().map(|mark| of_mark(mark, abscissae)));
    format!(r#"{{"x":{x},"y":{y},"e":{equal},"g":{greyed},"m":{marks}}}"#)
}

fn of_mark<'a>(mark: &'a Mark, abscissae: &mut Vec<&'a [f64]>) -> String {
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
            let (name, x) = (text(name), number(*x, DIGITS[0]));
            return format!(r#"{{"t":"a","n":{name},"v":{x}}}"#);
        }
    };
    // bit by bit, so that a NaN is equal to itself
    let bits = |values: &'a [f64]| values.iter().map(|value| value.to_bits());
    let known = abscissae.iter().position(|known| bits(known).eq(bits(x)));
    let which = known.unwrap_or(abscissae.len());
    if known.is_none() {
        abscissae.push(x);
    }
    let (role, name, y) = (*role as u8, text(name), numbers(y, DIGITS[1]));
    let z = match z {
        [] => String::new(),
        z => format!(r#","z":{}"#, numbers(z, DIGITS[1])),
    };
    format!(r#"{{"t":"{kind}","r":{role},"n":{name},"x":{which},"y":{y}{z}}}"#)
}

fn axis(axis: &Axis) -> String {
    let (label, unit) = (text(&axis.label), text(&unit_as_read(&axis.unit)));
    let scale = u8::from(axis.scale == Scale::Logarithmic);
    let range = axis.range.map_or_else(String::new, |range| {
        format!(r#","r":{}"#, numbers(&range, DIGITS[0]))
    });
    format!(r#"{{"l":{label},"u":{unit},"s":{scale}{range}}}"#)
}

fn numbers(values: &[f64], digits: i32) -> String {
    let mut json = String::from("[");
    for (index, &value) in values.iter().enumerate() {
        if index > 0 {
            json.push(',');
        }
        push_number(&mut json, value, digits);
    }
    json.push(']');
    json
}

fn number(value: f64, digits: i32) -> String {
    let mut json = String::new();
    push_number(&mut json, value, digits);
    json
}

/// Writes `value` with this number of significant digits, without trailing zeros; 0 for magnitudes
/// below 1e-290, and `null` if it is not finite.
#[expect(
    clippy::cast_possible_truncation,
    reason = "the power of ten of a number lies between -324 and 308, and seven digits are far below the greatest integer"
)]
fn push_number(json: &mut String, value: f64, digits: i32) {
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

/// Returns `text` as a JSON string. It contains none of the characters that end or change a script
/// of any type, as in `</script>` and `<!--`.
fn text(text: &str) -> String {
    let json = serde_json::Value::from(text).to_string();
    let json = json.replace('<', "\\u003c").replace('>', "\\u003e");
    json.replace('&', "\\u0026")
}

#[cfg(test)]
mod tests {
    use super::*;

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
        .map(|value| number(value, 6))
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
            let read: f64 = number(value, 6).parse().unwrap();
            proptest::prop_assert!((read / value - 1.0).abs() <= 5.1e-6, "{value} is written as {read}");
            proptest::prop_assert!(number(value, 6).len() <= 13, "{}", number(value, 6));
        });
    }

    #[test]
    fn no_text_ends_a_script() {
        let json = text("</script><!-- \"\\ & \u{7}");
        assert!(!json.contains('<') && !json.contains('&'), "{json}");
        let read: String = serde_json::from_str(&json).unwrap();
        assert_eq!(read, "</script><!-- \"\\ & \u{7}");
    }
}

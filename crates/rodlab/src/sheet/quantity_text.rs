//! Text of a quantity: number, unit, and the uncertainty after `±`.

use std::borrow::Cow;

use labio::{Dimension, LabioError, Unit};

use super::kind::{ImpactMass, Kind};

/// Returns the text of a quantity with its value moved by `standards` standard uncertainties, such
/// as `"1.01e1 mV/g ± 1 %"` for `"10 mV/g ± 1 %"` moved by 1; `None` for a text without a readable
/// uncertainty.
pub(super) fn moved(text: &str, standards: impl FnOnce() -> f64) -> Option<String> {
    let (quantity, Some(uncertainty)) = value_and_uncertainty(text) else {
        return None;
    };
    let read = |expected| {
        let (value, unit) = number_and_unit_of(&quantity, expected).ok()?;
        let (size, in_unit) = number_and_unit_of(&uncertainty, expected).ok()?;
        if in_unit.symbol() == "%" {
            return Some((value, value.abs() * size / 100.0));
        }
        // a difference of two values does not depend on the zero of the scale
        let scale = |unit: &Unit| unit.to_si(1.0) - unit.to_si(0.0);
        let alike = unit.dimension() == in_unit.dimension();
        alike.then(|| (value, size * scale(&in_unit) / scale(&unit)))
    };
    // if the units do not match, `g` is read as gram, as in the mass `2.9 g ± 30 mg`
    let (value, deviation) = read(Dimension::NONE).or_else(|| read(ImpactMass::DIMENSION))?;
    let unit = quantity.trim().get(number_of(quantity.trim()).len()..)?;
    let drawn = value + standards() * deviation;
    Some(format!("{drawn:e}{unit} ± {}", uncertainty.trim()))
}

/// Returns the parts before and after the sign of an uncertainty. A unit that both parts share, as
/// in `(799 ± 0.3) mm` or `799 ± 0.3 mm`, is added to the part that lacks it. This does not apply
/// to `%`, because the uncertainty in `799 mm ± 1 %` is one per cent of the value.
pub(crate) fn value_and_uncertainty(text: &str) -> (Cow<'_, str>, Option<Cow<'_, str>>) {
    let inside = text.trim().strip_prefix('(');
    let (body, unit) = inside
        .and_then(|inside| inside.split_once(')'))
        .unwrap_or((text, ""));
    let parts = ["±", "+-", "+/-"]
        .iter()
        .find_map(|sign| body.split_once(sign));
    let Some((value, uncertainty)) = parts else {
        return (Cow::Borrowed(text), None);
    };
    let unit = unit.trim();
    if !unit.is_empty() {
        let with_unit = |part: &str| Cow::Owned(format!("{} {unit}", part.trim()));
        return (with_unit(value), Some(with_unit(uncertainty)));
    }
    let of = unit_of(uncertainty);
    let value = if unit_of(value).is_empty() && !matches!(of, "" | "%") {
        Cow::Owned(format!("{} {of}", value.trim()))
    } else {
        Cow::Borrowed(value)
    };
    (value, Some(Cow::Borrowed(uncertainty)))
}

/// Returns the text after the number at the start of `text`.
fn unit_of(text: &str) -> &str {
    let text = text.trim();
    let unit = text.get(number_of(text).len()..);
    unit.unwrap_or_default().trim()
}

/// Returns the number at the start of `text` and the unit after it, in which `g` is standard
/// gravity.
pub(crate) fn number_and_unit(text: &str) -> Result<(f64, Unit), String> {
    number_and_unit_of(text, Dimension::NONE)
}

/// Returns the number at the start of `text` and the unit after it; `g` is the gram if the expected
/// dimension requires this.
pub(super) fn number_and_unit_of(text: &str, expected: Dimension) -> Result<(f64, Unit), String> {
    let text = text.trim();
    let (number, unit) = text.split_at(number_of(text).len());
    let number: f64 = number
        .parse()
        .map_err(|_| "does not begin with a number".to_owned())?;
    if let Some(behind) = unit.strip_prefix(',')
        && behind.starts_with(|next: char| next.is_ascii_digit())
    {
        let with_point = text.replacen(',', ".", 1);
        let digits = behind.chars().take_while(char::is_ascii_digit).count();
        return Err(if digits == 3 && number.abs() >= 1.0 {
            // the comma may separate thousands
            let without = text.replacen(',', "", 1);
            format!("has a comma in its number; write {with_point} or {without}")
        } else {
            format!("has a decimal comma; write {with_point}")
        });
    }
    // a pure number needs no unit
    let unit = if unit.trim().is_empty() { "1" } else { unit };
    let unit = Unit::parse_as(unit, expected).map_err(|error| match error {
        LabioError::UnknownUnit { token, reason, .. } => {
            format!("has no known unit: `{token}` {reason}")
        }
        error => format!("has no known unit: {error}"),
    })?;
    Ok((number, unit))
}

/// Returns the number at the start of `text`; empty if there is none.
fn number_of(text: &str) -> &str {
    let end = text
        .char_indices()
        .find(|(at, c)| {
            let exponent = matches!(c, 'e' | 'E')
                && text[at + 1..]
                    .starts_with(|next: char| next.is_ascii_digit() || matches!(next, '-' | '+'));
            !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+') || exponent)
        })
        .map_or(text.len(), |(at, _)| at);
    text.get(..end).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quantity_is_moved_by_its_uncertainty_in_its_own_unit() {
        let by_two = |text: &str| moved(text, || 2.0);
        for (text, expected) in [
            ("799 mm ± 0.3 mm", "7.996e2 mm ± 0.3 mm"),
            ("2.9 g ± 30 mg", "2.96e0 g ± 30 mg"),
            ("-20 degC ± 1 K", "-1.8e1 degC ± 1 K"),
            ("10 mV/g +- 1 %", "1.02e1 mV/g ± 1 %"),
            ("-0.5 ± 1 %", "-4.9e-1 ± 1 %"),
            ("(799 ± 0.3) mm", "7.996e2 mm ± 0.3 mm"),
            ("799±0.3 mm", "7.996e2 mm ± 0.3 mm"),
        ] {
            assert_eq!(by_two(text).as_deref(), Some(expected), "{text}");
        }
        for none in ["799 mm", "read ± by eye", "3 kg ± 1 m"] {
            assert_eq!(by_two(none), None);
        }
    }
}

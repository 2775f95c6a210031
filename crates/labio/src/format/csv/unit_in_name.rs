//! Units in the cells of names: `Time [s]`, `Force / N`, `acc_m/s2`.

use super::abscissa_name::names_abscissa;
use crate::format::text;

/// Functions that may precede a quantity in brackets: `real(accelerance)` does not have the unit
/// `accelerance`.
const FUNCTIONS: [&str; 14] = [
    "real",
    "imag",
    "re",
    "im",
    "abs",
    "mag",
    "magnitude",
    "amplitude",
    "phase",
    "angle",
    "arg",
    "log",
    "log10",
    "db",
];

/// Units in headers, in addition to those of [`Unit`](crate::Unit).
const UNITS_IN_HEADERS: [&str; 34] = [
    "-",
    "1",
    "#",
    "%",
    "s",
    "ms",
    "us",
    "\u{b5}s",
    "\u{3bc}s",
    "ns",
    "min",
    "h",
    "Hz",
    "kHz",
    "MHz",
    "V",
    "mV",
    "N",
    "kN",
    "m",
    "mm",
    "m/s",
    "m/s^2",
    "m/s\u{b2}",
    "g",
    "Pa",
    "kPa",
    "MPa",
    "GPa",
    "C",
    "\u{b0}C",
    "K",
    "rad",
    "deg",
];

/// Units that may follow a name after `_`, a comma or `in`, if all columns have one. Single capitals such
/// as `A` name the end of a rod more often than a unit.
const UNITS_BEHIND_NAMES: [&str; 12] = [
    "V", "mV", "N", "kN", "mm", "g", "Pa", "kPa", "MPa", "GPa", "%", "\u{b0}C",
];

pub(super) fn without_brackets(text: &str) -> &str {
    text.strip_prefix('[')
        .and_then(|inner| inner.strip_suffix(']'))
        .or_else(|| {
            text.strip_prefix('(')
                .and_then(|inner| inner.strip_suffix(')'))
        })
        .map_or(text, str::trim)
}

pub(super) fn is_unit(text: &str) -> bool {
    let text = without_brackets(text);
    UNITS_IN_HEADERS.contains(&text) || text::known_unit(text).is_some()
}

/// Returns true for a unit whose text is a word, such as `Second`, and not a symbol; `strain` is
/// more often a name.
pub(super) fn is_unit_in_full(text: &str) -> bool {
    let is_word = text.len() > 3 && text.bytes().all(|byte| byte.is_ascii_alphabetic());
    is_word && !text.eq_ignore_ascii_case("strain") && is_unit(text)
}

/// Splits `time_s,force_N`, `"time, s","force, N"` or `in s,C1 in V`, if all columns are written in
/// this way. A name alone may end like a unit: `strain in bar`.
pub(super) fn split_together(columns: &[(String, String)]) -> Option<Vec<(String, String)>> {
    let split = |sign: &str| {
        let parts = columns.iter().enumerate().map(|(at, (name, unit))| {
            let nameless = || Some(("", name.strip_prefix(sign.trim_start())?));
            let (head, own) = name.rsplit_once(sign).or_else(nameless)?;
            let is_compound = own.contains(['/', '^', '*', '\u{b2}']) && is_unit(own);
            let is_known = match at {
                0 => is_unit(own) && (head.is_empty() || names_abscissa(head)),
                _ => !head.is_empty() && (UNITS_BEHIND_NAMES.contains(&own) || is_compound),
            };
            let is_split = is_known && unit.is_empty();
            is_split.then(|| (head.trim().to_owned(), own.to_owned()))
        });
        parts.collect::<Option<Vec<_>>>()
    };
    if columns.len() < 2 {
        return None;
    }
    ["_", ", ", " in "].into_iter().find_map(split)
}

/// Splits name and unit in `Time [s]`, `Time (s)`, `Time/s`, `CH1V` or, for an abscissa only,
/// `time_s`.
pub(super) fn split_unit(name: &str) -> (String, String) {
    let split = |head: &str, unit: &str| {
        let bare = head.trim_end_matches(['/', ' ']).trim();
        let head = if bare.is_empty() { head.trim() } else { bare };
        (head.to_owned(), unit.trim().to_owned())
    };
    // as Rigol writes it: `CH1V`
    if let Some(number) = name
        .strip_prefix("CH")
        .and_then(|rest| rest.strip_suffix(['V', 'A']))
        && !number.is_empty()
        && number.bytes().all(|byte| byte.is_ascii_digit())
    {
        let (head, unit) = name.split_at(name.len() - 1);
        return split(head, unit);
    }
    if let Some((head, unit)) = name.strip_suffix(']').and_then(|n| n.rsplit_once('[')) {
        return split(head, unit);
    }
    if let Some((head, unit)) = name.strip_suffix(')').and_then(|n| n.rsplit_once('(')) {
        let function = FUNCTIONS.contains(&head.trim().to_ascii_lowercase().as_str());
        let number = unit.bytes().all(|byte| byte.is_ascii_digit());
        if !function && !number && !head.trim().is_empty() {
            return split(head, unit);
        }
    }
    for (slash, _) in name.match_indices('/') {
        let (head, unit) = name.split_at(slash);
        let unit = unit.strip_prefix('/').unwrap_or(unit);
        // x/L is a coordinate relative to a length, not x in litres
        let is_length = matches!(unit.trim(), "l" | "L");
        if !head.trim().is_empty() && is_unit(unit.trim()) && !is_length && !is_unit(head.trim()) {
            let begin = head.rfind([' ', '_']).filter(|&at| at > 0);
            let (shorter, whole) = name.split_at(begin.unwrap_or(slash));
            let whole = whole.trim_start_matches([' ', '_', '/']);
            // the unit of `acc_m/s2` begins before the slash, that of `end A/V` behind it
            let is_compound = text::known_unit(whole).is_some_and(|unit| unit.quantity().is_some());
            return if begin.is_some() && is_compound {
                split(shorter, whole)
            } else {
                split(head, unit)
            };
        }
    }
    if let Some((head, unit)) = name.rsplit_once('_')
        && names_abscissa(head)
        && UNITS_IN_HEADERS.contains(&unit)
    {
        return split(head, unit);
    }
    (name.to_owned(), String::new())
}

pub(super) fn is_bracketed(word: &str) -> bool {
    without_brackets(word).len() < word.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_behind_a_name_is_split_off() {
        let split = |name: &str| {
            let (name, unit) = split_unit(name);
            format!("{name}|{unit}")
        };
        assert_eq!(split("Time [s]"), "Time|s");
        assert_eq!(split("frequency(Hz)"), "frequency|Hz");
        assert_eq!(split("Time/s"), "Time|s");
        assert_eq!(split("v/m/s"), "v|m/s");
        assert_eq!(split("a (m/s^2)"), "a|m/s^2");
        assert_eq!(split("time_ms"), "time|ms");
        assert_eq!(split("acc_m/s2"), "acc|m/s2");
        assert_eq!(split("free end m/s^2"), "free end|m/s^2");
        assert_eq!(split("end A/V"), "end A|V");
        assert_eq!(split("Acc / (m/s^2)"), "Acc|m/s^2");
        assert_eq!(split("CH12V"), "CH12|V");
        for plain in [
            "m/s",
            "real(accelerance)",
            "at 0.15 m (1)",
            "Dev0/Ai0",
            "signal/voltage",
            "x/L",
            "force_s",
            "time_of",
            "(s)",
            "CHV",
            "CH1 raw V",
            "strain in bar",
        ] {
            assert_eq!(split(plain), format!("{plain}|"));
        }
    }
}

//! Comparison of a result with its snapshot in the repository.
//!
//! A snapshot guards against unintended changes; it proves nothing. Numbers are compared with a
//! relative tolerance, because the last digits of exp and ln differ between machines. The values of
//! [`NOT_COMPARED`] depend on these digits or follow from other values, and are not compared.

use std::path::Path;

use serde_json::Value;

use crate::Outcome;
use crate::files::read;
use testbed::generated::write_whole;

/// Largest relative difference that does not count as a change: far below every printed digit, far
/// above rounding.
const RELATIVE: f64 = 1e-3;

/// Additional absolute tolerance for errors: smaller values consist of rounding and of the last
/// digits of a machine.
const ABSOLUTE_OF_ERRORS: f64 = 1e-5;

/// Keys whose values are errors: ratios, or differences of exponents.
const ERRORS: [&str; 2] = ["relative_error", "standard_error"];

/// Keys whose values are shown but not compared: the point where an iteration stopped in an
/// undetermined direction, residuals at the level of rounding, and values derived from compared
/// keys.
const NOT_COMPARED: [&str; 4] = ["stopped_at", "iterations", "at_rounding", "deviation"];

/// Compares `found` with the snapshot at `path`, or writes it there with `accept`.
pub(crate) fn compare(path: &Path, found: &Value, accept: bool, command: &str) -> Outcome {
    if accept {
        let text = serde_json::to_string_pretty(&rounded(found))? + "\n";
        return Ok(write_whole(path, &text)?);
    }
    let text = read(path)?;
    let expected: Value = serde_json::from_str(&text)?;
    let mut differences = Vec::new();
    differ("", &expected, found, &mut differences);
    match differences.first() {
        None => Ok(()),
        Some(first) => Err(format!(
            "{} differences from the snapshot {}; the first: {first}. If the change is intended, run \
             `{command}` and record it under Numerics in CHANGELOG.md",
            differences.len(),
            path.display()
        )
        .into()),
    }
}

fn differ(at: &str, expected: &Value, found: &Value, differences: &mut Vec<String>) {
    match (expected, found) {
        (Value::Object(expected), Value::Object(found)) => {
            for (key, value) in expected {
                if NOT_COMPARED.contains(&key.as_str()) {
                    continue;
                }
                match found.get(key) {
                    Some(other) => differ(&format!("{at}/{key}"), value, other, differences),
                    None => differences.push(format!("{at}/{key} is missing")),
                }
            }
            for key in found.keys().filter(|key| !expected.contains_key(*key)) {
                differences.push(format!("{at}/{key} is new"));
            }
        }
        (Value::Array(expected), Value::Array(found)) => {
            if expected.len() != found.len() {
                differences.push(format!(
                    "{at} has {} entries, expected {}",
                    found.len(),
                    expected.len()
                ));
            }
            for (index, (value, other)) in expected.iter().zip(found).enumerate() {
                differ(&format!("{at}/{index}"), value, other, differences);
            }
        }
        (Value::Number(a), Value::Number(b)) => {
            if let (Some(a), Some(b)) = (a.as_f64(), b.as_f64())
                && (a - b).abs() > RELATIVE * a.abs().max(b.abs())
                && !(ERRORS.iter().any(|key| at.ends_with(key))
                    && (a - b).abs() < ABSOLUTE_OF_ERRORS)
            {
                differences.push(format!("{at} is {b:e}, expected {a:e}"));
            }
        }
        _ if expected == found => {}
        _ => differences.push(format!("{at} is {found}, expected {expected}")),
    }
}

/// Returns the same value with every number rounded to six significant digits, which keeps the
/// history of a snapshot readable.
fn rounded(value: &Value) -> Value {
    match value {
        Value::Number(number) if number.is_f64() => number
            .as_f64()
            .and_then(|x| format!("{x:.5e}").parse::<f64>().ok())
            .map_or_else(|| value.clone(), Value::from),
        Value::Array(values) => values.iter().map(rounded).collect(),
        Value::Object(entries) => entries
            .iter()
            .map(|(key, value)| (key.clone(), rounded(value)))
            .collect::<serde_json::Map<_, _>>()
            .into(),
        _ => value.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn differences(expected: &Value, found: &Value) -> Vec<String> {
        let mut differences = Vec::new();
        differ("", expected, found, &mut differences);
        differences
    }

    #[test]
    fn numbers_within_the_tolerance_are_the_same() {
        let expected = json!({"a": [1.0, {"b": 2.0, "stopped_at": 5.0}], "c": "text"});
        let found = json!({"a": [1.0005, {"b": 2.0, "stopped_at": 9.0}], "c": "text"});
        assert!(differences(&expected, &found).is_empty());
        assert!(differences(&expected, &rounded(&expected)).is_empty());
    }

    #[test]
    fn every_kind_of_drift_is_named_with_its_place() {
        let expected = json!({"a": [1.0, 2.0], "b": "identified", "gone": 1});
        let found = json!({"a": [1.01], "b": "not", "new": 1});
        assert_eq!(
            differences(&expected, &found),
            [
                "/a has 1 entries, expected 2",
                "/a/0 is 1.01e0, expected 1e0",
                "/b is \"not\", expected \"identified\"",
                "/gone is missing",
                "/new is new",
            ]
        );
    }
}

//! Information about a series other than its numbers, in separate members.

use std::collections::{HashMap, HashSet};

use super::FORMAT;
use crate::error;
use crate::format::kind::{kind_name, kind_of_name};
use crate::format::npy::array::{Array, Values};
use crate::format::text;
use crate::{Abscissa, LabioError, Place, Series, SeriesAxis, SeriesKind};

/// Member with the properties of the contents.
pub(super) const ABOUT: &str = "about";
pub(super) const SUFFIXES: [&str; 3] = [".about", ".abscissa", ".start_step"];

/// Returns true if a member describes another member, or the whole file.
pub(super) fn belongs_to_another(name: &str, names: &HashSet<String>) -> bool {
    name == ABOUT
        || SUFFIXES.iter().any(|suffix| {
            name.strip_suffix(suffix)
                .is_some_and(|other| names.contains(other))
        })
}

/// Returns rows of key and value with the information about a series other than its numbers.
pub(super) fn rows(series: &Series) -> Vec<(String, String)> {
    let mut rows = Vec::new();
    let mut row = |key: &str, value: &str, usual: &str| {
        if value != usual {
            rows.push((key.to_owned(), value.to_owned()));
        }
    };
    let usual = text::axis("index", "");
    row(
        "kind",
        &kind_name(series.kind),
        &kind_name(SeriesKind::General),
    );
    row("abscissa_label", &series.abscissa_axis.label, &usual.label);
    row("abscissa_unit", &series.abscissa_axis.unit_text, "");
    row("label", &series.ordinate_axis.label, "");
    row("unit", &series.ordinate_axis.unit_text, "");
    for (key, value) in &series.properties {
        if key != "descr" {
            rows.push((format!("property {key}"), value.clone()));
        }
    }
    rows
}

pub(super) fn malformed(name: &str, found: String, expected: &str) -> LabioError {
    error::malformed(FORMAT, Place::Byte(0), format!("`{name}`"), found, expected)
}

/// Adds the descriptions to the series and to the contents.
pub(super) fn attach(
    beside: &mut HashMap<String, Array>,
    series: &mut [Series],
    properties: &mut Vec<(String, String)>,
) -> Result<(), LabioError> {
    if let Some(about) = beside.remove(ABOUT) {
        properties.extend(pairs(ABOUT, about)?);
    }
    for one in series {
        let [about, uneven, even] = SUFFIXES.map(|suffix| format!("{}{suffix}", one.name));
        if let Some(rows) = beside.remove(&about) {
            for (key, value) in pairs(&about, rows)? {
                say(one, &about, &key, value)?;
            }
        }
        match (beside.remove(&even), beside.remove(&uneven)) {
            (Some(array), _) => {
                let Values::Real(values) = &array.values else {
                    let found = array.header.element.to_string();
                    return Err(malformed(&even, found, "two real numbers"));
                };
                let &[start, step] = values.as_slice() else {
                    let found = format!("{} numbers", values.len());
                    return Err(malformed(&even, found, "first value and step"));
                };
                one.abscissa = Abscissa::Even { start, step };
            }
            (None, Some(array)) => {
                let n = one.ordinate.len();
                match array.values {
                    Values::Real(values) if values.len() == n => {
                        one.abscissa = Abscissa::Uneven(values);
                    }
                    _ => {
                        let found = format!(
                            "of shape {:?} and element {}",
                            array.header.shape, array.header.element
                        );
                        let expected = format!("{n} real numbers, one per sample");
                        return Err(malformed(&uneven, found, &expected));
                    }
                }
            }
            (None, None) => {}
        }
    }
    // a description without its series is an error
    match beside.keys().min() {
        Some(name) => Err(malformed(
            name,
            "next to an array of two axes or a text".to_owned(),
            "next to a series",
        )),
        None => Ok(()),
    }
}

fn pairs(name: &str, array: Array) -> Result<Vec<(String, String)>, LabioError> {
    let shape = array.header.shape;
    match (array.values, shape.as_slice(), array.header.fortran_order) {
        (Values::Text(texts), [_, 2], false) => Ok(texts
            .as_chunks::<2>()
            .0
            .iter()
            .map(|[key, value]| (key.clone(), value.clone()))
            .collect()),
        _ => Err(malformed(
            name,
            format!("of shape {shape:?}"),
            "texts of shape (n, 2)",
        )),
    }
}

fn say(series: &mut Series, about: &str, key: &str, value: String) -> Result<(), LabioError> {
    let set = |axis: &mut SeriesAxis, value: String| {
        axis.unit = text::known_unit(&value);
        axis.unit_text = value;
    };
    match key {
        "kind" => {
            series.kind = kind_of_name(&value).ok_or_else(|| {
                malformed(about, format!("the kind `{value}`"), "a kind of series")
            })?;
        }
        "abscissa_label" => series.abscissa_axis.label = value,
        "abscissa_unit" => set(&mut series.abscissa_axis, value),
        "label" => series.ordinate_axis.label = value,
        "unit" => set(&mut series.ordinate_axis, value),
        _ => match key.strip_prefix("property ") {
            Some(key) => series.properties.push((key.to_owned(), value)),
            None => {
                let found = format!("the key `{key}`");
                return Err(malformed(about, found, "a key of a series"));
            }
        },
    }
    Ok(())
}

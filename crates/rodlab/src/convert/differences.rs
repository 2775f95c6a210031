//! Differences between a written file and its source.

use labio::{Abscissa, Contents, Ordinate, Series, SeriesAxis};

use crate::records::text_of_unit;

/// Properties of the file format, not of the contents.
const OF_THE_FORM: [&str; 8] = [
    "uff58.encoding",
    "uff58.precision",
    "uff58.step_half_unit",
    "array",
    "shape",
    "descr",
    "fortran_order",
    "encoding",
];

/// Returns the differences between `source` and `written`, in words.
pub(super) fn between(source: &Contents, written: &Contents) -> Vec<String> {
    let mut lost = Vec::new();
    properties(
        "of the file",
        &source.properties,
        &written.properties,
        &mut lost,
    );
    if source.series.len() != written.series.len() {
        lost.push(format!(
            "{} of {} data sets",
            source.series.len().abs_diff(written.series.len()),
            source.series.len()
        ));
    }
    for (number, (one, other)) in source.series.iter().zip(&written.series).enumerate() {
        let of = match one.name.trim() {
            "" => format!("of data set {}", number + 1),
            name => format!("of `{name}`"),
        };
        series(&of, one, other, &mut lost);
    }
    lost
}

fn series(of: &str, one: &Series, other: &Series, lost: &mut Vec<String>) {
    if one.name.trim() != other.name.trim() && !one.name.trim().is_empty() {
        lost.push(format!("the name {of}"));
    }
    if one.kind != other.kind {
        lost.push(format!(
            "the kind {of}: {:?} became {:?}",
            one.kind, other.kind
        ));
    }
    axis(
        "the abscissa",
        of,
        &one.abscissa_axis,
        &other.abscissa_axis,
        lost,
    );
    axis(
        "the values",
        of,
        &one.ordinate_axis,
        &other.ordinate_axis,
        lost,
    );
    abscissa(of, one, other, lost);
    values(of, &one.ordinate, &other.ordinate, lost);
    properties(of, &one.properties, &other.properties, lost);
}

fn axis(what: &str, of: &str, one: &SeriesAxis, other: &SeriesAxis, lost: &mut Vec<String>) {
    if one.label != other.label && !one.label.is_empty() {
        lost.push(format!("the label of {what} {of}, `{}`", one.label));
    }
    let text = text_of_unit(one);
    let kept = match (&one.unit, &other.unit) {
        (Some(unit), Some(written)) => unit.is_same_as(written),
        (unit, written) => unit.is_some() == written.is_some() && text == other.unit_text,
    };
    if !(kept || text.is_empty()) {
        lost.push(format!("the unit of {what} {of}, `{text}`"));
    }
}

fn abscissa(of: &str, one: &Series, other: &Series, lost: &mut Vec<String>) {
    let same = |a: f64, b: f64| a.to_bits() == b.to_bits();
    match (&one.abscissa, &other.abscissa) {
        (
            Abscissa::Even { start, step },
            Abscissa::Even {
                start: other_start,
                step: other_step,
            },
        ) => {
            if !(same(*start, *other_start) && same(*step, *other_step)) {
                lost.push(format!(
                    "the abscissa {of}: start {start} and step {step} became start {other_start} and step {other_step}"
                ));
            }
        }
        (Abscissa::Uneven(a), Abscissa::Uneven(b)) => {
            if a.len() != b.len() || !a.iter().zip(b).all(|(a, b)| same(*a, *b)) {
                lost.push(format!("digits of the abscissa {of}"));
            }
        }
        _ => lost.push(format!("the abscissa {of}")),
    }
}

fn values(of: &str, one: &Ordinate, other: &Ordinate, lost: &mut Vec<String>) {
    let parts = |ordinate: &Ordinate| -> Vec<f64> {
        match ordinate {
            Ordinate::Real(values) => values.clone(),
            Ordinate::Complex(values) => values.iter().flat_map(|v| [v.re, v.im]).collect(),
        }
    };
    let complex = |ordinate: &Ordinate| matches!(ordinate, Ordinate::Complex(_));
    if complex(one) != complex(other) || one.len() != other.len() {
        lost.push(format!("values {of}"));
        return;
    }
    let largest = parts(one)
        .iter()
        .zip(parts(other))
        .filter(|(a, b)| a.to_bits() != b.to_bits() && !(a.is_nan() && b.is_nan()))
        .map(|(a, b)| ((a - b) / a).abs())
        .fold(None, |largest: Option<f64>, x| {
            Some(largest.map_or(x, |largest| largest.max(x)))
        });
    if let Some(largest) = largest {
        lost.push(format!(
            "digits of the values {of}: up to {largest:.0e} of a value"
        ));
    }
}

fn properties(
    of: &str,
    one: &[(String, String)],
    other: &[(String, String)],
    lost: &mut Vec<String>,
) {
    for (key, value) in one {
        if !OF_THE_FORM.contains(&key.as_str()) && !other.contains(&(key.clone(), value.clone())) {
            lost.push(format!(
                "the property `{key}` {of}, `{}`",
                value.escape_debug()
            ));
        }
    }
}

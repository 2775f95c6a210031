//! Contents reduced to the parts that a format can hold.

use std::collections::HashSet;

use labio::{Abscissa, Contents, Series, SeriesAxis, SeriesKind};

use crate::records::text_of_unit;

/// Returns `contents` without the parts that `format` cannot hold; values are always kept. The
/// comparison of the written file with its source lists the removed parts.
pub(crate) fn fitted(contents: &Contents, format: &str) -> Contents {
    let mut fitted = Contents::of_format(contents.format);
    fitted.series.clone_from(&contents.series);
    for series in &mut fitted.series {
        // a universal file states the unit of a denominator in a field of its own
        let has_denominator = series
            .properties
            .iter()
            .any(|(key, _)| key.starts_with("uff58.denominator"));
        if format != "uff58" || !has_denominator {
            for axis in [&mut series.ordinate_axis, &mut series.abscissa_axis] {
                axis.unit_text = text_of_unit(axis).to_owned();
            }
        }
    }
    match format {
        "npy" => {
            let n = fitted.series.len();
            for (index, series) in fitted.series.iter_mut().enumerate() {
                bare(series, index, n);
            }
        }
        "wav" => {
            fitted.properties = contents
                .properties
                .iter()
                .filter(|(key, _)| is_info(key))
                .cloned()
                .collect();
            for series in &mut fitted.series {
                series.properties.clear();
                if series.kind == SeriesKind::General {
                    series.kind = SeriesKind::TimeResponse;
                }
            }
        }
        "uff58" => {
            for series in &mut fitted.series {
                series
                    .properties
                    .retain(|(key, _)| key.starts_with("uff58."));
                // properties of the encoding of the source do not apply to the new file
                let of_source = ["uff58.encoding", "uff58.precision", "uff58.step_half_unit"];
                series
                    .properties
                    .retain(|(key, _)| !of_source.contains(&key.as_str()));
            }
        }
        "npz" => {
            fitted.properties.clone_from(&contents.properties);
            name_members(&mut fitted.series);
            for series in &mut fitted.series {
                // these keys describe the layout of the array in the source
                series.properties.retain(|(key, _)| {
                    !["array", "shape", "fortran_order"].contains(&key.as_str())
                });
            }
        }
        _ => fitted.properties.clone_from(&contents.properties),
    }
    fitted
}

/// Gives each series a name that a member of an archive can have: without `/`, not empty, and
/// different from all others.
fn name_members(all: &mut [Series]) {
    let mut taken: HashSet<String> = HashSet::new();
    for (series, number) in all.iter_mut().zip(1_usize..) {
        let mut name = series.name.trim().replace(['/', '\\'], "_");
        if name.is_empty() {
            name = format!("series {number}");
        }
        while !taken.insert(name.clone()) {
            name = format!("{name} {number}");
        }
        series.name = name;
    }
}

/// Reduces one of `n` series to its numbers.
fn bare(series: &mut Series, index: usize, n: usize) {
    series.name = if n == 1 {
        String::new()
    } else {
        format!("[{index}, :]")
    };
    series.kind = SeriesKind::General;
    series.abscissa = Abscissa::Even {
        start: 0.0,
        step: 1.0,
    };
    series.abscissa_axis = SeriesAxis {
        label: "index".to_owned(),
        ..SeriesAxis::default()
    };
    series.ordinate_axis = SeriesAxis::default();
    series.properties.clear();
}

/// Returns true if a WAVE file has a field for a text of this name.
fn is_info(key: &str) -> bool {
    let of_info = key.len() == 4
        && key.starts_with('I')
        && key
            .bytes()
            .all(|b| b.is_ascii_uppercase() || b.is_ascii_digit());
    of_info && key != "ICMT"
}

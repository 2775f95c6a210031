//! Contents reduced to the parts that a format can hold.

use labio::{Abscissa, Contents, Series, SeriesAxis, SeriesKind};

/// Returns `contents` without the parts that `format` cannot hold; values are always kept. The
/// comparison of the written file with its source lists the removed parts.
pub(crate) fn fitted(contents: &Contents, format: &str) -> Contents {
    let mut fitted = Contents::of_format(contents.format);
    fitted.series.clone_from(&contents.series);
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

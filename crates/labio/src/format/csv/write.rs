//! Writing a table.

use std::io::Write;

use super::abscissa::default_kind;
use super::abscissa_name::Marker;
use super::cells::is_number;
use super::{CsvSeparator, FORMAT, header};
use crate::error::{not_representable, not_written};
use crate::format::kind::{kind_name, kind_of_name};
use crate::format::text::{self, DecimalMark};
use crate::{Abscissa, Contents, LabioError, Ordinate, Series};

/// Number of bytes of collected output at which they are written.
const BUFFER_BYTES: usize = 1 << 16;

fn cannot_hold(what: impl Into<String>) -> LabioError {
    not_representable(FORMAT, what.into())
}

pub(super) fn write(contents: &Contents, output: &mut dyn Write) -> Result<(), LabioError> {
    let longest = contents
        .series
        .iter()
        .max_by_key(|series| series.ordinate.len())
        .filter(|series| !series.ordinate.is_empty())
        .ok_or_else(|| cannot_hold("contents without a sample"))?;
    let n_rows = longest.ordinate.len();
    for series in &contents.series {
        check_series(series, longest)?;
    }
    let mut buffer = head(contents, longest)?;
    let mut put = |buffer: &mut Vec<u8>| {
        let result = output.write_all(buffer);
        buffer.clear();
        result.map_err(not_written)
    };
    for row in 0..n_rows {
        #[allow(
            clippy::indexing_slicing,
            reason = "`check_series` refuses an uneven abscissa that has not one value for each sample"
        )]
        let x = match &longest.abscissa {
            Abscissa::Even { start, step } => start + row as f64 * step,
            Abscissa::Uneven(values) => values[row],
        };
        number(x, &mut buffer)?;
        for series in &contents.series {
            buffer.push(b',');
            match &series.ordinate {
                Ordinate::Real(values) => {
                    if let Some(&value) = values.get(row) {
                        number(value, &mut buffer)?;
                    }
                }
                Ordinate::Complex(values) => {
                    if let Some(value) = values.get(row) {
                        number(value.re, &mut buffer)?;
                        if value.im.is_sign_positive() || value.im.is_nan() {
                            buffer.push(b'+');
                        }
                        number(value.im, &mut buffer)?;
                        buffer.push(b'j');
                    }
                }
            }
        }
        buffer.push(b'\n');
        if buffer.len() >= BUFFER_BYTES {
            put(&mut buffer)?;
        }
    }
    put(&mut buffer)
}

/// Writes a number with the fewest digits that read back to the same bits.
fn number(value: f64, to: &mut Vec<u8>) -> Result<(), LabioError> {
    write!(to, "{value:?}").map_err(not_written)
}

fn check_series(series: &Series, longest: &Series) -> Result<(), LabioError> {
    let name = &series.name;
    let same = match (&series.abscissa, &longest.abscissa) {
        (
            Abscissa::Even { start, step },
            Abscissa::Even {
                start: other_start,
                step: other_step,
            },
        ) => start.to_bits() == other_start.to_bits() && step.to_bits() == other_step.to_bits(),
        (Abscissa::Uneven(values), Abscissa::Uneven(others)) => {
            if values.len() != series.ordinate.len() {
                return Err(cannot_hold(format!(
                    "`{name}`, which has {} abscissae for {} samples",
                    values.len(),
                    series.ordinate.len()
                )));
            }
            values
                .iter()
                .zip(others)
                .all(|(value, other)| value.to_bits() == other.to_bits())
        }
        _ => false,
    };
    if !same || series.abscissa_axis != longest.abscissa_axis {
        return Err(cannot_hold(format!(
            "`{name}` and `{}` in one table: they have different abscissae",
            longest.name
        )));
    }
    let finite = match &longest.abscissa {
        Abscissa::Even { start, step } => start.is_finite() && step.is_finite(),
        Abscissa::Uneven(values) => values.iter().all(|value| value.is_finite()),
    };
    if !finite {
        return Err(cannot_hold(format!(
            "the abscissa of `{name}`, which is not finite"
        )));
    }
    if matches!(&series.ordinate, Ordinate::Complex(values) if values.is_empty()) {
        return Err(cannot_hold(format!(
            "`{name}`, which is complex and has no samples"
        )));
    }
    Ok(())
}

/// Returns the header: properties, names and units.
fn head(contents: &Contents, longest: &Series) -> Result<Vec<u8>, LabioError> {
    let mut lines = Vec::new();
    let mut comment = |key: &str, value: &str| {
        let line = format!("{key} = {value}");
        let kept = header::key_and_value(line.trim()) == Some((key, value));
        if !kept || line.chars().any(char::is_control) || key.starts_with(['#', '%']) {
            return Err(cannot_hold(format!(
                "the property {} with {}",
                text::quoted(key),
                text::quoted(value)
            )));
        }
        lines.push(format!("# {}\n", line.trim()));
        Ok(())
    };
    for (key, value) in &contents.properties {
        if key == "abscissa" || key.starts_with("column ") {
            return Err(cannot_hold(format!("a property called `{key}`")));
        }
        comment(key, value)?;
    }
    for (at, series) in contents.series.iter().enumerate() {
        let column = at + 2; // after the abscissa, counted from 1
        if series.kind != default_kind(&series.abscissa_axis) {
            comment(&format!("column {column}: kind"), &kind_name(series.kind))?;
        }
        if !series.ordinate_axis.label.is_empty() {
            comment(
                &format!("column {column}: label"),
                &series.ordinate_axis.label,
            )?;
        }
        for (key, value) in &series.properties {
            if key == "label" || (key == "kind" && kind_of_name(value).is_some()) {
                return Err(cannot_hold(format!(
                    "a property called `{key}` of `{}`",
                    series.name
                )));
            }
            comment(&format!("column {column}: {key}"), value)?;
        }
    }
    let marker = match longest.abscissa {
        Abscissa::Even { start, step } => Marker::Even { start, step },
        Abscissa::Uneven(_) => Marker::Uneven,
    };
    comment("abscissa", &marker.to_string())?;
    let mut head = lines.concat().into_bytes();
    let axis = &longest.abscissa_axis;
    let names: Vec<&str> = std::iter::once(axis.label.as_str())
        .chain(contents.series.iter().map(|series| series.name.as_str()))
        .collect();
    let units: Vec<String> = std::iter::once(&axis.unit_text)
        .chain(
            contents
                .series
                .iter()
                .map(|series| &series.ordinate_axis.unit_text),
        )
        .map(|unit| format!("[{unit}]"))
        .collect();
    if names
        .iter()
        .all(|name| name.is_empty() || is_number(name, DecimalMark::Point))
    {
        return Err(cannot_hold("names that are all empty or numbers"));
    }
    if axis.label.starts_with(['#', '%']) {
        return Err(cannot_hold(format!(
            "an abscissa called `{}`, because a comment begins the same way",
            axis.label
        )));
    }
    row(&names, &mut head)?;
    row(
        &units.iter().map(String::as_str).collect::<Vec<_>>(),
        &mut head,
    )?;
    Ok(head)
}

/// Writes one row of texts, in quotes where needed; a text that would not read back unchanged is an
/// error.
fn row(texts: &[&str], to: &mut Vec<u8>) -> Result<(), LabioError> {
    let failed = |source: ::csv::Error| LabioError::Write {
        source: std::io::Error::other(source),
    };
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    writer.write_record(texts).map_err(failed)?;
    let bytes = writer.into_inner().map_err(|error| LabioError::Write {
        source: std::io::Error::other(error.to_string()),
    })?;
    let mut cells = Vec::new();
    let line = String::from_utf8_lossy(&bytes);
    CsvSeparator::Comma.cut(line.trim_end_matches('\n'), &mut cells);
    for (text, cell) in texts.iter().zip(&cells) {
        if text != cell
            || text.chars().any(char::is_control)
            || text.contains("[ ")
            || text.contains(" ]")
        {
            return Err(cannot_hold(format!(
                "the name or unit {}",
                text::quoted(text)
            )));
        }
    }
    if cells.len() != texts.len() {
        return Err(cannot_hold(
            "names or units that do not form the cells of a row",
        ));
    }
    to.extend(bytes);
    Ok(())
}

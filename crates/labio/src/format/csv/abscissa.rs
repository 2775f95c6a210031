//! Choice of the abscissa column, and its spacing.

use super::abscissa_name::{INDEX_NAMES, Marker, called, is_frequency, is_time};
use super::header::Header;
use super::settings::Clock;
use super::table::Table;
use super::{CsvAbscissa, malformed};
use crate::error::{check_positive, count_mismatch};
use crate::format::Strictness;
use crate::format::kind::kind_of_name;
use crate::format::rounding::{Written, WrittenValues};
use crate::format::text;
use crate::{
    Abscissa, Contents, Dimension, LabioError, Ordinate, Place, Series, SeriesAxis, SeriesKind,
};

/// Largest accepted relative uncertainty of a step due to rounding. The relative error of a
/// frequency is then at most 1e-4.
pub const ROUNDED_STEP_TOLERANCE: f64 = 1e-4;

/// Relative difference between the mean steps of two columns of times above which the columns have
/// different rates: larger than the rounding of times with four digits.
const DIFFERENT_STEP: f64 = 1e-3;

/// Choice of the abscissa column, made before the numbers are read.
#[derive(Debug, Default)]
pub(super) struct Choice {
    pub(super) column: Option<usize>,
    /// True for the first column of a table without headings: it is the abscissa only if its values
    /// increase evenly.
    tentative: bool,
    /// True if the caller has chosen the column.
    is_stated: bool,
    step: Option<f64>,
    /// Times stated in the header, if no column has them; the column, if any, counts the samples.
    clock: Option<Clock>,
    /// Rate used if the column does not determine its own spacing.
    rate_hz: Option<f64>,
    marker: Option<Marker>,
}

impl Choice {
    pub(super) fn of(
        header: &Header,
        wish: CsvAbscissa,
        n_columns: usize,
    ) -> Result<Self, LabioError> {
        let mut choice = Self::default();
        match wish {
            CsvAbscissa::Index => return Ok(choice),
            CsvAbscissa::Column(column) => {
                if column == 0 || column > n_columns {
                    return count_mismatch(
                        "column of the abscissa, from 1 to the number of columns",
                        column,
                        n_columns,
                    );
                }
                choice.column = Some(column - 1);
                choice.is_stated = true;
                return Ok(choice);
            }
            CsvAbscissa::Step(step) => choice.step = Some(step),
            CsvAbscissa::Rate(rate_hz) => {
                choice.rate_hz = Some(check_positive("sampling rate [Hz]", rate_hz)?);
            }
            CsvAbscissa::ByContent => {}
        }
        let columns = &header.columns;
        let first = |test: fn(&str, &str) -> bool| {
            columns.first().is_some_and(|(name, unit)| test(name, unit))
        };
        if let Some(marker) = header.abscissa.as_deref().and_then(Marker::parse) {
            choice.marker = Some(marker);
            choice.column = Some(0);
        } else if n_columns < 2 {
            choice.column = None;
        } else if columns.is_empty() {
            choice.column = Some(0);
            choice.tentative = true;
        } else if let Some(column) = columns.iter().position(|(name, _)| is_time(name, "")) {
            choice.column = Some(column);
        } else if first(is_time)
            || first(is_frequency)
            || first(|name, _| called(name, &INDEX_NAMES))
        {
            choice.column = Some(0);
        }
        // a stated step has precedence over that of the file
        if choice.step.is_none() {
            let named = choice.column.and_then(|column| columns.get(column));
            let unit = named.map_or("", |(_, unit)| unit);
            // instruments write the interval next to a column with few digits
            choice.step = header.settings.step_in(unit);
            if named.is_none_or(|(name, _)| called(name, &INDEX_NAMES)) && !choice.tentative {
                choice.clock = header.settings.clock();
            }
        }
        Ok(choice)
    }
}

/// Assembles the contents from the columns and the header.
pub(super) fn assemble(
    mut table: Table,
    header: Header,
    choice: &Choice,
    strictness: Strictness,
    contents: &mut Contents,
) -> Result<(), LabioError> {
    let place = Place::cell(table.first_line, choice.column.unwrap_or(0));
    let axis = |at: usize| {
        let (label, unit_text) = header.columns.get(at).cloned().unwrap_or_default();
        text::axis(label, unit_text)
    };
    let mut abscissa_axis = choice.column.map(axis).unwrap_or_default();
    table.digits.restore_trailing_zeros();
    let abscissa = spacing(
        &table.digits,
        choice,
        &mut abscissa_axis,
        place,
        strictness,
        &mut contents.defects,
    )?;
    let column = choice.column.filter(|_| abscissa.is_some());
    let abscissa = abscissa.unwrap_or_else(|| {
        let (start, step) = match (&choice.clock, choice.step, choice.column) {
            (Some(clock), _, None) => (clock.start, clock.step),
            (None, Some(step), None) => (0.0, step),
            _ => (0.0, 1.0),
        };
        Abscissa::Even { start, step }
    });
    if let (Some(column), false) = (column, choice.is_stated || choice.marker.is_some())
        && let Some(error) = other_times(&table, column, &axis)
    {
        strictness.pass_over(error, &mut contents.defects)?;
    }
    if column.is_none() {
        abscissa_axis = match &choice.clock {
            Some(clock) => text::axis("time", clock.unit.as_str()),
            None => text::axis("index", ""),
        };
    }
    let kind = default_kind(&abscissa_axis);
    contents.properties.extend(header.properties);
    for (at, ordinate) in table.columns.into_iter().enumerate() {
        if column == Some(at) {
            continue;
        }
        let abscissa = match &abscissa {
            Abscissa::Uneven(values) => match values.get(..ordinate.len()) {
                Some(values) => Abscissa::Uneven(values.to_vec()),
                None => {
                    let found = format!("{} values", values.len());
                    let expected = format!("the {} of column {}", ordinate.len(), at + 1);
                    return Err(malformed(place, "abscissa", &found, &expected));
                }
            },
            even => even.clone(),
        };
        let mut ordinate_axis = axis(at);
        let mut series = Series {
            name: std::mem::take(&mut ordinate_axis.label),
            kind,
            abscissa,
            ordinate,
            abscissa_axis: abscissa_axis.clone(),
            ordinate_axis,
            properties: Vec::new(),
        };
        for (key, value) in header.of_columns.get(&(at + 1)).into_iter().flatten() {
            match (key.as_str(), kind_of_name(value)) {
                ("kind", Some(kind)) => series.kind = kind,
                ("label", _) => series.ordinate_axis.label.clone_from(value),
                _ => series.properties.push((key.clone(), value.clone())),
            }
        }
        contents.series.push(series);
    }
    Ok(())
}

/// Returns the error for a second column of times whose mean step or start differs from that of the
/// times `first`: the channels after it were sampled at another rate or at other times.
fn other_times(
    table: &Table,
    first: usize,
    axis: &impl Fn(usize) -> SeriesAxis,
) -> Option<LabioError> {
    // start and mean step [s]
    let times = |at: usize| {
        let unit = axis(at).unit?;
        let Ordinate::Real(values) = table.columns.get(at)? else {
            return None;
        };
        let rising = values
            .windows(2)
            .all(|pair| matches!(pair, [a, b] if a < b));
        let (from, to) = (unit.to_si(*values.first()?), unit.to_si(*values.last()?));
        let n_steps = values.len().checked_sub(1).filter(|&n| n > 0)?;
        (unit.dimension() == Dimension::TIME && rising)
            .then_some((from, (to - from) / n_steps as f64))
    };
    let (start, step) = times(first)?;
    // a second column of times has columns of other channels on both sides, whereas a column with
    // the time of day is next to the first column of times or at the end of the table
    let stands_between = |at: usize| at > first + 1 && at + 1 < table.columns.len();
    let mut others = (0..table.columns.len()).filter(|&at| at != first);
    let (at, part, other, own) = others.find_map(|at| {
        let (other_start, other_step) = times(at)?;
        if (other_step / step - 1.0).abs() > DIFFERENT_STEP {
            Some((at, "step of the times", other_step, step))
        } else if stands_between(at) && (other_start - start).abs() > 0.5 * step {
            Some((at, "start of the times", other_start, start))
        } else {
            None
        }
    })?;
    let place = Place::cell(table.first_line, at);
    Some(malformed(
        place,
        part,
        &format!("{other:e} s"),
        &format!(
            "{own:e} s, as in column {}; channels with other times need a file of their own",
            first + 1
        ),
    ))
}

/// Returns the abscissa that the written values represent, or `None` if the column is not an
/// abscissa.
fn spacing(
    digits: &WrittenValues,
    choice: &Choice,
    axis: &mut SeriesAxis,
    place: Place,
    strictness: Strictness,
    defects: &mut Vec<LabioError>,
) -> Result<Option<Abscissa>, LabioError> {
    let (Some(_), Some(start)) = (choice.column, digits.get(0)) else {
        return Ok(None);
    };
    let off = |found: String, expected: &str| Err(malformed(place, "abscissa", &found, expected));
    let even = |start: f64, step: f64| Ok(Some(Abscissa::Even { start, step }));
    match choice.marker {
        Some(Marker::Uneven) => return Ok(Some(Abscissa::Uneven(digits.values.clone()))),
        Some(Marker::Even { start, step }) => {
            return match digits.first_not_exactly(start, step) {
                None => even(start, step),
                Some(row) => {
                    let row = row + 1;
                    let found = format!("a value other than that of start and step in row {row}");
                    off(found, "the abscissa stated in the header")
                }
            };
        }
        None => {}
    }
    if let Some(clock) = &choice.clock {
        let one = Written::exactly(1.0);
        if let Some(row) = digits.first_off(Written::exactly(start.value), one) {
            return Err(off_step(digits, row, start.value, 1.0, place));
        }
        *axis = text::axis("time", clock.unit.as_str());
        return even(clock.start + start.value * clock.step, clock.step);
    }
    let first_off = |step: f64| {
        // numbers may have been rounded before they were printed with more digits
        let within = Written {
            half_unit: start.half_unit.max(0.5 * step.abs()),
            ..start
        };
        digits.first_off(within, Written::exactly(step))
    };
    if let Some(step) = choice.step {
        return match first_off(step) {
            None => even(start.value, step),
            Some(row) => Err(off_step(digits, row, start.value, step, place)),
        };
    }
    let spacing = digits.even_spacing();
    if let Some((start, step)) = spacing {
        let known = step.half_unit <= ROUNDED_STEP_TOLERANCE * step.value.abs();
        if known || digits.is_even(start, step.value) {
            let increasing = step.value > 0.0 || !choice.tentative;
            return Ok(increasing.then_some(Abscissa::Even {
                start,
                step: step.value,
            }));
        }
    }
    let told = axis.unit.as_ref().map(|unit| (unit.dimension(), unit));
    let unit_of_time = match told {
        Some((Dimension::TIME, unit)) => Some(unit.scale()),
        None if axis.unit_text.is_empty() => Some(1.0),
        _ => None,
    };
    if let (Some(rate_hz), Some(unit_of_time)) = (choice.rate_hz, unit_of_time) {
        let step = 1.0 / (rate_hz * unit_of_time);
        match first_off(step) {
            None => {
                if told.is_none() {
                    *axis = text::axis(std::mem::take(&mut axis.label), "s");
                }
                return even(start.value, step);
            }
            Some(row) if told.is_some() => {
                return Err(off_step(digits, row, start.value, step, place));
            }
            // nothing identifies the column as time
            Some(_) => {}
        }
    }
    if choice.tentative {
        return Ok(None);
    }
    let repeats = digits
        .values
        .windows(2)
        .any(|pair| matches!(pair, [a, b] if a.to_bits() == b.to_bits()));
    if let (Some((start, step)), true) = (spacing, repeats) {
        let found = format!(
            "repeated values; their digits give the step {:e} to within {:.1e}",
            step.value, step.half_unit
        );
        let expected =
            format!("a step known to within a relative {ROUNDED_STEP_TOLERANCE}, or a stated step");
        let error = malformed(place, "abscissa", &found, &expected);
        strictness.pass_over(error, defects)?;
        return even(start, step.value);
    }
    Ok(Some(Abscissa::Uneven(digits.values.clone())))
}

/// Returns the error for a column whose value in `row`, from 0, is not `start + row * step`.
fn off_step(digits: &WrittenValues, row: usize, start: f64, step: f64, place: Place) -> LabioError {
    let found = match digits.get(row) {
        Some(found) => format!("{:e} in row {}", found.value, row + 1),
        None => format!("no number in row {}", row + 1),
    };
    let expected = format!(
        "{:e} to within half a step of {step:e}",
        start + row as f64 * step
    );
    malformed(place, "abscissa", &found, &expected)
}

/// Default kind of a column with the abscissa `abscissa_axis`.
pub(super) fn default_kind(abscissa_axis: &SeriesAxis) -> SeriesKind {
    if is_time(&abscissa_axis.label, &abscissa_axis.unit_text) {
        SeriesKind::TimeResponse
    } else {
        SeriesKind::General
    }
}

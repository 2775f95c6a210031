//! Statements of a file about its channels, completed by statements of the sheet.

use labio::format::mat5::RATE_SOURCE;
use labio::format::uff58::response;
use labio::format::{self, Reader};
use labio::{Abscissa, Contents, Dimension, LabioError, Series, SeriesAxis, Unit};

use super::file_set::PartFile;
use super::{ChannelSheet, Records, Selector};
use crate::digits;
use crate::{InStep, RodlabError};

/// Largest relative difference at which the sampling rate of the sheet counts as the exact value of
/// a rate that is rounded in the file.
const ROUNDED_RATE: f64 = 1e-3;

/// Relative difference above which times without a unit contradict a sampling rate.
const STRANGE_RATE: f64 = 1e-2;

/// Units, in s, in which times may be written.
const SECONDS: [f64; 4] = [1.0, 1e-3, 1e-6, 1e-9];

/// Returns the step of evenly spaced times without a unit; `None` if the abscissa is the number of
/// the sample.
pub(crate) fn step_without_unit(series: &Series) -> Option<f64> {
    match series.abscissa {
        Abscissa::Even { step, .. } if series.abscissa_axis.unit.is_none() => {
            Some(step).filter(|step| (step - 1.0).abs() > 1e-9)
        }
        _ => None,
    }
}

/// Returns the text of the unit of an axis: the text of the file or, if this text is empty or names
/// another unit, as for the numerator of a frequency response, the symbol of the unit.
pub(crate) fn text_of_unit(axis: &SeriesAxis) -> &str {
    let text = axis.unit_text.as_str();
    match &axis.unit {
        Some(unit) if Unit::parse(text).is_ok_and(|of_text| of_text.is_same_as(unit)) => text,
        Some(unit) => unit.symbol(),
        None => text,
    }
}

/// Returns true for repeated times in a table, whose digits do not determine the step.
pub(crate) fn is_rounded_step(error: &LabioError) -> bool {
    // the name of a worksheet comes before that of the field
    matches!(
        error,
        LabioError::Malformed { field, found, .. }
            if field.ends_with("abscissa") && found.starts_with("repeated values")
    )
}

/// Returns the error for times of `file` that need a stated sampling rate; `are` describes them.
fn rate_needed(field: &str, file: &str, are: &str) -> RodlabError {
    RodlabError::request(
        format!("{field}.sampling_rate"),
        "not stated",
        format!(
            "the sampling rate, such as \"51.2 kHz\", that gives all times within half a step: the times of {file} are {are}"
        ),
    )
}

/// A doubtful statement of some of the files: a unit that the sheet replaces by another, or a
/// sampling rate.
#[derive(Debug)]
pub(super) struct FileStatement {
    /// The files with this statement.
    files: Vec<String>,
    /// Words after "the file states".
    statement: String,
}

impl FileStatement {
    /// Adds `file` to the files with this statement.
    fn note(all: &mut Vec<Self>, file: &str, statement: String) {
        match all.iter_mut().find(|one| one.statement == statement) {
            Some(one) if one.files.last().is_some_and(|last| last == file) => {}
            Some(one) => one.files.push(file.to_owned()),
            None => all.push(Self {
                files: vec![file.to_owned()],
                statement,
            }),
        }
    }

    /// Returns the warning. If there are several files, it states their number and the first of
    /// them.
    pub(super) fn warning(&self) -> String {
        let statement = &self.statement;
        match self.files.as_slice() {
            [first, _, ..] => {
                let n = self.files.len();
                format!("{n} files, the first of them {first}, state {statement}")
            }
            files => format!("{} states {statement}", files.concat()),
        }
    }
}

/// Returns true for a table of rows with a column of times or another abscissa.
fn has_time_column(contents: &Contents) -> bool {
    let mut series = contents.series.iter();
    format::reader(contents.format).is_some_and(Reader::reads_tables)
        && series.any(|series| series.abscissa_axis.label != "index")
}

/// Returns the variable from which the sampling rate of a MATLAB file is taken.
fn rate_source(contents: &Contents) -> Option<&str> {
    let mut properties = contents.properties.iter();
    let found = properties.find(|(key, _)| key == RATE_SOURCE);
    found.map(|(_, source)| source.as_str())
}

impl Records {
    /// Returns the error about `file`, which could not be read. For rounded times without a stated
    /// sampling rate, it asks for the rate.
    pub(super) fn not_read(&self, error: LabioError, file: &str, field: &str) -> RodlabError {
        if let LabioError::Malformed { found, .. } = &error
            && self.sampling_rate.is_none()
            && is_rounded_step(&error)
        {
            return rate_needed(field, file, &format!("rounded ({found})"));
        }
        RodlabError::step(format!("reading {file}"), error)
    }

    /// Adds to `contents` the sampling rate and the units that the sheet states and the file does
    /// not record. Returns, for each channel of the file, the indices of its series: one for each
    /// hit in the file.
    pub(super) fn complete(
        &self,
        contents: &mut Contents,
        PartFile {
            shown: file,
            channels,
            ..
        }: &PartFile<'_>,
        field: &str,
        statements: &mut Vec<FileStatement>,
    ) -> Result<Vec<Vec<usize>>, RodlabError> {
        if let (None, Some(source)) = (&self.sampling_rate, rate_source(contents)) {
            let statement = format!(
                "the sampling rate only as the {source}; state `sampling_rate` in the sheet to confirm it."
            );
            FileStatement::note(statements, file, statement);
        }
        let mut chosen = Vec::with_capacity(channels.len());
        for &(at, channel) in channels {
            let series = meant(contents, &channel.from);
            if series.is_empty() {
                let known = contents.series.iter().enumerate();
                let mut names: Vec<String> = known
                    .map(|(index, series)| match series.name.trim() {
                        "" => (index + 1).to_string(),
                        name => format!("`{name}`"),
                    })
                    .collect();
                names.dedup();
                let expected = match &channel.from {
                    Selector::Number(_) => format!("a number from 1 to {}", contents.series.len()),
                    Selector::Name(_) => format!("one of {}", names.join(", ")),
                };
                let mut hint = match &channel.from {
                    Selector::Number(_) if has_time_column(contents) => {
                        "; the column of times is not counted: channel 1 is the first column after it"
                            .to_owned()
                    }
                    _ => String::new(),
                };
                if let [_] = contents.series.as_slice()
                    && channel.files.is_empty()
                {
                    hint.push_str("; ");
                    hint.push_str(super::IN_SEPARATE_FILES);
                }
                return Err(RodlabError::request(
                    format!("{field}.channels[{at}].from"),
                    channel.from.to_string(),
                    format!("{expected} ({file}){hint}"),
                ));
            }
            if let Some(other) = namesake(contents, &channel.name, &series) {
                return Err(RodlabError::request(
                    format!("{field}.channels[{at}].from"),
                    channel.from.to_string(),
                    format!(
                        "channel {}, which has the name `{}` in {file}, or another name",
                        other + 1,
                        channel.name
                    ),
                ));
            }
            for &index in &series {
                self.complete_time(contents, index, file, field)?;
                let place = format!("{field}.channels[{at}].unit");
                complete_unit(contents, index, channel, (file, &place), statements)?;
            }
            chosen.push(series);
        }
        Ok(chosen)
    }

    #[allow(
        clippy::indexing_slicing,
        reason = "`complete` passes indices of series of the file"
    )]
    fn complete_time(
        &self,
        contents: &mut Contents,
        index: usize,
        file: &str,
        field: &str,
    ) -> Result<(), RodlabError> {
        let (by, remedy) = match rate_source(contents) {
            Some(source) => (
                format!(" ({source})"),
                "; if the variable is wrong, save the file without it",
            ),
            None => (String::new(), ""),
        };
        let series = &mut contents.series[index];
        let told = series.abscissa_axis.unit.as_ref();
        let Some(rate) = &self.sampling_rate else {
            let of_time = told.is_some_and(|unit| unit.dimension() == Dimension::TIME);
            if of_time && matches!(series.abscissa, Abscissa::Uneven(_)) {
                return Err(rate_needed(field, file, "not evenly spaced"));
            }
            return if told.is_none() {
                let told = step_without_unit(series).map_or_else(
                    || "does not state it".to_owned(),
                    |step| {
                        let without = match series.abscissa_axis.unit_text.as_str() {
                            "" => "without a unit".to_owned(),
                            unit => format!("in `{unit}`, which is not a known unit"),
                        };
                        format!(
                            "has times {without}; in s they give {} Hz",
                            digits::rate(1.0 / step)
                        )
                    },
                );
                Err(RodlabError::request(
                    format!("{field}.sampling_rate"),
                    "not stated",
                    format!("the sampling rate, such as \"51.2 kHz\": {file} {told}"),
                ))
            } else {
                Ok(())
            };
        };
        let field = format!("{field}.sampling_rate");
        let or = format!("the field left out{remedy}");
        let source = format!("{file}{by}");
        state_rate(
            series,
            (rate.si(), &rate.to_string()),
            &field,
            (&source, &or),
        )
    }
}

/// Adds the unit of `channel` to the series with this index; `place` is the place of the unit in
/// the sheet.
#[allow(
    clippy::indexing_slicing,
    reason = "`complete` passes indices of series of the file"
)]
fn complete_unit(
    contents: &mut Contents,
    index: usize,
    channel: &ChannelSheet,
    (file, place): (&str, &str),
    statements: &mut Vec<FileStatement>,
) -> Result<(), RodlabError> {
    let axis = &mut contents.series[index].ordinate_axis;
    let Some(text) = &channel.unit else {
        if axis.unit.is_some() {
            return Ok(());
        }
        let told = if axis.unit_text.is_empty() {
            format!("{file} does not state it")
        } else {
            format!("`{}`, found in {file}, is not a known unit", axis.unit_text)
        };
        return Err(RodlabError::request(
            place,
            "not stated",
            format!("the unit of the samples, such as \"V\": {told}"),
        ));
    };
    let unit = Unit::parse(text).in_step(place)?;
    if let Some(told) = &axis.unit {
        let is_same = (told.scale() / unit.scale() - 1.0).abs() < 1e-12;
        if told.dimension() == unit.dimension() && !is_same {
            return Err(RodlabError::request(
                place,
                text,
                format!(
                    "`{}`, as stated in {file}, or the field left out; if the unit of the file is wrong, correct it by `gain`",
                    told.symbol()
                ),
            ));
        }
        if told.dimension() != unit.dimension() {
            FileStatement::note(
                statements,
                file,
                format!(
                    "{} in {}; the unit of the sheet is used instead, {}.",
                    channel.from,
                    told.symbol(),
                    unit.symbol()
                ),
            );
        }
    }
    *axis = SeriesAxis {
        unit_text: text.clone(),
        unit: Some(unit),
        ..axis.clone()
    };
    Ok(())
}

/// States the sampling rate \[Hz\] of `series`, which was read from `file`, or refuses a rate that
/// contradicts its times. `stated` is the rate as it is written at `field`; `or` is the alternative
/// to the rate of the file.
pub(crate) fn state_rate(
    series: &mut Series,
    (rate_hz, stated): (f64, &str),
    field: &str,
    (file, or): (&str, &str),
) -> Result<(), RodlabError> {
    let told = series.abscissa_axis.unit.as_ref();
    let start = match (told, &series.abscissa) {
        (Some(unit), Abscissa::Even { start, step }) if unit.dimension() == Dimension::TIME => {
            let told = 1.0 / unit.to_si(*step);
            if ((rate_hz - told) / told).abs() > ROUNDED_RATE {
                return Err(RodlabError::request(
                    field,
                    stated,
                    format!("{} Hz, as stated in {file}, or {or}", digits::rate(told)),
                ));
            }
            unit.to_si(*start)
        }
        (None, _) => {
            let in_seconds = step_without_unit(series).map(|step| step * rate_hz);
            let is_time = |periods: f64| {
                SECONDS
                    .iter()
                    .any(|unit| (periods * unit - 1.0).abs() < STRANGE_RATE)
            };
            if let Some(periods) = in_seconds.filter(|periods| !is_time(*periods)) {
                return Err(RodlabError::request(
                    field,
                    stated,
                    format!(
                        "{} Hz, which the times of {file} give if they are in s",
                        digits::rate(rate_hz / periods)
                    ),
                ));
            }
            0.0
        }
        // a missing or uneven time axis is reported later, when records are made
        _ => return Ok(()),
    };
    let second = Unit::parse("s").in_step("the unit of time")?;
    series.abscissa_axis.unit = Some(second);
    "s".clone_into(&mut series.abscissa_axis.unit_text);
    series.abscissa = Abscissa::Even {
        start,
        step: 1.0 / rate_hz,
    };
    Ok(())
}

/// Returns another series of the file that has the `name` of a channel, if none of the selected
/// series `meant` has this name.
fn namesake(contents: &Contents, name: &str, meant: &[usize]) -> Option<usize> {
    let has_name = |series: &Series| series.name.trim().eq_ignore_ascii_case(name.trim());
    let mut own = meant.iter().filter_map(|index| contents.series.get(*index));
    let other = || contents.series.iter().position(has_name);
    if own.any(has_name) { None } else { other() }
}

/// Returns the indices of the series that `selector` selects. A name selects all series with this
/// name, with or without the point of the response after it. A number selects the series with this
/// number and all series with the same name and the same point.
fn meant(contents: &Contents, selector: &Selector) -> Vec<usize> {
    let all_that = |is_meant: &dyn Fn(&Series) -> bool| -> Vec<usize> {
        let all = contents.series.iter().enumerate();
        all.filter(|(_, series)| is_meant(series))
            .map(|(index, _)| index)
            .collect()
    };
    match selector {
        Selector::Name(wanted) => all_that(&|series| {
            let name = series.name.trim();
            name == wanted.trim()
                || response(series)
                    .is_some_and(|point| format!("{name} {point}").trim() == wanted.trim())
        }),
        Selector::Number(number) => {
            let index = number.checked_sub(1);
            match index.and_then(|index| Some((index, contents.series.get(index)?))) {
                None => Vec::new(),
                Some((index, one)) if one.name.trim().is_empty() && response(one).is_none() => {
                    vec![index]
                }
                Some((_, one)) => all_that(&|series| {
                    series.name.trim() == one.name.trim() && response(series) == response(one)
                }),
            }
        }
    }
}

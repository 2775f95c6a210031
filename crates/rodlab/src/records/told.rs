//! Statements of a file about its channels, completed by statements of the sheet.

use labio::format::uff58::response;
use labio::{Abscissa, Contents, Dimension, Series, SeriesAxis, Unit};

use super::{Records, Selector};
use crate::RodlabError;
use crate::digits;

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

/// A unit of the sheet that replaces another unit, which some of the files state.
#[derive(Debug)]
pub(super) struct ReplacedUnit {
    /// The files that state the other unit.
    files: Vec<String>,
    /// Words after "the file states".
    statement: String,
}

impl ReplacedUnit {
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

    /// Returns the warning; it counts the files if there are several.
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
    matches!(contents.format, "csv" | "xlsx" | "xls" | "lvm")
        && series.any(|series| series.abscissa_axis.label != "index")
}

impl Records {
    /// Adds to `contents` the sampling rate and the units that the sheet states and `file` does not
    /// record. Returns the series of every channel of the sheet, which are several if a file
    /// contains several hits.
    pub(super) fn complete(
        &self,
        contents: &mut Contents,
        file: &str,
        field: &str,
        replaced: &mut Vec<ReplacedUnit>,
    ) -> Result<Vec<Vec<usize>>, RodlabError> {
        let mut chosen = Vec::with_capacity(self.channels.len());
        for (at, channel) in self.channels.iter().enumerate() {
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
                let hint = match &channel.from {
                    Selector::Number(_) if has_time_column(contents) => {
                        "; the time column is not counted"
                    }
                    _ => "",
                };
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
                self.complete_unit(contents, index, at, file, field, replaced)?;
            }
            chosen.push(series);
        }
        Ok(chosen)
    }

    #[allow(
        clippy::indexing_slicing,
        reason = "`complete` counts the series of the file and the channels of the sheet"
    )]
    fn complete_time(
        &self,
        contents: &mut Contents,
        index: usize,
        file: &str,
        field: &str,
    ) -> Result<(), RodlabError> {
        let series = &mut contents.series[index];
        let told = series.abscissa_axis.unit.as_ref();
        let Some(rate) = &self.sampling_rate else {
            let of_time = told.is_some_and(|unit| unit.dimension() == Dimension::TIME);
            if of_time && matches!(series.abscissa, Abscissa::Uneven(_)) {
                return Err(RodlabError::request(
                    format!("{field}.sampling_rate"),
                    "not stated",
                    format!(
                        "the sampling rate, such as \"51.2 kHz\", that gives all times within half a step: those of {file} are not evenly spaced"
                    ),
                ));
            }
            return if told.is_none() && series.abscissa_axis.unit_text.is_empty() {
                let told = step_without_unit(series).map_or_else(
                    || "does not state it".to_owned(),
                    |step| {
                        format!(
                            "has times without a unit; in s they give {} Hz",
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
        let start = match (told, &series.abscissa) {
            (Some(unit), Abscissa::Even { start, step }) if unit.dimension() == Dimension::TIME => {
                let told = 1.0 / unit.to_si(*step);
                if ((rate.si() - told) / told).abs() > ROUNDED_RATE {
                    return Err(RodlabError::request(
                        format!("{field}.sampling_rate"),
                        rate.to_string(),
                        format!(
                            "{} Hz, as stated in {file}, or the field left out",
                            digits::rate(told)
                        ),
                    ));
                }
                unit.to_si(*start)
            }
            (None, _) => {
                let in_seconds = step_without_unit(series).map(|step| step * rate.si());
                let is_time = |periods: f64| {
                    SECONDS
                        .iter()
                        .any(|unit| (periods * unit - 1.0).abs() < STRANGE_RATE)
                };
                if let Some(periods) = in_seconds.filter(|periods| !is_time(*periods)) {
                    return Err(RodlabError::request(
                        format!("{field}.sampling_rate"),
                        rate.to_string(),
                        format!(
                            "{} Hz, which the times of {file} give if they are in s",
                            digits::rate(rate.si() / periods)
                        ),
                    ));
                }
                0.0
            }
            // a missing or uneven time axis is reported later, when records are made
            _ => return Ok(()),
        };
        let second =
            Unit::parse("s").map_err(|error| RodlabError::step("the unit of time", error))?;
        series.abscissa_axis.unit = Some(second);
        series.abscissa = Abscissa::Even {
            start,
            step: 1.0 / rate.si(),
        };
        Ok(())
    }

    #[allow(
        clippy::indexing_slicing,
        reason = "`complete` counts the series of the file and the channels of the sheet"
    )]
    fn complete_unit(
        &self,
        contents: &mut Contents,
        index: usize,
        at: usize,
        file: &str,
        field: &str,
        replaced: &mut Vec<ReplacedUnit>,
    ) -> Result<(), RodlabError> {
        let axis = &mut contents.series[index].ordinate_axis;
        let channel = &self.channels[at];
        let place = format!("{field}.channels[{at}].unit");
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
        let unit = Unit::parse(text).map_err(|error| RodlabError::step(&place, error))?;
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
                ReplacedUnit::note(
                    replaced,
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
}

/// Returns another series of the file that has the `name` of a channel, if none of the selected
/// series `meant` has this name.
fn namesake(contents: &Contents, name: &str, meant: &[usize]) -> Option<usize> {
    let has_name = |series: &Series| series.name.trim().eq_ignore_ascii_case(name.trim());
    let mut own = meant.iter().filter_map(|index| contents.series.get(*index));
    let other = || contents.series.iter().position(has_name);
    if own.any(has_name) { None } else { other() }
}

/// Returns the series that `selector` selects. A name selects all series with this name; a number
/// selects the series with this number and all series with the same name at the same point.
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

//! Suspicions about the records of a file, found by the checks that are made for hits.

use labio::hits::{Criteria, Reason};
use labio::{Abscissa, Contents, Dimension, Quantity, Record, Series, Unit};

use crate::digits::short;
use crate::{InStep, RodlabError};

/// Sets a unit for the inspection where the file has none: 1 for values, s for times. Returns true
/// if the file records every sampling rate.
pub(super) fn complete(contents: &mut Contents) -> Result<bool, RodlabError> {
    let unit = |text| Unit::parse(text).in_step("checking levels");
    let (one, second) = (unit("1")?, unit("s")?);
    let mut told = true;
    for series in &mut contents.series {
        let axis = &mut series.ordinate_axis;
        if axis.unit.as_ref().and_then(Unit::quantity).is_none() {
            axis.unit = Some(one.clone());
        }
        if series.abscissa_axis.unit.is_none() {
            series.abscissa_axis.unit = Some(second.clone());
            told = false;
        }
    }
    Ok(told)
}

/// Minimum number of samples of a record that could be a hit.
const SHORTEST_HIT: usize = 64;

/// Returns suspicions about the channels, and objections to each record if it is judged as one hit.
/// The objections are given only if the sampling rate is known.
pub(super) fn of_records(
    records: &[Record],
    rate_is_told: bool,
) -> Result<(Vec<String>, Vec<String>), RodlabError> {
    let (mut wrong, mut as_hits) = (Vec::new(), Vec::new());
    for (number, record) in records.iter().enumerate() {
        let of_which = if records.len() > 1 {
            format!("record {}: ", number + 1)
        } else {
            String::new()
        };
        let channels = record.channels();
        let force = channels.iter().find(|c| c.quantity() == Quantity::Force);
        let Some(reference) = force.or(channels.first()) else {
            continue;
        };
        let criteria = if reference.quantity() == Quantity::Force {
            Criteria::hammer()
        } else {
            Criteria::bar()
        };
        let reasons = criteria
            .judge(record, reference.name(), None)
            .in_step("checking levels")?;
        for reason in reasons {
            let said = format!("{of_which}{reason}");
            match reason {
                Reason::Clipped { .. }
                | Reason::DropOut { .. }
                | Reason::Dead { .. }
                | Reason::StaticOffset { .. }
                | Reason::Overload { .. }
                | Reason::NonFinite { .. } => wrong.push(said),
                _ if rate_is_told && record.n_samples() >= SHORTEST_HIT => as_hits.push(said),
                _ => {}
            }
        }
    }
    Ok((wrong, as_hits))
}

/// Returns a suspicion for each time axis whose times do not increase or are unevenly spaced, with
/// the names of the data sets on it.
pub(super) fn of_times(all: &[Series]) -> Vec<String> {
    let mut found: Vec<(String, Vec<String>)> = Vec::new();
    for series in all {
        let Some(what) = fault_of_times(series) else {
            continue;
        };
        let name = format!("`{}`", series.name.trim());
        match found.iter_mut().find(|(known, _)| *known == what) {
            Some((_, names)) => names.push(name),
            None => found.push((what, vec![name])),
        }
    }
    let in_words = |(what, names): (String, Vec<String>)| {
        format!("the times of {} {what}", super::text::listed(&names))
    };
    found.into_iter().map(in_words).collect()
}

/// Describes the times of a series if they do not increase or are unevenly spaced.
fn fault_of_times(series: &Series) -> Option<String> {
    let unit = series.abscissa_axis.unit.as_ref();
    let unit = unit.filter(|unit| unit.dimension() == Dimension::TIME)?;
    let symbol = unit.symbol();
    let values = match &series.abscissa {
        Abscissa::Even { step, .. } => {
            return (*step <= 0.0).then(|| format!("change by {step} {symbol}, expected above 0"));
        }
        Abscissa::Uneven(values) => values,
    };
    let steps = values.windows(2).filter_map(|pair| match pair {
        [before, after] => Some((*before, after - before)),
        _ => None,
    });
    let (_, shortest) = steps.clone().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (at, longest) = steps.clone().max_by(|a, b| a.1.total_cmp(&b.1))?;
    if let Some((before, step)) = steps.clone().find(|(_, step)| *step <= 0.0) {
        return Some(format!(
            "change by {} {symbol} after {} {symbol}, expected above 0",
            short(step),
            short(before)
        ));
    }
    Some(format!(
        "are uneven: steps of {} to {} {symbol}, the longest after {} {symbol}; a job needs a `sampling_rate` that gives all times within half a step",
        short(shortest),
        short(longest),
        short(at)
    ))
}

//! Suspicions about the records of a file, found by the checks that are made for hits.

use labio::hits::{Criteria, Reason};
use labio::{Contents, Quantity, Record, Unit};

use crate::RodlabError;

/// Gives data sets without a known unit, or without a unit of time, a default for the inspection.
/// Returns true if the file records every sampling rate.
pub(super) fn complete(contents: &mut Contents) -> Result<bool, RodlabError> {
    let unit =
        |text| Unit::parse(text).map_err(|error| RodlabError::step("checking levels", error));
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
    let judging = |error| RodlabError::step("checking levels", error);
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
            .map_err(judging)?;
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

//! Responses from long records with stationary random excitation by one or several inputs, averaged
//! over overlapping segments.

use labio::hits::{Copy, Extent, find_copy, repeated_extreme};
use labio::{AveragedSpectra, Detrend, Estimator, Record, Welch};

use super::estimate;
use super::scope::{band_of, outputs_of, outside_of};
use super::sheet::{DetrendSheet, FrfSheet, SegmentsSheet};
use super::{Named, of_the_test, report, universal, warn};
use crate::digits::short;
use crate::job::JobContext;
use crate::records::{NamedRecord, SKEW_NOT_FOLLOWED, expect_different_files};
use crate::responses::with_silence;
use crate::{InStep, Outcome, RodlabError};

/// Default overlap, as a fraction of a segment.
const OVERLAP: f64 = 0.5;

pub(super) fn run(
    sheet: &FrfSheet,
    segments: &SegmentsSheet,
    context: &JobContext<'_>,
    mut outcome: Outcome,
) -> Result<Outcome, RodlabError> {
    refuse_hits(sheet)?;
    let outputs = outputs_of(sheet, &sheet.records, "")?;
    context.progress.begins("reading records", 0);
    sheet
        .records
        .refuse_uncertain_skews("records", SKEW_NOT_FOLLOWED)?;
    let loaded = sheet.records.load(context.folder, "records")?;
    let records = loaded.entered_in(&mut outcome);
    expect_different_files(&outcome.inputs)?;
    let inputs = sheet.inputs();
    let channels: Vec<&str> = inputs
        .iter()
        .copied()
        .chain(outputs.iter().map(String::as_str))
        .collect();
    check_measurements(&records, &channels, &mut outcome)?;
    let Some(first) = records.first().map(|first| &first.record) else {
        return Err(RodlabError::request(
            "records.files",
            "no record",
            "at least one",
        ));
    };
    for input in &inputs {
        for output in &outputs {
            estimate::check_kind(sheet, first, (input, output))?;
        }
    }
    context.has_read_all(&outcome.inputs, &outcome.warnings)?;
    let rate = first.sampling_rate_hz();
    let silent = match &sheet.silent {
        None => 0,
        Some(silent) => Extent::Seconds(silent.si())
            .samples(rate)
            .in_step("silent")?,
    };
    let averaging = |error| RodlabError::step("averaging segments", error);
    let whole: Vec<&Record> = records.iter().map(|named| &named.record).collect();
    let excited = whole
        .iter()
        .map(|record| record.part(silent..record.n_samples()))
        .collect::<Result<Vec<_>, _>>()
        .map_err(averaging)?;
    let excited: Vec<&Record> = excited.iter().collect();
    let length = length_of(segments, rate)?;
    context.progress.begins("averaging segments", 2);
    let spectra_of = |length| -> Result<AveragedSpectra, RodlabError> {
        context.check_cancelled()?;
        let averaged = welch(sheet, segments, length)?.spectra_of(&excited);
        context.progress.one_more();
        averaged.map_err(averaging)
    };
    let (spectra, halved) = (spectra_of(length)?, spectra_of(length / 2)?);
    let stated = (silent > 0).then_some(silent);
    let spectra = with_silence(spectra, &whole, stated, &channels, "silent")?;
    if let Some(reason) = too_few(&spectra, inputs.len()) {
        outcome.deny("No frequency response", reason);
        return Ok(outcome);
    }
    let band = band_of(sheet, &spectra)?;
    let greyed = outside_of(sheet, band, &spectra);
    let tests = std::slice::from_ref(&spectra);
    of_the_test(sheet, &[Vec::new()], tests, &greyed, &mut outcome)?;
    let mut estimated = Vec::new();
    context.progress.begins("forming responses", outputs.len());
    for output in &outputs {
        context.check_cancelled()?;
        for (input, node) in inputs.iter().zip(1..) {
            let names = (*input, output.as_str());
            estimated.push(Named {
                output: output.clone(),
                input: (*input).to_owned(),
                node,
                one: estimate::of_segments(sheet, [&spectra, &halved], names, first)?,
            });
        }
        context.progress.one_more();
    }
    report(sheet, &estimated, band, &greyed, &mut outcome);
    outcome
        .attachments
        .push(universal::attachment(&estimated, &sheet.title)?);
    outcome.say(format!(
        "{} segments of {} samples are averaged, equivalent to {} independent ones.",
        spectra.n_averages(),
        spectra.n_samples(),
        short(spectra.effective_averages())
    ));
    warn(sheet, tests, &estimated, &mut outcome);
    Ok(outcome)
}

/// Refuses statements about hits in a sheet with segments.
fn refuse_hits(sheet: &FrfSheet) -> Result<(), RodlabError> {
    let hits = &sheet.hits;
    let stated = [
        ("hits", hits.is_stated()),
        ("force_window", sheet.force_window.is_some()),
        ("exponential_window", sheet.exponential_window.is_some()),
        ("second_hammer", sheet.second_hammer.is_some()),
        ("detrend", sheet.detrend == Some(DetrendSheet::Rest)),
    ];
    if let Some((field, _)) = stated.into_iter().find(|(_, stated)| *stated) {
        return Err(RodlabError::request(
            field,
            "stated together with `segments`",
            "no setting for hits: segments are taken from continuous records",
        ));
    }
    let estimator = sheet.estimator.unwrap_or_default();
    if !sheet.further_inputs.is_empty() && estimator != Estimator::H1 {
        return Err(RodlabError::request(
            "estimator",
            format!("{estimator:?}"),
            "H1, the estimator for several inputs",
        ));
    }
    Ok(())
}

/// Refuses records or channels with identical samples. A clipped channel, which has more samples at
/// an extreme value than at neighbouring values, puts the result in doubt.
fn check_measurements(
    records: &[NamedRecord],
    channels: &[&str],
    outcome: &mut Outcome,
) -> Result<(), RodlabError> {
    let all: Vec<&Record> = records.iter().map(|named| &named.record).collect();
    let name = |place: usize| records.get(place).map_or("", |named| named.name.as_str());
    let one = |first: String, second: String| RodlabError::OneMeasurement {
        first,
        second,
        how: "have the same samples",
    };
    match find_copy(&all, channels).in_step("comparing records")? {
        Some(Copy::Hits { first, second }) => {
            return Err(one(name(first).to_owned(), name(second).to_owned()));
        }
        Some(Copy::Channels { hit, first, second }) => {
            let second = format!("channel `{second}` of {}", name(hit));
            return Err(one(format!("channel `{first}`"), second));
        }
        None => {}
    }
    for NamedRecord { name, record } in records {
        for channel in channels {
            let samples = record
                .recorded(channel)
                .in_step("comparing records")?
                .to_vec();
            if let Some((value, count)) = repeated_extreme(&samples) {
                outcome.doubt(format!(
                    "`{channel}` of {name} is clipped: {count} samples are at {}, more than at neighbouring values",
                    short(value)
                ));
            }
        }
    }
    Ok(())
}

/// Returns the number of samples of a segment.
fn length_of(segments: &SegmentsSheet, rate: f64) -> Result<usize, RodlabError> {
    let length = segments
        .length
        .extent()
        .samples(rate)
        .in_step("segments.length")?;
    if length < 16 || !length.is_multiple_of(2) {
        return Err(RodlabError::request(
            "segments.length",
            if segments.length.extent() == Extent::Samples(length) {
                segments.length.to_string()
            } else {
                format!("{}, {length} samples", segments.length)
            },
            "an even number of samples, 16 or more: segments of half the length give the error due to the width of the lines",
        ));
    }
    Ok(length)
}

/// Returns the settings for segments of `length` samples.
fn welch(sheet: &FrfSheet, segments: &SegmentsSheet, length: usize) -> Result<Welch, RodlabError> {
    let overlap = segments
        .overlap
        .as_ref()
        .map_or(OVERLAP, |overlap| overlap.si());
    if !(0.0..1.0).contains(&overlap) {
        return Err(RodlabError::request(
            "segments.overlap",
            format!("{} %", 100.0 * overlap),
            "a part of the segment from 0 % to less than 100 %",
        ));
    }
    let shared = Extent::Seconds(overlap * length as f64).samples(1.0);
    let detrend = match sheet.detrend {
        Some(DetrendSheet::Nothing) => Detrend::None,
        Some(DetrendSheet::Line) => Detrend::Linear,
        Some(DetrendSheet::Mean | DetrendSheet::Rest) | None => Detrend::Mean,
    };
    shared
        .and_then(|shared| Welch::new(length)?.with_overlap(shared))
        .map(|welch| {
            let window = sheet.window_or_default().window();
            welch.with_window(window).with_detrend(detrend)
        })
        .in_step("segments.overlap")
}

/// Returns the reason why there are too few segments to estimate errors; `None` if there are
/// enough.
fn too_few(spectra: &AveragedSpectra, n_inputs: usize) -> Option<String> {
    let effective = spectra.effective_averages();
    (effective < n_inputs as f64 + 1.0).then(|| {
        format!(
            "the records contain {} segments, equivalent to {} independent ones, and {n_inputs} inputs need {} or more",
            spectra.n_averages(),
            short(effective),
            n_inputs + 1
        )
    })
}

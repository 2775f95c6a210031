//! Force determined from a measured response.

use labio::hits::Reason;
use labio::{FrequencyResponse, Quantity as Physical, Record};

use super::response_problem::{
    FEWEST_AT_REST, Noise, Problem, further_place, problem, scatter_about_mean,
};
use super::response_sheet::{NoiseSheet, PathSheet, ResponseSheet};
use super::response_solve::HitsInBand;
use super::{response_answer, response_figures, response_solve, response_tables};
use crate::digits::short;
use crate::hits::{FoundHits, windows_of_analyser};
use crate::job::JobContext;
use crate::outcome::Setting;
use crate::records::{expect_motion, expect_quantity, is_lost};
use crate::responses::{HitsSource, line_spacing_hz};
use crate::{Outcome, RodlabError};

/// Largest relative difference of line spacings that count as equal. Values with eight digits and a
/// rounded sampling rate cause smaller differences.
const SAME_LINES: f64 = 1e-4;

const NO_FORCE: &str = "There is no force";

pub(super) fn run(
    sheet: &ResponseSheet,
    context: &JobContext<'_>,
    outcome: &mut Outcome,
) -> Result<(), RodlabError> {
    let why = "the error of a calibration is not propagated to the force";
    sheet
        .record
        .refuse_uncertain_calibrations("problem.record", why)?;
    if let PathSheet::Hits(hits) = &sheet.path {
        hits.records
            .refuse_uncertain_calibrations("problem.path.records", why)?;
        if let Some(silent) = &hits.silent {
            return Err(RodlabError::request(
                "problem.path.silent",
                silent.to_string(),
                "no value: the path is computed without the noise at rest",
            ));
        }
    }
    let file = match &sheet.path {
        PathSheet::File(file) => Some(file.read(context.folder, "problem.path", outcome)?),
        PathSheet::Hits(_) => None,
    };
    let mut files = Vec::new();
    for (at, further) in sheet.further.iter().enumerate() {
        let place = further_place(at, "path");
        files.push(match (&further.path, &sheet.path) {
            (Some(named), PathSheet::File(_)) => {
                Some(named.read(context.folder, &place, outcome)?)
            }
            (None, PathSheet::Hits(_)) => None,
            (named, _) => {
                let found = named.as_ref().map_or("not stated", |named| &named.file);
                let expected = "a file if `problem.path` is a file, and no file if it is hits";
                return Err(RodlabError::request(place, found, expected));
            }
        });
    }
    let calibration = match &sheet.path {
        PathSheet::Hits(hits) => Some((hits, hits.read(context, "problem.path", outcome)?)),
        PathSheet::File(_) => None,
    };
    // for each response, the calibration hits with the channel of this response
    let sources: Vec<HitsSource> = match &calibration {
        Some((hits, _)) => std::iter::once((*hits).clone())
            .chain(sheet.further.iter().map(|further| {
                HitsSource {
                    response: further
                        .of_hits
                        .as_ref()
                        .unwrap_or(&further.response)
                        .clone(),
                    ..(*hits).clone()
                }
            }))
            .collect(),
        None => Vec::new(),
    };
    let found = read_blow(sheet, context, outcome)?;
    outcome.settings.extend(defaults());
    let blow = match &sheet.hit {
        Some(_) => found.accepted().first().copied(),
        None => found.hits().find_map(|found| found.hit.record()),
    };
    let Some(record) = blow.cloned() else {
        context.has_read_all(&outcome.inputs, &outcome.warnings)?;
        let n_found = found.n_found();
        let reason =
            format!("none of {n_found} hits of the record is accepted: the log states why");
        outcome.deny(NO_FORCE, reason);
        return Ok(());
    };
    outcome.doubt_all(windows_of_analyser(&[&record], &responses_of(sheet))?);
    check_lines(
        sheet,
        &record,
        (file.as_ref(), &files),
        calibration.as_ref(),
    )?;
    context.has_read_all(&outcome.inputs, &outcome.warnings)?;

    context.progress.begins("path from force to response", 0);
    let mut paths: Vec<FrequencyResponse> = file
        .into_iter()
        .chain(files.into_iter().flatten())
        .collect();
    if let Some((_, found)) = &calibration {
        let accepted = found.accepted();
        if accepted.len() < 2 {
            let reason = format!(
                "{} of {} calibration hits are accepted, and at least 2 are needed: the log states what is wrong with the others{}",
                accepted.len(),
                found.n_found(),
                remedy(sheet, found)
            );
            outcome.deny(NO_FORCE, reason);
            return Ok(());
        }
        for hits in &sources {
            paths.push(response_solve::path_of(
                hits,
                accepted.iter().copied(),
                context,
            )?);
        }
    }
    let mut problem = problem(sheet, paths, &record, outcome)?;
    context.progress.begins("force", 0);
    let mut span = None;
    if let Some((hits, found)) = &calibration {
        let accepted = found.accepted();
        let seen = std::iter::once(&mut problem.first).chain(&mut problem.further);
        for (hits, seen) in sources.iter().zip(seen) {
            if let Some(lines) = response_solve::lines_of_hits(hits, &accepted, &mut seen.path)? {
                if matches!(seen.noise, Noise::Unknown) {
                    seen.noise = Noise::Lines(lines.noise.clone());
                }
                seen.blows = Some(lines);
            }
        }
        if sheet.acting.is_none() {
            span = response_solve::span_of(hits, &accepted)?;
            let of_hits = match span {
                Some(span) => HitsInBand::of(sheet, hits, &accepted, span)?,
                None => None,
            };
            let found =
                response_solve::acting_like_hits(&problem, span, of_hits.as_ref(), outcome)?;
            (span, problem.acting) = found.unzip();
            if problem.acting.is_none() {
                problem.lost_in_band = of_hits.map(|hits| hits.lost);
            }
        }
    }
    if !problem.further.is_empty() {
        let unknown = problem
            .seen()
            .position(|seen| matches!(seen.noise, Noise::Unknown));
        if let Some(unknown) = unknown {
            let place = match unknown.checked_sub(1) {
                Some(at) => further_place(at, "noise"),
                None => "problem.noise".to_owned(),
            };
            return Err(RodlabError::request(
                place,
                "unknown",
                "`white` or `from_rest` (in RON `White` or `FromRest`): several responses are weighted by their noise",
            ));
        }
    }
    if let (Some(window), None) = (problem.first.path.added_damping, problem.acting) {
        return Err(RodlabError::request(
            "problem.acting",
            "not stated",
            format!(
                "the time span in which the force acts: with a path under an exponential window, the error of the force grows at a rate of {} 1/s",
                short(window.decay_rate())
            ),
        ));
    }
    problem.rest = problem.acting.and_then(|acting| {
        let rate = problem.sampling_rate_hz;
        let n_rest =
            (0..problem.first.samples.len()).take_while(|n| (*n as f64) < acting.from * rate);
        let rest = problem
            .first
            .samples
            .get(..n_rest.count())
            .unwrap_or_default();
        (rest.len() >= FEWEST_AT_REST).then(|| scatter_about_mean(rest).1)
    });
    chosen(&problem, outcome);
    let solved = match response_solve::solve(&problem)? {
        Ok(solved) => solved,
        Err(reason) => {
            outcome.deny(NO_FORCE, reason);
            return Ok(());
        }
    };
    if !problem.further.is_empty() {
        outcome.say(format!(
            "The force explains {} responses at once, weighted by their noise; figures and tables show the first.",
            1 + problem.further.len()
        ));
    }
    context.check_cancelled()?;
    let scatter = match &calibration {
        Some((_, found)) => {
            let span = span.filter(|_| problem.acting.is_some());
            response_solve::scatter(&problem, &solved, (&sources, found, span), context, outcome)?
        }
        None => None,
    };
    let bands = response_answer::bands(&problem, &solved, scatter, outcome)?;
    response_answer::tell(&problem, &solved, &bands, outcome);
    outcome
        .tables
        .push(response_tables::force(&problem, &solved, &bands));
    outcome.tables.extend(response_tables::curve(&solved));
    outcome.figures = response_figures::all(&problem, &solved, &bands);
    Ok(())
}

/// Returns the remedy if a rejected calibration hit ends before the body is at rest.
fn remedy(sheet: &ResponseSheet, found: &FoundHits) -> String {
    let rings = |reason: &Reason| matches!(reason, Reason::NotDecayed { .. });
    let mut rejected = found.hits().filter(|found| !found.hit.is_accepted());
    if rejected.any(|found| found.hit.reasons().iter().any(rings)) {
        let remedy = sheet.path.remedy_of_ringing();
        format!(". Hits end before the body is at rest: {remedy}")
    } else {
        String::new()
    }
}

fn responses_of(sheet: &ResponseSheet) -> Vec<&str> {
    let further = sheet.further.iter().map(|further| &further.response);
    let all = std::iter::once(&sheet.response).chain(further);
    all.map(String::as_str).collect()
}

fn read_blow(
    sheet: &ResponseSheet,
    context: &JobContext<'_>,
    outcome: &mut Outcome,
) -> Result<FoundHits, RodlabError> {
    let loaded = sheet.record.load(context.folder, "problem.record")?;
    if let Some(first) = loaded.records.first() {
        let record = &first.record;
        expect_motion(record, &sheet.response, "problem.response")?;
        let mut names = vec![&sheet.response];
        for (at, further) in sheet.further.iter().enumerate() {
            let place = further_place(at, "response");
            expect_motion(record, &further.response, &place)?;
            if names.contains(&&further.response) {
                let found = format!("`{}` again", further.response);
                return Err(RodlabError::request(place, found, "another channel"));
            }
            names.push(&further.response);
        }
        if let Some(name) = &sheet.compare_with {
            expect_quantity(record, name, Physical::Force, "problem.compare_with")?;
        }
    }
    let records = loaded.entered_in(outcome);
    // the beginning of the impact is clearest in a measured force
    let reference = sheet.compare_with.as_ref().unwrap_or(&sheet.response);
    let found = sheet
        .hit
        .clone()
        .unwrap_or_default()
        .find(records, reference, "problem.hit")?;
    outcome.settings.extend(found.settings().iter().cloned());
    if sheet.hit.is_some() {
        outcome.log.extend(found.log());
    } else {
        let doubted = doubted(&responses_of(sheet), &found);
        for mut entry in found.log() {
            entry.what = format!("the impact: {}", entry.what);
            if !entry.accepted {
                let reasons = entry.reasons.iter().filter(|one| !doubted.contains(one));
                let reasons: Vec<&str> = reasons.map(String::as_str).collect();
                if !reasons.is_empty() {
                    outcome.warn(format!(
                        "The impact is used as it is, although it fails checks of hits: {}.",
                        reasons.join("; ")
                    ));
                }
                entry.accepted = true;
            }
            outcome.log.push(entry);
        }
        for doubt in doubted {
            outcome.doubt(format!("the impact: {doubt}"));
        }
    }
    let n_taken = match &sheet.hit {
        Some(_) => found.n_accepted(),
        None => found.n_found(),
    };
    if n_taken > 1 {
        outcome.warn(format!(
            "There are {n_taken} impacts in the record: only the force of the first is computed."
        ));
    }
    Ok(found)
}

/// Returns the objections that a response to the evaluated impact is clipped or has a drop-out: a
/// part of the response was not recorded, and neither the peak nor the impulse of the force follows
/// from the rest.
fn doubted(channels: &[&str], found: &FoundHits) -> Vec<String> {
    let blow = found.hits().find(|found| found.hit.record().is_some());
    let reasons = blow.iter().flat_map(|blow| blow.hit.reasons());
    let lost = reasons.filter(|reason| is_lost(reason, channels));
    lost.map(ToString::to_string).collect()
}

/// Checks that path and record have the same line spacing (the path may end at a lower frequency),
/// and that the time in which the force acts is within the record.
fn check_lines(
    sheet: &ResponseSheet,
    record: &Record,
    (file, files): (Option<&FrequencyResponse>, &[Option<FrequencyResponse>]),
    calibration: Option<&(&HitsSource, FoundHits)>,
) -> Result<(), RodlabError> {
    if let Some(acting) = &sheet.acting {
        let (from, to, end) = (acting.from.si(), acting.to.si(), record.duration());
        if !(0.0 <= from && from < to && to <= end) {
            return Err(RodlabError::request(
                "problem.acting",
                format!("{} to {}", acting.from, acting.to),
                format!("a time span from 0 s to {end:.6} s, the end of the record"),
            ));
        }
    }
    let spacing = record.sampling_rate_hz() / record.n_samples() as f64;
    let n_lines = record.n_samples() / 2 + 1;
    let here = format!("{n_lines} lines {spacing:.6} Hz apart, those of the record");
    let named = match &sheet.path {
        PathSheet::File(named) => Some((named, "problem.path".to_owned())),
        PathSheet::Hits(_) => None,
    };
    let further = sheet.further.iter().enumerate();
    let further = further.map(|(at, further)| {
        let named = further.path.as_ref()?;
        Some((named, further_place(at, "path")))
    });
    let read = std::iter::once(file).chain(files.iter().map(Option::as_ref));
    for (path, named) in read.zip(std::iter::once(named).chain(further)) {
        let (Some(path), Some((named, place))) = (path, named) else {
            continue;
        };
        let found = line_spacing_hz(path)?;
        if path.values.len() > n_lines || (found / spacing - 1.0).abs() > SAME_LINES {
            return Err(RodlabError::request(
                format!("{place}.file"),
                format!(
                    "{} with {} lines {found:.6} Hz apart",
                    named.file,
                    path.values.len()
                ),
                format!("up to {here}"),
            ));
        }
        if path.kind().is_err() {
            return Err(RodlabError::request(
                format!("{place}.kind"),
                "not a response between a force and a motion",
                "one of the six kinds between a force and a motion",
            ));
        }
    }
    if let Some((_, found)) = calibration
        && let Some(first) = found.accepted().first()
    {
        let same_rate =
            (first.sampling_rate_hz() / record.sampling_rate_hz() - 1.0).abs() <= SAME_LINES;
        if first.n_samples() != record.n_samples() || !same_rate {
            return Err(RodlabError::request(
                "problem.path.records",
                format!(
                    "hits of {} samples at {} Hz",
                    first.n_samples(),
                    first.sampling_rate_hz()
                ),
                format!(
                    "{} samples at {} Hz, as in the record of the impact",
                    record.n_samples(),
                    record.sampling_rate_hz()
                ),
            ));
        }
    }
    Ok(())
}

/// Returns the defaults of optional fields.
fn defaults() -> [Setting; 3] {
    [
        Setting::by_default("problem.regularisation", "none"),
        Setting::by_default("problem.band", "all lines"),
        Setting::by_default("problem.non_negative", "tension is allowed"),
    ]
}

/// Adds the settings that the sheet does not state and that were chosen from the data: the
/// exponential window, the noise, and the time in which the force acts.
fn chosen(problem: &Problem<'_>, outcome: &mut Outcome) {
    let mut say = |name: &str, value: String| {
        outcome.by_default(format!("problem.{name}"), value);
    };
    if let Some(window) = problem.first.path.added_damping {
        say(
            "path.exponential_window",
            format!(
                "{} 1/s, also applied to the response and removed from the force",
                short(window.decay_rate())
            ),
        );
    }
    if matches!(problem.sheet.noise, NoiseSheet::Unknown) {
        say(
            "noise",
            match problem.first.noise {
                Noise::Lines(_) => "of each line, from the scatter between calibration hits",
                _ => "estimated from the residual",
            }
            .to_owned(),
        );
    }
    if problem.sheet.acting.is_none() {
        say(
            "acting",
            problem.acting.map_or("at any time".to_owned(), |acting| {
                format!(
                    "{:.4} ms to {:.4} ms, around the peak, as long as the calibration hits",
                    1e3 * acting.from,
                    1e3 * acting.to
                )
            }),
        );
    }
}

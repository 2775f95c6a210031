//! The force determined from a measured response.

use impulse::TimeInterval;
use labio::hits::Extent;
use labio::{FrequencyResponse, Quantity as Physical, Record};

use super::response_problem::{Noise, Problem};
use super::response_sheet::{NoiseSheet, PathSheet, ResponseSheet};
use super::{response_answer, response_figures, response_solve, response_tables};
use crate::digits::short;
use crate::hits::{FoundHits, Stretch};
use crate::job::JobContext;
use crate::outcome::{Setting, Verdict};
use crate::records::expect_quantity;
use crate::responses::{HitsSource, completed, line_spacing_hz};
use crate::{Outcome, RodlabError};

/// Relative difference of spacings of equal lines, as left by eight digits and a rounded sampling
/// rate.
const SAME_LINES: f64 = 1e-4;

/// Fewest samples at rest: the standard deviation is then known to 16 %.
const FEWEST_AT_REST: usize = 20;

pub(super) fn run(
    sheet: &ResponseSheet,
    context: &JobContext<'_>,
    outcome: &mut Outcome,
) -> Result<(), RodlabError> {
    let why = "the error of the force by that of a calibration is not followed";
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
                "no statement: a path is formed without the noise at rest",
            ));
        }
    }
    let file = match &sheet.path {
        PathSheet::File(file) => Some(file.read(context.folder, "problem.path", outcome)?),
        PathSheet::Hits(_) => None,
    };
    let calibration = match &sheet.path {
        PathSheet::Hits(hits) => Some((hits, hits.read(context, "problem.path", outcome)?)),
        PathSheet::File(_) => None,
    };
    let found = read_blow(sheet, context, outcome)?;
    outcome.settings.extend(defaults());
    let blow = match &sheet.hit {
        Some(_) => found.accepted().first().copied(),
        None => found.hits().find_map(|found| found.hit.record()),
    };
    let Some(record) = blow.cloned() else {
        context.has_read_all(&outcome.inputs)?;
        refuse(
            outcome,
            format!(
                "none of {} hits of the record is accepted: the log says why",
                found.n_found()
            ),
        );
        return Ok(());
    };
    check_lines(sheet, &record, file.as_ref(), calibration.as_ref())?;
    context.has_read_all(&outcome.inputs)?;

    context.progress.begins("path from force to response", 0);
    let path = match (file, &calibration) {
        (Some(file), _) => file,
        (None, Some((hits, found))) => {
            let accepted = found.accepted();
            if accepted.len() < 2 {
                refuse(
                    outcome,
                    format!(
                        "{} of {} calibration hits accepted, and at least 2 are needed: the log says what is wrong with the others",
                        accepted.len(),
                        found.n_found()
                    ),
                );
                return Ok(());
            }
            response_solve::path_of(hits, accepted, context)?
        }
        (None, None) => return Ok(()),
    };
    let path = response_solve::on_lines_of(path, &record, &sheet.response)?;
    let mut problem = problem(sheet, path, &record, outcome)?;
    context.progress.begins("force", 0);
    let mut span = None;
    if let Some((hits, found)) = &calibration {
        let accepted = found.accepted();
        if let Some(lines) = response_solve::lines_of_hits(hits, &accepted, &mut problem.path)? {
            if matches!(sheet.noise, NoiseSheet::Unknown) {
                problem.noise = Noise::Lines(lines.noise.clone());
            }
            problem.blows = Some(lines);
        }
        if sheet.acting.is_none() {
            span = response_solve::span_of(hits, &accepted)?;
            problem.acting = response_solve::acting_like_hits(&problem, span, outcome)?;
        }
    }
    if let (Some(window), None) = (problem.path.added_damping, problem.acting) {
        return Err(RodlabError::request(
            "problem.acting",
            "not stated",
            format!(
                "the time span in which the force acts: by a path under an exponential window the error of the force grows by {} 1/s",
                short(window.decay_rate())
            ),
        ));
    }
    problem.rest = problem.acting.and_then(|acting| {
        let rate = problem.sampling_rate_hz;
        let n_rest = (0..problem.samples.len()).take_while(|n| (*n as f64) < acting.from * rate);
        let rest = problem.samples.get(..n_rest.count()).unwrap_or_default();
        (rest.len() >= FEWEST_AT_REST).then(|| scatter_about_mean(rest).1)
    });
    chosen(&problem, outcome);
    let solved = match response_solve::solve(&problem)? {
        Ok(solved) => solved,
        Err(reason) => {
            refuse(outcome, reason);
            return Ok(());
        }
    };
    context.check_cancelled()?;
    let scatter = match &calibration {
        Some((hits, found)) => {
            let span = span.filter(|_| problem.acting.is_some());
            response_solve::scatter(&problem, &solved, (hits, found, span), context, outcome)?
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

fn refuse(outcome: &mut Outcome, reason: String) {
    outcome
        .summary
        .insert(0, format!("There is no force: {reason}."));
    outcome.verdict = Verdict::NotAllowed { reason };
}

fn read_blow(
    sheet: &ResponseSheet,
    context: &JobContext<'_>,
    outcome: &mut Outcome,
) -> Result<FoundHits, RodlabError> {
    let loaded = sheet.record.load(context.folder, "problem.record")?;
    if let Some(first) = loaded.records.first() {
        let record = &first.record;
        let place = "problem.response";
        let known = record
            .channels()
            .iter()
            .find(|channel| channel.name() == sheet.response);
        match known.map(|channel| channel.quantity()) {
            Some(Physical::Acceleration | Physical::Velocity | Physical::Displacement) => {}
            Some(other) => {
                return Err(RodlabError::request(
                    place,
                    format!("`{}`, a channel of {}", sheet.response, other.name()),
                    "a channel of acceleration, velocity or displacement",
                ));
            }
            // an error that names the existing channels
            None => expect_quantity(record, &sheet.response, Physical::Acceleration, place)?,
        }
        if let Some(name) = &sheet.compare_with {
            expect_quantity(record, name, Physical::Force, "problem.compare_with")?;
        }
    }
    outcome.inputs.extend(loaded.inputs);
    outcome.warnings.extend(loaded.warnings);
    outcome.log.extend(loaded.left_out);
    // a measured force shows its own beginning best
    let reference = sheet.compare_with.as_ref().unwrap_or(&sheet.response);
    let found =
        sheet
            .hit
            .clone()
            .unwrap_or_default()
            .find(loaded.records, reference, "problem.hit")?;
    outcome.settings.extend(found.settings().iter().cloned());
    if sheet.hit.is_some() {
        outcome.log.extend(found.log());
    } else {
        for mut entry in found.log() {
            entry.what = format!("the blow: {}", entry.what);
            if !entry.accepted {
                outcome.warnings.push(format!(
                    "The blow is taken as it is, although the checks of hits have against it: {}.",
                    entry.reasons.join("; ")
                ));
                entry.accepted = true;
            }
            outcome.log.push(entry);
        }
    }
    let n_taken = match &sheet.hit {
        Some(_) => found.n_accepted(),
        None => found.n_found(),
    };
    if n_taken > 1 {
        outcome.warnings.push(format!(
            "There are {n_taken} blows in the record: the force is that of the first."
        ));
    }
    Ok(found)
}

/// Checks that path and record have the same lines (the path may end lower), and that the force
/// acts in the record.
fn check_lines(
    sheet: &ResponseSheet,
    record: &Record,
    file: Option<&FrequencyResponse>,
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
    if let (Some(path), PathSheet::File(named)) = (file, &sheet.path) {
        let found = line_spacing_hz(path)?;
        if path.values.len() > n_lines || (found / spacing - 1.0).abs() > SAME_LINES {
            return Err(RodlabError::request(
                "problem.path.file",
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
                "problem.path.kind",
                "no response between a force and a motion",
                "one of the six kinds",
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
                    "{} samples at {} Hz, as the blow has",
                    record.n_samples(),
                    record.sampling_rate_hz()
                ),
            ));
        }
    }
    Ok(())
}

fn problem<'a>(
    sheet: &'a ResponseSheet,
    path: FrequencyResponse,
    record: &Record,
    outcome: &mut Outcome,
) -> Result<Problem<'a>, RodlabError> {
    let step = |error| RodlabError::step("problem.response", error);
    let samples = record.channel(&sheet.response).map_err(step)?.to_vec();
    let channel = record
        .channels()
        .iter()
        .find(|channel| channel.name() == sheet.response);
    let unit = channel.map_or("", |channel| channel.quantity().unit());
    let noise = match (&sheet.noise, channel) {
        (NoiseSheet::White(level), Some(channel)) => {
            Noise::White(level.of(channel, "problem.noise.White")?)
        }
        (NoiseSheet::FromRest(stretch), _) => Noise::White(noise_at_rest(
            &samples,
            stretch,
            record.sampling_rate_hz(),
            unit,
            outcome,
        )?),
        _ => Noise::Unknown,
    };
    let measured = sheet
        .compare_with
        .as_ref()
        .map(|name| record.channel(name).map(|samples| samples.to_vec()))
        .transpose()
        .map_err(step)?;
    Ok(Problem {
        sheet,
        samples: completed(record, &sheet.response, path.added_damping).map_err(step)?,
        path,
        sampling_rate_hz: record.sampling_rate_hz(),
        noise,
        rest: None,
        blows: None,
        acting: sheet.acting.as_ref().map(|acting| TimeInterval {
            from: acting.from.si(),
            to: acting.to.si(),
        }),
        measured,
        unit,
    })
}

/// Standard deviation over the beginning of the record.
fn noise_at_rest(
    samples: &[f64],
    stretch: &Stretch,
    rate: f64,
    unit: &str,
    outcome: &mut Outcome,
) -> Result<f64, RodlabError> {
    let n_rest = match stretch.extent() {
        Extent::Samples(n) => n,
        Extent::Seconds(seconds) => (0..samples.len())
            .take_while(|n| ((*n + 1) as f64) <= seconds * rate * (1.0 + 1e-9))
            .count(),
    };
    let rest = samples.get(..n_rest).unwrap_or_default();
    if rest.len() < FEWEST_AT_REST {
        return Err(RodlabError::request(
            "problem.noise.FromRest",
            match stretch.extent() {
                Extent::Samples(_) => stretch.to_string(),
                Extent::Seconds(_) => format!("{stretch}, {n_rest} samples"),
            },
            format!("from {FEWEST_AT_REST} to {} samples", samples.len()),
        ));
    }
    let n = rest.len() as f64;
    let (mean, deviation) = scatter_about_mean(rest);
    if mean.abs() > 4.0 * deviation / n.sqrt() {
        outcome.warnings.push(format!(
            "The response has an offset of {mean:.3e} {unit} at rest: it is taken for a response, and lines near 0 Hz are wrong by it."
        ));
    }
    Ok(deviation)
}

/// Mean and standard deviation.
fn scatter_about_mean(samples: &[f64]) -> (f64, f64) {
    let n = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / n;
    let variance = samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, variance.sqrt())
}

/// Defaults of the fields that the sheet leaves open.
fn defaults() -> [Setting; 3] {
    [
        Setting::by_default("problem.regularisation", "none"),
        Setting::by_default("problem.band", "all lines"),
        Setting::by_default("problem.non_negative", "tension is allowed"),
    ]
}

/// Adds settings left open by the sheet and determined from the calibration hits.
fn chosen(problem: &Problem<'_>, outcome: &mut Outcome) {
    let mut say = |name: &str, value: String| {
        outcome.by_default(format!("problem.{name}"), value);
    };
    if let Some(window) = problem.path.added_damping {
        say(
            "path.exponential_window",
            format!(
                "{} 1/s, put on the response too and taken off the force",
                short(window.decay_rate())
            ),
        );
    }
    if matches!(problem.sheet.noise, NoiseSheet::Unknown) {
        say(
            "noise",
            match problem.noise {
                Noise::Lines(_) => "of each line, by the scatter between calibration hits",
                _ => "estimated from what the force does not explain",
            }
            .to_owned(),
        );
    }
    if problem.sheet.acting.is_none() {
        say(
            "acting",
            problem.acting.map_or("at any time".to_owned(), |acting| {
                format!(
                    "{:.4} ms to {:.4} ms, about the peak as long as the calibration hits",
                    1e3 * acting.from,
                    1e3 * acting.to
                )
            }),
        );
    }
}

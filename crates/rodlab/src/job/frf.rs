//! Frequency responses of hits, with coherence and errors.
//!
//! The spectra of the hits are averaged. The ratio of output to input is the response, reported
//! with its coherence, the random error of every line, and the histories and spectra needed to
//! judge it. Optionally the responses of two hammers are merged, the weighed mass of a free body
//! replaces low-frequency lines, and one kind of motion is converted into another. All numerical
//! methods are those of `labio`.

mod estimate;
mod input_spectra;
mod response_figures;
mod scope;
mod segments;
mod sheet;
mod tables;
mod thin;
mod time_histories;
mod universal;
mod words;

pub use sheet::{
    DetrendSheet, ExponentialWindowSheet, FrfSheet, KindSheet, SecondHammerSheet, SegmentsSheet,
    WeighedMassSheet, WindowSheet,
};

use labio::hits::{Criteria, Reason};
use labio::{AddedDamping, AveragedSpectra, Departure, Record};
use rodfigure::Greyed;

use self::estimate::Estimated;
use self::scope::{Band, band_of, outputs_of, outside_of};
use super::JobContext;
use crate::digits::{hertz, short};
use crate::hits::{FoundHit, FoundHits, HitKind, HitsSheet, expect_independent, silent_samples};
use crate::outcome::{Quantity, sentence};
use crate::records::{Records, SKEW_NOT_FOLLOWED, expect_different_files};
use crate::responses::{MergeSheet, disagreements, with_silence};
use crate::{InStep, Outcome, RodlabError};

/// The response of one output to one input, with the names of both.
#[derive(Debug)]
struct Named {
    output: String,
    input: String,
    /// Number of the input, from 1.
    node: usize,
    one: Estimated,
}

#[allow(
    clippy::indexing_slicing,
    reason = "`too_few` has found an accepted hit in every set, and the first hammer is always one of the sets"
)]
pub(crate) fn run(sheet: &FrfSheet, context: &JobContext<'_>) -> Result<Outcome, RodlabError> {
    let mut outcome = Outcome::of("frf", sheet.title.as_str());
    outcome.settings = sheet.defaults();
    if let Some(segments) = &sheet.segments {
        return segments::run(sheet, segments, context, outcome);
    }
    if !sheet.further_inputs.is_empty() {
        return Err(RodlabError::request(
            "further_inputs",
            sheet.further_inputs.join(", "),
            "none with hits: several inputs act together in long records, which `segments` averages",
        ));
    }
    let mut sets = Vec::new();
    let first = ("", &sheet.records, &sheet.hits);
    let second = sheet
        .second_hammer
        .as_ref()
        .map(|second| ("second_hammer.", &second.records, &second.hits));
    let mut outputs = Vec::new();
    for (place, records, hits) in std::iter::once(first).chain(second) {
        context.check_cancelled()?;
        outputs = outputs_of(sheet, records, place)?;
        let found = find(
            sheet,
            (records, hits),
            &outputs,
            place,
            context,
            &mut outcome,
        )?;
        describe(sheet, &found, &outputs, place, &mut outcome)?;
        sets.push(found);
    }
    if let Some(reason) = too_few(sheet, &sets) {
        outcome.deny("No frequency response", reason);
        return Ok(outcome);
    }
    expect_different_files(&outcome.inputs)?;
    let mut channels = vec![sheet.input.as_str()];
    channels.extend(outputs.iter().map(String::as_str));
    outcome.doubt_all(expect_independent(
        &sets.iter().collect::<Vec<_>>(),
        &channels,
    )?);
    let accepted: Vec<Vec<&Record>> = sets.iter().map(FoundHits::accepted).collect();
    let first_hits: Vec<&Record> = accepted.iter().map(|hits| hits[0]).collect();
    let hit = first_hits[0];
    for output in &outputs {
        estimate::check_kind(sheet, hit, (&sheet.input, output))?;
    }
    context.has_read_all(&outcome.inputs, &outcome.warnings)?;
    let mut spectra = Vec::with_capacity(sets.len());
    for ((hits, found), place) in accepted.iter().zip(&sets).zip(["", "second_hammer."]) {
        let field = format!("{place}silent");
        let rest = (field.as_str(), Some(channels.as_slice()));
        let n_silent = silent_samples(found, sheet.silent.as_ref(), rest, &mut outcome.settings)?;
        let averaged = estimate::spectra(sheet, hits, context)?;
        spectra.push(with_silence(averaged, hits, n_silent, &channels, &field)?);
    }
    let band = band_of(sheet, &spectra[0])?;
    let greyed = outside_of(sheet, band, &spectra[0]);
    of_the_test(sheet, &accepted, &spectra, &greyed, &mut outcome)?;
    let mut estimated = Vec::with_capacity(outputs.len());
    context.progress.begins("forming responses", outputs.len());
    for output in &outputs {
        context.check_cancelled()?;
        estimated.push(Named {
            output: output.clone(),
            input: sheet.input.clone(),
            node: 1,
            one: estimate::estimate(sheet, &spectra, output, &first_hits)?,
        });
        context.progress.one_more();
    }
    report(sheet, &estimated, band, &greyed, &mut outcome);
    outcome
        .attachments
        .push(universal::attachment(&estimated, &sheet.title)?);
    for found in &sets {
        outcome.say(sentence(&found.in_words()));
    }
    warn(sheet, &spectra, &estimated, &mut outcome);
    for (hits, spectra) in accepted.iter().zip(&spectra) {
        for output in &outputs {
            let departure = estimate::departure(sheet, hits, spectra, output, context)?;
            warn_of_windows(sheet, output, departure, &mut outcome);
        }
    }
    Ok(outcome)
}

/// Reads the records of one hammer and finds the hits in them.
fn find(
    sheet: &FrfSheet,
    (records, hits): (&Records, &HitsSheet),
    outputs: &[String],
    place: &str,
    context: &JobContext<'_>,
    outcome: &mut Outcome,
) -> Result<FoundHits, RodlabError> {
    context.progress.begins("reading records", 0);
    records.refuse_uncertain_skews(&format!("{place}records"), SKEW_NOT_FOLLOWED)?;
    let loaded = records.load(context.folder, &format!("{place}records"))?;
    context.check_cancelled()?;
    let loaded = loaded.entered_in(outcome);
    context.progress.begins("judging hits", 0);
    let weigh = |criteria: Criteria| {
        let weighed = match &sheet.exponential_window {
            None => Ok(criteria),
            Some(ExponentialWindowSheet::EndWeight { weight }) => {
                criteria.with_end_weight(weight.si())
            }
            Some(ExponentialWindowSheet::TimeConstant { time }) => {
                AddedDamping::new(1.0 / time.si()).map(|window| criteria.with_decay_rate(window))
            }
        };
        weighed.in_step("exponential_window")
    };
    let field = format!("{place}hits");
    let mut found = hits.find_weighed(HitKind::Hammer, weigh, loaded, &sheet.input, &field)?;
    let outputs: Vec<&str> = outputs.iter().map(String::as_str).collect();
    let from_hz = sheet.band.as_ref().map(|band| band.from.si());
    let window = (sheet.force_window.is_some(), from_hz);
    found.judge((&sheet.input, &outputs), window, outcome)?;
    Ok(found)
}

/// Adds figure and table of the hits of one hammer.
fn describe(
    sheet: &FrfSheet,
    found: &FoundHits,
    outputs: &[String],
    place: &str,
    outcome: &mut Outcome,
) -> Result<(), RodlabError> {
    let (name, title) = if place.is_empty() {
        ("hits", "Hits")
    } else {
        ("hits_second_hammer", "Hits of the second hammer")
    };
    outcome
        .figures
        .push(time_histories::figure(sheet, found, outputs, name, title)?);
    outcome
        .tables
        .push(time_histories::table(found, &sheet.input, name, title));
    Ok(())
}

/// Returns the reason why the accepted hits give no response; `None` if they give one.
fn too_few(sheet: &FrfSheet, sets: &[FoundHits]) -> Option<String> {
    for (found, hammer) in sets.iter().zip(["", " of the second hammer"]) {
        let n_found = found.n_found();
        if found.n_accepted() == 0 {
            let first = found.log().into_iter().find(|entry| !entry.accepted);
            let because = first
                .and_then(|entry| Some((entry.what, entry.reasons.first()?.clone())))
                .map(|(what, reason)| format!(" ({what}: {reason})"))
                .unwrap_or_default();
            if found.hits().all(|hit| !hit.is_found()) {
                return Some(format!("no hit{hammer} is found{because}"));
            }
            let two_contacts = |hit: FoundHit<'_>| {
                let mut reasons = hit.hit.reasons().iter();
                reasons.any(|reason| matches!(reason, Reason::DoubleHit { .. }))
            };
            let advice = if sheet.hits.cut.is_none() && found.hits().any(two_contacts) {
                "; if a record contains several hits, cut it by `hits.cut`"
            } else {
                ""
            };
            return Some(match n_found {
                1 => format!("the only hit{hammer} is rejected{because}{advice}"),
                n => format!("all {n} hits{hammer} are rejected{because}{advice}"),
            });
        }
        let by_variance = sheet
            .second_hammer
            .as_ref()
            .is_some_and(|second| second.merge.unwrap_or_default() == MergeSheet::InverseVariance);
        if by_variance && found.n_accepted() < 2 {
            return Some(format!(
                "1 of {n_found} hits{hammer} is accepted, and merging by inverse variance needs two of each hammer"
            ));
        }
    }
    None
}

/// Reports the spectra of the input, and the results for the whole test.
fn of_the_test(
    sheet: &FrfSheet,
    accepted: &[Vec<&Record>],
    spectra: &[AveragedSpectra],
    greyed: &[Greyed],
    outcome: &mut Outcome,
) -> Result<(), RodlabError> {
    for (number, (hits, spectra)) in accepted.iter().zip(spectra).enumerate() {
        let (hammer, name, title) = if number == 0 {
            ("", "input_spectra", "Spectra of the input")
        } else {
            (
                ", second hammer",
                "input_spectra_second_hammer",
                "Spectra of the input, second hammer",
            )
        };
        outcome.figures.push(input_spectra::figure(
            sheet, hits, spectra, greyed, name, title,
        )?);
        outcome.quantities.push(Quantity::of(
            format!("averages{hammer}"),
            "",
            spectra.n_averages() as f64,
            match sheet.segments {
                None => "accepted hits".to_owned(),
                Some(_) => format!(
                    "segments, equivalent to {} independent ones",
                    short(spectra.effective_averages())
                ),
            },
        ));
        outcome.quantities.push(Quantity::of(
            format!("end of the spectrum of the input{hammer}"),
            "Hz",
            input_spectra::end_of(spectra, &sheet.input)?,
            "where the mean falls 20 dB below its maximum, or the lines end",
        ));
    }
    let first = spectra.first();
    outcome.quantities.extend(first.map(|spectra| {
        Quantity::of(
            "distance of lines",
            "Hz",
            spectra.line_spacing_hz(),
            match sheet.segments {
                None => "the inverse of the duration of a hit",
                Some(_) => "the inverse of the duration of a segment",
            },
        )
    }));
    if let Some(damping) = first.and_then(AveragedSpectra::added_damping) {
        outcome.quantities.push(Quantity::of(
            "damping added by the exponential window",
            "1/s",
            damping.decay_rate(),
            "to be subtracted from the decay rate of every mode",
        ));
    }
    Ok(())
}

/// Reports tables, figures, quantities and sentences for all responses.
fn report(
    sheet: &FrfSheet,
    estimated: &[Named],
    band: Band,
    greyed: &[Greyed],
    outcome: &mut Outcome,
) {
    let named = |named: &Named| match sheet.further_inputs.is_empty() {
        true => named.output.clone(),
        false => format!("{} over {}", named.output, named.input),
    };
    let files = words::file_names(&estimated.iter().map(named).collect::<Vec<_>>());
    let mut only_chance = true;
    let mut figures = Vec::new();
    for (
        Named {
            output, input, one, ..
        },
        file,
    ) in estimated.iter().zip(&files)
    {
        outcome
            .tables
            .push(tables::table(one, output, input, file, band));
        figures.push(response_figures::bode(
            one, output, input, file, band, greyed,
        ));
        figures.push(response_figures::nyquist(one, output, input, file, band));
        figures.extend(response_figures::merge(one, output, file, band, greyed));
        let merit = tables::merit(one, output, input, band);
        let holds = one.is_more_than_chance(merit.n_coherent, merit.n_lines);
        only_chance &= !holds;
        outcome.quantities.extend(merit.quantities);
        outcome.say(merit.sentence);
        if !holds {
            outcome.warn(format!(
                "`{output}` has no response: no more of its lines are coherent with `{input}` than noise alone would give."
            ));
        } else if merit.n_valid < merit.n_lines && !one.coherences.is_empty() {
            outcome.warn(format!(
                "{} of {} lines of `{output}` in the band are not valid: they have no signal, a coherence that chance alone reaches once in twenty, or hardly more than the noise of their neighbours.",
                merit.n_lines - merit.n_valid,
                merit.n_lines
            ));
        }
    }
    // the figures of the responses come before the figures of the records
    outcome.figures.splice(0..0, figures);
    if only_chance {
        let reason = format!(
            "no more lines between {} and {} are coherent with `{}` than noise alone would give",
            hertz(band.from_hz),
            hertz(band.to_hz),
            sheet.inputs().join("` or `")
        );
        outcome.deny("No frequency response", reason);
    }
}

/// Warns of the effect on the response of `output` of windows, and of removing a trend other than
/// the level at rest.
fn warn_of_windows(
    sheet: &FrfSheet,
    output: &str,
    departure: Option<Departure>,
    outcome: &mut Outcome,
) {
    let trend = match sheet.detrend {
        Some(DetrendSheet::Mean) => Some("mean"),
        Some(DetrendSheet::Line) => Some("least-squares line"),
        _ => None,
    };
    if let Some(trend) = trend {
        outcome.warn(format!(
            "The {trend} of a hit contains part of its motion: removing it biases the response of `{output}`. Remove the level at rest: state `detrend` as `rest` (in RON `Rest`)."
        ));
    }
    let Some(departure) = departure else {
        return;
    };
    let said = format!(
        "windows and trend change the response of `{output}` by {} % in the median and by {} % or more on a tenth of the lines, compared with a stated error of {} %",
        short(100.0 * departure.median),
        short(100.0 * departure.of_a_tenth),
        short(100.0 * departure.own)
    );
    if departure.is_beyond_errors() {
        outcome.doubt(format!(
            "{said}: they cut off part of the hits, or the hits have an offset"
        ));
    }
}

/// Adds warnings about the use of the responses.
fn warn(sheet: &FrfSheet, spectra: &[AveragedSpectra], estimated: &[Named], outcome: &mut Outcome) {
    for (spectra, hammer) in spectra.iter().zip(["", " of the second hammer"]) {
        if spectra.n_averages() == 1 {
            outcome.doubt(format!(
                "only one hit{hammer} is accepted: there is no coherence, and the error of its lines is not known"
            ));
        }
    }
    if let Some(damping) = spectra.first().and_then(AveragedSpectra::added_damping) {
        outcome.warn(format!(
            "The exponential window adds a decay rate of {} 1/s: the responses are those on the line s = {0} 1/s + i omega, and the decay rate of every mode is larger by this amount.",
            short(damping.decay_rate())
        ));
    }
    for Named { output, one, .. } in estimated {
        if let Some(merged) = &one.merged {
            outcome.doubt_all(disagreements(merged, "the second hammer", output));
        }
        if let Some((leakage, random)) = one.median_leakage()
            && leakage > random
        {
            let (leakage, random) = (short(100.0 * leakage), short(100.0 * random));
            outcome.warn(match sheet.segments {
                None => format!(
                    "`{output}` still moves at the end of the records: the part cut off changes a line by {leakage} % in the median, compared with a random error of {random} %. Record longer, or state an exponential window."
                ),
                Some(_) => format!(
                    "The lines are too wide for `{output}`: their width changes a line by {leakage} % in the median, compared with a random error of {random} %. State longer segments."
                ),
            });
        }
        let (Some(completed), Some(weighed)) = (&one.completed, &sheet.weighed_mass) else {
            continue;
        };
        let mass = weighed.mass.with_uncertainty();
        let error = mass.uncertainty();
        let apart = completed.apparent_mass - mass.value;
        let spread = completed
            .apparent_mass_standard_error
            .hypot(error)
            .hypot(mass.value * one.calibration);
        if apart.abs() > 3.0 * spread {
            outcome.doubt(format!(
                "the lines of `{output}` give a mass of {} kg, the balance {}: the difference is larger than their errors explain; a sensitivity is wrong or the body is not free",
                short(completed.apparent_mass),
                weighed.mass
            ));
        }
    }
}

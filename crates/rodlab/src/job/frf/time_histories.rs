//! Figure of the hits over time, with trigger and windows, and table of the hits.

use std::ops::Range;

use labio::Record;
use rodfigure::{Figure, Mark, Panel, Role};

use super::estimate;
use super::sheet::FrfSheet;
use crate::hits::{FoundHit, FoundHits};
use crate::outcome::{Rows, Table};
use crate::{InStep, RodlabError};

/// Maximum number of histories on one panel. If there are more, only the first ones are drawn;
/// rejected hits have priority.
const MOST_HISTORIES: usize = 40;

/// Fraction of the peak above which the input belongs to the impact, which is drawn enlarged.
const STRONG: f64 = 0.05;

const MS: f64 = 1e3;

/// Figure of the histories of all hits; rejected hits are faint.
pub(super) fn figure(
    sheet: &FrfSheet,
    found: &FoundHits,
    outputs: &[String],
    name: &str,
    title: &str,
) -> Result<Figure, RodlabError> {
    let drawable = || found.hits().filter(|f| f.hit.record().is_some());
    // rejected hits are drawn first, so that they are behind the others
    let mut drawn: Vec<_> = drawable().filter(|f| !f.hit.is_accepted()).collect();
    drawn.extend(drawable().filter(|f| f.hit.is_accepted()));
    let n_hits = drawn.len();
    drawn.truncate(MOST_HISTORIES);
    let mut panels = Vec::with_capacity(outputs.len() + 2);
    let whole = f64::NEG_INFINITY..f64::INFINITY;
    if let Some(about) = blow(sheet, &drawn) {
        panels.push(panel(sheet, &drawn, &sheet.input, about)?);
    }
    for channel in std::iter::once(&sheet.input).chain(outputs) {
        panels.push(panel(sheet, &drawn, channel, whole.clone())?);
    }
    let of_which = if n_hits > drawn.len() {
        format!(" {} of {n_hits} hits are drawn.", drawn.len())
    } else {
        String::new()
    };
    Ok(Figure::new(name, title, panels).with_caption(format!(
        "Time histories of the hits, overlaid; a short impact is also shown enlarged, in the first panel. Time starts at the trigger, or at the beginning of each record. Rejected hits are faint. Windows are drawn with the height of the largest sample.{of_which}"
    )))
}

/// Returns the time range about the impact \[ms\] that is drawn enlarged, counted from the trigger
/// or from the beginning of each record. `None` if it is longer than 30 % of the hit.
fn blow(sheet: &FrfSheet, drawn: &[FoundHit<'_>]) -> Option<Range<f64>> {
    let (mut from, mut to, mut duration) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
    for found in drawn.iter().filter(|found| found.hit.is_accepted()) {
        let record = found.hit.record()?;
        let samples = record.channel(&sheet.input).ok()?;
        let peak = samples.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
        let strong = |x: &f64| x.abs() > STRONG * peak;
        let first = samples.iter().position(strong)?;
        let behind = samples.iter().rev().position(strong)?;
        let last = samples.len() - 1 - behind;
        let time = |index: usize| MS * (record.time_at(index) - found.hit.time());
        from = from.min(time(first));
        to = to.max(time(last));
        duration = duration.max(MS * record.duration());
    }
    let margin = to - from;
    let about = from - margin..to + 2.0 * margin;
    (margin > 0.0 && about.end - about.start < 0.3 * duration).then_some(about)
}

/// Returns the panel with the histories of one channel in the time range `about` \[ms\].
fn panel(
    sheet: &FrfSheet,
    drawn: &[FoundHit<'_>],
    channel: &str,
    about: Range<f64>,
) -> Result<Panel, RodlabError> {
    let mut marks = Vec::with_capacity(drawn.len() + 3);
    let mut unit = "";
    let mut named = None;
    let mut peak: f64 = 0.0;
    for found in drawn {
        let Some(record) = found.hit.record() else {
            continue;
        };
        let samples = record.channel(channel).in_step("drawing hits")?;
        let known = record.channels().iter().find(|c| c.name() == channel);
        unit = known.map_or("", |c| c.quantity().unit());
        let accepted = found.hit.is_accepted();
        if accepted {
            peak = samples.iter().fold(peak, |peak, x| peak.max(x.abs()));
        }
        let samples = samples
            .iter()
            .enumerate()
            .map(|(index, sample)| (MS * (record.time_at(index) - found.hit.time()), *sample))
            .filter(|(time, _)| about.contains(time));
        // the rejected hits come first, and the first hit of each kind has a name
        let name = match (named.replace(accepted) == Some(accepted), accepted) {
            (true, _) => "",
            (false, true) => "accepted hits",
            (false, false) => "rejected hits",
        };
        let role = if accepted { Role::First } else { Role::Faint };
        marks.push(Mark::line(name, role, samples));
    }
    let last = drawn.iter().rev();
    if let Some((found, record)) = last
        .filter_map(|found| Some((found, found.hit.record()?)))
        .next()
    {
        let offset = record.start_time() - found.hit.time();
        let is_input = channel == sheet.input;
        marks.extend(window_of(sheet, record, is_input, peak, offset, &about)?);
        if found.is_by_trigger() && about.contains(&0.0) {
            marks.push(Mark::at("trigger", 0.0));
        }
    }
    let label = if about.start.is_finite() {
        "time about the impact"
    } else {
        "time"
    };
    Ok(Panel::new((label, "ms"), (channel, unit), marks))
}

/// Returns the window weights of a channel, scaled to its peak; `None` if all weights are 1.
fn window_of(
    sheet: &FrfSheet,
    record: &Record,
    is_input: bool,
    peak: f64,
    offset: f64,
    about: &Range<f64>,
) -> Result<Option<Mark>, RodlabError> {
    let (n, rate) = (record.n_samples(), record.sampling_rate_hz());
    let window = sheet.window.clone().unwrap_or_default().window();
    let sampled = window.sample(n).in_step("window")?;
    let mut weights = sampled.weights;
    let mut multiply = |factors: Vec<f64>| {
        for (weight, factor) in weights.iter_mut().zip(factors) {
            *weight *= factor;
        }
    };
    let mut names = Vec::new();
    if window != labio::Window::Rectangular {
        names.push("window");
    }
    if is_input && let Some(force_window) = &sheet.force_window {
        let gate = force_window.window("force_window")?.weights(n, rate);
        multiply(gate.in_step("force_window")?);
        names.push("force window");
    }
    if let Some(damping) = estimate::added_damping(sheet, record.duration())? {
        let decay = damping.weights(n, rate);
        multiply(decay.in_step("exponential_window")?);
        names.push("exponential window");
    }
    if names.is_empty() {
        return Ok(None);
    }
    let weights = weights
        .into_iter()
        .enumerate()
        .map(|(index, weight)| (MS * (offset + index as f64 / rate), peak * weight))
        .filter(|(time, _)| about.contains(time));
    let name = names.join(" and ");
    Ok(Some(Mark::line(name, Role::Reference, weights)))
}

/// Returns a table with one row per hit: time, strength, decision and reasons.
pub(super) fn table(found: &FoundHits, input: &str, name: &str, title: &str) -> Table {
    let hits: Vec<FoundHit<'_>> = found.hits().collect();
    let unit = hits.iter().find_map(|found| {
        let mut channels = found.hit.record()?.channels().iter();
        let channel = channels.find(|channel| channel.name() == input)?;
        Some(channel.quantity().unit())
    });
    let peak = |found: &FoundHit<'_>| {
        let samples = found.hit.record()?.channel(input).ok()?;
        let all = samples.iter().copied();
        all.max_by(|a, b| a.abs().total_cmp(&b.abs()))
    };
    Rows::of(&hits, name, title)
        .number("hit", "", |found| found.number as f64)
        .word("record", |found| found.of)
        .number("time", "s", |found| found.hit.time())
        .number(format!("peak of {input}"), unit.unwrap_or(""), |found| {
            peak(found).unwrap_or(f64::NAN)
        })
        .word("decision", |found| {
            if found.log_entry().accepted {
                "accepted"
            } else {
                "rejected"
            }
        })
        .word("reasons", |found| found.log_entry().reasons.join("; "))
        .table
}

//! Windows that the sheet states around pulses.

use labio::hits::{Extent, samples_at_rest};
use labio::ratio::{find_cut_edges, find_other_pulse};
use labio::{PulseWindow, Record};

use crate::RodlabError;
use crate::digits::significant;
use crate::job::modulus::method::Pulse;
use crate::sheet::{Exact, Time};

/// Returns the samples of a pulse; the end of the pulse must be within all hits.
pub(super) fn window(pulse: &Pulse<'_>, hits: &[&Record]) -> Result<PulseWindow, RodlabError> {
    let rate_hz = hits.first().map_or(f64::NAN, |hit| hit.sampling_rate_hz());
    let sample = |time: &Exact<Time>| Extent::Seconds(time.si()).samples(rate_hz).ok();
    let shortest = hits.iter().map(|hit| hit.n_samples()).min().unwrap_or(0);
    match (sample(pulse.from), sample(pulse.to)) {
        (Some(from), Some(to)) if from + 2 < to && to < shortest => Ok(PulseWindow {
            channel: pulse.channel.to_owned(),
            samples: from..to,
        }),
        _ => Err(RodlabError::request(
            pulse.field.as_str(),
            format!("\"{}\" to \"{}\"", pulse.from, pulse.to),
            format!(
                "an interval in the record of a hit, 0 to {:.4} ms",
                1e3 * shortest as f64 / rate_hz
            ),
        )),
    }
}

/// Returns the number of samples from which the level at rest of both channels is found: the number
/// `silent` or, if this is not known, the number of samples before the first motion; `None` if
/// there are too few samples before the motion.
pub(super) fn samples_for_level(
    hits: &[&Record],
    windows: [&PulseWindow; 2],
    silent: Option<usize>,
) -> Result<Option<usize>, RodlabError> {
    let channels = windows.map(|window| window.channel.as_str());
    match silent {
        Some(silent) => Ok(Some(silent)),
        None => samples_at_rest(hits, &channels).map_err(refused),
    }
}

/// Returns the reason for doubt if there is another pulse between the `earlier` and the `later`
/// window ([`find_other_pulse`]).
pub(super) fn between(
    hits: &[&Record],
    [earlier, later]: [&PulseWindow; 2],
    names: [&str; 2],
    n_rest: Option<usize>,
) -> Result<Option<String>, RodlabError> {
    let other = find_other_pulse(hits, n_rest, later, earlier).map_err(refused)?;
    let [first, second] = names.map(last_part);
    Ok(other.map(|other| {
        format!(
            "between the windows `{first}` and `{second}` lies another pulse, {} % of the smaller one of the two: the window `{second}` may be that of a later passage",
            significant(100.0 * other, 2)
        )
    }))
}

/// Returns a clause for each edge of the windows at which a pulse is cut ([`find_cut_edges`]).
pub(super) fn cut(
    hits: &[&Record],
    windows: [&PulseWindow; 2],
    names: [&str; 2],
    n_rest: Option<usize>,
) -> Result<Vec<String>, RodlabError> {
    let mut found = Vec::new();
    for (window, name) in windows.into_iter().zip(names.map(last_part)) {
        let edges = find_cut_edges(hits, n_rest, window).map_err(refused)?;
        for (edge, place) in edges.into_iter().zip(["beginning", "end"]) {
            found.extend(edge.map(|part| {
                format!(
                    "at the {place} of the window `{name}` the signal is at {} % of the peak of the pulse",
                    significant(100.0 * part, 2)
                )
            }));
        }
    }
    Ok(found)
}

fn last_part(field: &str) -> &str {
    field.rsplit('.').next().unwrap_or(field)
}

fn refused(error: labio::LabioError) -> RodlabError {
    RodlabError::step("cutting pulses out of the hits", error)
}

//! Time histories of the hits.

use rodfigure::{Figure, Mark, Panel, Role};

use crate::hits::FoundHits;

use super::method::Taken;

/// Maximum number of accepted hits that are drawn.
const HITS_DRAWN: usize = 3;

/// Fraction of its peak to which every channel has decayed at the end of the drawn part of a hit.
const DECAYED: f64 = 0.005;

/// Figure with one panel per channel: the first accepted hits and, faintly, the first rejected hit.
pub(super) fn figures(
    found: &FoundHits,
    channels: &[Taken<'_>],
    silent: Option<usize>,
) -> Vec<Figure> {
    let mut panels = Vec::new();
    let shown = channels
        .iter()
        .map(|taken| alive(found, taken.channel))
        .max()
        .unwrap_or(0);
    for taken in channels {
        if let Some(panel) = panel(found, taken.channel, shown, silent) {
            panels.push(panel);
        }
    }
    if panels.is_empty() {
        return Vec::new();
    }
    let accepted = found.n_accepted();
    let drawn = if accepted > HITS_DRAWN {
        format!("The first {HITS_DRAWN} of {accepted} accepted hits")
    } else {
        "The accepted hits".to_owned()
    };
    vec![Figure::new("hits", "Time histories of the hits", panels).with_caption(format!(
        "{drawn}, and the first rejected one faintly, until they have decayed to {} % of their peaks.",
        100.0 * DECAYED
    ))]
}

/// Returns the number of samples until the first accepted hit has decayed in a channel, plus a
/// tenth of this number.
fn alive(found: &FoundHits, channel: &str) -> usize {
    let accepted = found.accepted();
    let Some(history) = accepted.first().and_then(|hit| hit.channel(channel).ok()) else {
        return usize::MAX;
    };
    let peak = history.iter().fold(0.0_f64, |peak, y| peak.max(y.abs()));
    let last = history.iter().rposition(|y| y.abs() > DECAYED * peak);
    last.map_or(usize::MAX, |last| last + last / 10)
}

fn panel(found: &FoundHits, channel: &str, shown: usize, silent: Option<usize>) -> Option<Panel> {
    let mut marks = Vec::new();
    let mut axis = None;
    let (mut accepted, mut rejected) = (0, 0);
    for hit in found.hits() {
        let Some(record) = hit.hit.record() else {
            continue;
        };
        let is_accepted = hit.hit.is_accepted();
        let role = if is_accepted {
            if accepted == HITS_DRAWN {
                continue;
            }
            accepted += 1;
            Role::of_series(accepted - 1)
        } else {
            if rejected == 1 {
                continue;
            }
            rejected += 1;
            Role::Faint
        };
        let Ok(history) = record.channel(channel) else {
            continue;
        };
        let quantity = record.channels().iter().find(|c| c.name() == channel)?;
        if axis.is_none() {
            let quantity = quantity.quantity();
            let (unit, scale) = match quantity {
                labio::Quantity::Strain => ("µε", 1e6),
                labio::Quantity::Displacement => ("mm", 1e3),
                _ => (quantity.unit(), 1.0),
            };
            axis = Some((format!("{}, {channel}", quantity.name()), unit, scale));
        }
        let (_, _, scale) = axis.as_ref()?;
        let milliseconds = 1e3 / record.sampling_rate_hz();
        let samples = history.iter().take(shown).enumerate();
        let points = samples.map(|(index, y)| (milliseconds * index as f64, scale * y));
        let verb = if is_accepted { "" } else { ", rejected" };
        let name = format!("hit {}{verb}", hit.number);
        marks.push(Mark::line(name, role, points));
        if marks.len() == 1
            && let Some(silent) = silent
        {
            marks.push(Mark::at("end of the silence", silent as f64 * milliseconds));
        }
    }
    let (label, unit, _) = axis?;
    let time = ("time from the beginning of the hit", "ms");
    Some(Panel::new(time, (label, unit), marks))
}

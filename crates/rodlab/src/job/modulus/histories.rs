//! Time histories of the hits.

use rodfigure::{Figure, Mark, Panel, Role};

use crate::hits::FoundHits;

use super::method::Taken;

/// Maximum number of accepted hits that are drawn.
const HITS_DRAWN: usize = 3;
/// Number of parts of a history, which is the resolution of a figure. The smallest and the largest
/// sample of each part are drawn.
const STRETCHES: usize = 600;

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
    vec![Figure {
        caption: format!(
            "{drawn}, and the first rejected one faintly, until they have decayed to {} % of their peaks. For long histories, the smallest and the largest samples of short intervals \
             are drawn.",
            100.0 * DECAYED
        ),
        ..Figure::new("hits", "Time histories of the hits", panels)
    }]
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
        let history: Vec<f64> = history.iter().take(shown).copied().collect();
        let (x, y) = drawn(&history, milliseconds, *scale);
        let verb = if is_accepted { "" } else { ", rejected" };
        marks.push(Mark::curve(
            format!("hit {}{verb}", hit.number),
            role,
            &x,
            y,
        ));
        if marks.len() == 1
            && let Some(silent) = silent
        {
            marks.push(Mark::At {
                name: "end of the silence".to_owned(),
                x: silent as f64 * milliseconds,
            });
        }
    }
    let (label, unit, _) = axis?;
    let time = ("time from the beginning of the hit", "ms");
    Some(Panel::new(time, (label, unit), marks))
}

/// Returns the samples to draw: all samples, or the smallest and the largest of each part in their
/// order.
#[allow(
    clippy::indexing_slicing,
    reason = "minimum and maximum are taken over the samples of the part, which has at least one"
)]
fn drawn(samples: &[f64], step: f64, scale: f64) -> (Vec<f64>, Vec<f64>) {
    let stretch = samples.len().div_ceil(STRETCHES);
    if stretch <= 2 {
        let x = (0..samples.len())
            .map(|index| step * index as f64)
            .collect();
        return (x, samples.iter().map(|y| scale * y).collect());
    }
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for (number, part) in samples.chunks(stretch).enumerate() {
        let place = |better: fn(f64, f64) -> bool| {
            let mut best = 0;
            for (index, value) in part.iter().enumerate() {
                if better(*value, part[best]) {
                    best = index;
                }
            }
            best
        };
        let (least, greatest) = (place(|a, b| a < b), place(|a, b| a > b));
        let mut pair = [least, greatest];
        pair.sort_unstable();
        for index in pair {
            x.push(step * (number * stretch + index) as f64);
            y.push(scale * part[index]);
        }
    }
    (x, y)
}

#[cfg(test)]
mod tests {
    use super::drawn;

    #[test]
    fn a_peak_of_one_sample_is_drawn() {
        let mut samples = vec![0.0; 65_536];
        samples[12_345] = 7.0;
        samples[12_346] = -3.0;
        let (x, y) = drawn(&samples, 0.1, 2.0);
        assert!(x.len() == y.len() && x.len() <= 1200);
        let peak = y.iter().position(|value| *value > 13.0).unwrap();
        assert!((x[peak] - 1234.5).abs() < 1e-9);
        assert!(y.iter().any(|value| *value < -5.0));
        assert!(x.windows(2).all(|pair| pair[0] <= pair[1]));
        assert_eq!(drawn(&samples[..1000], 0.1, 1.0).0.len(), 1000);
    }
}

//! Windows of the sheet around pulses.

use labio::hits::Extent;
use labio::{PulseWindow, Record};

use crate::RodlabError;
use crate::job::modulus::method::WindowSheet;
use crate::sheet::{Exact, Time};

/// The window of a pulse at a section.
pub(super) fn at_section(
    window: &WindowSheet,
    hits: &[&Record],
    field: &str,
) -> Result<PulseWindow, RodlabError> {
    between(&window.channel, (&window.from, &window.to), hits, field)
}

/// The samples of `channel` between two times from the start of a hit; the end must be within all
/// hits.
pub(super) fn between(
    channel: &str,
    (from, to): (&Exact<Time>, &Exact<Time>),
    hits: &[&Record],
    field: &str,
) -> Result<PulseWindow, RodlabError> {
    let rate_hz = hits.first().map_or(f64::NAN, |hit| hit.sampling_rate_hz());
    let sample = |time: &Exact<Time>| Extent::Seconds(time.si()).samples(rate_hz).ok();
    let shortest = hits.iter().map(|hit| hit.n_samples()).min().unwrap_or(0);
    match (sample(from), sample(to)) {
        (Some(from), Some(to)) if from + 2 < to && to < shortest => Ok(PulseWindow {
            channel: channel.to_owned(),
            samples: from..to,
        }),
        _ => Err(RodlabError::request(
            field,
            format!("\"{from}\" to \"{to}\""),
            format!(
                "an interval in the record of a hit, 0 to {:.4} ms",
                1e3 * shortest as f64 / rate_hz
            ),
        )),
    }
}

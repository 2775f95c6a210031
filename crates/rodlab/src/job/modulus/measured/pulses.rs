//! Windows that the sheet states around pulses.

use labio::hits::Extent;
use labio::{PulseWindow, Record};

use crate::RodlabError;
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

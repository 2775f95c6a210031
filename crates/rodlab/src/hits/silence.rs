//! Silence of a hit before the blow.

use labio::Record;
use labio::hits::{Extent, Hit, samples_at_rest};

use crate::RodlabError;
use crate::hits::FoundHits;
use crate::outcome::Setting;
use crate::sheet::{Duration, Exact};

/// Longest time from the beginning of a blow to the trigger \[s\], unless the sheet states the
/// silence.
const RISE: f64 = 0.2e-3;

/// Number of samples before the blow, if known.
pub(crate) fn silent_samples(
    found: &FoundHits,
    stated: Option<&Exact<Duration>>,
    (name, at_rest): (&str, Option<&[&str]>),
    settings: &mut Vec<Setting>,
) -> Result<Option<usize>, RodlabError> {
    let first = found.hits().find_map(|hit| Some((hit, hit.hit.record()?)));
    let Some((hit, record)) = first else {
        return Ok(None);
    };
    let rate = record.sampling_rate_hz();
    let extent = |seconds: f64| {
        Extent::Seconds(seconds)
            .samples(rate)
            .map_err(|error| RodlabError::step(name, error))
    };
    if let Some(stated) = stated {
        return extent(stated.si()).map(Some);
    }
    if let Some(trigger) = trigger_of(hit.hit, record) {
        // the trigger fires some time after the beginning of the blow
        let before = trigger as f64 / rate;
        let silent = before - (0.2 * before).min(RISE);
        settings.push(Setting::by_default(
            name,
            format!(
                "{:.4} ms, the pre-trigger less the rise of the blow",
                1e3 * silent
            ),
        ));
        return extent(silent).map(Some);
    }
    let rest = match at_rest {
        Some(channels) => samples_at_rest(&found.accepted(), channels)
            .map_err(|error| RodlabError::step(name, error))?,
        None => None,
    };
    let said = rest.map_or_else(
        || "not known".to_owned(),
        |n| {
            format!(
                "{:.4} ms, in which the channels are at rest",
                1e3 * n as f64 / rate
            )
        },
    );
    settings.push(Setting::by_default(name, said));
    Ok(rest)
}

/// The sample of a hit at which the trigger fired; `None` if each record is a hit.
pub(crate) fn trigger_of(hit: &Hit, record: &Record) -> Option<usize> {
    let before = hit.time() - record.start_time();
    (before > 0.0)
        .then(|| Extent::Seconds(before).samples(record.sampling_rate_hz()))
        .and_then(Result::ok)
}

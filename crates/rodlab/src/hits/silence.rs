//! Silence of a hit before the impact.

use labio::Record;
use labio::hits::{Extent, Hit, samples_at_rest};

use crate::digits::{prefix_for, rate};
use crate::hits::FoundHits;
use crate::outcome::Setting;
use crate::sheet::{Duration, Exact};
use crate::{InStep, RodlabError};

/// Longest time from the beginning of an impact to the trigger \[s\], unless the sheet states the
/// silence.
const RISE: f64 = 0.2e-3;

/// Returns the number of samples before the impact, if it is known.
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
    let extent = |seconds: f64| Extent::Seconds(seconds).samples(rate).in_step(name);
    if let Some(stated) = stated {
        return extent(stated.si()).map(Some);
    }
    if let Some(trigger) = trigger_of(hit.hit, record) {
        // the impact begins before the trigger fires, by at most `RISE` or a fifth of the
        // pre-trigger
        let before = trigger as f64 / rate;
        let silent = before - (0.2 * before).min(RISE);
        settings.push(Setting::by_default(
            name,
            format!(
                "{:.4} ms, the pre-trigger minus the rise time of the impact",
                1e3 * silent
            ),
        ));
        return extent(silent).map(Some);
    }
    let rest = match at_rest {
        Some(channels) => samples_at_rest(&found.accepted(), channels).in_step(name)?,
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

/// Fraction of its greatest deviation in the hit that a channel may reach during the silence.
const MOST_IN_SILENCE: f64 = 0.5;
/// Number of first samples whose mean is the rest level of a channel.
const FOR_LEVEL: usize = 8;

/// Checks that the impact is not in the first `n_silent` samples of the hits; `name` is the place
/// of the silence in the sheet, and `stated` the silence as stated there.
///
/// # Errors
///
/// [`RodlabError::Request`] if the silence is longer than a hit, or a channel moves within it; it
/// states duration and sampling rate of the hit, because the cause may be a wrong sampling rate.
pub(crate) fn expect_silence(
    hits: &[&Record],
    channels: &[&str],
    n_silent: usize,
    (name, stated): (&str, &Exact<Duration>),
) -> Result<(), RodlabError> {
    for hit in hits {
        let rate_hz = hit.sampling_rate_hz();
        let all = format!("{:.4} ms long", 1e3 * hit.n_samples() as f64 / rate_hz);
        let (size, prefix) = prefix_for(rate_hz, "Hz");
        let rate = rate(rate_hz / size);
        let refused = |why: String| {
            RodlabError::request(
                name,
                format!("`{stated}`"),
                format!(
                    "the time from the beginning of a record to the impact; {why}; is the sampling rate of {rate} {prefix}Hz right?"
                ),
            )
        };
        if n_silent >= hit.n_samples() {
            return Err(refused(format!("a record is only {all}")));
        }
        for channel in channels {
            let samples = hit.channel(channel).in_step(name)?;
            let level = samples.iter().take(FOR_LEVEL).sum::<f64>() / FOR_LEVEL as f64;
            let greatest = |samples: &mut dyn Iterator<Item = &f64>| {
                samples.fold(0.0_f64, |most, x| most.max((x - level).abs()))
            };
            let in_silence = greatest(&mut samples.iter().take(n_silent));
            if in_silence > MOST_IN_SILENCE * greatest(&mut samples.iter()) {
                return Err(refused(format!(
                    "`{channel}` already moves within this time, and a record is {all}"
                )));
            }
        }
    }
    Ok(())
}

/// Returns the sample of a hit at which the trigger fired; `None` if each record is a hit.
pub(crate) fn trigger_of(hit: &Hit, record: &Record) -> Option<usize> {
    let before = hit.time() - record.start_time();
    (before > 0.0)
        .then(|| Extent::Seconds(before).samples(record.sampling_rate_hz()))
        .and_then(Result::ok)
}

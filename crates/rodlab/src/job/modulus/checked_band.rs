//! Lines used in the checks: the lines with a signal and, if the sheet states no band, without
//! aliases.

use cmod::ModulusEstimate;
use labio::{Coherence, ResponseRatio};

use super::Found;
use crate::digits::hertz;
use crate::responses::stretch_with_signal;
use crate::{Outcome, RodlabError};

/// Returns the estimate on the lines used in the checks, and enters the range of these lines in
/// `outcome`. Returns `None` if the checks use all lines of the estimate.
pub(super) fn lines(
    outcome: &mut Outcome,
    found: &Found<'_>,
) -> Result<Option<ModulusEstimate>, RodlabError> {
    let stated = found.sheet.checks.alias_free_to.as_ref();
    let nyquist = found.measured.sampling_rate_hz.map(|rate| 0.5 * rate);
    if let (Some(stated), Some(nyquist)) = (stated, nyquist)
        && stated.si() > nyquist
    {
        return Err(RodlabError::request(
            "checks.alias_free_to",
            stated.to_string(),
            format!("at most {}, the Nyquist frequency", hertz(nyquist)),
        ));
    }
    let has_band = found.sheet.band.is_some();
    let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
    let mut because = Vec::new();
    if let Some((first, last)) = found.ratio().and_then(with_signal) {
        (from, to) = (first, last);
        because.push("the coherence is above that of chance".to_owned());
    }
    match (stated, nyquist) {
        // a band that the sheet states is assumed to be free of aliases
        _ if has_band => {}
        (Some(stated), _) => {
            to = to.min(stated.si());
            because.push(format!("aliases are suppressed up to {stated}"));
        }
        (None, Some(nyquist)) => {
            to = to.min(0.5 * nyquist);
            because.push(format!(
                "no alias is expected below {}, half the Nyquist frequency",
                hertz(0.5 * nyquist)
            ));
        }
        (None, None) => {}
    }
    if because.is_empty() {
        return Ok(None);
    }
    let looked_at = found.estimate.within(from, to);
    let all = found.estimate.lines();
    let (Some(first), Some(last)) = (looked_at.lines().first(), looked_at.lines().last()) else {
        return Ok(Some(looked_at));
    };
    if looked_at.lines().len() == all.len() {
        return Ok(None);
    }
    let ends = format!(
        "{} to {}",
        hertz(first.frequency_hz),
        hertz(last.frequency_hz)
    );
    outcome.by_default(
        "band of the checks",
        format!("{ends}: {}", because.join(", ")),
    );
    let beyond = found.estimate.valid().count() - looked_at.valid().count();
    if beyond > 0 {
        let (the_checks, remedy) = if has_band {
            ("The checks", "")
        } else {
            (
                "No `band` is stated: the checks",
                "; state a band, or `checks.alias_free_to` if the filter of the recorder suppresses aliases further up",
            )
        };
        outcome.warn(format!(
            "{the_checks} use the lines from {ends}, where {}. {beyond} valid lines are outside and are not checked{remedy}.",
            because.join(" and ")
        ));
    }
    Ok(Some(looked_at))
}

/// Returns the first and the last frequency \[Hz\] of the lines with a signal.
fn with_signal(ratio: &ResponseRatio) -> Option<(f64, f64)> {
    let coherent = ratio.above_chance(Coherence::CHANCE)?;
    let (from, to) = stretch_with_signal(coherent)?;
    Some((*ratio.frequency_hz.get(from)?, *ratio.frequency_hz.get(to)?))
}

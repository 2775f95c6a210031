//! Ratio of two channels of the hits.

use cmod::section_ratio::pooling::AveragedVariance;
use cmod::two_point::variance_from_coherence;
use labio::{AveragedSpectra, Record, Window};

use super::Ratio;
use super::shot::{Shot, ShotChannel};
use crate::RodlabError;
use crate::hits::expect_noise;

/// The ratio of two channels: with its variance from the coherence for several hits, from the
/// silence before it for one.
pub(super) fn ratio_of(
    hits: &[&Record],
    silent: Option<usize>,
    numerator: &str,
    denominator: &str,
) -> Result<Ratio, RodlabError> {
    let ([hit], Some(silent)) = (hits, silent) else {
        return averaged_ratio(hits.iter().copied(), numerator, denominator, 1.0);
    };
    let channel = |name| ShotChannel {
        name,
        at_rest: name,
        duration: hit.duration(),
    };
    let shot = Shot {
        hit,
        silent,
        record: hit,
    };
    shot.ratio(&channel(numerator), &channel(denominator), 1.0)
}

/// H1 with the denominator as input, and its variance from the coherence, pooled over neighbouring
/// lines if the hits are few; it is given how many lines share independent noise.
pub(super) fn averaged_ratio<'a>(
    hits: impl IntoIterator<Item = &'a Record>,
    numerator: &str,
    denominator: &str,
    lines_per_independent_line: f64,
) -> Result<Ratio, RodlabError> {
    let averaging = |error| RodlabError::step("averaging the spectra of the hits", error);
    let spectra = AveragedSpectra::of(hits, Window::Rectangular).map_err(averaging)?;
    expect_noise(&spectra, (denominator, numerator), "source")?;
    let response = spectra.h1(denominator, numerator).map_err(averaging)?;
    let coherence = response
        .coherence
        .unwrap_or_else(|| vec![f64::NAN; response.values.len()]);
    let variance =
        variance_from_coherence(&response.values, &coherence, response.effective_averages)
            .map_err(|error| RodlabError::step("the variance of the ratio", error))?;
    let pooled = AveragedVariance {
        ratio: &response.values,
        variance: &variance,
        denominator_power: &spectra.auto(denominator).map_err(averaging)?,
        averages: response.effective_averages,
        lines_per_independent_line,
    }
    .pooled()
    .map_err(|error| RodlabError::step("the variance of the ratio", error))?;
    Ok(Ratio {
        frequency_hz: response.frequency_hz,
        values: response.values,
        variance: pooled.variance,
        coherence: Some(coherence),
        averages: Some(response.effective_averages),
        freedom: Some(pooled.freedom),
        lines_per_independent_line,
        delay: None,
    })
}

//! Tests for hits or channels that are the same measurement.

use labio::hits::{Copy, find_copy, find_near_copies};
use labio::{AveragedSpectra, Record};

use super::{FoundHits, comparing, windows_of_analyser};
use crate::digits::significant;
use crate::{InStep, RodlabError};

/// Probability that independent hits are doubted.
const LEVEL: f64 = 0.01;

/// Refuses accepted hits of `sets` that are the same measurement, and `channels` that have the same
/// samples. Returns one reason for doubt for each pair of hits that differ by less than their noise
/// ([`find_near_copies`]). If the analyser has applied a window, the noise before an impact does
/// not represent the noise of the whole hit; pairs are then not compared, and the windows are the
/// reasons for doubt.
pub(crate) fn expect_independent(
    sets: &[&FoundHits],
    channels: &[&str],
) -> Result<Vec<String>, RodlabError> {
    let (names, hits): (Vec<String>, Vec<&Record>) = sets
        .iter()
        .flat_map(|found| found.hits())
        .filter(|found| found.hit.is_accepted())
        .filter_map(|found| Some((found.name(), found.hit.record()?)))
        .unzip();
    let name = |hit: usize| names.get(hit).cloned().unwrap_or_default();
    match find_copy(&hits, channels).map_err(comparing)? {
        Some(Copy::Hits { first, second }) => {
            return Err(RodlabError::OneMeasurement {
                first: name(first),
                second: name(second),
                how: "have the same samples",
            });
        }
        Some(Copy::Channels { hit, first, second }) => {
            return Err(RodlabError::OneMeasurement {
                first: format!("channel `{first}`"),
                second: format!("channel `{second}` of {}", name(hit)),
                how: "have the same samples",
            });
        }
        None => {}
    }
    let mut windows: Vec<String> = Vec::new();
    for found in sets {
        windows.extend(windows_of_analyser(&found.accepted(), channels)?);
    }
    if !windows.is_empty() {
        return Ok(windows);
    }
    let near = find_near_copies(&hits, channels, LEVEL).map_err(comparing)?;
    Ok(near
        .iter()
        .map(|pair| {
            format!(
                "the difference between {} and {} has {} times the power of the noise before them, expected at least 1: they may be one \
                 measurement that was stored twice",
                name(pair.first),
                name(pair.second),
                significant(pair.share_of_noise, 2)
            )
        })
        .collect())
}

/// Refuses averages whose coherence is 1 within rounding; `place` is their place in the sheet.
pub(crate) fn expect_noise(
    spectra: &AveragedSpectra,
    (input, output): (&str, &str),
    place: &str,
) -> Result<(), RodlabError> {
    if spectra.n_averages() < 2 {
        return Ok(());
    }
    let coherence = spectra.coherence(input, output).in_step(place)?;
    if coherence.is_one_to_rounding() {
        return Err(RodlabError::NoNoise {
            place: place.to_owned(),
            input: input.to_owned(),
            output: output.to_owned(),
            hits: spectra.n_averages(),
        });
    }
    Ok(())
}

//! Frequency responses of a sheet, from hits or from a file.
//!
//! All jobs use these sources of a response: [`HitsSource`] averages hits, and [`ResponseFile`]
//! reads an averaged response.

mod file;
mod hits;
mod kind;
mod lines;
mod signal;
mod support;

pub use file::ResponseFile;
pub(crate) use file::{AVERAGES, COMMON_ERROR, FREEDOM, STANDARD_ERROR};
pub(crate) use hits::with_silence;
pub use hits::{ForceWindowSheet, HitsSource, MergeSheet, disagreements};
pub(crate) use lines::{JudgedLine, judged_lines, with_errors};
pub(crate) use signal::stretch_with_signal;
pub use support::{CompletionSheet, SupportSheet, measured_body};

use labio::hits::samples_at_rest;
use labio::{
    AddedDamping, AveragedSpectra, FrequencyResponse, LabioError, LineValidity, Record,
    completed_motion,
};

use crate::RodlabError;
use crate::digits::short;
use crate::sheet::{Exact, Frequency};

/// Degrees of freedom written for a known variance. With this number, Student's distribution is
/// practically the normal distribution.
pub(crate) const MOST_FREEDOM: f64 = 1e6;

/// Minimum number of lines of a usable response.
const FEWEST_LINES: usize = 8;

/// Returns the line spacing \[Hz\].
///
/// # Errors
///
/// [`RodlabError::Step`] for a response with fewer than two lines.
pub fn line_spacing_hz(response: &FrequencyResponse) -> Result<f64, RodlabError> {
    let second = response.frequency_hz.get(1).copied();
    second.ok_or_else(|| {
        let too_few = LabioError::CountMismatch {
            what: "lines of a response, at least",
            found: response.frequency_hz.len(),
            expected: 2,
        };
        RodlabError::step("line spacing", too_few)
    })
}

/// Returns in words the reason why a line contains no information.
#[must_use]
pub fn in_words(validity: LineValidity) -> &'static str {
    match validity {
        LineValidity::Valid => "valid",
        LineValidity::NoInput => "no input",
        LineValidity::NoOutput => "no output",
        LineValidity::NoCorrelation => "no correlation",
        LineValidity::NotDefined => "not defined",
        LineValidity::DependentInputs => "dependent inputs",
        _ => "no information",
    }
}

/// Refuses a response that was estimated with an exponential window. Its lines are values at
/// complex frequencies, off the frequency axis by the decay rate of the window, and do not
/// determine the values on the axis. `field` is the place of the response in the sheet.
pub(crate) fn expect_undamped(
    response: &FrequencyResponse,
    field: &str,
) -> Result<(), RodlabError> {
    match response.added_damping {
        None => Ok(()),
        Some(window) => Err(RodlabError::request(
            field,
            format!(
                "a response under an exponential window of {} 1/s",
                short(window.decay_rate())
            ),
            "a response without an exponential window, from records in which the body comes to rest",
        )),
    }
}

/// Returns the samples of a channel, completed by the motion after the end of the hit. Their
/// transform can be divided by a response of [`HitsSource`]; `window` is the exponential window of
/// this response, if any.
///
/// # Errors
///
/// [`LabioError::UnknownChannel`] for a missing channel.
pub fn completed(
    hit: &Record,
    channel: &str,
    window: Option<AddedDamping>,
) -> Result<Vec<f64>, LabioError> {
    let rest = samples_at_rest(&[hit], &[channel])?;
    completed_motion(hit, channel, rest, window)
}

/// Returns the relative systematic error due to truncated records on each line of the response of
/// `output` to `input`. For two tests it is weighted by `shares`, the share of the first test in
/// each line. `None` if the error is not known.
pub(crate) fn leakage_of<'a>(
    tests: impl IntoIterator<Item = &'a AveragedSpectra>,
    input: &str,
    output: &str,
    shares: Option<&[f64]>,
) -> Result<Option<Vec<f64>>, LabioError> {
    let mut sums: Option<Vec<f64>> = None;
    for (number, test) in tests.into_iter().enumerate() {
        let Some(of_test) = test.leakage(input, output)? else {
            continue;
        };
        let share = |line: usize| match shares.and_then(|shares| shares.get(line)) {
            Some(first) if number == 0 => *first,
            Some(first) => 1.0 - first,
            None => 1.0,
        };
        let sums = sums.get_or_insert_with(|| vec![0.0; of_test.len()]);
        for (line, (sum, one)) in sums.iter_mut().zip(of_test).enumerate() {
            // a test with share zero may have no value on this line
            if share(line) > 0.0 {
                *sum += share(line) * one;
            }
        }
    }
    Ok(sums)
}

/// Leaves out the lines of `response` above the frequency `up_to`; `field` is its place in the
/// sheet.
///
/// # Errors
///
/// [`RodlabError::Request`] if fewer than eight lines remain.
pub fn cut(
    response: &mut FrequencyResponse,
    up_to: &Exact<Frequency>,
    field: &str,
) -> Result<(), RodlabError> {
    let limit = up_to.si() + 1e-6 * line_spacing_hz(response)?;
    let n_lines = response.frequency_hz.partition_point(|f| *f <= limit);
    if n_lines < FEWEST_LINES {
        return Err(RodlabError::request(
            field,
            format!("{up_to}, with {n_lines} lines up to it"),
            format!("a frequency with at least {FEWEST_LINES} lines below it"),
        ));
    }
    response.truncate(n_lines);
    Ok(())
}

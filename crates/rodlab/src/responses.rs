//! Frequency responses of a sheet: of hits, or of a file.
//!
//! A job that needs the response of a body takes it from here, wherever it comes from: [`HitsSource`] averages hits,
//! [`ResponseFile`] reads what was averaged before.

mod file;
mod hits;
mod kind;
mod signal;
mod support;

pub use file::ResponseFile;
pub(crate) use file::{AVERAGES, COMMON_ERROR, FREEDOM, STANDARD_ERROR};
pub use hits::{
    EstimatorSheet, ForceWindowSheet, HitsSource, MergeSheet, disagreements, with_silence,
};
pub use kind::KindSheet;
pub use signal::stretch_with_signal;
pub use support::{CompletionSheet, SupportSheet, measured_body};

use labio::{FrequencyResponse, LineValidity};

use crate::RodlabError;
use crate::sheet::{Exact, Frequency};

/// Degrees of freedom that are written where a variance is known: of these Student's law is the normal one.
pub(crate) const MOST_FREEDOM: f64 = 1e6;

/// Fewest lines of a response that something is made of.
const FEWEST_LINES: usize = 8;

/// Distance of the lines \[Hz\].
#[must_use]
pub fn line_spacing_hz(response: &FrequencyResponse) -> f64 {
    response.frequency_hz.get(1).copied().unwrap_or(f64::NAN)
}

/// Why a line carries no information, in words.
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

/// Leaves out the lines of `response` above the frequency `up_to`; `field` is its place in the sheet.
///
/// # Errors
///
/// [`RodlabError::Request`] if fewer than eight lines are left.
pub fn cut(
    response: &mut FrequencyResponse,
    up_to: &Exact<Frequency>,
    field: &str,
) -> Result<(), RodlabError> {
    let limit = up_to.si() + 1e-6 * line_spacing_hz(response);
    let n_lines = response.frequency_hz.partition_point(|f| *f <= limit);
    if n_lines < FEWEST_LINES {
        return Err(RodlabError::request(
            field,
            format!("{up_to}, up to which there are {n_lines} lines"),
            format!("a frequency with at least {FEWEST_LINES} lines below it"),
        ));
    }
    response.truncate(n_lines);
    Ok(())
}

//! Frequency responses of hits, with coherence and errors.

use serde::Deserialize;

use super::Surroundings;
use crate::{Outcome, RodlabError};

/// Sheet of the job.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrfSheet {
    /// Title of the test.
    pub title: String,
}

pub(crate) fn run(sheet: &FrfSheet, _around: &Surroundings<'_>) -> Result<Outcome, RodlabError> {
    Ok(Outcome::of("frf", sheet.title.as_str()))
}

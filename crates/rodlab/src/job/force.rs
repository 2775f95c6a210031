//! Force between two bodies, or from a measured response.

use serde::Deserialize;

use super::Surroundings;
use crate::{Outcome, RodlabError};

/// Sheet of the job.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceSheet {
    /// Title of the test.
    pub title: String,
}

pub(crate) fn run(sheet: &ForceSheet, _around: &Surroundings<'_>) -> Result<Outcome, RodlabError> {
    Ok(Outcome::of("force", sheet.title.as_str()))
}

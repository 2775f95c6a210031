//! Constitutive law from velocity histories.

use serde::Deserialize;

use super::Surroundings;
use crate::{Outcome, RodlabError};

/// Sheet of the job.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IdentifySheet {
    /// Title of the test.
    pub title: String,
}

pub(crate) fn run(
    sheet: &IdentifySheet,
    _around: &Surroundings<'_>,
) -> Result<Outcome, RodlabError> {
    Ok(Outcome::of("identify", sheet.title.as_str()))
}

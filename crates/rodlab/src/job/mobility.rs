//! Mobility of an impact face.

use serde::Deserialize;

use super::Surroundings;
use crate::{Outcome, RodlabError};

/// Sheet of the job.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MobilitySheet {
    /// Title of the test.
    pub title: String,
}

pub(crate) fn run(
    sheet: &MobilitySheet,
    _around: &Surroundings<'_>,
) -> Result<Outcome, RodlabError> {
    Ok(Outcome::of("mobility", sheet.title.as_str()))
}

//! Loss factor from creep recovery.

use serde::Deserialize;

use super::Surroundings;
use crate::{Outcome, RodlabError};

/// Sheet of the job.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecoverySheet {
    /// Title of the test.
    pub title: String,
}

pub(crate) fn run(
    sheet: &RecoverySheet,
    _around: &Surroundings<'_>,
) -> Result<Outcome, RodlabError> {
    Ok(Outcome::of("recovery", sheet.title.as_str()))
}

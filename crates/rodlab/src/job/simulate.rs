//! A virtual test, for planning and for trying the other commands.

use serde::Deserialize;

use super::Surroundings;
use crate::{Outcome, RodlabError};

/// Sheet of the job.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SimulateSheet {
    /// Title of the test.
    pub title: String,
}

pub(crate) fn run(
    sheet: &SimulateSheet,
    _around: &Surroundings<'_>,
) -> Result<Outcome, RodlabError> {
    Ok(Outcome::of("simulate", sheet.title.as_str()))
}

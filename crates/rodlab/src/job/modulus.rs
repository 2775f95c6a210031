//! Complex modulus of a rod.

use serde::Deserialize;

use super::Surroundings;
use crate::{Outcome, RodlabError};

/// Sheet of the job.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModulusSheet {
    /// Title of the test.
    pub title: String,
}

pub(crate) fn run(
    sheet: &ModulusSheet,
    _around: &Surroundings<'_>,
) -> Result<Outcome, RodlabError> {
    Ok(Outcome::of("modulus", sheet.title.as_str()))
}

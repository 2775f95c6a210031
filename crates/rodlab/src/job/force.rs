//! Force between two bodies that meet, from their mobilities (Ödeen 1993, paper E), or force on a
//! body, from a measured response.

mod bodies;
mod draws;
mod histories;
mod impact;
mod impact_figures;
mod impact_lines;
mod impact_march;
mod impact_sheet;
mod impact_tables;
mod response;
mod response_answer;
mod response_band;
mod response_figures;
mod response_problem;
mod response_sheet;
mod response_solve;
mod response_tables;

pub use impact_sheet::{ContactSheet, ImpactSheet, Line, UncertaintySheet};
pub use response_sheet::{
    IntervalSheet, NoiseSheet, PathSheet, RegularisationSheet, ResponseSheet,
};

use serde::Deserialize;

use super::{About, JobContext};
use crate::bodies::material_sheet;
use crate::bodies::material_sheet::Materials;
use crate::{Outcome, RodlabError};

/// Sheet of the job.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceSheet {
    /// Title of the test.
    pub title: String,
    /// Free texts for the report.
    #[serde(default)]
    pub about: About,
    /// Materials of the bodies, by name.
    #[serde(default)]
    pub materials: Materials,
    /// The force to be found.
    pub problem: Problem,
    /// Number of Monte Carlo draws, such as 1000, of the mobilities and of every quantity stated
    /// with ±; they check the errors of an impact.
    pub monte_carlo: Option<usize>,
}

/// The force to be found.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(
    clippy::large_enum_variant,
    reason = "a sheet has one problem; it is read once and never moved about"
)]
pub enum Problem {
    /// Force between two bodies that meet.
    Impact(ImpactSheet),
    /// Force determined from a measured response.
    Response(ResponseSheet),
}

pub(crate) fn run(sheet: &ForceSheet, context: &JobContext<'_>) -> Result<Outcome, RodlabError> {
    let mut outcome = Outcome::of("force", sheet.title.as_str());
    match &sheet.problem {
        Problem::Impact(problem) => {
            let mut materials =
                material_sheet::read(&sheet.materials, context.folder, &mut outcome)?;
            if let Some(draw) = &context.draw {
                for material in materials.values_mut() {
                    if let Some(measured) = &material.measured {
                        material.measured = Some(measured.moved(|_| Ok(draw.standard()))?);
                    }
                }
            }
            impact::run(problem, &materials, context, &mut outcome)?;
        }
        Problem::Response(problem) => {
            if let Some(name) = sheet.materials.keys().next() {
                return Err(RodlabError::request(
                    "materials",
                    format!("`{name}`"),
                    "none: a force from a response has no computed bodies",
                ));
            }
            if let Some(n_draws) = sheet.monte_carlo {
                return Err(RodlabError::request(
                    "monte_carlo",
                    n_draws.to_string(),
                    "none: the bands of a force from a response come from the draws stated in `problem.uncertainty.draws`",
                ));
            }
            response::run(problem, context, &mut outcome)?;
        }
    }
    Ok(outcome)
}

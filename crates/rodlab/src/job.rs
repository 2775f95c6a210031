//! The jobs of the commands: each takes a sheet and returns an [`Outcome`].

pub mod bar;
pub mod fit;
pub mod force;
pub mod frf;
pub mod identify;
pub mod mobility;
pub mod modulus;
mod monte_carlo;
pub mod recovery;
mod sheet;
pub mod shpb;
pub mod simulate;

pub use crate::about::About;
pub use crate::context::{JobContext, Progress, Silent};
pub use sheet::{Job, Sheet, parse};

use std::sync::atomic::AtomicBool;

use crate::outcome::{InputFile, Setting};
use crate::{Outcome, RodlabError};

/// Runs the job of `sheet`.
///
/// # Errors
///
/// [`RodlabError`] if the sheet or a file is wrong. Data that do not allow a result are not an
/// error: they are reported in the verdict of the outcome.
pub fn run(
    sheet: &Sheet,
    progress: &dyn Progress,
    interrupted: &AtomicBool,
) -> Result<Outcome, RodlabError> {
    run_in(sheet, &JobContext::of(sheet, progress, interrupted))
}

impl<'a> JobContext<'a> {
    /// Returns the environment of an ordinary run of `sheet`.
    fn of(sheet: &'a Sheet, progress: &'a dyn Progress, interrupted: &'a AtomicBool) -> Self {
        Self {
            folder: sheet.folder(),
            language: sheet.language(),
            progress,
            interrupted,
            only_reads: false,
            draw: None,
        }
    }
}

/// Files of a sheet, all of which could be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Checked {
    /// The files.
    pub inputs: Vec<InputFile>,
    /// Warnings about the sheet and its files, such as a unit in the sheet that contradicts the
    /// unit in a file.
    pub warnings: Vec<String>,
}

/// Reads the files of `sheet`, computes nothing, and returns the files with warnings about them.
///
/// # Errors
///
/// [`RodlabError`] if the sheet or a file is wrong.
pub fn check(
    sheet: &Sheet,
    progress: &dyn Progress,
    interrupted: &AtomicBool,
) -> Result<Checked, RodlabError> {
    let context = JobContext {
        only_reads: true,
        ..JobContext::of(sheet, progress, interrupted)
    };
    match run_in(sheet, &context) {
        Ok(Outcome {
            inputs, warnings, ..
        })
        | Err(RodlabError::ReadOnly { inputs, warnings }) => Ok(Checked { inputs, warnings }),
        Err(error) => Err(error),
    }
}

fn run_in(sheet: &Sheet, context: &JobContext<'_>) -> Result<Outcome, RodlabError> {
    let mut outcome = sheet.job.run(context)?;
    if let Some(n_draws) = sheet.job.monte_carlo() {
        monte_carlo::judge(&mut outcome, sheet, context, n_draws)?;
    }
    let mut outcome = outcome.settled();
    let stated = sheet.statements().into_iter();
    outcome.settle_settings(
        stated
            .map(|statement| Setting {
                name: statement.name,
                value: statement.value,
                by_default: false,
            })
            .collect(),
    );
    Ok(outcome)
}

//! The jobs of the commands: each takes a sheet and returns an [`Outcome`].

pub mod bar;
pub mod fit;
pub mod force;
pub mod frf;
pub mod identify;
pub mod mobility;
pub mod modulus;
pub mod recovery;
pub mod shpb;
pub mod simulate;

pub use crate::about::About;
pub use crate::surroundings::{Progress, Silent, Surroundings};

use std::sync::atomic::AtomicBool;

use crate::outcome::InputFile;
use crate::sheet::{Job, Sheet};
use crate::{Outcome, RodlabError};

/// Does the job of `sheet`.
///
/// # Errors
///
/// [`RodlabError`] if the sheet or a file is wrong. Data that do not allow a result give an outcome
/// with that verdict.
pub fn run(
    sheet: &Sheet,
    progress: &dyn Progress,
    interrupted: &AtomicBool,
) -> Result<Outcome, RodlabError> {
    run_in(
        sheet,
        &Surroundings {
            folder: sheet.folder(),
            language: sheet.language(),
            progress,
            interrupted,
            only_reads: false,
        },
    )
}

/// Reads the files of `sheet`, computes nothing, and returns the files.
///
/// # Errors
///
/// [`RodlabError`] if the sheet or a file is wrong.
pub fn check(
    sheet: &Sheet,
    progress: &dyn Progress,
    interrupted: &AtomicBool,
) -> Result<Vec<InputFile>, RodlabError> {
    let around = Surroundings {
        folder: sheet.folder(),
        language: sheet.language(),
        progress,
        interrupted,
        only_reads: true,
    };
    match run_in(sheet, &around) {
        Ok(outcome) => Ok(outcome.inputs),
        Err(RodlabError::ReadOnly { inputs }) => Ok(inputs),
        Err(error) => Err(error),
    }
}

fn run_in(sheet: &Sheet, around: &Surroundings<'_>) -> Result<Outcome, RodlabError> {
    let outcome = match &sheet.job {
        Job::Frf(sheet) => frf::run(sheet, around),
        Job::Modulus(sheet) => modulus::run(sheet, around),
        Job::Recovery(sheet) => recovery::run(sheet, around),
        Job::Fit(sheet) => fit::run(sheet, around),
        Job::Identify(sheet) => identify::run(sheet, around),
        Job::Mobility(sheet) => mobility::run(sheet, around),
        Job::Force(sheet) => force::run(sheet, around),
        Job::Bar(sheet) => bar::run(sheet, around),
        Job::Shpb(sheet) => shpb::run(sheet, around),
        Job::Simulate(sheet) => simulate::run(sheet, around),
    };
    outcome.map(Outcome::settled)
}

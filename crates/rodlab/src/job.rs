//! The jobs of the commands: each takes a sheet and returns an [`Outcome`].

mod about;
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

pub use about::About;

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::outcome::InputFile;
use crate::sheet::{Job, Language, Sheet};
use crate::{Outcome, RodlabError};

/// The environment of a job: the folder of its relative paths, the language of its sheet, its
/// progress display and its interruption.
#[derive(Debug)]
pub struct Surroundings<'a> {
    /// The folder of the relative paths in the sheet.
    pub folder: &'a Path,
    /// The language of the sheet.
    pub language: Language,
    /// Receiver of the current step and the number of finished parts.
    pub progress: &'a dyn Progress,
    /// Set to stop the job.
    pub interrupted: &'a AtomicBool,
    /// Ends the job when it has read everything ([`check`]).
    pub only_reads: bool,
}

impl Surroundings<'_> {
    /// Fails if the job must stop. Long jobs call this between their steps.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Interrupted`].
    pub fn go_on(&self) -> Result<(), RodlabError> {
        if self.interrupted.load(Ordering::Relaxed) {
            Err(RodlabError::Interrupted)
        } else {
            Ok(())
        }
    }

    /// Ends a job that only reads. Each job calls this when it has read all its files, the
    /// `inputs`, and checked its sheet, before it computes.
    ///
    /// # Errors
    ///
    /// [`RodlabError::ReadOnly`] if nothing is to be computed.
    pub fn has_read_all(&self, inputs: &[InputFile]) -> Result<(), RodlabError> {
        if self.only_reads {
            Err(RodlabError::ReadOnly {
                inputs: inputs.to_vec(),
            })
        } else {
            self.go_on()
        }
    }
}

/// Receiver of the progress of a job.
pub trait Progress: std::fmt::Debug + Sync {
    /// Reports the start of `step` with `of` parts, 0 if unknown.
    fn begins(&self, step: &str, of: usize);
    /// Reports that one part is done.
    fn one_more(&self);
}

/// Progress that is not displayed.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begins(&self, _step: &str, _of: usize) {}
    fn one_more(&self) {}
}

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

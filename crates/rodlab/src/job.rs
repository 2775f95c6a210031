//! What each command does: a sheet in, an [`Outcome`] out.

mod about;
pub mod force;
pub mod frf;
pub mod identify;
pub mod mobility;
pub mod modulus;
pub mod recovery;
pub mod simulate;

pub use about::About;

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::sheet::{Job, Sheet};
use crate::{Outcome, RodlabError};

/// What surrounds a job: where its paths start, who is told how far it is, and whether somebody wants it to stop.
#[derive(Debug)]
pub struct Surroundings<'a> {
    /// The folder that relative paths of the sheet start from.
    pub folder: &'a Path,
    /// Told what is being done, and how many of how many steps are.
    pub progress: &'a dyn Progress,
    /// Set when the job should stop.
    pub interrupted: &'a AtomicBool,
    /// Whether the job ends once it has read everything ([`check`]).
    pub only_reads: bool,
}

impl Surroundings<'_> {
    /// Fails if somebody wants the job to stop. Long jobs ask between their steps.
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

    /// Every job calls this when it has read all its files and understood its sheet, before it computes.
    ///
    /// # Errors
    ///
    /// [`RodlabError::ReadOnly`] if nothing is to be computed.
    pub fn has_read_all(&self) -> Result<(), RodlabError> {
        if self.only_reads {
            Err(RodlabError::ReadOnly)
        } else {
            self.go_on()
        }
    }
}

/// Somebody who wants to know how far a job is.
pub trait Progress: std::fmt::Debug + Sync {
    /// `step` begins; it has `of` parts, 0 if that is not known.
    fn begins(&self, step: &str, of: usize);
    /// One part is done.
    fn one_more(&self);
}

/// Nobody.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begins(&self, _step: &str, _of: usize) {}
    fn one_more(&self) {}
}

/// Does what `sheet` asks for.
///
/// # Errors
///
/// [`RodlabError`] where the sheet or a file is wrong. Data that do not allow a result are an outcome that says so.
pub fn run(
    sheet: &Sheet,
    progress: &dyn Progress,
    interrupted: &AtomicBool,
) -> Result<Outcome, RodlabError> {
    run_in(
        sheet,
        &Surroundings {
            folder: sheet.folder(),
            progress,
            interrupted,
            only_reads: false,
        },
    )
}

/// Reads what `sheet` names and computes nothing.
///
/// # Errors
///
/// [`RodlabError`] where the sheet or a file is wrong.
pub fn check(
    sheet: &Sheet,
    progress: &dyn Progress,
    interrupted: &AtomicBool,
) -> Result<(), RodlabError> {
    let around = Surroundings {
        folder: sheet.folder(),
        progress,
        interrupted,
        only_reads: true,
    };
    match run_in(sheet, &around) {
        Ok(_) | Err(RodlabError::ReadOnly) => Ok(()),
        Err(error) => Err(error),
    }
}

fn run_in(sheet: &Sheet, around: &Surroundings<'_>) -> Result<Outcome, RodlabError> {
    let outcome = match &sheet.job {
        Job::Frf(sheet) => frf::run(sheet, around),
        Job::Modulus(sheet) => modulus::run(sheet, around),
        Job::Recovery(sheet) => recovery::run(sheet, around),
        Job::Identify(sheet) => identify::run(sheet, around),
        Job::Mobility(sheet) => mobility::run(sheet, around),
        Job::Force(sheet) => force::run(sheet, around),
        Job::Simulate(sheet) => simulate::run(sheet, around),
    };
    outcome.map(Outcome::settled)
}

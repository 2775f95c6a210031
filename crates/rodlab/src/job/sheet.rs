//! Parsed sheets, each with its job.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::JobContext;
use super::{bar, fit, force, frf, identify, mobility, modulus, recovery, shpb, simulate};
use crate::sheet::{self, Language, SheetError, Statement};
use crate::{Outcome, RodlabError};

/// A parsed sheet with its path and text.
#[derive(Debug, Clone)]
pub struct Sheet {
    /// Path as it was given.
    pub path: PathBuf,
    /// Text of the file, with a byte-order mark if it has one.
    pub text: String,
    /// The requested job.
    pub job: Job,
}

/// Job of a sheet, with the statements of the sheet.
#[derive(Debug, Clone, Deserialize)]
#[non_exhaustive]
#[allow(
    clippy::large_enum_variant,
    reason = "a sheet contains only one of these, and is short compared with a record"
)]
pub enum Job {
    /// Frequency responses of hits.
    Frf(Box<frf::FrfSheet>),
    /// Complex modulus of a rod.
    Modulus(Box<modulus::ModulusSheet>),
    /// Loss factor from creep recovery.
    Recovery(Box<recovery::RecoverySheet>),
    /// Laws and master curve from tables of a modulus.
    Fit(Box<fit::FitSheet>),
    /// Constitutive law from two velocity histories.
    Identify(Box<identify::IdentifySheet>),
    /// Mobility of an impact face.
    Mobility(Box<mobility::MobilitySheet>),
    /// Force between two bodies, or from a response.
    Force(Box<force::ForceSheet>),
    /// Propagation of waves in a long bar, from one or more shots.
    Bar(Box<bar::BarSheet>),
    /// Stress-strain curve from split Hopkinson bars.
    Shpb(Box<shpb::ShpbSheet>),
    /// A virtual test.
    Simulate(Box<simulate::SimulateSheet>),
}

impl Job {
    /// Returns the name of the job, which is also the name of its command.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Frf(_) => "frf",
            Self::Modulus(_) => "modulus",
            Self::Recovery(_) => "recovery",
            Self::Fit(_) => "fit",
            Self::Identify(_) => "identify",
            Self::Mobility(_) => "mobility",
            Self::Force(_) => "force",
            Self::Bar(_) => "bar",
            Self::Shpb(_) => "shpb",
            Self::Simulate(_) => "simulate",
        }
    }
}

impl Job {
    /// Runs the job, without a Monte Carlo computation of the whole job.
    pub(super) fn run(&self, context: &JobContext<'_>) -> Result<Outcome, RodlabError> {
        match self {
            Self::Frf(sheet) => frf::run(sheet, context),
            Self::Modulus(sheet) => modulus::run(sheet, context),
            Self::Recovery(sheet) => recovery::run(sheet, context),
            Self::Fit(sheet) => fit::run(sheet, context),
            Self::Identify(sheet) => identify::run(sheet, context),
            Self::Mobility(sheet) => mobility::run(sheet, context),
            Self::Force(sheet) => force::run(sheet, context),
            Self::Bar(sheet) => bar::run(sheet, context),
            Self::Shpb(sheet) => shpb::run(sheet, context),
            Self::Simulate(sheet) => simulate::run(sheet, context),
        }
    }

    /// Returns the number of draws of a Monte Carlo computation of the whole job, if the sheet
    /// requests one. `None` for split Hopkinson bars, because that job makes its draws itself.
    pub(super) fn monte_carlo(&self) -> Option<usize> {
        match self {
            Self::Modulus(sheet) => sheet.monte_carlo,
            Self::Bar(sheet) => sheet.monte_carlo,
            Self::Recovery(sheet) => sheet.monte_carlo,
            Self::Fit(sheet) => sheet.monte_carlo,
            Self::Identify(sheet) => sheet.monte_carlo,
            Self::Force(sheet) => sheet.monte_carlo,
            _ => None,
        }
    }

    /// Removes the Monte Carlo draws from the sheet, and the laws from a sheet for a modulus.
    /// Returns true if there was anything to remove.
    pub(crate) fn leave_out_what_takes_long(&mut self) -> bool {
        let draws = match self {
            Self::Modulus(sheet) => {
                let laws = sheet.laws.take().is_some();
                return sheet.monte_carlo.take().is_some() || laws;
            }
            Self::Bar(sheet) => &mut sheet.monte_carlo,
            Self::Recovery(sheet) => &mut sheet.monte_carlo,
            Self::Fit(sheet) => &mut sheet.monte_carlo,
            Self::Identify(sheet) => &mut sheet.monte_carlo,
            Self::Force(sheet) => &mut sheet.monte_carlo,
            _ => return false,
        };
        draws.take().is_some()
    }
}

impl Sheet {
    /// Reads the sheet at `path`.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Read`] for a file that cannot be read; [`RodlabError::NoSheet`] for a
    /// recording; [`RodlabError::Encoding`] for a text that is not UTF-8; [`RodlabError::Sheet`]
    /// for a mistake, with its place in the text.
    pub fn read(path: &Path) -> Result<Self, RodlabError> {
        let (text, job) = sheet::read(path)?;
        Ok(Self {
            path: path.to_path_buf(),
            text,
            job,
        })
    }

    /// Returns the language of the sheet.
    #[must_use]
    pub fn language(&self) -> Language {
        sheet::language_of(&self.text)
    }

    /// Returns all statements of the sheet except its title, as written, with their places.
    pub(crate) fn statements(&self) -> Vec<Statement> {
        let mut statements = sheet::statements::<Job>(&self.text);
        statements.retain(|statement| statement.name != "title");
        statements
    }

    /// Returns the folder to which paths in the sheet are relative.
    #[must_use]
    pub fn folder(&self) -> &Path {
        match self.path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        }
    }
}

/// Parses the job of the text of a sheet; `path` is used only in error messages. A leading
/// byte-order mark is ignored.
///
/// # Errors
///
/// [`SheetError`] with the place, the field, the text found and the text expected.
pub fn parse(path: &Path, text: &str) -> Result<Job, Box<SheetError>> {
    sheet::parse_as(path, text)
}

//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

/// From recordings of struck rods to a complex modulus, a constitutive law or an impact force, with their errors.
#[derive(Debug, Parser)]
#[command(name = "rodlab", version, max_term_width = 100)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Say nothing but errors.
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// Print result.json on the standard output instead of words.
    #[arg(long, global = true)]
    pub json: bool,
}

/// The commands.
#[derive(Debug, Subcommand)]
#[non_exhaustive]
pub enum Command {
    /// Frequency responses of hits, with coherence and errors.
    Frf(SheetCommand),
    /// Complex modulus of a rod from the motion of its sections.
    Modulus(SheetCommand),
    /// Loss factor from creep recovery.
    Recovery(SheetCommand),
    /// Constitutive law from two histories of an impacted rod.
    Identify(SheetCommand),
    /// Mobility of an impact face, screened and completed.
    Mobility(SheetCommand),
    /// Force between two bodies that meet, or from a measured response.
    Force(SheetCommand),
    /// A virtual test, for planning and for trying the other commands.
    Simulate(SheetCommand),
}

/// A sheet, and where its results go.
#[derive(Debug, Args)]
pub struct SheetCommand {
    /// The test sheet.
    pub sheet: PathBuf,
    /// Folder for the results; by default beside the sheet, with its name.
    #[arg(long, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
}

impl Command {
    /// The job and the sheet of a command that has one.
    #[must_use]
    pub fn sheet(&self) -> Option<(&'static str, &SheetCommand)> {
        match self {
            Self::Frf(sheet) => Some(("frf", sheet)),
            Self::Modulus(sheet) => Some(("modulus", sheet)),
            Self::Recovery(sheet) => Some(("recovery", sheet)),
            Self::Identify(sheet) => Some(("identify", sheet)),
            Self::Mobility(sheet) => Some(("mobility", sheet)),
            Self::Force(sheet) => Some(("force", sheet)),
            Self::Simulate(sheet) => Some(("simulate", sheet)),
        }
    }
}

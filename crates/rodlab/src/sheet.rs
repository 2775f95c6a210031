//! Test sheets: specimen, sensors, files and processing of a test, in TOML, RON or JSON.
//!
//! A sheet names its job and states its fields. In TOML:
//!
//! ```toml
//! job = "modulus"
//! title = "Polypropylene rod, test 6"
//!
//! [specimen]
//! length = "799 mm"
//! diameter = "15.8 mm"
//! density = "912 kg/m3"
//! accelerometer_mass = "2.9 gram"
//!
//! [method.two_point]
//! impacted_end = "struck end"
//! free_end = "free end"
//! ```
//!
//! and in RON:
//!
//! ```ron
//! Modulus(
//!     title: "Polypropylene rod, test 6",
//!     specimen: (length: "799 mm", diameter: "15.8 mm", density: "912 kg/m3", accelerometer_mass: "2.9 gram"),
//!     method: TwoPoint(impacted_end: "struck end", free_end: "free end"),
//! )
//! ```
//!
//! [`Language`] tells them apart by their content. All languages are read to one tree of values
//! with places, and from there by one deserializer, which maps the names of choices (`two_point`,
//! `TwoPoint`) and gathers all mistakes.
//!
//! Quantities are texts with a unit. A measured quantity whose uncertainty the job propagates to
//! the result takes a `±` ([`Stated`]). Any other is refused with a `±`: chosen quantities are
//! exact by definition ([`Exact`]), and for some measured ones the propagation is not implemented
//! ([`NotFollowed`]). Thus no `±` is without effect. Numbers without quotes are exact by
//! definition. Paths are relative to the sheet.

pub mod body;
mod diagnostic;
mod encoding;
mod exact;
mod kind;
mod language;
pub mod material;
pub mod measured;
pub(crate) mod measured_material;
mod mistake;
pub(crate) mod plausible;
pub(crate) mod replacement;
mod stated;
mod toml_text;
mod tree;
mod typed;

pub use diagnostic::SheetError;
pub(crate) use exact::ADVICE;
pub use exact::{ByDefinition, Exact, NoWay, NotFollowed, Reason};
pub use kind::{
    AddedMass, Coordinate, Density, Duration, Force, Frequency, ImpactMass, Kind, Length,
    PoissonRatio, Pressure, Ratio, SpecificImpedance, Stiffness, Stress, Temperature, Time,
    Velocity, Viscosity,
};
pub use language::Language;
pub use stated::{Stated, ValueWithUncertainty, Written};
pub(crate) use stated::{number_and_unit, value_and_uncertainty};
pub(crate) use typed::Statement;

use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::{RodlabError, input, job};

/// A parsed sheet.
#[derive(Debug, Clone)]
pub struct Sheet {
    /// Path as it was given.
    pub path: PathBuf,
    /// Text of the file, with a byte-order mark if it has one.
    pub text: String,
    /// The requested job.
    pub job: Job,
}

/// The job of a sheet with its statements.
#[derive(Debug, Clone, Deserialize)]
#[non_exhaustive]
#[allow(
    clippy::large_enum_variant,
    reason = "there is one of them in a sheet, and no sheet is as long as a record"
)]
pub enum Job {
    /// Frequency responses of hits.
    Frf(Box<job::frf::FrfSheet>),
    /// Complex modulus of a rod.
    Modulus(Box<job::modulus::ModulusSheet>),
    /// Loss factor from creep recovery.
    Recovery(Box<job::recovery::RecoverySheet>),
    /// Laws and master curve from tables of a modulus.
    Fit(Box<job::fit::FitSheet>),
    /// Constitutive law from two velocity histories.
    Identify(Box<job::identify::IdentifySheet>),
    /// Mobility of an impact face.
    Mobility(Box<job::mobility::MobilitySheet>),
    /// Force between two bodies, or from a response.
    Force(Box<job::force::ForceSheet>),
    /// Propagation of waves in a long bar, from one shot on it.
    Bar(Box<job::bar::BarSheet>),
    /// Stress-strain curve from split Hopkinson bars.
    Shpb(Box<job::shpb::ShpbSheet>),
    /// A virtual test.
    Simulate(Box<job::simulate::SimulateSheet>),
}

impl Job {
    /// Name of the job and of its command.
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

impl Sheet {
    /// Reads the sheet at `path`.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Read`]; [`RodlabError::NoSheet`] for a recording, [`RodlabError::Encoding`]
    /// for a text that is not UTF-8; [`RodlabError::Sheet`] with the place in the text.
    pub fn read(path: &Path) -> Result<Self, RodlabError> {
        let bytes = input::read(path)?;
        let text = encoding::text_of(path, &bytes)?;
        let job =
            parse(path, &text).map_err(|error| encoding::or_recording(path, &bytes, error))?;
        Ok(Self {
            path: path.to_path_buf(),
            text,
            job,
        })
    }

    /// The language of its text.
    #[must_use]
    pub fn language(&self) -> Language {
        Language::of(without_mark(&self.text)).unwrap_or(Language::Toml)
    }

    /// All that the sheet states but its title, by its place and as it is written.
    pub(crate) fn statements(&self) -> Vec<Statement> {
        let text = without_mark(&self.text);
        let read = tree::of(text).and_then(|(language, root)| typed::read::<Job>(language, &root));
        let (_, mut statements) = read.unwrap_or_else(|_| (self.job.clone(), Vec::new()));
        statements.retain(|statement| statement.name != "title");
        statements
    }

    /// The folder of the relative paths in the sheet.
    #[must_use]
    pub fn folder(&self) -> &Path {
        match self.path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        }
    }
}

/// Parses the job of the text of a sheet; `path` is only named in errors. A leading byte-order mark
/// is ignored.
///
/// # Errors
///
/// [`SheetError`] with the place, the field, the text found and the text expected.
pub fn parse(path: &Path, text: &str) -> Result<Job, Box<SheetError>> {
    parse_as(path, text)
}

/// Parses the text of any file in the grammar of sheets, like [`parse`].
pub(crate) fn parse_as<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, Box<SheetError>> {
    let text = without_mark(text);
    let read = tree::of(text).and_then(|(language, root)| typed::read(language, &root));
    read.map(|(value, _)| value)
        .map_err(|mistakes| SheetError::of(path, text, mistakes))
}

/// The text of a sheet in RON, in TOML. Comments above and behind its fields stay with them.
///
/// # Errors
///
/// [`SheetError`] for a text that is no sheet in its language.
pub fn in_toml(path: &Path, text: &str) -> Result<String, Box<SheetError>> {
    let text = without_mark(text);
    let (_, root) = tree::of(text).map_err(|mistakes| SheetError::of(path, text, mistakes))?;
    Ok(toml_text::of(text, &root))
}

/// Returns true for a text in TOML with a line `job = ...`, however wrong the rest is.
pub(crate) fn names_a_job(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let mut lines = without_mark(&text).lines().map(str::trim_start);
    lines.any(|line| {
        let value = line.trim_start_matches(['"', '\'']).strip_prefix(tree::JOB);
        value.is_some_and(|value| {
            value
                .trim_start_matches(['"', '\'', ' ', '\t'])
                .starts_with('=')
        })
    })
}

fn without_mark(text: &str) -> &str {
    text.strip_prefix(encoding::MARK).unwrap_or(text)
}

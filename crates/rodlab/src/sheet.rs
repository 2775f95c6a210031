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
//! [`Language`] recognises the language of a text by its content. A text in any of these languages
//! is read into the same kind of tree, whose values have their places in the text. One deserializer
//! reads the tree, maps the names of choices (`two_point`, `TwoPoint`) and collects all mistakes.
//!
//! Quantities are written as texts with a unit. A measured quantity may have a `±` if the job
//! propagates its uncertainty to the result ([`Stated`]). Any other quantity is refused if it has a
//! `±`: chosen quantities are exact by definition ([`Exact`]), and for some measured quantities the
//! propagation is not implemented ([`NotFollowed`]). Thus every accepted `±` has an effect. Numbers
//! without quotes are exact by definition. Paths are relative to the sheet.

mod band;
mod diagnostic;
pub(crate) mod edit;
mod encoding;
mod exact;
mod kind;
mod language;
mod mistake;
pub(crate) mod plausible;
mod quantity_text;
mod stated;
mod toml_text;
mod tree;
mod typed;

pub use band::BandSheet;
pub use diagnostic::SheetError;
pub(crate) use exact::ADVICE;
pub use exact::{ByDefinition, Exact, NoWay, NotFollowed, Reason};
pub use kind::{
    AddedMass, Coordinate, Density, Duration, Force, Frequency, ImpactMass, Kind, Length,
    PerKelvin, PoissonRatio, Pressure, Ratio, SpecificImpedance, Stiffness, Stress, Temperature,
    Time, Velocity, Viscosity,
};
pub use language::Language;
pub(crate) use language::snake_case;
pub(crate) use mistake::{nearest, quoted};
pub(crate) use quantity_text::{number_and_unit, value_and_uncertainty};
pub use stated::{Stated, ValueWithUncertainty, Written};
pub(crate) use typed::Statement;

use std::path::Path;

use rand_chacha::ChaCha8Rng;
use serde::de::DeserializeOwned;

use crate::{RodlabError, input};

/// Parses the text of a file in the grammar of sheets; `path` is used only in error messages. A
/// leading byte-order mark is ignored.
///
/// # Errors
///
/// [`SheetError`] with the place, the field, the text found and the text expected.
pub(crate) fn parse_as<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, Box<SheetError>> {
    let text = without_mark(text);
    let read = tree::of(text).and_then(|(language, root)| typed::read(language, &root));
    read.map(|(value, _)| value)
        .map_err(|mistakes| SheetError::of(path, text, mistakes))
}

/// Parses `text` as `T` with every quantity drawn within its stated uncertainty; `path` is used
/// only in error messages.
///
/// # Errors
///
/// [`SheetError`] for a drawn value that the field does not accept, such as a length below 0.
pub(crate) fn drawn_as<T: DeserializeOwned>(
    path: &Path,
    text: &str,
    random: ChaCha8Rng,
) -> Result<T, Box<SheetError>> {
    let text = without_mark(text);
    tree::of(text)
        .and_then(|(language, root)| typed::read_drawn(language, &root, random))
        .map_err(|mistakes| SheetError::of(path, text, mistakes))
}

/// Reads the file at `path`; returns its text and its value as a `T`.
///
/// # Errors
///
/// [`RodlabError::Read`] for a file that cannot be read; [`RodlabError::NoSheet`] for a recording;
/// [`RodlabError::Encoding`] for a text that is not UTF-8; [`RodlabError::Sheet`] for a mistake,
/// with its place in the text.
pub(crate) fn read<T: DeserializeOwned>(path: &Path) -> Result<(String, T), RodlabError> {
    let bytes = input::read(path)?;
    let text = encoding::text_of(path, &bytes)?;
    let value =
        parse_as(path, &text).map_err(|error| encoding::or_recording(path, &bytes, error))?;
    Ok((text, value))
}

/// Reads the text of the file at `path`.
pub(crate) fn text(path: &Path) -> Result<String, RodlabError> {
    encoding::text_of(path, &input::read(path)?)
}

/// Returns every statement of `text`, a sheet of type `T`, with its place and its value as written.
pub(crate) fn statements<T: DeserializeOwned>(text: &str) -> Vec<Statement> {
    let read =
        tree::of(without_mark(text)).and_then(|(language, root)| typed::read::<T>(language, &root));
    read.map(|(_, statements)| statements).unwrap_or_default()
}

/// Returns the language of a text with or without a byte-order mark; TOML if no language is
/// recognised.
pub(crate) fn language_of(text: &str) -> Language {
    Language::of(without_mark(text)).unwrap_or(Language::Toml)
}

/// Converts the text of a sheet to TOML. Comments above and after a field stay with the field.
///
/// # Errors
///
/// [`SheetError`] for a text that is not a sheet in any of the languages.
pub fn in_toml(path: &Path, text: &str) -> Result<String, Box<SheetError>> {
    let text = without_mark(text);
    let (_, root) = tree::of(text).map_err(|mistakes| SheetError::of(path, text, mistakes))?;
    Ok(toml_text::of(text, &root))
}

/// Returns true for a text in TOML with a line `job = ...`, even if the rest contains mistakes.
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

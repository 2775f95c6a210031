//! Which sheets a campaign has.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::RodlabError;
use crate::output::RESULT;

/// A test of a campaign.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Test {
    /// Path of the sheet from the folder that all have in common, without extension and with slashes; the folder of its
    /// result has this name.
    pub name: String,
    /// Path of the sheet.
    pub sheet: PathBuf,
}

/// The tests that `places` name: sheets, folders with sheets in them or in their folders, and patterns; in order of their names.
///
/// Folders that hold a result are not looked into.
///
/// # Errors
///
/// [`RodlabError::NoFile`] for a place without a sheet, [`RodlabError::Read`] for a folder that cannot be read, and
/// [`RodlabError::Request`] if two sheets differ in nothing but the extension.
pub fn tests_of(places: &[String]) -> Result<Vec<Test>, RodlabError> {
    let mut sheets = Vec::new();
    for place in places {
        let path = Path::new(place);
        let before = sheets.len();
        if path.is_dir() {
            in_folder(path, &mut sheets)?;
        } else if path.exists() {
            sheets.push(path.to_path_buf());
        } else {
            let listed = glob::glob(place).map_err(|error| {
                RodlabError::request(
                    "sheets",
                    format!("`{place}`, {error}"),
                    "a sheet, a folder or a pattern",
                )
            })?;
            for found in listed {
                let found = found.map_err(|error| RodlabError::Read {
                    path: error.path().to_path_buf(),
                    source: error.into(),
                })?;
                if found.is_dir() {
                    in_folder(&found, &mut sheets)?;
                } else {
                    sheets.push(found);
                }
            }
        }
        if sheets.len() == before {
            return Err(RodlabError::NoFile {
                pattern: place.clone(),
                folder: PathBuf::from("."),
            });
        }
    }
    sheets.sort();
    sheets.dedup();
    named(sheets)
}

/// All files `*.ron` in `folder` and below.
fn in_folder(folder: &Path, sheets: &mut Vec<PathBuf>) -> Result<(), RodlabError> {
    if folder.join(RESULT).exists() {
        return Ok(());
    }
    let fail = |source| RodlabError::Read {
        path: folder.to_path_buf(),
        source,
    };
    for entry in fs::read_dir(folder).map_err(fail)? {
        let path = entry.map_err(fail)?.path();
        if path.is_dir() {
            in_folder(&path, sheets)?;
        } else if path.extension().is_some_and(|extension| extension == "ron") {
            sheets.push(path);
        }
    }
    Ok(())
}

fn named(sheets: Vec<PathBuf>) -> Result<Vec<Test>, RodlabError> {
    let common = sheets
        .iter()
        .map(|sheet| sheet.parent().unwrap_or(Path::new("")).to_path_buf())
        .reduce(|common, folder| {
            common
                .components()
                .zip(folder.components())
                .take_while(|(a, b)| a == b)
                .map(|(part, _)| part)
                .collect()
        })
        .unwrap_or_default();
    let mut tests: BTreeMap<String, PathBuf> = BTreeMap::new();
    for sheet in sheets {
        let short = sheet.strip_prefix(&common).unwrap_or(&sheet);
        let name = short
            .with_extension("")
            .to_string_lossy()
            .replace('\\', "/");
        if let Some(other) = tests.insert(name.clone(), sheet.clone()) {
            return Err(RodlabError::request(
                "sheets",
                format!("{} and {}", other.display(), sheet.display()),
                "names that differ without the extension: a result has the name of its sheet",
            ));
        }
    }
    Ok(tests
        .into_iter()
        .map(|(name, sheet)| Test { name, sheet })
        .collect())
}

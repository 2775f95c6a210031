//! Comparison of a result, and of the earlier results that it uses, with their sheets and files.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use labio::ContentHash;
use serde::{Deserialize, Serialize};

use crate::outcome::InputFile;
use crate::output::{OutputFile, RESULT, SheetIdentity};
use crate::{InStep, RodlabError, input, material_file};

/// Comparison of a result with its sheet and its files.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Verified {
    /// Folder of the result.
    pub result: PathBuf,
    /// Number of files that were compared: the sheet, its inputs, and the files of the result.
    pub compared: usize,
    /// Changed and missing files, one clause each; empty for an unchanged result.
    pub changed: Vec<String>,
    /// Comparisons of the results from which the inputs came, if the folders of these results
    /// exist.
    pub ancestors: Vec<Self>,
}

impl Verified {
    /// Returns true if neither the result nor any earlier result that it uses has changed.
    #[must_use]
    pub fn is_as_it_was(&self) -> bool {
        self.changed.is_empty() && self.ancestors.iter().all(Self::is_as_it_was)
    }

    /// Returns one line for each result; the earlier results that it uses follow it.
    #[must_use]
    pub fn in_words(&self) -> Vec<String> {
        let folder = self.result.display();
        let own = if self.changed.is_empty() {
            format!("{folder}: unchanged, {} files", self.compared)
        } else {
            format!("{folder}: {}", self.changed.join("; "))
        };
        let of_ancestors = self.ancestors.iter().flat_map(Self::in_words);
        std::iter::once(own).chain(of_ancestors).collect()
    }
}

/// The parts of `result.json` that name files.
#[derive(Debug, Deserialize)]
struct Written {
    sheet: SheetIdentity,
    inputs: Vec<InputFile>,
    outputs: Vec<OutputFile>,
}

/// Compares the result in `folder` with its files, like [`verify`]. If `folder` is the folder of a
/// campaign, all results below it are compared, in the order of their names. The sheets of a
/// campaign are in the same subfolders of `sheets` as their results in `folder`.
///
/// # Errors
///
/// The errors of [`verify`]; [`RodlabError::NoFile`] for a folder without results.
pub fn verify_all(folder: &Path, sheets: Option<&Path>) -> Result<Vec<Verified>, RodlabError> {
    if folder.join(RESULT).exists() || !folder.is_dir() {
        return verify(folder, sheets).map(|found| vec![found]);
    }
    let mut results = Vec::new();
    results_below(folder, &mut results)?;
    if results.is_empty() {
        return Err(RodlabError::no_file(RESULT, folder, ""));
    }
    results.sort();
    let compared = results.iter().map(|result| {
        let within = result
            .parent()
            .and_then(|one| one.strip_prefix(folder).ok());
        let own = sheets.map(|sheets| sheets.join(within.unwrap_or(Path::new(""))));
        verify(result, own.as_deref())
    });
    compared.collect()
}

fn results_below(folder: &Path, results: &mut Vec<PathBuf>) -> Result<(), RodlabError> {
    let fail = |source| RodlabError::read(folder, source);
    for entry in std::fs::read_dir(folder).map_err(fail)? {
        let path = entry.map_err(fail)?.path();
        if path.join(RESULT).is_file() {
            results.push(path.clone());
        }
        if path.is_dir() {
            results_below(&path, results)?;
        }
    }
    Ok(())
}

/// Compares the result in `folder` with its files by their hashes. Its sheet is expected in the
/// folder `sheets`, by default next to `folder`; the paths of inputs are relative to the sheet. If
/// an input is the material of another result, this other result is compared too.
///
/// # Errors
///
/// [`RodlabError::Read`] for a folder without `result.json`, [`RodlabError::Step`] for a
/// `result.json` that cannot be parsed.
pub fn verify(folder: &Path, sheets: Option<&Path>) -> Result<Verified, RodlabError> {
    verified(folder, sheets, &mut BTreeSet::new())
}

fn verified(
    folder: &Path,
    sheets: Option<&Path>,
    met: &mut BTreeSet<PathBuf>,
) -> Result<Verified, RodlabError> {
    let path = folder.join(RESULT);
    let bytes = input::read(&path)?;
    let written: Written =
        serde_json::from_slice(&bytes).in_step(format!("reading {}", path.display()))?;
    let beside = folder.parent().unwrap_or(Path::new("."));
    let of_sheet = sheets.unwrap_or(beside);
    let mut found = Verified {
        result: folder.to_path_buf(),
        compared: 0,
        changed: Vec::new(),
        ancestors: Vec::new(),
    };
    let mut compare = |what: &str, name: &str, place: &Path, sha256: &str| {
        found.compared += 1;
        match input::read(&place.join(name)) {
            Ok(bytes) if ContentHash::of(&bytes).to_string() == sha256 => {}
            Ok(_) => found.changed.push(format!("{what} {name} has changed")),
            Err(_) => found.changed.push(format!("{what} {name} is missing")),
        }
    };
    let SheetIdentity { file, sha256 } = &written.sheet;
    compare("the sheet", file, of_sheet, sha256);
    let advise = sheets.is_none() && !of_sheet.join(file).exists();
    for input in &written.inputs {
        compare("the input", &input.path, of_sheet, &input.sha256);
    }
    for output in &written.outputs {
        compare("its file", &output.file, folder, &output.sha256);
    }
    if let Some(sheet) = found.changed.first_mut().filter(|_| advise) {
        sheet.push_str(" (if it is in another folder, state `--sheets FOLDER`)");
    }
    for input in &written.inputs {
        let material = of_sheet.join(&input.path);
        let is_material = material
            .file_name()
            .is_some_and(|name| name == material_file::NAME);
        if let Some(earlier) = material.parent().filter(|_| is_material)
            && earlier.join(RESULT).exists()
            && met.insert(earlier.to_path_buf())
        {
            found.ancestors.push(verified(earlier, None, met)?);
        }
    }
    Ok(found)
}

//! Comparison of a result, and of the earlier results from which it was made, with their sheets and
//! files.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use labio::ContentHash;
use serde::{Deserialize, Serialize};

use crate::{RodlabError, input, material_file};

/// Name of the file of a result.
const RESULT: &str = "result.json";

/// Comparison of a result with its sheet and its files.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Verified {
    /// Folder of the result.
    pub result: PathBuf,
    /// Number of files that were compared: the sheet, its inputs, and the files of the result.
    pub compared: usize,
    /// Changed and missing files, one clause each; empty for an unchanged result.
    pub changed: Vec<String>,
    /// The results from which its inputs came, if their folders are there.
    pub ancestors: Vec<Self>,
}

impl Verified {
    /// Returns true if neither the result nor any result from which it was made has changed.
    #[must_use]
    pub fn is_as_it_was(&self) -> bool {
        self.changed.is_empty() && self.ancestors.iter().all(Self::is_as_it_was)
    }

    /// One line for each result; the results from which it was made follow it.
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
    sheet: Sheet,
    inputs: Vec<Input>,
    outputs: Vec<Output>,
}

#[derive(Debug, Deserialize)]
struct Sheet {
    file: String,
    sha256: String,
}

#[derive(Debug, Deserialize)]
struct Input {
    path: String,
    sha256: String,
}

#[derive(Debug, Deserialize)]
struct Output {
    file: String,
    sha256: String,
}

/// Compares the result in `folder` with its files by their hashes. Its sheet is looked for in
/// `sheets`, by default next to the folder; inputs are relative to the sheet. If an input is the
/// material of another result, that result is compared too.
///
/// # Errors
///
/// [`RodlabError::Read`] for a folder without `result.json`, [`RodlabError::Step`] for one of
/// another kind.
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
    let written: Written = serde_json::from_slice(&bytes)
        .map_err(|error| RodlabError::step(format!("reading {}", path.display()), error))?;
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
    compare(
        "the sheet",
        &written.sheet.file,
        of_sheet,
        &written.sheet.sha256,
    );
    for input in &written.inputs {
        compare("the input", &input.path, of_sheet, &input.sha256);
    }
    for output in &written.outputs {
        compare("its file", &output.file, folder, &output.sha256);
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

//! Processing of one sheet, from its file to the files of its result.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use labio::ContentHash;

use crate::job::{self, Progress, Sheet};
use crate::output::{ResultFiles, SheetIdentity, TableFiles};
use crate::{Outcome, RodlabError};

/// A finished sheet.
#[derive(Debug)]
pub struct Finished {
    /// The outcome.
    pub outcome: Outcome,
    /// The sheet of the outcome.
    pub sheet: SheetIdentity,
    /// Written files, in order; `result.json` is the last.
    pub files: Vec<PathBuf>,
    /// Text of `result.json`.
    pub json: String,
}

/// Reads the sheet at `path`, runs its job and writes the result to `folder`.
///
/// `expected` is the job of the command; `None` accepts a sheet of any job. The tables are written
/// in the formats `tables`.
///
/// # Errors
///
/// [`RodlabError`] if the sheet, a file or the folder is wrong, or if `interrupted` is set before
/// files are written. The folder is then unchanged, or contains complete files but no
/// `result.json`.
pub fn finish(
    path: &Path,
    expected: Option<&'static str>,
    folder: &Path,
    tables: TableFiles,
    progress: &dyn Progress,
    interrupted: &AtomicBool,
) -> Result<Finished, RodlabError> {
    let sheet = Sheet::read(path).map_err(|error| match (error, expected) {
        (RodlabError::NoSheet { path, format, .. }, Some(job)) => {
            RodlabError::NoSheet { path, format, job }
        }
        (error, _) => error,
    })?;
    let found = sheet.job.name();
    if let Some(expected) = expected.filter(|expected| *expected != found) {
        return Err(RodlabError::OtherJob {
            path: path.to_path_buf(),
            found,
            expected,
        });
    }
    let identity = identity_of(&sheet);
    let outcome = job::run(&sheet, progress, interrupted)?;
    // after an interruption no files are written
    if interrupted.load(Ordering::Relaxed) {
        return Err(RodlabError::Interrupted);
    }
    let mut reads = vec![path.to_path_buf()];
    let inputs = outcome.inputs.iter();
    reads.extend(inputs.map(|input| sheet.folder().join(&input.path)));
    let result = ResultFiles::dated(&outcome, &identity, &reads, tables)?;
    let files = result.put(folder, &reads)?;
    Ok(Finished {
        outcome,
        sheet: identity,
        files,
        json: result.json,
    })
}

/// Returns name and hash of a sheet.
#[must_use]
pub fn identity_of(sheet: &Sheet) -> SheetIdentity {
    let name = sheet.path.file_name().unwrap_or_default();
    SheetIdentity {
        file: name.to_string_lossy().into_owned(),
        sha256: ContentHash::of(sheet.text.as_bytes()).to_string(),
    }
}

//! Files of the repository. Every error names its path.

use std::path::{Path, PathBuf};
use std::{fs, io};

use crate::Outcome;
use testbed::generated::GeneratedError;
use testbed::papers::files;

/// Returns the error of the file or folder at `path`.
pub(crate) fn at(path: &Path) -> impl Fn(io::Error) -> GeneratedError + Copy {
    move |source| GeneratedError::Io {
        path: path.to_path_buf(),
        source,
    }
}

pub(crate) fn read(path: &Path) -> Result<String, GeneratedError> {
    fs::read_to_string(path).map_err(at(path))
}

/// Returns the files with an extension in a folder and its subfolders, in the order of their paths.
pub(crate) fn files_below(folder: &Path, extension: &str) -> Outcome<Vec<PathBuf>> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(folder) = open.pop() {
        for path in files(&folder)? {
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|found| found == extension) {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}

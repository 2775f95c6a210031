//! Reading of hand-written RON, with the place of an error in the file.

use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;

/// Error of a file that is not RON or does not fit the schema. `text` is the line of the error.
#[derive(Debug, thiserror::Error)]
#[error("{}, line {line}, column {column}: {reason}, in `{text}`", path.display())]
pub struct RonError {
    path: PathBuf,
    line: usize,
    column: usize,
    text: String,
    reason: String,
}

/// Reads a value from `text`; `path` is used in messages only.
pub fn parse_ron<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, RonError> {
    ron::from_str(text).map_err(|error| {
        let at = error.span.start;
        RonError {
            path: path.to_path_buf(),
            line: at.line,
            column: at.col,
            text: text
                .lines()
                .nth(at.line.saturating_sub(1))
                .unwrap_or_default()
                .trim()
                .to_owned(),
            reason: error.code.to_string(),
        }
    })
}

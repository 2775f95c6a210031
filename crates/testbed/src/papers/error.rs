//! Errors of transcribed tables and golden files.

use std::io;
use std::path::PathBuf;

use crate::generated::GeneratedError;
use crate::ron_text::RonError;

/// Error of a fixture, with the file and the place in the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FixtureError {
    /// A file or folder could not be read.
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: io::Error },
    /// A file is not RON, or it does not fit the schema.
    #[error(transparent)]
    Syntax(#[from] RonError),
    /// The number of cells in a row differs from the number of columns of the table.
    #[error("{}, row {row}: {found} cells, expected {expected}", path.display())]
    RowWidth {
        path: PathBuf,
        row: String,
        found: usize,
        expected: usize,
    },
    /// The content of a cell does not fit its column.
    #[error("{}, row {row}, column {column}: found `{found}`, expected {expected}", path.display())]
    Cell {
        path: PathBuf,
        row: String,
        column: String,
        found: String,
        expected: &'static str,
    },
    /// Two rows or two columns have the same name and cannot be distinguished.
    #[error("{}: {what} `{name}` occurs twice", path.display())]
    Duplicate {
        path: PathBuf,
        what: &'static str,
        name: String,
    },
    /// An erratum, an allowance or a loader refers to a cell that does not exist in the table.
    #[error("{}: no value in row `{row}`, column `{column}`", path.display())]
    Missing {
        path: PathBuf,
        row: String,
        column: String,
    },
    /// A golden file is missing, not current, or cannot be written.
    #[error(transparent)]
    Generated(#[from] GeneratedError),
}

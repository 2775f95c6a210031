//! Errors of transcribed tables and golden files.

use std::io;
use std::path::PathBuf;

use crate::generated::GeneratedError;
use crate::ron_text::RonError;

/// Error of a fixture, with the file and the place in it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FixtureError {
    /// A file or folder could not be read.
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: io::Error },
    /// The file is not RON, or not of the schema; `text` is the line, which names the field.
    #[error(transparent)]
    Syntax(#[from] RonError),
    /// A row has another number of cells than the table has columns.
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
    /// Two rows or two columns have one name, so that they cannot be distinguished.
    #[error("{}: {what} `{name}` occurs twice", path.display())]
    Duplicate {
        path: PathBuf,
        what: &'static str,
        name: String,
    },
    /// An erratum, an allowance or a loader refers to a cell that the table does not have.
    #[error("{}: no value in row `{row}`, column `{column}`", path.display())]
    Missing {
        path: PathBuf,
        row: String,
        column: String,
    },
    /// A file of the golden folder belongs to no transcribed table.
    #[error("{} is made by no transcribed table: remove it or transcribe its table, then run `{command}`", path.display())]
    Orphan {
        path: PathBuf,
        command: &'static str,
    },
    /// A golden table is read by no test.
    #[error("{}: read by no test", path.display())]
    NotRead { path: PathBuf },
    /// A folder of reference output cannot be reproduced, or is compared by no test.
    #[error("{}: {reason}", folder.display())]
    Reference { folder: PathBuf, reason: String },
    /// A golden file is missing, stale or cannot be written.
    #[error(transparent)]
    Generated(#[from] GeneratedError),
}

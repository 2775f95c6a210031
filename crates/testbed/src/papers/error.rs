//! Why a transcribed table or a golden file is not what it should be.

use std::io;
use std::path::PathBuf;

use crate::generated::GeneratedError;
use crate::ron_text::RonError;

/// What can be wrong with a fixture: always the file, and where in it.
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
    /// A cell is not what its column holds.
    #[error("{}, row {row}, column {column}: found `{found}`, expected {expected}", path.display())]
    Cell {
        path: PathBuf,
        row: String,
        column: String,
        found: String,
        expected: &'static str,
    },
    /// Two rows or two columns carry one name, so that neither can be asked for.
    #[error("{}: {what} `{name}` occurs twice", path.display())]
    Duplicate {
        path: PathBuf,
        what: &'static str,
        name: String,
    },
    /// An erratum, an allowance or a loader asks for a cell that the table does not have.
    #[error("{}: no value in row `{row}`, column `{column}`", path.display())]
    Missing {
        path: PathBuf,
        row: String,
        column: String,
    },
    /// A file of the golden folder that no transcribed table makes.
    #[error("{} is made by no transcribed table: remove it or transcribe its table, then run `{command}`", path.display())]
    Orphan {
        path: PathBuf,
        command: &'static str,
    },
    /// A golden table that no test reads.
    #[error("{}: read by no test", path.display())]
    NotRead { path: PathBuf },
    /// A folder of reference output that cannot be made again, or that no test compares.
    #[error("{}: {reason}", folder.display())]
    Reference { folder: PathBuf, reason: String },
    /// A golden file is missing, stale or cannot be written.
    #[error(transparent)]
    Generated(#[from] GeneratedError),
}

//! What can be wrong with the table or with what it refers to: always the row, what was found, what was expected.

use std::fmt;
use std::io;
use std::path::PathBuf;

use super::numbered::Numbered;
use super::workspace::Unresolved;
use testbed::ron_text::RonError;

/// Why the table cannot be checked at all.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum TraceabilityError {
    /// A file or folder could not be read.
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: io::Error },
    /// The rows are not RON, or not of the schema.
    #[error(transparent)]
    Rows(#[from] RonError),
    /// A source file is no Rust.
    #[error("{file}: {reason}")]
    Rust { file: String, reason: String },
    /// A module is declared, and neither of its files is there.
    #[error("{file} declares module `{module}`, expected {}", expected.join(" or "))]
    NoModule {
        file: String,
        module: String,
        expected: Vec<String>,
    },
    /// A snapshot is no JSON object.
    #[error("{}: {reason}", path.display())]
    Snapshot { path: PathBuf, reason: String },
}

/// One thing that is wrong.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum Fault {
    /// The thesis has it, the table does not.
    #[error("{item}: no row, expected one")]
    Missing { item: Numbered },
    /// Rows that say the same thing twice.
    #[error("{item}: {found} rows, expected one")]
    Repeated { item: Numbered, found: usize },
    /// The table has it, the thesis does not.
    #[error("{item}: no such item, expected {numbers}")]
    NotOfTheThesis { item: Numbered, numbers: String },
    /// All there, in another order.
    #[error("{found}: out of order, expected {expected} here")]
    Order { found: Numbered, expected: Numbered },
    /// A field that every row must have.
    #[error("{item}: `{field}` is empty, expected an entry")]
    Empty { item: Numbered, field: &'static str },
    /// A reference leads nowhere.
    #[error("{item}, {field}: {source}")]
    Unresolved {
        item: Numbered,
        field: &'static str,
        source: Unresolved,
    },
    /// A test where code was expected.
    #[error("{item}, implemented: `{reference}` is a test, expected the code that it tests")]
    TestAsCode { item: Numbered, reference: String },
    /// Nothing that a user of the crates could call.
    #[error("{item}, implemented: nothing public among {references}, expected a public item")]
    Private { item: Numbered, references: String },
    /// A function that `cargo test` does not run.
    #[error("{item}, proved: `{reference}` is no test, expected a function with #[test]")]
    NoTest { item: Numbered, reference: String },
    /// A link of the text leads nowhere.
    #[error("{item}: link `{link}` leads nowhere, expected a file seen from docs")]
    DeadLink { item: Numbered, link: String },
    /// Code that does not say which equation it is.
    #[error(
        "{item}: cited in none of {files}, expected `(Ödeen 1993, {item})` where it is implemented"
    )]
    NotCited { item: Numbered, files: String },
    /// A citation of something that the thesis does not have.
    #[error("{file}, line {line}: `{cited}` is cited, expected {expected}")]
    Citation {
        file: String,
        line: usize,
        cited: Numbered,
        expected: String,
    },
}

/// All that is wrong: whoever mends it wants to see it at once.
#[derive(Debug)]
pub(crate) struct Faults(pub(crate) Vec<Fault>);

impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} faults of the traceability table", self.0.len())?;
        for fault in &self.0 {
            write!(f, "\n  {fault}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Faults {}

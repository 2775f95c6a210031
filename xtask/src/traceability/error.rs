//! Faults of traceability: an item of the thesis without code or proof, or a citation of an item
//! that does not exist, with its file and line.

use std::fmt;

use super::numbered::Numbered;

/// One fault.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Fault {
    /// An item has no code or no proof.
    #[error("{item}: not cited by any {what}")]
    NotCited { item: Numbered, what: &'static str },
    /// A citation refers to an item that does not exist in the thesis.
    #[error("{file}, line {line}: `{cited}` is cited, expected {expected}")]
    Citation {
        file: String,
        line: usize,
        cited: Numbered,
        expected: String,
    },
}

/// All faults together, so that they can be corrected in one pass.
#[derive(Debug)]
pub(crate) struct Faults(pub(crate) Vec<Fault>);

impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} items of the thesis are not traced", self.0.len())?;
        for fault in &self.0 {
            write!(f, "\n  {fault}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Faults {}

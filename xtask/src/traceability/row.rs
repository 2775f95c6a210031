//! The rows of docs/traceability.ron.

use std::fs;
use std::path::Path;

use serde::Deserialize;

use super::error::TraceabilityError;
use super::numbered::{Kind, Numbered, Part};
use testbed::ron_text::parse_ron;

/// The file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Rows {
    rows: Vec<Row>,
}

/// One numbered item of the thesis.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Row {
    part: Part,
    kind: Kind,
    /// As printed: `7`, `A16`, `2.1`.
    number: String,
    /// What it is, in words.
    pub(crate) says: String,
    /// `file.rs::item` of what implements it.
    pub(crate) implemented: Vec<String>,
    /// `file.rs::test` of what proves it.
    pub(crate) proved: Vec<String>,
    /// `task::file` that a task draws, or `task::key` of its snapshot.
    #[serde(default)]
    pub(crate) reproduced: Vec<String>,
    /// The erratum with its home, or why it is reproduced in part.
    #[serde(default)]
    pub(crate) note: String,
}

impl Row {
    pub(crate) fn item(&self) -> Numbered {
        Numbered {
            part: self.part,
            kind: self.kind,
            number: self.number.clone(),
        }
    }

    pub(crate) fn part(&self) -> Part {
        self.part
    }

    pub(crate) fn kind(&self) -> Kind {
        self.kind
    }

    /// Where the links of its text lead, from the folder of the page.
    pub(crate) fn links(&self) -> impl Iterator<Item = &str> {
        [&self.says, &self.note].into_iter().flat_map(|text| {
            text.split("](")
                .skip(1)
                .filter_map(|rest| rest.split_once(')').map(|(link, _)| link))
        })
    }
}

/// Reads the rows of the file at `path`.
pub(crate) fn read(path: &Path) -> Result<Vec<Row>, TraceabilityError> {
    let text = fs::read_to_string(path).map_err(|source| TraceabilityError::Io {
        path: path.to_path_buf(),
        source,
    })?;
    parse(path, &text)
}

/// Reads the rows from `text`; `path` is for messages.
pub(crate) fn parse(path: &Path, text: &str) -> Result<Vec<Row>, TraceabilityError> {
    Ok(parse_ron::<Rows>(path, text)?.rows)
}

//! `cargo xtask validate`: the software on measured records, next to what is known of them.
//!
//! A check whose record is not there is skipped and listed with the reason; a check that fails makes the task fail. The
//! table is printed and written to `target/validate`.

mod check;
mod claims;
mod files;
mod hammer;
mod impulse;
mod shock;

use std::path::Path;

use check::Tally;

use crate::Outcome;
use crate::generated::{workspace_root, write_whole};

/// Why the validation did not succeed.
#[derive(Debug, thiserror::Error)]
enum ValidationError {
    #[error("{failed} of {total} checks failed: see {report}")]
    Failed {
        failed: usize,
        total: usize,
        report: String,
    },
}

pub(crate) fn run(data: Option<&Path>) -> Outcome {
    let report = hammer::report(data)
        .and(shock::report(data))
        .and(files::report(data))
        .and(impulse::report());
    let folder = workspace_root().join("target").join("validate");
    let markdown = folder.join("validation.md");
    write_whole(&markdown, &report.to_markdown())?;
    write_whole(&folder.join("validation.json"), &report.to_json()?)?;
    print!("{}", report.to_text());
    match report.tally() {
        Tally { failed: 0, .. } => Ok(()),
        Tally { failed, total, .. } => Err(Box::new(ValidationError::Failed {
            failed,
            total,
            report: markdown.display().to_string(),
        })),
    }
}

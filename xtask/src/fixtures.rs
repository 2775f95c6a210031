//! `cargo xtask fixtures`: golden files from the transcribed tables.
//!
//! The task reads every table of `fixtures/papers`, converts the values and the half unit of their
//! last digit to SI, and writes one golden file per table. It calls none of our numerical code: a
//! fixture must be independent of the code that it tests. Each table must be read by a test.

mod reference;

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::Path;

use testbed::generated::{ensure_file_contents, workspace_root};
use testbed::papers::error::FixtureError;
use testbed::papers::{PAPERS, file_name, files, paper_d, transcribed_tables};

use crate::Outcome;

/// Command that makes the golden files.
const COMMAND: &str = "cargo xtask fixtures";
/// Folder of the golden files, relative to the root of the workspace.
const GOLDEN: &str = "fixtures/golden";

/// Table of the numbers in the survey.
const SURVEY: &str = "survey_constants.ron";

/// Writes the golden files. With `check`, fails if a golden file is missing, not current, or
/// belongs to no table.
pub(crate) fn run(check: bool) -> Outcome {
    let root = workspace_root();
    let tables = transcribed_tables(root)?;
    let golden = root.join(GOLDEN);
    let mut expected = BTreeSet::new();
    let (mut rows, mut values) = (0, 0);
    for table in tables.iter().filter(|table| table.value_count() > 0) {
        let name = file_name(&table.source);
        let text = table.golden(&format!("{PAPERS}/{}", name.display()), COMMAND);
        ensure_file_contents(&golden.join(&name), &text, check, COMMAND)
            .map_err(FixtureError::from)?;
        expected.insert(name);
        rows += table.rows.len();
        values += table.value_count();
    }
    refuse_orphans(&golden, &expected)?;
    paper_d::load()?;
    let tests = reference::tests(root)?;
    // the table of the survey needs no integration test: a unit test of `testbed` compares it with
    // paper D, whose values it repeats
    let is_read = |name: &OsString| name == SURVEY || tests.contains(&*name.to_string_lossy());
    if let Some(name) = expected.iter().find(|name| !is_read(name)) {
        return Err(Box::new(FixtureError::NotRead {
            path: golden.join(name),
        }));
    }
    let references = reference::check(root)?;
    println!(
        "{} tables, {rows} rows, {values} values {} {GOLDEN}; {references} folders of reference output",
        expected.len(),
        if check {
            "are current in"
        } else {
            "written to"
        },
    );
    Ok(())
}

/// Fails if `folder` contains a file that is not in `expected`.
fn refuse_orphans(folder: &Path, expected: &BTreeSet<OsString>) -> Result<(), FixtureError> {
    match files(folder)?
        .into_iter()
        .find(|path| !expected.contains(&file_name(path)))
    {
        Some(path) => Err(FixtureError::Orphan {
            path,
            command: COMMAND,
        }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_golden_file_without_a_table_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["paper_a_table_2.ron", "paper_a_table_9.ron"] {
            fs::write(folder.path().join(name), "").unwrap();
        }
        let known = BTreeSet::from([OsString::from("paper_a_table_2.ron")]);
        let message = refuse_orphans(folder.path(), &known)
            .unwrap_err()
            .to_string();
        assert!(
            message.contains("paper_a_table_9.ron")
                && message.ends_with("then run `cargo xtask fixtures`"),
            "{message}"
        );
        fs::remove_file(folder.path().join("paper_a_table_9.ron")).unwrap();
        refuse_orphans(folder.path(), &known).unwrap();
    }
}

//! `cargo xtask validate`: all claims of the software, compared with results from other sources.
//!
//! The claims are assertions of the integration tests. The tests write a row for each claim to the
//! folder named by `RODLAB_CLAIMS`. The expected values are independent of ours: the printed tables
//! of the thesis, closed forms, conservation laws, the output of other software, measured records.
//! This task runs these tests and combines the rows in the page `docs/validation.md`; the rows in
//! `target/validate/claims` have all digits. If `RODLAB_CLAIMS` is already set, the rows in its
//! folder are those of completed tests, and no test is run again.
//!
//! A claim whose record is missing is skipped with a reason, and its row on the page is unchanged.
//! A failed claim makes the task fail. With `--check`, the page is compared and not written. The
//! counts of faults are not computed here but by the tests of the command.

mod drift;
mod faults;
mod page;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

use testbed::claim::{Claims, FOLDER, Verdict};
use testbed::generated::{GeneratedError, workspace_root, write_whole};
use testbed::papers::files;

use page::Page;

use crate::cargo::{cargo, target_folder};
use crate::files::read;
use crate::{Outcome, none_of};

/// Command that writes the page.
const COMMAND: &str = "cargo xtask validate --data FOLDER";
/// Path of the page, relative to the root of the workspace.
const PAGE: &str = "docs/validation.md";
/// Sections of the page, in their order: one per crate, and one for the measured records.
const SECTIONS: [&str; 6] = [
    "rodwave",
    "labio",
    "cmod",
    "maxwellid",
    "impulse",
    "measured records",
];

/// Claims of one crate, or those of the measured records.
#[derive(Debug)]
struct Section {
    name: &'static str,
    report: Claims,
}

/// Returns the folder with the rows of the tests, and the exit status of the tests. If
/// `RODLAB_CLAIMS` names the rows of completed tests, no test is run and the status is 0.
fn rows(data: Option<&Path>) -> Outcome<(PathBuf, Option<i32>)> {
    if let Some(folder) = env::var_os(FOLDER) {
        return Ok((folder.into(), Some(0)));
    }
    let folder = target_folder().join("validate").join("claims");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    let mut tests = cargo();
    tests
        .current_dir(workspace_root())
        .args([
            "test",
            "--locked",
            "--workspace",
            "--test",
            "it",
            "--no-fail-fast",
        ])
        .args(["--", "--quiet"])
        .env(FOLDER, &folder);
    if let Some(data) = data {
        tests.env("RODLAB_DATA", std::path::absolute(data)?);
    }
    let ended = tests.status()?;
    Ok((folder, ended.code()))
}

/// Returns the sections in the order of the page.
fn sections(folder: &Path) -> Outcome<Vec<Section>> {
    let section = |name: &'static str| {
        let mut report = Claims::default();
        for path in files(&folder.join(name))? {
            let topic: Claims = serde_json::from_str(&read(&path)?)
                .map_err(|error| format!("{}: {error}", path.display()))?;
            report = report.and(topic);
        }
        Ok(Section { name, report })
    };
    SECTIONS.into_iter().map(section).collect()
}

pub(crate) fn run(data: Option<&Path>, check: bool) -> Outcome {
    let (folder, ended) = rows(data)?;
    let sections = sections(&folder)?;
    all_different(&sections)?;
    let written = workspace_root().join(PAGE);
    let committed = committed(&written)?;
    let current = Page::of(&sections, faults::section()?);

    let folder = workspace_root().join("target").join("validate");
    write_whole(&folder.join("validation.md"), &current.to_markdown())?;
    print_summary(&sections, &current);

    let failed: usize = sections
        .iter()
        .flat_map(|s| &s.report.checks)
        .filter(|check| check.verdict == Verdict::Fail)
        .count();
    let total: usize = sections.iter().map(|s| s.report.checks.len()).sum();
    // a test that panicked before its claims were asserted leaves no rows; a page written now would
    // lose these rows
    if ended != Some(0) && failed == 0 {
        return Err(format!(
            "the tests that make the claims ended with {ended:?}, so that rows may be missing: the page is not written"
        )
        .into());
    }
    if check {
        let what = format!("rows of {PAGE} differ: run `{COMMAND}` and review the difference");
        none_of(&drift::between(&committed, &current), &what)?;
    } else if ended == Some(0) {
        write_whole(&written, &current.with_rows_of(&committed).to_markdown())?;
    }
    if failed > 0 {
        return Err(format!("{failed} of {total} checks failed").into());
    }
    Ok(())
}

/// Returns the page in the repository, or an empty page if there is none.
fn committed(path: &Path) -> Result<Page, GeneratedError> {
    match fs::read_to_string(path) {
        Ok(text) => Ok(Page::read(&text)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Page::default()),
        Err(source) => Err(GeneratedError::Io {
            path: path.to_path_buf(),
            source,
        }),
    }
}

/// Checks that the descriptions of the claims are unique, because they identify the claims.
fn all_different(sections: &[Section]) -> Outcome {
    for section in sections {
        let mut claims: Vec<&str> = section
            .report
            .checks
            .iter()
            .map(|check| check.claim.what.as_str())
            .collect();
        claims.sort_unstable();
        if let Some(pair) = claims.windows(2).find(|pair| pair[0] == pair[1]) {
            let name = section.name;
            return Err(format!("two claims of {name} are called \"{}\"", pair[0]).into());
        }
    }
    Ok(())
}

/// Prints the number of claims per crate, every failed row, and the reasons why claims were
/// skipped.
fn print_summary(sections: &[Section], page: &Page) {
    print!("{}", page.tally());
    for section in sections {
        let mut skipped: BTreeMap<String, usize> = BTreeMap::new();
        for check in &section.report.checks {
            let row = page::Row::of(check);
            match check.verdict {
                Verdict::Pass => {}
                Verdict::Skipped => *skipped.entry(row.verdict).or_default() += 1,
                Verdict::Fail => println!(
                    "{}: {}: {} (expected {}, ours {}, tolerance {})",
                    section.name, row.claim, row.verdict, row.expected, row.ours, row.tolerance
                ),
            }
        }
        for (why, count) in skipped {
            println!("{}: {count} checks {why}", section.name);
        }
        for observation in &section.report.observations {
            println!(
                "{}, also measured: {}: {} {}",
                section.name,
                observation.what,
                page::number(observation.ours),
                observation.unit
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use testbed::claim::{Check, Claim};

    use super::*;

    #[test]
    fn two_claims_of_one_name_are_refused() {
        let check = || Check::of(Claim::new("length", "ruler"), Ok(0.0));
        let section = |n| Section {
            name: "rods",
            report: Claims {
                checks: (0..n).map(|_| check()).collect(),
                ..Claims::default()
            },
        };
        assert!(all_different(&[section(1), section(1)]).is_ok());
        assert_eq!(
            all_different(&[section(2)]).unwrap_err().to_string(),
            "two claims of rods are called \"length\""
        );
    }
}

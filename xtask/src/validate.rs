//! `cargo xtask validate`: everything that the software claims, next to what is known of it otherwise.
//!
//! What is ours is computed by the libraries when the task runs. What is expected comes from somewhere else: the printed tables
//! of the thesis, closed forms, conservation, the output of other software, measured records. The page is
//! `docs/validation.md`; every digit is in `target/validate/validation.json`.
//!
//! A check whose record is not there is skipped, with the reason, and its row on the page stays as it was; a check that fails
//! makes the task fail. With `--check` the page is compared and not written. The counts of faults are not made here, but by the tests of
//! the command.

mod check;
mod claims;
mod cmod;
mod difference;
mod drift;
mod faults;
mod files;
mod hammer;
mod impulse;
mod labio;
mod maxwellid;
mod page;
mod rodwave;
mod shock;

use std::collections::BTreeMap;
use std::path::Path;
use std::{fs, io};

use rayon::prelude::*;

use check::{Report, Verdict};
use page::Page;

use crate::Outcome;
use crate::generated::{GeneratedError, workspace_root, write_whole};

/// What writes the page.
const COMMAND: &str = "cargo xtask validate --data FOLDER";
/// The page, from the root of the workspace.
const PAGE: &str = "docs/validation.md";

/// Why the validation did not succeed.
#[derive(Debug, thiserror::Error)]
enum ValidationError {
    #[error("{failed} of {total} checks failed")]
    Failed { failed: usize, total: usize },
    #[error("two claims of {section} are called \"{claim}\"")]
    Alike {
        section: &'static str,
        claim: String,
    },
    #[error("{PAGE} is not current in {rows} rows: run `{COMMAND}` and review the difference")]
    Stale { rows: usize },
}

/// The claims of one crate, or of the measured records.
#[derive(Debug)]
struct Section {
    name: &'static str,
    report: Report,
}

/// In the order of the page.
fn sections(data: Option<&Path>) -> Vec<Section> {
    type Claims<'a> = Box<dyn Fn() -> Report + Sync + 'a>;
    let sections: Vec<(&'static str, Claims<'_>)> = vec![
        ("rodwave", Box::new(rodwave::report)),
        ("labio", Box::new(labio::report)),
        ("cmod", Box::new(cmod::report)),
        ("maxwellid", Box::new(maxwellid::report)),
        ("impulse", Box::new(impulse::report)),
        (
            "measured records",
            Box::new(|| {
                hammer::report(data)
                    .and(shock::report(data))
                    .and(files::report(data))
            }),
        ),
    ];
    sections
        .par_iter()
        .map(|(name, claims)| Section {
            name,
            report: claims(),
        })
        .collect()
}

pub(crate) fn run(data: Option<&Path>, check: bool) -> Outcome {
    let sections = sections(data);
    all_different(&sections)?;
    let written = workspace_root().join(PAGE);
    let committed = committed(&written)?;
    let current = Page::of(&sections, faults::section()?);

    let folder = workspace_root().join("target").join("validate");
    let json: BTreeMap<&str, &Report> = sections.iter().map(|s| (s.name, &s.report)).collect();
    let json = serde_json::to_string_pretty(&json)? + "\n";
    write_whole(&folder.join("validation.json"), &json)?;
    write_whole(&folder.join("validation.md"), &current.to_markdown())?;
    print_summary(&sections, &current);

    let failed: usize = sections
        .iter()
        .flat_map(|s| &s.report.checks)
        .filter(|check| check.verdict == Verdict::Fail)
        .count();
    let total = sections.iter().map(|s| s.report.checks.len()).sum();
    if check {
        let drifts = drift::between(&committed, &current);
        for drift in &drifts {
            println!("{drift}");
        }
        if !drifts.is_empty() {
            return Err(Box::new(ValidationError::Stale { rows: drifts.len() }));
        }
    } else {
        write_whole(&written, &current.with_rows_of(&committed).to_markdown())?;
    }
    if failed > 0 {
        return Err(Box::new(ValidationError::Failed { failed, total }));
    }
    Ok(())
}

/// The page in the repository; an empty one if there is none.
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

/// A claim is found again by its words.
fn all_different(sections: &[Section]) -> Result<(), ValidationError> {
    for section in sections {
        let mut claims: Vec<&str> = section
            .report
            .checks
            .iter()
            .map(|check| check.claim.what.as_str())
            .collect();
        claims.sort_unstable();
        if let Some(pair) = claims.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(ValidationError::Alike {
                section: section.name,
                claim: pair[0].to_owned(),
            });
        }
    }
    Ok(())
}

/// How many of each crate, every row that failed, and why others were skipped.
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
                "{}, measured besides: {}: {} {}",
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
    use super::check::{Check, Claim};
    use super::*;

    #[test]
    fn two_claims_of_one_name_are_refused() {
        let check = || Check::of(Claim::new("length", "ruler"), Ok(0.0));
        let section = |n| Section {
            name: "rods",
            report: Report {
                checks: (0..n).map(|_| check()).collect(),
                observations: Vec::new(),
            },
        };
        assert!(all_different(&[section(1), section(1)]).is_ok());
        assert_eq!(
            all_different(&[section(2)]).unwrap_err().to_string(),
            "two claims of rods are called \"length\""
        );
    }
}

//! Batches of test sheets, with one output line per test and a summary. A failed test does not stop
//! the others.

mod list;
mod row;
mod sheets;
mod summary;
mod sweep;

pub use list::{Listed, list};
pub use row::Row;
pub(crate) use row::remember_failure;
pub use sheets::{Test, tests_of};
pub use summary::{Summary, collect};
pub use sweep::{Sweep, SweptSheet, sweep};

use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use crate::RodlabError;
use crate::finished;
use crate::job::{Progress, Silent};
use crate::output::{self, TableFiles};

/// Part of a campaign: the tests whose index from 0, divided by `of`, leaves the remainder
/// `number - 1`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Number of the part, from 1.
    pub number: usize,
    /// Number of parts.
    pub of: usize,
}

impl FromStr for Shard {
    type Err = String;

    /// Reads a part such as `3/8`.
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong =
            || format!("`{text}` is not a part, expected one such as 3/8, between 1/8 and 8/8");
        let (number, of) = text.split_once('/').ok_or_else(wrong)?;
        let number = number.parse().map_err(|_| wrong())?;
        let of = of.parse().map_err(|_| wrong())?;
        if number == 0 || number > of {
            return Err(wrong());
        }
        Ok(Self { number, of })
    }
}

/// A batch of sheets: tests, output folder and options.
#[derive(Debug, Clone)]
pub struct Batch {
    /// The tests, in order of their names.
    pub tests: Vec<Test>,
    /// Folder that receives one folder for each test.
    pub out: PathBuf,
    /// True to skip tests with a complete result of the same sheet, the same files and the same
    /// software.
    pub resume: bool,
    /// Restricts the work to this part.
    pub shard: Option<Shard>,
    /// Formats of the tables.
    pub tables: TableFiles,
}

impl Batch {
    /// Runs the tests of the `shard`, or all tests; with `resume`, it skips those with a current
    /// result. `say` receives the row of each test when the test is done.
    ///
    /// The rows are in the order of the tests. After an interruption, the tests that were not done
    /// are missing.
    pub fn run(
        &self,
        say: &(dyn Fn(&Row) + Sync),
        progress: &dyn Progress,
        interrupted: &AtomicBool,
    ) -> Vec<Row> {
        let mine: Vec<&Test> = self
            .tests
            .iter()
            .enumerate()
            .filter(|(index, _)| {
                self.shard
                    .is_none_or(|shard| index % shard.of == shard.number - 1)
            })
            .map(|(_, test)| test)
            .collect();
        progress.begins("tests", mine.len());
        mine.par_iter()
            .filter_map(|test| {
                if interrupted.load(Ordering::Relaxed) {
                    return None;
                }
                let row = self.one(test, interrupted)?;
                say(&row);
                progress.one_more();
                Some(row)
            })
            .collect()
    }

    /// Runs one test; returns `None` if it was interrupted.
    fn one(&self, test: &Test, interrupted: &AtomicBool) -> Option<Row> {
        let folder = self.out.join(&test.name);
        if self.resume
            && let Some(row) = row::current(test, &folder)
        {
            return Some(Row { kept: true, ..row });
        }
        match finished::finish(
            &test.sheet,
            None,
            &folder,
            self.tables,
            &Silent,
            interrupted,
        ) {
            Ok(done) => Some(Row {
                test: test.name.clone(),
                job: done.outcome.job.to_owned(),
                title: done.outcome.title,
                status: done.outcome.verdict.standing(),
                headline: done.outcome.verdict.headline(&done.outcome.summary),
                warnings: done.outcome.warnings.len(),
                quantities: done.outcome.quantities,
                warnings_in_words: done.outcome.warnings,
                kept: false,
            }),
            Err(RodlabError::Interrupted) => None,
            Err(error) => {
                let row = Row::wrong_input(&test.name, &in_one_line(&error));
                // a failure that cannot be written to the folder is reported on the terminal only,
                // and an older result is kept
                if !error.is_of_output() {
                    let _ = remember_failure(&row, &folder);
                }
                Some(row)
            }
        }
    }
}

/// Returns an error with its causes in one line.
#[must_use]
pub fn in_one_line(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let more = error.to_string();
        if !text.contains(&more) {
            text = format!("{text}: {more}");
        }
        cause = error.source();
    }
    text
}

/// Name of the summary file that states the program that wrote it.
const SIGNED: &str = "summary.json";

/// Writes table, quantities and combined report of `summary` to `out`, in place of the files of an
/// earlier summary.
///
/// # Errors
///
/// [`RodlabError::Write`] or [`RodlabError::Busy`] if the folder cannot be written;
/// [`RodlabError::Taken`] if one of the files exists and belongs to no earlier summary.
pub fn write_summary(summary: &Summary, out: &Path) -> Result<Vec<PathBuf>, RodlabError> {
    let files = [
        ("summary.csv", summary.to_csv()?),
        ("quantities.csv", summary.quantities_to_csv()?),
        (SIGNED, summary.to_json()?.into_bytes()),
        ("index.html", summary.to_html()?.into_bytes()),
    ];
    let files = files
        .each_ref()
        .map(|(name, bytes)| (*name, bytes.as_slice()));
    output::replace_summary(out, &files, SIGNED)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shard_is_a_number_of_a_number() {
        assert_eq!("3/8".parse(), Ok(Shard { number: 3, of: 8 }));
        for wrong in ["0/8", "9/8", "3", "a/8", "3/", "-1/8", "1/0"] {
            let error = wrong.parse::<Shard>().unwrap_err();
            assert!(error.contains("one such as 3/8"), "{wrong}: {error}");
        }
    }
}

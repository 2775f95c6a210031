//! Summary of all tests of a campaign on one page.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::row::{self, Row};
use crate::output::SOFTWARE;
use crate::{InStep, RodlabError, Standing};

/// Largest number of warnings shown on the terminal.
const MOST_WARNINGS: usize = 5;

/// The rows of a campaign, in order of their names.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    software: &'static str,
    answered: usize,
    in_doubt: usize,
    not_allowed: usize,
    wrong_input: usize,
    /// Number of tests whose result has warnings.
    with_warnings: usize,
    tests: Vec<Row>,
}

impl Summary {
    /// Returns the summary of these rows.
    #[must_use]
    pub fn of(mut tests: Vec<Row>) -> Self {
        tests.sort_by(|a, b| a.test.cmp(&b.test));
        let count = |status| tests.iter().filter(|row| row.status == status).count();
        Self {
            software: SOFTWARE,
            answered: count(Standing::Answered),
            in_doubt: count(Standing::InDoubt),
            not_allowed: count(Standing::NotAllowed),
            wrong_input: count(Standing::WrongInput),
            with_warnings: tests.iter().filter(|row| row.warnings > 0).count(),
            tests,
        }
    }

    /// Returns the number of tests with this standing.
    #[must_use]
    pub fn count(&self, standing: Standing) -> usize {
        match standing {
            Standing::Answered => self.answered,
            Standing::InDoubt => self.in_doubt,
            Standing::NotAllowed => self.not_allowed,
            Standing::WrongInput => self.wrong_input,
        }
    }

    /// Returns the standing of the worst test, which is the standing of the campaign.
    #[must_use]
    pub fn worst(&self) -> Standing {
        let all = self.tests.iter().map(|row| row.status);
        all.max().unwrap_or(Standing::Answered)
    }

    /// The rows.
    #[must_use]
    pub fn tests(&self) -> &[Row] {
        &self.tests
    }

    /// Returns the summary in one sentence.
    #[must_use]
    pub fn sentence(&self) -> String {
        let counts = Standing::ALL.map(|standing| format!("{} {standing}", self.count(standing)));
        format!(
            "{} tests: {}; {} with warnings",
            self.tests.len(),
            counts.join(", "),
            self.with_warnings
        )
    }

    /// Returns the lines that the terminal shows above the [`sentence`](Self::sentence): the most
    /// frequent warnings (at most five), each with the number of tests that have it; the number of
    /// other warnings; and the number of earlier results that were kept.
    #[must_use]
    pub fn remarks(&self) -> Vec<String> {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for row in &self.tests {
            let distinct: BTreeSet<&str> =
                row.warnings_in_words.iter().map(String::as_str).collect();
            for warning in distinct {
                *counts.entry(warning).or_default() += 1;
            }
        }
        let mut warnings: Vec<(&str, usize)> = counts.into_iter().collect();
        warnings.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        let of_tests = |count: usize| match count {
            1 => "1 test".to_owned(),
            _ => format!("{count} tests"),
        };
        let shown = warnings.iter().take(MOST_WARNINGS);
        let mut lines: Vec<String> = shown
            .map(|(warning, count)| format!("warning ({}): {warning}", of_tests(*count)))
            .collect();
        if warnings.len() > MOST_WARNINGS {
            let others = warnings.len() - MOST_WARNINGS;
            lines.push(format!("warnings: {others} more, in the reports"));
        }
        let kept = self.tests.iter().filter(|row| row.kept).count();
        if kept > 0 {
            lines.push(format!(
                "{kept} of {} kept: sheets, files and software have not changed",
                of_tests(self.tests.len())
            ));
        }
        lines
    }

    /// Returns the CSV table with one line per test.
    pub(crate) fn to_csv(&self) -> Result<Vec<u8>, RodlabError> {
        let heads = ["test", "job", "title", "status", "warnings", "result"];
        let rows = self.tests.iter().map(|row| {
            [
                row.test.clone(),
                row.job.clone(),
                row.title.clone(),
                row.status.word().to_owned(),
                row.warnings.to_string(),
                row.headline.clone(),
            ]
        });
        let heads = std::iter::once(heads.map(str::to_owned));
        csv_of("summary.csv", heads.chain(rows))
    }

    /// Returns the CSV table with one line per test and quantity.
    pub(crate) fn quantities_to_csv(&self) -> Result<Vec<u8>, RodlabError> {
        let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
        let rows = self.tests.iter().flat_map(|row| {
            row.quantities.iter().map(move |quantity| {
                [
                    row.test.clone(),
                    quantity.name.clone(),
                    quantity.unit.clone(),
                    number(quantity.value),
                    number(quantity.standard_error),
                    quantity.valid.to_string(),
                    quantity.verdict.clone(),
                    row.status.word().to_owned(),
                ]
            })
        });
        let heads = [
            "test",
            "quantity",
            "unit",
            "value",
            "standard_error",
            "valid",
            "verdict",
            "status",
        ];
        let heads = std::iter::once(heads.map(str::to_owned));
        csv_of("quantities.csv", heads.chain(rows))
    }

    /// Returns the summary as JSON.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Step`] if the text cannot be written.
    pub fn to_json(&self) -> Result<String, RodlabError> {
        serde_json::to_string_pretty(self)
            .map(|text| text + "\n")
            .in_step("writing summary.json")
    }

    /// Returns the HTML page with a link to the report of each test.
    pub(crate) fn to_html(&self) -> Result<String, RodlabError> {
        let mut pages = minijinja::Environment::new();
        pages
            .add_template("index.html", include_str!("index.html"))
            .in_step("writing index.html")?;
        let page = pages
            .get_template("index.html")
            .in_step("writing index.html")?;
        let rows: Vec<_> = self
            .tests
            .iter()
            .map(|row| {
                minijinja::context! {
                    link => (row.status != Standing::WrongInput).then(|| link(&row.test)),
                    test => &row.test, job => &row.job, title => &row.title,
                    status => row.status.word(), class => row.status.word().replace(' ', "-"),
                    warnings => row.warnings, headline => &row.headline,
                }
            })
            .collect();
        page.render(minijinja::context! {
            sentence => self.sentence(), software => self.software, rows,
        })
        .in_step("writing index.html")
    }
}

/// Returns the address of the report of a test, relative to the folder of the campaign.
fn link(test: &str) -> String {
    let mut address = String::new();
    for byte in test.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte) {
            address.push(char::from(byte));
        } else {
            address.push_str(&format!("%{byte:02X}"));
        }
    }
    address + "/report.html"
}

/// Returns `rows` as the file `name` of comma-separated values.
pub(super) fn csv_of<R: IntoIterator<Item: AsRef<[u8]>>>(
    name: &str,
    rows: impl Iterator<Item = R>,
) -> Result<Vec<u8>, RodlabError> {
    let refused = |error| RodlabError::step(format!("writing {name}"), error);
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.write_record(row).map_err(refused)?;
    }
    writer.into_inner().in_step(format!("writing {name}"))
}

/// Returns the results and failures below `folders`, each named by its path there; with several
/// `folders`, the name of the folder comes first.
///
/// # Errors
///
/// [`RodlabError::Read`] for a folder that cannot be read, [`RodlabError::NoFile`] for a folder
/// without results.
pub fn collect(folders: &[PathBuf]) -> Result<Summary, RodlabError> {
    let mut rows = Vec::new();
    for folder in folders {
        let before = rows.len();
        let prefix = if folders.len() > 1 {
            format!(
                "{}/",
                folder
                    .to_string_lossy()
                    .replace('\\', "/")
                    .trim_end_matches('/')
            )
        } else {
            String::new()
        };
        results_below(folder, folder, &prefix, &mut rows)?;
        if rows.len() == before {
            let pattern = "result.json or failure.json";
            return Err(RodlabError::no_file(pattern, folder, ""));
        }
    }
    Ok(Summary::of(rows))
}

fn results_below(
    folder: &Path,
    root: &Path,
    prefix: &str,
    rows: &mut Vec<Row>,
) -> Result<(), RodlabError> {
    let fail = |source| RodlabError::read(folder, source);
    if row::is_result(folder) {
        let short = folder.strip_prefix(root).unwrap_or(folder);
        let name = format!("{prefix}{}", short.to_string_lossy().replace('\\', "/"));
        let row = Row::read(&name, folder).unwrap_or_else(|| {
            Row::wrong_input(&name, "its result cannot be read: run the test again")
        });
        rows.push(row);
    }
    for entry in fs::read_dir(folder).map_err(fail)? {
        let path = entry.map_err(fail)?.path();
        if path.is_dir() {
            results_below(&path, root, prefix, rows)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_are_shown_once_and_kept_results_are_counted() {
        let row = |test: &str, warnings: &[&str]| Row {
            warnings_in_words: warnings.iter().map(ToString::to_string).collect(),
            kept: test == "b",
            ..Row::wrong_input(test, "")
        };
        let summary = Summary::of(vec![row("a", &["one", "two", "two"]), row("b", &["two"])]);
        assert_eq!(
            summary.remarks(),
            [
                "warning (2 tests): two",
                "warning (1 test): one",
                "1 of 2 tests kept: sheets, files and software have not changed"
            ]
        );
        let many = ["1", "2", "3", "4", "5", "6", "7"];
        let remarks = Summary::of(vec![row("a", &many)]).remarks();
        assert_eq!(remarks.len(), 6);
        assert_eq!(remarks[5], "warnings: 2 more, in the reports");
    }
}

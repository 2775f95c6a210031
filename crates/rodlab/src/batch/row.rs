//! The entry of one test in a campaign, in memory and on disk.

use std::collections::BTreeSet;
use std::path::Path;

use labio::ContentHash;
use serde::{Deserialize, Serialize};

use super::Test;
use crate::input;
use crate::outcome::{InputFile, Quantity, Verdict};
use crate::output::{self, FAILURE, OutputFile, RESULT, RESULT_VERSION, SOFTWARE, SheetIdentity};
use crate::{InStep, RodlabError, Standing, records};

/// One test in a summary.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Name of the test, which is the path of its result in the campaign.
    pub test: String,
    /// The job; empty if the sheet could not be read.
    pub job: String,
    /// Title of the sheet.
    pub title: String,
    /// The standing of the test.
    pub status: Standing,
    /// Number of warnings in its result.
    #[serde(default)]
    pub warnings: usize,
    /// The answer, the failed checks, the reason why there is no answer, or the error.
    pub headline: String,
    /// Single numbers of the result.
    pub quantities: Vec<Quantity>,
    /// The warnings, for the terminal.
    #[serde(skip)]
    pub warnings_in_words: Vec<String>,
    /// True for an earlier result that was kept because it is still current.
    #[serde(skip)]
    pub kept: bool,
}

impl Row {
    pub(crate) fn wrong_input(test: &str, error: &str) -> Self {
        Self {
            test: test.to_owned(),
            job: String::new(),
            title: String::new(),
            status: Standing::WrongInput,
            warnings: 0,
            headline: error.to_owned(),
            quantities: Vec::new(),
            warnings_in_words: Vec::new(),
            kept: false,
        }
    }

    /// Returns the row of the result, or of the failure, in `folder`; `None` if the folder contains
    /// neither, or the file cannot be read.
    pub(super) fn read(test: &str, folder: &Path) -> Option<Self> {
        if let Ok(text) = input::read_text(&folder.join(FAILURE)) {
            let row = serde_json::from_str(&text).ok()?;
            return Some(Self {
                test: test.to_owned(),
                ..row
            });
        }
        Some(result_in(folder)?.row(test))
    }
}

/// The parts of `result.json` that are read back.
#[derive(Deserialize)]
struct StoredResult {
    result_version: u32,
    software: String,
    sheet: SheetIdentity,
    job: String,
    title: String,
    verdict: Verdict,
    summary: Vec<String>,
    warnings: Vec<String>,
    inputs: Vec<InputFile>,
    outputs: Option<Vec<OutputFile>>,
    quantities: Vec<Quantity>,
}

impl StoredResult {
    fn row(self, test: &str) -> Row {
        Row {
            test: test.to_owned(),
            job: self.job,
            title: self.title,
            status: self.verdict.standing(),
            warnings: self.warnings.len(),
            headline: self.verdict.headline(&self.summary),
            quantities: self.quantities,
            warnings_in_words: self.warnings,
            kept: false,
        }
    }
}

fn result_in(folder: &Path) -> Option<StoredResult> {
    let text = input::read_text(&folder.join(RESULT)).ok()?;
    serde_json::from_str(&text).ok()
}

/// Returns the row of the result in `folder` if a new run would reproduce the result: software,
/// sheet and input files are the same, no other files match the patterns of the sheet, and all
/// files of the result are unchanged.
pub(super) fn current(test: &Test, folder: &Path) -> Option<Row> {
    let stored = result_in(folder)?;
    let hash = |path: &Path| Some(ContentHash::of(&input::read(path).ok()?).to_string());
    let base = test.sheet.parent()?;
    let outputs = stored.outputs.as_ref()?;
    let same = output::is_settled(folder)
        && stored.result_version == RESULT_VERSION
        && stored.software == SOFTWARE
        && hash(&test.sheet)? == stored.sheet.sha256
        && stored
            .inputs
            .iter()
            .all(|input| hash(&base.join(&input.path)).as_ref() == Some(&input.sha256))
        && finds_the_same(&stored.inputs, base)
        && outputs
            .iter()
            .all(|output| hash(&folder.join(&output.file)).as_ref() == Some(&output.sha256));
    same.then(|| stored.row(&test.name))
}

/// Returns true if the patterns of a sheet in the folder `base` still match the same files of
/// `inputs`, and no others.
fn finds_the_same(inputs: &[InputFile], base: &Path) -> bool {
    let found = inputs
        .iter()
        .filter_map(|input| Some((input.pattern.as_deref()?, input.path.as_str())));
    let (patterns, found): (BTreeSet<&str>, BTreeSet<&str>) = found.unzip();
    let mut now = BTreeSet::new();
    for pattern in patterns {
        let Ok(paths) = records::found_by(pattern, base) else {
            return false;
        };
        now.extend(paths);
    }
    now.iter().map(String::as_str).eq(found)
}

/// Writes the failure in place of an older result, because the result of a sheet that is now wrong
/// is no longer valid.
pub(crate) fn remember_failure(row: &Row, folder: &Path) -> Result<(), RodlabError> {
    #[derive(Serialize)]
    struct Failure<'a> {
        result_version: u32,
        software: &'static str,
        #[serde(flatten)]
        row: &'a Row,
        /// Files of an older result that are still in the folder.
        files: Vec<String>,
    }
    output::replace_by_failure(folder, |files| {
        let mut text = serde_json::to_vec_pretty(&Failure {
            result_version: RESULT_VERSION,
            software: SOFTWARE,
            row,
            files,
        })
        .in_step("writing failure.json")?;
        text.push(b'\n');
        Ok(text)
    })
}

/// Returns true if `folder` contains the result or the failure of a test.
pub(super) fn is_result(folder: &Path) -> bool {
    folder.join(RESULT).is_file() || folder.join(FAILURE).is_file()
}

//! List of the sheets of a campaign with their jobs, input files and hashes. Nothing is computed.

use std::sync::atomic::AtomicBool;

use labio::ContentHash;
use rayon::prelude::*;
use serde::Serialize;

use super::{Test, in_one_line};
use crate::RodlabError;
use crate::finished;
use crate::job::{self, Sheet, Silent};
use crate::outcome::InputFile;
use crate::output::SOFTWARE;

/// A sheet of a campaign, with the files and hashes on which its result depends.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Listed {
    /// Name of the test, which is the path of its result in the campaign.
    pub test: String,
    /// Path of the sheet.
    pub sheet: String,
    /// The job; absent if the sheet is wrong.
    pub job: Option<&'static str>,
    /// SHA-256 of the sheet, hexadecimal; absent if it cannot be read.
    pub sha256: Option<String>,
    /// The input files; their paths are relative to the sheet.
    pub inputs: Vec<InputFile>,
    /// SHA-256 of software, sheet and input files together. If it changes, `rodlab batch --resume`
    /// repeats the test. Absent if the sheet or a file is wrong.
    pub key: Option<String>,
    /// The error, if the sheet or a file is wrong.
    pub error: Option<String>,
}

/// Reads the sheets of `tests` and their files.
///
/// # Errors
///
/// [`RodlabError::Interrupted`] if `interrupted` is set. A wrong sheet is no error: it is listed
/// with its message.
pub fn list(tests: &[Test], interrupted: &AtomicBool) -> Result<Vec<Listed>, RodlabError> {
    tests
        .par_iter()
        .map(|test| one(test, interrupted))
        .collect()
}

fn one(test: &Test, interrupted: &AtomicBool) -> Result<Listed, RodlabError> {
    let mut listed = Listed {
        test: test.name.clone(),
        sheet: test.sheet.to_string_lossy().into_owned(),
        ..Listed::default()
    };
    let read = Sheet::read(&test.sheet).and_then(|sheet| {
        listed.sha256 = Some(finished::identity_of(&sheet).sha256);
        listed.inputs = job::check(&sheet, &Silent, interrupted)?.inputs;
        Ok(sheet.job.name())
    });
    match read {
        Ok(job) => {
            listed.job = Some(job);
            listed.key = listed.sha256.as_deref().map(|sha| key(sha, &listed.inputs));
        }
        Err(RodlabError::Interrupted) => return Err(RodlabError::Interrupted),
        Err(error) => listed.error = Some(in_one_line(&error)),
    }
    Ok(listed)
}

/// Returns the hash of the software, the sheet, and the contents and paths of the input files. The
/// hashed text has one line for each of them; this is unambiguous, because neither a hash nor the
/// name of the software contains a line break.
fn key(sheet: &str, inputs: &[InputFile]) -> String {
    let mut text = format!("{SOFTWARE}\n{sheet}\n");
    for input in inputs {
        text.push_str(&format!(
            "{} {}\n",
            input.sha256,
            ContentHash::of(input.path.as_bytes())
        ));
    }
    ContentHash::of(text.as_bytes()).to_string()
}

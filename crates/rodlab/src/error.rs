//! Errors that end the command without a result.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::outcome::InputFile;
use crate::sheet::SheetError;

/// The reason why there is no outcome. Data that do not allow a result are not an error: they give
/// an [`Outcome`](crate::Outcome) with the verdict
/// [`NotAllowed`](crate::outcome::Verdict::NotAllowed).
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the message of an error names its fields")]
#[non_exhaustive]
pub enum RodlabError {
    /// The sheet is wrong; the error shows the place.
    #[error("{0}")]
    Sheet(Box<SheetError>),
    /// A sheet was given to the command of another job.
    #[error("{} is a sheet for `{found}`, expected one for `{expected}`: run `rodlab {found}` on it", path.display())]
    OtherJob {
        path: PathBuf,
        found: &'static str,
        expected: &'static str,
    },
    /// A file of data was given instead of a sheet.
    #[error("{} is a file of data ({format}), expected a test sheet{}; `rodlab init {job}` writes a sheet", path.display(), or_options(job))]
    NoSheet {
        path: PathBuf,
        /// Its format, such as `NPY`.
        format: String,
        job: &'static str,
    },
    /// A sheet is not encoded in UTF-8.
    #[error("{}:{line}:{column}: found {found}, expected UTF-8 text: save the sheet as UTF-8", path.display())]
    Encoding {
        path: PathBuf,
        /// Line of the first character that is not UTF-8, from 1.
        line: usize,
        /// Its column, from 1, in characters.
        column: usize,
        /// The text at this place.
        found: String,
    },
    /// A name or pattern in the sheet matches no file.
    #[error("no file matches `{pattern}` in {}{}", searched(folder, field), has(similar.as_deref()))]
    NoFile {
        pattern: String,
        folder: PathBuf,
        /// Place of the pattern in the sheet; empty for a pattern of the command line.
        field: String,
        /// Files of the folder with similar names, such as `hits-1.npy and 4 more`.
        similar: Option<String>,
    },
    /// A file could not be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// A file or folder could not be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// The path of a file to read is a folder, a pipe or a device.
    #[error("cannot read {}: it is {found}, expected a file", path.display())]
    NoRegularFile {
        path: PathBuf,
        /// Its file type.
        found: &'static str,
    },
    /// Another run is writing to the folder and has not finished in time.
    #[error("{} has been in use by another run ({owner}) for half a minute; wait for it, or choose another folder", folder.display())]
    Busy {
        folder: PathBuf,
        /// The writer, such as `process 4711`.
        owner: String,
    },
    /// A file of the result would replace a file that belongs to no earlier result.
    #[error("cannot write {}: it exists and no earlier result lists it: choose another folder (--out), or move it away", path.display())]
    Taken {
        /// The existing file.
        path: PathBuf,
    },
    /// A new file would replace an existing one.
    #[error("cannot write {}: it exists already: choose another name, or move it away", path.display())]
    Exists { path: PathBuf },
    /// The result would replace or remove a file that the run has read.
    #[error("cannot write {}: this run has read it: choose another folder (--out)", path.display())]
    OverInput {
        /// The file that was read.
        path: PathBuf,
    },
    /// The sheet requests something impossible, for example by two contradictory statements or a
    /// channel that no file has.
    #[error("{field} is {found}, expected {expected}")]
    Request {
        /// Place in the sheet, such as `records.channels[1].from`.
        field: String,
        /// The statement found there.
        found: String,
        expected: String,
    },
    /// Two files, hits or channels contain the same measurement. Counted twice, it would make the
    /// errors too small.
    #[error(
        "{first} and {second} {how}: they are one measurement, expected independent measurements: remove one of the two from the sheet"
    )]
    OneMeasurement {
        /// The first of them.
        first: String,
        /// The second of them.
        second: String,
        /// Their common property, such as `have the same content`.
        how: &'static str,
    },
    /// The coherence of several hits is 1 within rounding, which no measurement reaches.
    #[error(
        "{place}: the coherence of `{input}` and `{output}` is 1 within rounding over {hits} hits, expected hits with independent noise: the hits are copies of one hit, or were computed without noise"
    )]
    NoNoise {
        /// Part of the sheet, such as `source`.
        place: String,
        /// Channel in the denominator.
        input: String,
        /// Channel in the numerator.
        output: String,
        hits: usize,
    },
    /// The job was interrupted.
    #[error("interrupted")]
    Interrupted,
    /// All files have been read, and no computation was requested.
    #[error("everything has been read")]
    ReadOnly {
        inputs: Vec<InputFile>,
        /// Warnings about the sheet and its files.
        warnings: Vec<String>,
    },
    /// A library crate returned an error in the step `what`.
    #[error("{what}: {source}")]
    Step {
        /// The step, such as `reading hits.npy`.
        what: String,
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

/// Returns, in words, the folder that was searched for a file and the field that states the file.
fn searched(folder: &Path, field: &str) -> String {
    let is_here = folder == Path::new(".");
    match (is_here, field) {
        (true, "") => "the current folder".to_owned(),
        (true, field) => match std::env::current_dir() {
            Ok(here) => format!("the folder of the sheet, {} ({field})", here.display()),
            Err(_) => format!("the folder of the sheet ({field})"),
        },
        (false, "") => folder.display().to_string(),
        (false, field) => format!("{} ({field})", folder.display()),
    }
}

/// Returns the words about `similar` files, which follow the folder.
fn has(similar: Option<&str>) -> String {
    similar.map_or_else(String::new, |similar| format!(": the folder has {similar}"))
}

/// Returns the options with which the command of `job` takes recordings instead of a sheet.
fn or_options(job: &str) -> &'static str {
    match job {
        "frf" => ", or `--input` and `--output` with the channels",
        "modulus" => ", or `--impacted` and `--free` with the channels of both ends of a rod",
        _ => "",
    }
}

impl RodlabError {
    /// Wraps an error that one of the library crates returned in the step `what`.
    pub fn step(
        what: impl Into<String>,
        source: impl std::error::Error + Send + Sync + 'static,
    ) -> Self {
        Self::Step {
            what: what.into(),
            source: Box::new(source),
        }
    }

    /// Returns the error for a file or folder at `path` that could not be read.
    pub(crate) fn read(path: &Path, source: io::Error) -> Self {
        let path = path.to_path_buf();
        Self::Read { path, source }
    }

    /// Returns the error for a file or folder that could not be listed.
    pub(crate) fn listing(error: glob::GlobError) -> Self {
        let path = error.path().to_path_buf();
        Self::read(&path, error.into())
    }

    /// Returns the error for a file or folder at `path` that could not be written.
    pub(crate) fn write(path: &Path, source: io::Error) -> Self {
        let path = path.to_path_buf();
        Self::Write { path, source }
    }

    /// Returns true if the result could not be written, so that an earlier result remains the
    /// latest.
    #[must_use]
    pub fn is_of_output(&self) -> bool {
        matches!(
            self,
            Self::Write { .. }
                | Self::Busy { .. }
                | Self::Taken { .. }
                | Self::Exists { .. }
                | Self::OverInput { .. }
        )
    }

    /// Returns the error for a name or `pattern` that matches no file in the `folder`; `field` is
    /// its place in the sheet, empty for the command line.
    pub(crate) fn no_file(pattern: &str, folder: &Path, field: &str) -> Self {
        Self::NoFile {
            pattern: pattern.to_owned(),
            folder: folder.to_path_buf(),
            field: field.to_owned(),
            similar: None,
        }
    }

    /// Refuses an empty list in the `field` of a sheet.
    pub(crate) fn refuse_empty<T>(
        list: &[T],
        field: impl Into<String>,
        expected: &str,
    ) -> Result<(), Self> {
        match list {
            [] => Err(Self::request(field, "empty", expected)),
            _ => Ok(()),
        }
    }

    /// Returns the error for a statement of the sheet that is impossible or not allowed.
    pub fn request(
        field: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::Request {
            field: field.into(),
            found: found.into(),
            expected: expected.into(),
        }
    }
}

/// Results of the library crates as results of a job.
pub(crate) trait InStep<T> {
    /// Wraps the error, if any, as one of the step `what`.
    fn in_step(self, what: impl Into<String>) -> Result<T, RodlabError>;
}

impl<T, E: std::error::Error + Send + Sync + 'static> InStep<T> for Result<T, E> {
    fn in_step(self, what: impl Into<String>) -> Result<T, RodlabError> {
        self.map_err(|error| RodlabError::step(what, error))
    }
}

impl From<Box<SheetError>> for RodlabError {
    fn from(error: Box<SheetError>) -> Self {
        Self::Sheet(error)
    }
}

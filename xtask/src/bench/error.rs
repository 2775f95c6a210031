//! Why no page of performance can be made.

use std::io;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;

#[derive(Debug, thiserror::Error)]
pub(super) enum BenchError {
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: io::Error },
    #[error("{}:{line}: {reason}, at `{text}`", path.display())]
    Ron {
        path: PathBuf,
        line: usize,
        text: String,
        reason: String,
    },
    #[error("{}: {reason}", path.display())]
    Json { path: PathBuf, reason: String },
    #[error("{}, row `{what}`: {reason}", path.display())]
    Row {
        path: PathBuf,
        what: String,
        reason: String,
    },
    /// A row that nothing backs is a claim without evidence.
    #[error("{} rows have nothing that was measured: {}", rows.len(), rows.join("; "))]
    NotMeasured { rows: Vec<String> },
    #[error(
        "benchmarks of the sources and of the measurements differ: not measured {not_measured:?}, not in the sources \
         {not_there:?}; run `{command}`"
    )]
    OtherBenchmarks {
        not_measured: Vec<String>,
        not_there: Vec<String>,
        command: &'static str,
    },
    #[error("`{command}`: {reason}")]
    Command { command: String, reason: String },
    #[error("instructions of {} kernels rose by more than {limit:.0} %: {}", kernels.len(), kernels.join("; "))]
    MoreInstructions { limit: f64, kernels: Vec<String> },
    #[error("this is a build without optimisation, which tells nothing: call `cargo xtask bench`")]
    Unoptimised,
    #[error("valgrind is not installed: no instructions were counted")]
    NoValgrind,
    #[error("there is no kernel `{name}`, expected one of {expected}")]
    NoKernel { name: String, expected: String },
}

/// A value from the RON of `text`; `path` is for messages.
pub(super) fn parse_ron<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, BenchError> {
    ron::from_str(text).map_err(|error| {
        let line = error.span.start.line;
        BenchError::Ron {
            path: path.to_path_buf(),
            line,
            text: text
                .lines()
                .nth(line.saturating_sub(1))
                .unwrap_or_default()
                .trim()
                .to_owned(),
            reason: error.code.to_string(),
        }
    })
}

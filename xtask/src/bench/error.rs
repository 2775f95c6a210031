//! Errors of the benchmarks and of their page.

use std::io;
use std::path::{Path, PathBuf};

use testbed::ron_text::RonError;

#[derive(Debug, thiserror::Error)]
pub(super) enum BenchError {
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: io::Error },
    #[error(transparent)]
    Ron(#[from] RonError),
    #[error("{}: {reason}", path.display())]
    Json { path: PathBuf, reason: String },
    #[error("{}, row `{what}`: {reason}", path.display())]
    Row {
        path: PathBuf,
        what: String,
        reason: String,
    },
    /// Rows of the page have no measurement.
    #[error("{} rows have no measurement: {}", rows.len(), rows.join("; "))]
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
    #[error("the instruction counts of {} kernels rose by more than {limit:.0} %: {}", kernels.len(), kernels.join("; "))]
    MoreInstructions { limit: f64, kernels: Vec<String> },
    #[error("times of an unoptimised build are meaningless: call `cargo xtask bench`")]
    Unoptimised,
    #[error("valgrind is not installed: no instructions were counted")]
    NoValgrind,
    #[error("there is no kernel `{name}`, expected one of {expected}")]
    NoKernel { name: String, expected: String },
}

impl BenchError {
    /// Returns the error of the file or folder at `path`.
    pub(super) fn at(path: &Path) -> impl Fn(io::Error) -> Self + Copy {
        move |source| Self::Io {
            path: path.to_path_buf(),
            source,
        }
    }
}

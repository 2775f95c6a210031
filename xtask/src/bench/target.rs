//! docs/performance.ron: targets of benchmarks or programs, their reasons, and results of others
//! for the same.

use std::fs;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::error::BenchError;
use testbed::ron_text::parse_ron;

/// Contents of the file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Targets {
    pub(super) sections: Vec<Section>,
}

/// Table of the page.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Section {
    pub(super) title: String,
    /// Information needed to read the table; may be omitted.
    #[serde(default)]
    pub(super) text: String,
    pub(super) rows: Vec<Row>,
}

/// Target.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Row {
    pub(super) what: String,
    pub(super) of: Quantity,
    pub(super) unit: Unit,
    pub(super) target: Target,
    /// Reason for that number.
    pub(super) because: String,
    #[serde(default)]
    pub(super) baseline: Baseline,
}

/// Measured quantity. Benchmarks have the name given by criterion, programs that of `program.rs`.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub(super) enum Quantity {
    /// Time of one iteration of a benchmark.
    Time(String),
    /// Elements per second of a benchmark that states its throughput.
    Rate(String),
    /// Time of the first benchmark as a multiple of that of the second.
    Multiple(String, String),
    /// Elements per second of the first benchmark as a multiple of those of the second.
    MultipleOfRate(String, String),
    /// Time of a whole process.
    Process(String),
    /// Maximum memory of a process.
    Memory(String),
}

/// Unit of target, result and baseline.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub(super) enum Unit {
    Microseconds,
    Milliseconds,
    Seconds,
    Megabytes,
    MillionsASecond,
    Multiple,
}

/// Side of the limit on which the result must lie, in the unit of the row.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub(super) enum Target {
    AtMost(f64),
    AtLeast(f64),
}

/// Comparison of the result, besides its target.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
pub(super) enum Baseline {
    /// No other software does the same.
    #[default]
    None,
    /// Another benchmark of ours in the same run, in the same quantity.
    Bench(String),
    /// Result of another program, in the unit of the row.
    Recorded { value: f64, by: String },
}

impl Unit {
    /// Returns the number of these units per SI unit: seconds, bytes, elements per second, 1.
    pub(super) fn a_si(self) -> f64 {
        match self {
            Self::Microseconds => 1e6,
            Self::Milliseconds => 1e3,
            Self::Seconds | Self::Multiple => 1.0,
            Self::Megabytes | Self::MillionsASecond => 1e-6,
        }
    }

    pub(super) fn symbol(self) -> &'static str {
        match self {
            Self::Microseconds => "µs",
            Self::Milliseconds => "ms",
            Self::Seconds => "s",
            Self::Megabytes => "MB",
            Self::MillionsASecond => "M/s",
            Self::Multiple => "×",
        }
    }
}

impl Quantity {
    fn fits(&self, unit: Unit) -> bool {
        match self {
            Self::Time(_) | Self::Process(_) => {
                matches!(
                    unit,
                    Unit::Microseconds | Unit::Milliseconds | Unit::Seconds
                )
            }
            Self::Rate(_) => unit == Unit::MillionsASecond,
            Self::Multiple(..) | Self::MultipleOfRate(..) => unit == Unit::Multiple,
            Self::Memory(_) => unit == Unit::Megabytes,
        }
    }

    /// Returns the required benchmarks.
    pub(super) fn benchmarks(&self) -> Vec<&str> {
        match self {
            Self::Time(id) | Self::Rate(id) => vec![id],
            Self::Multiple(first, second) | Self::MultipleOfRate(first, second) => {
                vec![first, second]
            }
            Self::Process(_) | Self::Memory(_) => Vec::new(),
        }
    }
}

impl Target {
    pub(super) fn limit(self) -> f64 {
        match self {
            Self::AtMost(limit) | Self::AtLeast(limit) => limit,
        }
    }
}

impl Targets {
    /// Reads and checks the file at `path`.
    pub(super) fn read(path: &Path) -> Result<Self, BenchError> {
        let text = fs::read_to_string(path).map_err(|source| BenchError::Io {
            path: path.to_path_buf(),
            source,
        })?;
        Self::parse(path, &text)
    }

    /// Reads and checks `text`; `path` is for messages.
    pub(super) fn parse(path: &Path, text: &str) -> Result<Self, BenchError> {
        let targets: Self = parse_ron(path, text)?;
        for row in targets.rows() {
            row.check(path)?;
        }
        Ok(targets)
    }

    pub(super) fn rows(&self) -> impl Iterator<Item = &Row> {
        self.sections.iter().flat_map(|section| &section.rows)
    }
}

impl Row {
    fn check(&self, path: &Path) -> Result<(), BenchError> {
        let fault = |reason: String| BenchError::Row {
            path: PathBuf::from(path),
            what: self.what.clone(),
            reason,
        };
        let positive = |name: &str, value: f64| {
            if value.is_finite() && value > 0.0 {
                Ok(())
            } else {
                Err(fault(format!(
                    "{name} is {value}, expected a finite number above 0"
                )))
            }
        };
        if !self.of.fits(self.unit) {
            let unit = self.unit.symbol();
            return Err(fault(format!("{:?} is not measured in {unit}", self.of)));
        }
        if self.because.trim().is_empty() {
            return Err(fault("nothing says why that target".into()));
        }
        positive("the target", self.target.limit())?;
        match &self.baseline {
            Baseline::Recorded { value, by } => {
                if by.trim().is_empty() {
                    return Err(fault("nothing says whose the baseline is".into()));
                }
                positive("the baseline", *value)
            }
            Baseline::Bench(_) if !matches!(self.of, Quantity::Time(_) | Quantity::Rate(_)) => Err(
                fault("a benchmark is a baseline for a time or a rate only".into()),
            ),
            Baseline::Bench(_) | Baseline::None => Ok(()),
        }
    }
}

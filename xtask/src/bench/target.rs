//! docs/performance.ron: targets of benchmarks and programs, their reasons, and results of other
//! software for the same task.

use std::path::Path;

use serde::Deserialize;

use crate::files::read;
use crate::{Error, Outcome};
use testbed::ron_text::parse_ron;

/// Contents of the file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Targets {
    pub(super) sections: Vec<Section>,
    #[serde(default)]
    pub(super) growth: Vec<Growth>,
}

/// Table of the page.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Section {
    pub(super) title: String,
    /// Text that the reader of the table needs; may be omitted.
    #[serde(default)]
    pub(super) text: String,
    pub(super) rows: Vec<Row>,
}

/// One target.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Row {
    pub(super) what: String,
    pub(super) of: Quantity,
    pub(super) unit: Unit,
    pub(super) target: Target,
    /// Reason for the number of the target.
    pub(super) because: String,
    #[serde(default)]
    pub(super) baseline: Baseline,
    #[serde(default)]
    pub(super) bound: Option<Bound>,
    /// Reason why the result misses its target, and what was tried; may be omitted.
    #[serde(default)]
    pub(super) missed: String,
}

/// Shortest time that the machine needs for the task, measured in the same run.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Bound {
    pub(super) of: Quantity,
    pub(super) is: String,
}

/// Growth of time or memory with the size of the task, as the exponent between two sizes.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Growth {
    pub(super) what: String,
    /// Unit of the sizes, such as `lines`.
    pub(super) with: String,
    pub(super) from: (Quantity, f64),
    pub(super) to: (Quantity, f64),
    /// Greatest allowed exponent.
    pub(super) at_most: f64,
    /// Reason for an exponent above `at_most` or far from 1; may be omitted.
    #[serde(default)]
    pub(super) because: String,
}

/// Measured quantity. Benchmarks have the names that criterion gives them, programs those in
/// `program.rs`.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub(super) enum Quantity {
    /// Time of one iteration of a benchmark.
    Time(String),
    /// Elements per second of a benchmark that states its throughput.
    Rate(String),
    /// Time of the first benchmark as a multiple of the time of the second.
    Multiple(String, String),
    /// Elements per second of the first benchmark as a multiple of those of the second.
    MultipleOfRate(String, String),
    /// Time of a whole process.
    Process(String),
    /// Maximum memory of a process.
    Memory(String),
}

/// Unit of the target, the result and the baseline of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub(super) enum Unit {
    Microseconds,
    Milliseconds,
    Seconds,
    Megabytes,
    MillionsASecond,
    Multiple,
}

/// Limit for the result, in the unit of the row, with the side on which the result must lie.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub(super) enum Target {
    AtMost(f64),
    AtLeast(f64),
    /// Allowed multiple of the bound of the row.
    OfBound(f64),
}

/// Comparison with another result, in addition to the target.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
pub(super) enum Baseline {
    /// No other software does the same.
    #[default]
    None,
    /// Another of our benchmarks in the same run, in the same quantity.
    Bench(String),
    /// Result of another program, in the unit of the row.
    Recorded { value: f64, by: String },
}

impl Unit {
    /// Returns the number of these units per SI unit (seconds, bytes, elements per second, 1).
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

    /// Returns the benchmarks that the quantity needs.
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
            Self::AtMost(limit) | Self::AtLeast(limit) | Self::OfBound(limit) => limit,
        }
    }
}

impl Targets {
    /// Reads and checks the file at `path`.
    pub(super) fn read(path: &Path) -> Outcome<Self> {
        Self::parse(path, &read(path)?)
    }

    /// Reads and checks `text`; `path` is used in messages.
    pub(super) fn parse(path: &Path, text: &str) -> Outcome<Self> {
        let targets: Self = parse_ron(path, text)?;
        for row in targets.rows() {
            row.check(path)?;
        }
        for growth in &targets.growth {
            growth.check(path)?;
        }
        Ok(targets)
    }

    /// Returns every quantity in the file, with the name of its row.
    pub(super) fn quantities(&self) -> impl Iterator<Item = (&str, &Quantity)> {
        let rows = self.rows().flat_map(|row| {
            let bound = row.bound.as_ref().map(|bound| &bound.of);
            let all = std::iter::once(&row.of).chain(bound);
            all.map(|of| (row.what.as_str(), of))
        });
        let growth = self
            .growth
            .iter()
            .flat_map(|growth| [&growth.from.0, &growth.to.0].map(|of| (growth.what.as_str(), of)));
        rows.chain(growth)
    }

    pub(super) fn rows(&self) -> impl Iterator<Item = &Row> {
        self.sections.iter().flat_map(|section| &section.rows)
    }
}

/// Returns the error of the row `what` of the file at `path`.
pub(super) fn fault(path: &Path, what: &str, reason: &str) -> Error {
    format!("{}, row `{what}`: {reason}", path.display()).into()
}

impl Row {
    fn check(&self, path: &Path) -> Outcome {
        let fault = |reason: &str| fault(path, &self.what, reason);
        let positive = |name: &str, value: f64| {
            if value.is_finite() && value > 0.0 {
                Ok(())
            } else {
                Err(fault(&format!(
                    "{name} is {value}, expected a finite number above 0"
                )))
            }
        };
        let bound = self.bound.as_ref().map(|bound| &bound.of);
        if let Some(of) = [Some(&self.of), bound]
            .into_iter()
            .flatten()
            .find(|of| !of.fits(self.unit))
        {
            let unit = self.unit.symbol();
            return Err(fault(&format!("{of:?} is not measured in {unit}")));
        }
        if self.because.trim().is_empty() {
            return Err(fault("the target has no reason"));
        }
        if matches!(self.target, Target::OfBound(_)) && bound.is_none() {
            return Err(fault(
                "the target is a multiple of a bound, but the row has no bound",
            ));
        }
        positive("the target", self.target.limit())?;
        match &self.baseline {
            Baseline::Recorded { value, by } => {
                if by.trim().is_empty() {
                    return Err(fault("the baseline has no source"));
                }
                positive("the baseline", *value)
            }
            Baseline::Bench(_) if !matches!(self.of, Quantity::Time(_) | Quantity::Rate(_)) => {
                Err(fault("a benchmark is a baseline for a time or a rate only"))
            }
            Baseline::Bench(_) | Baseline::None => Ok(()),
        }
    }
}

impl Growth {
    fn check(&self, path: &Path) -> Outcome {
        let kinds = [&self.from.0, &self.to.0].map(std::mem::discriminant);
        let reason = if kinds[0] != kinds[1] {
            format!(
                "{:?} and {:?} are not of the same kind",
                self.from.0, self.to.0
            )
        } else if !(self.from.1 > 0.0 && self.to.1 > self.from.1) {
            format!(
                "sizes {} and {}, expected increasing sizes",
                self.from.1, self.to.1
            )
        } else if !(self.at_most.is_finite()) {
            format!(
                "the greatest exponent is {}, expected a finite number",
                self.at_most
            )
        } else {
            return Ok(());
        };
        Err(fault(path, &self.what, &reason))
    }
}

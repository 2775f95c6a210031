//! A target with what was measured for it.

use super::error::BenchError;
use super::measured::Measured;
use super::target::{Baseline, Quantity, Row, Target, Targets};

/// What a row says of the software.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RowResult {
    /// In the unit of the row.
    pub(super) ours: f64,
    /// Median absolute deviation over the median of a benchmark; half the range over the median of a program that ran more than once.
    pub(super) spread: Option<f64>,
    /// Part of what the target allows: above 1 it is missed.
    pub(super) used: f64,
    /// In the unit of the row.
    pub(super) baseline: Option<f64>,
    /// By how much ours is quicker than the baseline, or smaller.
    pub(super) better: Option<f64>,
}

impl RowResult {
    pub(super) fn is_met(&self) -> bool {
        self.used <= 1.0
    }
}

/// The result of each row of each section, in their order. A row that nothing backs is an error.
pub(super) fn results(
    targets: &Targets,
    measured: &Measured,
) -> Result<Vec<Vec<RowResult>>, BenchError> {
    let mut missing = Vec::new();
    let sections = targets
        .sections
        .iter()
        .map(|section| {
            section
                .rows
                .iter()
                .filter_map(|row| {
                    let found = result(row, measured);
                    if found.is_none() {
                        missing.push(format!("{} ({:?})", row.what, row.of));
                    }
                    found
                })
                .collect()
        })
        .collect();
    if missing.is_empty() {
        Ok(sections)
    } else {
        Err(BenchError::NotMeasured { rows: missing })
    }
}

fn result(row: &Row, measured: &Measured) -> Option<RowResult> {
    let (ours, spread) = value(&row.of, measured)?;
    let unit = row.unit.a_si();
    let ours = unit * ours;
    let used = match row.target {
        Target::AtMost(limit) => ours / limit,
        Target::AtLeast(limit) => limit / ours,
    };
    let baseline = match &row.baseline {
        Baseline::None => None,
        Baseline::Recorded { value, .. } => Some(*value),
        Baseline::Bench(id) => {
            let of = match row.of {
                Quantity::Rate(_) => Quantity::Rate(id.clone()),
                _ => Quantity::Time(id.clone()),
            };
            Some(unit * value(&of, measured)?.0)
        }
    };
    let better = baseline.map(|baseline| match row.target {
        Target::AtMost(_) => baseline / ours,
        Target::AtLeast(_) => ours / baseline,
    });
    Some(RowResult {
        ours,
        spread,
        used,
        baseline,
        better,
    })
}

/// In SI units, with its relative spread.
fn value(of: &Quantity, measured: &Measured) -> Option<(f64, Option<f64>)> {
    let relative = |id: &str| {
        let benchmark = measured.benchmark(id)?;
        Some((benchmark, benchmark.deviation / benchmark.median))
    };
    match of {
        Quantity::Time(id) => {
            let (benchmark, spread) = relative(id)?;
            Some((benchmark.median, Some(spread)))
        }
        Quantity::Rate(id) => {
            let (benchmark, spread) = relative(id)?;
            Some((benchmark.rate()?, Some(spread)))
        }
        Quantity::Multiple(first, second) => {
            let ((first, a), (second, b)) = (relative(first)?, relative(second)?);
            Some((first.median / second.median, Some(a.hypot(b))))
        }
        Quantity::MultipleOfRate(first, second) => {
            let ((first, a), (second, b)) = (relative(first)?, relative(second)?);
            Some((first.rate()? / second.rate()?, Some(a.hypot(b))))
        }
        Quantity::Process(name) => {
            let program = measured.program(name)?;
            let half = 0.5 * (program.greatest - program.least) / program.median;
            Some((program.median, (program.runs > 1).then_some(half)))
        }
        Quantity::Memory(name) => {
            let bytes = measured.program(name)?.peak_memory?;
            Some((
                u32::try_from(bytes / 1024).map(f64::from).ok()? * 1024.0,
                None,
            ))
        }
    }
}

//! Target with its measured result.

use super::error::BenchError;
use super::measured::{Benchmark, Measured};
use super::target::{Baseline, Quantity, Row, Target, Targets};

/// Result of the software for a row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RowResult {
    /// Result in the unit of the row.
    pub(super) ours: f64,
    /// Result of the quickest samples or runs.
    pub(super) best: f64,
    /// Median absolute deviation relative to the median of a benchmark; half the range relative to
    /// the median of a program with several runs.
    pub(super) spread: Option<f64>,
    /// Fraction of the allowed target: above 1 it is missed.
    pub(super) used: f64,
    /// Baseline in the unit of the row.
    pub(super) baseline: Option<f64>,
    /// Factor by which ours is quicker or smaller than the baseline.
    pub(super) better: Option<f64>,
}

impl RowResult {
    pub(super) fn is_met(&self) -> bool {
        self.used <= 1.0
    }
}

/// Returns the result of each row of each section, in their order. A row without a measurement is
/// an error.
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
    let Value { ours, best, spread } = value(&row.of, measured)?;
    let unit = row.unit.a_si();
    let (ours, best) = (unit * ours, unit * best);
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
            Some(unit * value(&of, measured)?.ours)
        }
    };
    let better = baseline.map(|baseline| match row.target {
        Target::AtMost(_) => baseline / ours,
        Target::AtLeast(_) => ours / baseline,
    });
    Some(RowResult {
        ours,
        best,
        spread,
        used,
        baseline,
        better,
    })
}

/// Value in SI units, except for the relative spread.
struct Value {
    ours: f64,
    best: f64,
    spread: Option<f64>,
}

fn value(of: &Quantity, measured: &Measured) -> Option<Value> {
    let spread = |benchmark: &Benchmark| benchmark.deviation / benchmark.median;
    let pair = |first: &str, second: &str| {
        let (first, second) = (measured.benchmark(first)?, measured.benchmark(second)?);
        Some((first, second, Some(spread(first).hypot(spread(second)))))
    };
    match of {
        Quantity::Time(id) => {
            let found = measured.benchmark(id)?;
            Some(Value {
                ours: found.median,
                best: found.least,
                spread: Some(spread(found)),
            })
        }
        Quantity::Rate(id) => {
            let found = measured.benchmark(id)?;
            Some(Value {
                ours: found.rate(found.median)?,
                best: found.rate(found.least)?,
                spread: Some(spread(found)),
            })
        }
        Quantity::Multiple(first, second) => {
            let (first, second, spread) = pair(first, second)?;
            Some(Value {
                ours: first.median / second.median,
                best: first.least / second.least,
                spread,
            })
        }
        Quantity::MultipleOfRate(first, second) => {
            let (first, second, spread) = pair(first, second)?;
            Some(Value {
                ours: first.rate(first.median)? / second.rate(second.median)?,
                best: first.rate(first.least)? / second.rate(second.least)?,
                spread,
            })
        }
        Quantity::Process(name) => {
            let program = measured.program(name)?;
            let half = 0.5 * (program.greatest - program.least) / program.median;
            Some(Value {
                ours: program.median,
                best: program.least,
                spread: (program.runs > 1).then_some(half),
            })
        }
        Quantity::Memory(name) => {
            let kilobytes = u32::try_from(measured.program(name)?.peak_memory? / 1024).ok()?;
            let bytes = 1024.0 * f64::from(kilobytes);
            Some(Value {
                ours: bytes,
                best: bytes,
                spread: None,
            })
        }
    }
}

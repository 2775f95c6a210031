//! Targets with their measured results.

use crate::{Outcome, none_of};

use super::measured::{Before, Benchmark, Measured, four_digits};
use super::target::{Baseline, Growth, Quantity, Row, Target, Targets};

/// Result of the software for a row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RowResult {
    /// Result in the unit of the row.
    pub(super) ours: f64,
    /// Spread relative to the median: the median absolute deviation of a benchmark, half the range
    /// of a program with several runs.
    pub(super) spread: Option<f64>,
    /// Fraction of the allowed value that the result uses (for rates, allowed value over result);
    /// above 1, the target is missed.
    pub(super) used: f64,
    /// Baseline in the unit of the row.
    pub(super) baseline: Option<f64>,
    /// Factor by which the result is faster or smaller than the baseline.
    pub(super) better: Option<f64>,
    /// Bound in the unit of the row.
    pub(super) bound: Option<f64>,
    /// Result as a multiple of the bound; for rates, the bound as a multiple of the result.
    pub(super) of_bound: Option<f64>,
    /// Result of the previous run, in the unit of the row.
    pub(super) before: Option<f64>,
}

/// Exponent of a growth, measured between its two sizes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct GrowthResult {
    /// Smaller size, in SI units.
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) exponent: f64,
}

impl RowResult {
    pub(super) fn is_met(&self) -> bool {
        self.used <= 1.0
    }

    /// Returns the relative change since the previous run, if it is more than a tenth and more than
    /// three spreads.
    pub(super) fn moved(&self) -> Option<f64> {
        let change = self.ours / self.before? - 1.0;
        (change.abs() > 0.1_f64.max(3.0 * self.spread.unwrap_or(0.0))).then_some(change)
    }
}

/// Returns the result of each row of each section, in the order of the file. A row without a
/// measurement is an error.
pub(super) fn results(targets: &Targets, measured: &Measured) -> Outcome<Vec<Vec<RowResult>>> {
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
    none_of(&missing, "rows have no measurement")?;
    Ok(sections)
}

/// Returns each growth, in the order of the file.
pub(super) fn growth(targets: &Targets, measured: &Measured) -> Outcome<Vec<GrowthResult>> {
    let of = |growth: &Growth| {
        let (from, to) = (&growth.from, &growth.to);
        let (first, second) = (value(&from.0, measured)?.ours, value(&to.0, measured)?.ours);
        Some(GrowthResult {
            from: first,
            to: second,
            exponent: (second / first).ln() / (to.1 / from.1).ln(),
        })
    };
    targets
        .growth
        .iter()
        .map(|growth| {
            of(growth).ok_or_else(|| {
                let Growth { what, from, to, .. } = growth;
                format!("{what} ({from:?}, {to:?}) has no measurement").into()
            })
        })
        .collect()
}

/// Returns the results of all rows that were measured, by their names.
pub(super) fn by_row(targets: &Targets, measured: &Measured) -> Vec<Before> {
    targets
        .rows()
        .filter_map(|row| {
            Some(Before {
                what: row.what.clone(),
                ours: four_digits(row.unit.a_si() * value(&row.of, measured)?.ours),
            })
        })
        .collect()
}

fn result(row: &Row, measured: &Measured) -> Option<RowResult> {
    let Value { ours, spread } = value(&row.of, measured)?;
    let unit = row.unit.a_si();
    let ours = unit * ours;
    let is_rate = matches!(row.target, Target::AtLeast(_));
    let over = |of: f64| if is_rate { of / ours } else { ours / of };
    let bound = match &row.bound {
        Some(bound) => Some(unit * value(&bound.of, measured)?.ours),
        None => None,
    };
    let of_bound = bound.map(over);
    let used = match row.target {
        Target::AtMost(limit) | Target::AtLeast(limit) => over(limit),
        Target::OfBound(limit) => of_bound? / limit,
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
    let before = measured
        .before
        .iter()
        .find(|before| before.what == row.what);
    Some(RowResult {
        ours,
        spread,
        used,
        baseline,
        better: baseline.map(|baseline| 1.0 / over(baseline)),
        bound,
        of_bound,
        before: before.map(|before| before.ours),
    })
}

/// Value in SI units, with its relative spread.
struct Value {
    ours: f64,
    spread: Option<f64>,
}

fn value(of: &Quantity, measured: &Measured) -> Option<Value> {
    let spread = |benchmark: &Benchmark| benchmark.deviation / benchmark.median;
    let pair = |first: &str, second: &str| {
        let (first, second) = (measured.benchmark(first)?, measured.benchmark(second)?);
        Some((first, second, Some(spread(first).hypot(spread(second)))))
    };
    let (ours, spread) = match of {
        Quantity::Time(id) => {
            let found = measured.benchmark(id)?;
            (found.median, Some(spread(found)))
        }
        Quantity::Rate(id) => {
            let found = measured.benchmark(id)?;
            (found.rate(found.median)?, Some(spread(found)))
        }
        Quantity::Multiple(first, second) => {
            let (first, second, spread) = pair(first, second)?;
            (first.median / second.median, spread)
        }
        Quantity::MultipleOfRate(first, second) => {
            let (first, second, spread) = pair(first, second)?;
            let rates = first.rate(first.median)? / second.rate(second.median)?;
            (rates, spread)
        }
        Quantity::Process(name) => {
            let program = measured.program(name)?;
            let half = 0.5 * (program.greatest - program.least) / program.median;
            (program.median, (program.runs > 1).then_some(half))
        }
        Quantity::Memory(name) => {
            let kilobytes = u32::try_from(measured.program(name)?.peak_memory? / 1024).ok()?;
            (1024.0 * f64::from(kilobytes), None)
        }
    };
    Some(Value { ours, spread })
}

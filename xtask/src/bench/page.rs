//! docs/performance.md.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use crate::reproduce::number::significant;
use crate::reproduce::table::Table;

use super::error::BenchError;
use super::kernel::KERNELS;
use super::measured::{Benchmark, Measured};
use super::result::{RowResult, results};
use super::target::{Baseline, Row, Target, Targets};
use super::{COMMAND, MEASURED, TARGETS};

/// Returns the page.
pub(super) fn markdown(targets: &Targets, measured: &Measured) -> Result<String, BenchError> {
    let results = results(targets, measured)?;
    let mut page = head(measured);
    page.push_str(&tally(targets, &results));
    for (section, results) in targets.sections.iter().zip(&results) {
        let _ = write!(page, "\n## {}\n\n", section.title);
        if !section.text.is_empty() {
            let _ = write!(page, "{}\n\n", section.text);
        }
        page.push_str(&rows(&section.rows, results));
    }
    page.push_str(&programs(measured));
    page.push_str(&instructions(measured));
    page.push_str(&without_target(targets, measured));
    Ok(page)
}

fn head(measured: &Measured) -> String {
    let machine = &measured.machine;
    let load = match machine.load_before {
        Some(load) => format!("; {load:.1} processes wanted a processor in the minute before"),
        None => String::new(),
    };
    format!(
        "<!-- Made by `{COMMAND}` from {TARGETS} and {MEASURED}: do not edit by hand. -->\n\n\
         # Performance\n\n\
         Every target that was set, what the software takes, and what else takes for the same. `{COMMAND}` runs the benchmarks and \
         programs and writes this page; `{COMMAND} --check`, in the gate, compares the page with the numbers beside it and the \
         benchmarks with the sources, and runs nothing. A target whose benchmark is gone is an error.\n\n\
         Measured on {}, {} processors, {}, {}{load}. Times are medians of criterion's samples or of whole processes, wall clock; *best* is of the \
         quickest samples, which a busy machine disturbs least, and decides nothing. The spread of a benchmark is its median absolute deviation, that of a program half its range; a program without one ran \
         once. *Used* is the part of what the target allows: above 100 % it is missed. *Times better* compares with the baseline: \
         another benchmark of the same run, or the time of another program as it was recorded on two processors of an AMD EPYC, which the row \
         names (`xtask/baselines.py` takes those of Python packages again). Times of a shared machine say less than ratios; instructions, [below](#instructions-of-the-hottest-kernels), are the same on any day.\n",
        machine.processor, machine.processors, machine.system, machine.compiler,
    )
}

/// Counts the targets that are met, and lists the others.
fn tally(targets: &Targets, results: &[Vec<RowResult>]) -> String {
    let mut table = Table::new(&["", "targets", "met", "missed"]);
    let mut total = (0, 0);
    let mut missed = String::new();
    for (section, results) in targets.sections.iter().zip(results) {
        let met = results.iter().filter(|result| result.is_met()).count();
        total = (total.0 + results.len(), total.1 + met);
        table.row([
            section.title.clone(),
            results.len().to_string(),
            met.to_string(),
            (results.len() - met).to_string(),
        ]);
        for (row, result) in section.rows.iter().zip(results) {
            if !result.is_met() {
                let _ = writeln!(missed, "- {}: {}", row.what, missed_by(row, result));
            }
        }
    }
    table.row([
        "all".to_owned(),
        total.0.to_string(),
        total.1.to_string(),
        (total.0 - total.1).to_string(),
    ]);
    let missed = if missed.is_empty() {
        "None is missed.\n".to_owned()
    } else {
        format!("Missed:\n\n{missed}")
    };
    format!("\n{}\n{missed}", table.markdown())
}

fn missed_by(row: &Row, result: &RowResult) -> String {
    let unit = row.unit.symbol();
    format!(
        "{} {unit}, {} wanted, {} times off",
        significant(result.ours, 3),
        target(row.target),
        significant(result.used, 3)
    )
}

fn target(target: Target) -> String {
    match target {
        Target::AtMost(limit) => format!("≤ {}", plain(limit)),
        Target::AtLeast(limit) => format!("≥ {}", plain(limit)),
    }
}

/// Formats a hand-written number.
fn plain(value: f64) -> String {
    format!("{value}")
}

fn rows(rows: &[Row], results: &[RowResult]) -> String {
    let mut table = Table::new(&[
        "what",
        "unit",
        "target",
        "ours",
        "best",
        "spread",
        "used",
        "verdict",
        "baseline",
        "times better",
        "whose baseline",
        "why that target",
    ]);
    for (row, result) in rows.iter().zip(results) {
        let (baseline, better) = match (result.baseline, result.better) {
            (Some(baseline), Some(better)) => (significant(baseline, 3), significant(better, 2)),
            _ => ("-".to_owned(), "-".to_owned()),
        };
        let whose = match &row.baseline {
            Baseline::None => "-".to_owned(),
            Baseline::Bench(id) => format!("same run: `{id}`"),
            Baseline::Recorded { by, .. } => by.clone(),
        };
        let verdict = if result.is_met() { "met" } else { "**missed**" };
        let cells = [
            row.what.clone(),
            row.unit.symbol().to_owned(),
            target(row.target),
            significant(result.ours, 3),
            significant(result.best, 3),
            result.spread.map_or_else(|| "-".to_owned(), percent),
            percent(result.used),
            verdict.to_owned(),
            baseline,
            better,
            whose,
            row.because.clone(),
        ];
        table.row(cells.map(|cell| cell.replace('|', "\\|")));
    }
    table.markdown()
}

fn percent(part: f64) -> String {
    if part < 0.01 {
        "< 1 %".to_owned()
    } else {
        format!("{:.0} %", 100.0 * part)
    }
}

/// Lists time and memory of every program.
fn programs(measured: &Measured) -> String {
    let mut table = Table::new(&[
        "program",
        "runs",
        "median",
        "least",
        "greatest",
        "peak memory",
    ]);
    for program in &measured.programs {
        let memory = program
            .peak_memory
            .and_then(|bytes| u32::try_from(bytes / 1_000_000).ok())
            .map_or_else(|| "-".to_owned(), |megabytes| format!("{megabytes} MB"));
        table.row([
            program.name.clone(),
            program.runs.to_string(),
            time(program.median),
            time(program.least),
            time(program.greatest),
            memory,
        ]);
    }
    format!(
        "\n## Time and memory of the programs\n\n\
         Peak memory is the high-water mark of the resident set, read every millisecond where the system tells it; `reproduce-all` is the sum of the \
         five papers.\n\n{}",
        table.markdown()
    )
}

fn instructions(measured: &Measured) -> String {
    let counted = &measured.instructions;
    let mut table = Table::new(&[
        "kernel",
        "what a call does",
        "instructions",
        "for each",
        "",
        "spread",
    ]);
    for found in &counted.kernels {
        let Some(kernel) = KERNELS.iter().find(|kernel| kernel.name == found.name) else {
            continue;
        };
        #[expect(clippy::cast_precision_loss, reason = "counts far below 2^52")]
        let each = found.instructions as f64 / f64::from(kernel.count);
        table.row([
            kernel.name.to_owned(),
            kernel.what.to_owned(),
            thousands(found.instructions),
            significant(each, 3),
            kernel.of.to_owned(),
            thousands(found.spread),
        ]);
    }
    format!(
        "\n## Instructions of the hottest kernels\n\n\
         Counted by {} (callgrind) over one call, made with {}. `{COMMAND} --instructions --check` counts again and fails where a kernel \
         needs 2 % more; `{COMMAND} --instructions` takes new counts for reference. Without valgrind nothing is counted and the task says so. The \
         kernels are the loops in which each job of the libraries spends its time; profiles of whole programs put the order of a Prony series, \
         histories between samples, marches and chains first. Valgrind has no AVX-512: what is chosen at run time \
         by the processor counts as on one with AVX2, and the mathematics of the system library is part of the count. The spread is that of two \
         counts.\n\n{}",
        counted.counted_by,
        counted.compiler,
        table.markdown()
    )
}

/// Formats digits in groups of three.
fn thousands(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// Lists measurements without a row.
fn without_target(targets: &Targets, measured: &Measured) -> String {
    let mut with: BTreeSet<&str> = targets.rows().flat_map(|row| row.of.benchmarks()).collect();
    for row in targets.rows() {
        if let Baseline::Bench(id) = &row.baseline {
            with.insert(id);
        }
    }
    let mut table = Table::new(&["benchmark", "time", "least", "spread", "M/s"]);
    let mut rest: Vec<&Benchmark> = measured
        .benchmarks
        .iter()
        .filter(|benchmark| !with.contains(benchmark.id.as_str()))
        .collect();
    rest.sort_by(|a, b| (&a.program, &a.id).cmp(&(&b.program, &b.id)));
    for benchmark in rest {
        table.row([
            format!(
                "`{}: {}`",
                benchmark.program,
                benchmark.id.replace('|', "\\|")
            ),
            time(benchmark.median),
            time(benchmark.least),
            percent(benchmark.deviation / benchmark.median),
            benchmark
                .rate(benchmark.median)
                .map_or_else(|| "-".to_owned(), |rate| significant(1e-6 * rate, 3)),
        ]);
    }
    format!(
        "\n## Without a target\n\n\
         Benchmarks that compare: of laws, sizes and ways with each other. The last column is elements a second, where a benchmark counts them.\n\n{}",
        table.markdown()
    )
}

/// Formats with the unit that leaves one to three digits before the point.
fn time(seconds: f64) -> String {
    let (factor, unit) = match seconds {
        s if s < 1e-3 => (1e6, "µs"),
        s if s < 1.0 => (1e3, "ms"),
        _ => (1.0, "s"),
    };
    format!("{} {unit}", significant(factor * seconds, 3))
}

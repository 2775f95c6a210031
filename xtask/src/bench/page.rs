//! Text of docs/performance.md.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use crate::Outcome;
use crate::reproduce::{Table, table_of};
use rodwave::digits::significant;

use super::kernel::KERNELS;
use super::measured::{Benchmark, Measured};
use super::result::{GrowthResult, RowResult, growth, results};
use super::target::{Baseline, Growth, Quantity, Row, Target, Targets, Unit};
use super::{COMMAND, MEASURED, TARGETS};

/// Returns the page.
pub(super) fn markdown(targets: &Targets, measured: &Measured) -> Outcome<String> {
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
    page.push_str(&grown(&targets.growth, &growth(targets, measured)?));
    page.push_str(&programs(measured));
    page.push_str(&instructions(measured));
    page.push_str(&without_target(targets, measured));
    Ok(page)
}

fn head(measured: &Measured) -> String {
    let machine = &measured.machine;
    let quick = if machine.quick {
        ", by a quick run"
    } else {
        ""
    };
    let load = match machine.load_before {
        Some(load) => format!(
            "; in the minute before, {load:.1} processes were running or waiting for a processor"
        ),
        None => String::new(),
    };
    format!(
        "<!-- Made by `{COMMAND}` from {TARGETS} and {MEASURED}: do not edit by hand. -->\n\n\
         # Performance\n\n\
         For every target that was set, this page shows the time of this software, the shortest time in which the machine can do the essential \
         part of the task, and the time of other software. `{COMMAND}` runs the benchmarks and programs and writes this page; \
         `{COMMAND} --quick` does so in a few minutes and writes it to target/bench; `{COMMAND} --check`, which is part of the gate, runs no \
         benchmark: it compares the page with the files of targets and measurements, and the names of the benchmarks with the sources. A target \
         without a benchmark is an error, and so is a missed target without a reason.\n\n\
         Measured on {}, {} processors, {}, {}{quick}{load}. Times are medians of criterion's samples or of whole processes, wall clock. The \
         value after ± is the median absolute deviation of a benchmark, or half the range of a program that ran more than once. A *bound* is the \
         essential part alone, such as the transforms, a copy or the bare recurrence, measured in the same run. *Of the bound* is our time \
         divided by the bound; for rates, it is the bound divided by our rate. *Others* is another benchmark of the same run, or the time of \
         another program as it was recorded on two processors of an AMD EPYC (`xtask/baselines.py` measures those of Python packages again), \
         followed by the factor by which ours is better. *Moved* is the change since the last run, if it exceeds a tenth and three times the \
         spread. On a shared machine, ratios are more reliable than times; the instruction counts \
         [below](#instructions-of-the-hottest-kernels) do not depend on the load.\n",
        machine.processor, machine.processors, machine.system, machine.compiler,
    )
}

/// Counts the targets that are met, and lists the others.
fn tally(targets: &Targets, results: &[Vec<RowResult>]) -> String {
    let mut table = Table::new(&["", "targets", "met", "missed"]);
    let mut row = |title: &str, [all, met]: [usize; 2]| {
        let counts = [all, met, all - met].map(|count| count.to_string());
        table.row(std::iter::once(title.to_owned()).chain(counts));
    };
    let mut total = [0, 0];
    let mut missed = String::new();
    for (section, results) in targets.sections.iter().zip(results) {
        let met = results.iter().filter(|result| result.is_met()).count();
        total = [total[0] + results.len(), total[1] + met];
        row(&section.title, [results.len(), met]);
        for (row, result) in section.rows.iter().zip(results) {
            if !result.is_met() {
                let _ = writeln!(missed, "- {}: {}", row.what, missed_by(row, result));
            }
        }
    }
    row("all", total);
    let missed = if missed.is_empty() {
        "None is missed.\n".to_owned()
    } else {
        format!("Missed:\n\n{missed}")
    };
    format!("\n{}\n{missed}", table.markdown())
}

fn missed_by(row: &Row, result: &RowResult) -> String {
    let why = match row.missed.trim() {
        "" => "**no reason is given**",
        why => why,
    };
    format!(
        "{}, target {}, missed by a factor of {}. {why}",
        of_unit(result.ours, row.unit),
        target(row),
        significant(result.used, 3)
    )
}

/// Formats a value with three digits and the unit of a row.
fn of_unit(value: f64, unit: Unit) -> String {
    format!("{} {}", significant(value, 3), unit.symbol())
}

fn target(row: &Row) -> String {
    let unit = row.unit.symbol();
    match row.target {
        Target::AtMost(limit) => format!("≤ {limit} {unit}"),
        Target::AtLeast(limit) => format!("≥ {limit} {unit}"),
        Target::OfBound(limit) => format!("≤ {limit} × the bound"),
    }
}

fn rows(rows: &[Row], results: &[RowResult]) -> String {
    let nothing = || "-".to_owned();
    let ours = |row: &Row, result: &RowResult| {
        let spread = result
            .spread
            .map(|spread| format!(" ± {}", percent(spread)));
        of_unit(result.ours, row.unit) + &spread.unwrap_or_default()
    };
    let bound = |row: &Row, result: &RowResult| match (result.bound, &row.bound) {
        (Some(value), Some(bound)) => format!("{} ({})", significant(value, 3), bound.is),
        _ => nothing(),
    };
    let others = |row: &Row, result: &RowResult| {
        let (Some(baseline), Some(better)) = (result.baseline, result.better) else {
            return nothing();
        };
        let whose = match &row.baseline {
            Baseline::Bench(id) => format!("`{id}`"),
            Baseline::Recorded { by, .. } => by.clone(),
            Baseline::None => nothing(),
        };
        let better = significant(better, 2);
        format!("{} ({whose}): {better} ×", significant(baseline, 3))
    };
    let text = |cell: String| cell.replace('|', "\\|");
    table_of!(rows.iter().zip(results), |(row, result)|
        "what" => text(row.what.clone()),
        "target" => target(row),
        "ours" => ours(row, result),
        "verdict" => if result.is_met() { "met" } else { "**missed**" },
        "bound" => text(bound(row, result)),
        "of the bound" => result.of_bound.map_or_else(nothing, |of| significant(of, 3)),
        "others" => text(others(row, result)),
        "moved" => result.moved().map_or_else(nothing, |moved| format!("{:+.0} %", 100.0 * moved)),
        "why that target" => text(row.because.clone()),
    )
    .markdown()
}

/// Lists the exponents of time and memory.
fn grown(growth: &[Growth], results: &[GrowthResult]) -> String {
    let shown = |(of, size): &(Quantity, f64), value: f64| match of {
        Quantity::Memory(_) => format!("{size}: {} MB", significant(1e-6 * value, 3)),
        _ => format!("{size}: {}", time(value)),
    };
    let too_much = |row: &Growth, result: &GrowthResult| {
        if result.exponent > row.at_most {
            "**exceeded** "
        } else {
            ""
        }
    };
    let table = table_of!(growth.iter().zip(results), |(row, result)|
        "what" => row.what,
        "with" => row.with,
        "from" => shown(&row.from, result.from),
        "to" => shown(&row.to, result.to),
        "exponent" => format!("{:.2}", result.exponent),
        "at most" => row.at_most,
        "" => format!("{}{}", too_much(row, result), row.because),
    );
    format!(
        "\n## Growth\n\nTime or memory at two sizes of the task, and the exponent of the growth between them: 1 if the time or memory is proportional to the size.\n\n{}",
        table.markdown()
    )
}

fn percent(part: f64) -> String {
    if part < 0.01 {
        "< 1 %".to_owned()
    } else {
        format!("{:.0} %", 100.0 * part)
    }
}

/// Lists time and memory of each program.
fn programs(measured: &Measured) -> String {
    let memory = |bytes: u64| u32::try_from(bytes / 1_000_000).ok();
    let table = table_of!(&measured.programs, |program|
        "program" => program.name,
        "runs" => program.runs,
        "median" => time(program.median),
        "least" => time(program.least),
        "greatest" => time(program.greatest),
        "peak memory" => program
            .peak_memory
            .and_then(memory)
            .map_or_else(|| "-".to_owned(), |megabytes| format!("{megabytes} MB")),
    );
    format!(
        "\n## Time and memory of the programs\n\n\
         Peak memory is the high-water mark of the resident set, read every millisecond on systems that report it; `reproduce-all` is the sum of the \
         five papers.\n\n{}",
        table.markdown()
    )
}

fn instructions(measured: &Measured) -> String {
    let counted = &measured.instructions;
    let kernels = counted.kernels.iter().filter_map(|found| {
        let kernel = KERNELS.iter().find(|kernel| kernel.name == found.name)?;
        Some((found, kernel))
    });
    let table = table_of!(kernels, |(found, kernel)|
        "kernel" => kernel.name,
        "what a call does" => kernel.what,
        "instructions" => thousands(found.instructions),
        "for each" => significant(found.instructions as f64 / f64::from(kernel.count), 3),
        "" => kernel.of,
        "spread" => thousands(found.spread),
    );
    format!(
        "\n## Instructions of the hottest kernels\n\n\
         Counted by {} (callgrind) over one call, compiled with {}. `{COMMAND} --instructions --check` counts again and fails if a kernel \
         needs 2 % more; `{COMMAND} --instructions` writes new reference counts. If valgrind is installed, the gate counts in its own build \
         profile. The kernels are the loops in which the jobs spend most of their time: the order of a Prony series, histories between samples, time \
         marching, chains. Valgrind does not support AVX-512: code that selects its instructions at run time is counted with AVX2. The \
         mathematical functions of the system library are counted too. The spread is the difference of two counts.\n\n{}",
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

/// Lists the measurements that no row uses.
fn without_target(targets: &Targets, measured: &Measured) -> String {
    let mut with: BTreeSet<&str> = targets
        .quantities()
        .flat_map(|(_, of)| of.benchmarks())
        .collect();
    for row in targets.rows() {
        if let Baseline::Bench(id) = &row.baseline {
            with.insert(id);
        }
    }
    let mut rest: Vec<&Benchmark> = measured
        .benchmarks
        .iter()
        .filter(|benchmark| !with.contains(benchmark.id.as_str()))
        .collect();
    rest.sort_by(|a, b| (&a.program, &a.id).cmp(&(&b.program, &b.id)));
    let table = table_of!(rest, |one|
        "benchmark" => format!("`{}: {}`", one.program, one.id.replace('|', "\\|")),
        "time" => time(one.median),
        "least" => time(one.least),
        "spread" => percent(one.deviation / one.median),
        "M/s" => one
            .rate(one.median)
            .map_or_else(|| "-".to_owned(), |rate| significant(1e-6 * rate, 3)),
    );
    format!(
        "\n## Without a target\n\n\
         Benchmarks that compare laws, sizes or methods with each other. The last column is the number of elements per second, in millions, if a benchmark counts elements.\n\n{}",
        table.markdown()
    )
}

/// Formats a time with the unit that leaves one to three digits before the point.
fn time(seconds: f64) -> String {
    let (factor, unit) = match seconds {
        s if s < 1e-3 => (1e6, "µs"),
        s if s < 1.0 => (1e3, "ms"),
        _ => (1.0, "s"),
    };
    format!("{} {unit}", significant(factor * seconds, 3))
}

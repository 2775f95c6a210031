//! `cargo xtask bench`: docs/performance.md, with every target, the results of this software, and
//! those of other software for the same task.
//!
//! docs/performance.ron contains the targets with their reasons, docs/performance-measured.ron the
//! numbers of the last complete run. The page is made from both files and can be checked without a
//! run. Times must be measured on an idle machine; the instruction counts of the hottest kernels do
//! not depend on the load.

mod criterion;
mod instructions;
mod kernel;
mod machine;
mod measured;
mod page;
mod program;
mod result;
mod target;

use std::path::Path;

use crate::Outcome;
use testbed::generated::{ensure_file_contents, workspace_root, write_whole};

use kernel::KERNELS;
use measured::Measured;
use program::Programs;
use target::{Quantity, Targets};

pub(crate) use kernel::run as run_kernel;

/// Command that makes the page.
const COMMAND: &str = "cargo xtask bench";
/// Hand-written targets.
const TARGETS: &str = "docs/performance.ron";
/// Measured results.
const MEASURED: &str = "docs/performance-measured.ron";
/// Page made from these two files.
const PAGE: &str = "docs/performance.md";
/// Folder for the files of the runs, below the root.
const WORK: &str = "target/bench";

/// Task to be performed.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Task {
    /// Run everything and write numbers and page.
    Measure,
    /// Run for a shorter time, without the longest programs and without counting instructions, and
    /// write numbers and page to target/bench.
    Try,
    /// Run nothing, and write the page again from the existing numbers.
    Page,
    /// Run nothing, and check that the page is current.
    Check,
    /// Count instructions and store them as the reference.
    Count,
    /// Count instructions and compare them with the reference. If this is impossible, it is an
    /// error, or with `where_possible` a printed remark.
    CompareCounts { where_possible: bool },
}

/// Length of the measurements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pace {
    Whole,
    Quick,
}

impl Pace {
    fn choose<T>(self, whole: T, quick: T) -> T {
        match self {
            Self::Whole => whole,
            Self::Quick => quick,
        }
    }
}

/// Performs the `task`.
pub(crate) fn run(task: Task) -> Outcome {
    let root = workspace_root();
    if cfg!(debug_assertions) && matches!(task, Task::Measure | Task::Try) {
        return Err(
            "times of an unoptimised build are meaningless: call `cargo xtask bench`".into(),
        );
    }
    let targets = Targets::read(&root.join(TARGETS))?;
    known_programs(&targets, &root.join(TARGETS))?;
    let (record, page) = (root.join(MEASURED), root.join(PAGE));
    match task {
        Task::Measure => {
            let before = Measured::read(&record).unwrap_or_default();
            let last = result::by_row(&targets, &before);
            let mut measured = measure(root, Pace::Whole, before)?;
            measured.before = last;
            // the page is made first, so that numbers from which no page can be made are not stored
            let text = page::markdown(&targets, &measured)?;
            measured.write(&record)?;
            write_whole(&page, &text)?;
            say(&text, PAGE);
        }
        Task::Try => {
            let before = Measured::read(&record).unwrap_or_default();
            let measured = measure(root, Pace::Quick, before)?;
            let work = root.join(WORK);
            measured.write(&work.join("performance-measured.ron"))?;
            let text = page::markdown(&targets, &measured)?;
            write_whole(&work.join("performance.md"), &text)?;
            say(&text, "target/bench/performance.md");
        }
        Task::Page => {
            let text = page::markdown(&targets, &Measured::read(&record)?)?;
            write_whole(&page, &text)?;
            say(&text, PAGE);
        }
        Task::Check => {
            let measured = Measured::read(&record)?;
            same_benchmarks(root, &measured)?;
            let text = page::markdown(&targets, &measured)?;
            ensure_file_contents(&page, &text, true, COMMAND)?;
            reasons(&targets, &measured, &root.join(TARGETS))?;
            say(&text, PAGE);
        }
        Task::Count => {
            let mut measured = Measured::read(&record)?;
            *measured.own_instructions() = count(root)?;
            measured.write(&record)?;
            write_whole(&page, &page::markdown(&targets, &measured)?)?;
            for kernel in &measured.own_instructions().kernels {
                println!(
                    "{}: {} instructions, spread {}",
                    kernel.name, kernel.instructions, kernel.spread
                );
            }
        }
        Task::CompareCounts { where_possible } => {
            let mut measured = Measured::read(&record)?;
            let reference = measured.own_instructions();
            if where_possible && let Some(reason) = instructions::not_comparable(reference) {
                println!("{reason}: no instructions were counted");
                return Ok(());
            }
            let moved = instructions::compare(reference, &count(root)?)?;
            for kernel in &moved {
                println!("{kernel}");
            }
            println!(
                "{} kernels counted, {} with exactly the counts of {MEASURED}",
                KERNELS.len(),
                KERNELS.len() - moved.len()
            );
        }
    }
    Ok(())
}

/// Prints the number of targets that are met and missed, the missed targets, and the `path` of the
/// page.
fn say(page: &str, path: &str) {
    let tally = page.lines().skip_while(|line| !line.starts_with("| "));
    for line in tally.take_while(|line| !line.starts_with("## ")) {
        println!("{line}");
    }
    println!("{path}");
}

/// Checks that every program named in a row exists.
fn known_programs(targets: &Targets, path: &Path) -> Outcome {
    for (what, of) in targets.quantities() {
        if let Quantity::Process(name) | Quantity::Memory(name) = of
            && !program::NAMES.contains(&name.as_str())
        {
            let expected = program::NAMES.join("; ");
            let reason = format!("there is no program `{name}`, expected one of {expected}");
            return Err(target::fault(path, what, &reason));
        }
    }
    Ok(())
}

/// Checks that a reason is given for every missed target and for every growth beyond its limit.
fn reasons(targets: &Targets, measured: &Measured, path: &Path) -> Outcome {
    let results = result::results(targets, measured)?.into_iter().flatten();
    let rows = targets.rows().zip(results).filter_map(|(row, result)| {
        (!result.is_met() && row.missed.trim().is_empty()).then_some(&row.what)
    });
    let grown = result::growth(targets, measured)?;
    let growth = targets
        .growth
        .iter()
        .zip(grown)
        .filter_map(|(row, result)| {
            (result.exponent > row.at_most && row.because.trim().is_empty()).then_some(&row.what)
        });
    match rows.chain(growth).next() {
        None => Ok(()),
        Some(what) => {
            let reason = "missed, but the reason and what was tried are not stated";
            Err(target::fault(path, what, reason))
        }
    }
}

/// Checks that the benchmark programs and kernels in the sources are those that were measured.
fn same_benchmarks(root: &Path, measured: &Measured) -> Outcome {
    let benches = criterion::programs(root)?;
    let there: Vec<String> = benches
        .iter()
        .map(criterion::BenchProgram::path)
        .chain(KERNELS.iter().map(|kernel| kernel.name.to_owned()))
        .collect();
    let mut known: Vec<String> = measured
        .benchmarks
        .iter()
        .map(|benchmark| benchmark.program.clone())
        .chain(
            measured
                .instructions
                .kernels
                .iter()
                .map(|kernel| kernel.name.clone()),
        )
        .collect();
    known.sort();
    known.dedup();
    let without = |all: &[String], others: &[String]| -> Vec<String> {
        all.iter()
            .filter(|name| !others.contains(name))
            .cloned()
            .collect()
    };
    let (not_measured, not_there) = (without(&there, &known), without(&known, &there));
    if not_measured.is_empty() && not_there.is_empty() {
        Ok(())
    } else {
        Err(format!(
            "benchmarks of the sources and of the measurements differ: not measured {not_measured:?}, not in the sources \
             {not_there:?}; run `{COMMAND}`"
        )
        .into())
    }
}

/// Runs all benchmarks and programs, and counts the instructions of the kernels. Without valgrind,
/// and in a quick run, the counts of `before` are kept.
fn measure(root: &Path, pace: Pace, before: Measured) -> Outcome<Measured> {
    let machine = machine::machine(pace == Pace::Quick);
    let work = root.join(WORK);
    eprintln!("building the programs and writing their records");
    let programs = Programs::prepare(root, &work.join("programs"))?;
    eprintln!("benchmarks");
    let mut benchmarks = Vec::new();
    for bench in criterion::programs(root)? {
        eprintln!("  {}", bench.path());
        benchmarks.extend(criterion::run(root, &bench, pace, &work.join("criterion"))?);
    }
    eprintln!("programs");
    let programs = programs.time(pace, &before)?;
    let instructions_in_gate = before.instructions_in_gate;
    let instructions = if pace == Pace::Quick {
        before.instructions
    } else if instructions::counter().is_none() {
        eprintln!("instructions: valgrind is not installed; the counts of {MEASURED} are kept");
        before.instructions
    } else {
        eprintln!("instructions");
        count(root)?
    };
    Ok(Measured {
        machine,
        benchmarks,
        programs,
        instructions,
        instructions_in_gate,
        before: Vec::new(),
    })
}

fn count(root: &Path) -> Outcome<measured::Instructions> {
    instructions::count(&root.join(WORK).join("callgrind"))
}

#[cfg(test)]
mod tests;

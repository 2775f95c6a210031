//! `cargo xtask bench`: docs/performance.md, every target with what the software takes and what else takes for the same.
//!
//! docs/performance.ron says what is asked and why, docs/performance-measured.ron holds the numbers of the last whole run. The page is made of
//! both, so that it can be checked without running anything. Times need a quiet machine; the instructions of the
//! hottest kernels do not.

mod criterion;
mod error;
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

use error::BenchError;
use kernel::KERNELS;
use measured::Measured;
use program::Programs;
use target::{Quantity, Targets};

pub(crate) use kernel::run as run_kernel;

/// The command that makes the page.
const COMMAND: &str = "cargo xtask bench";
/// What is asked, by hand.
const TARGETS: &str = "docs/performance.ron";
/// What was measured.
const MEASURED: &str = "docs/performance-measured.ron";
/// What is made of both.
const PAGE: &str = "docs/performance.md";
/// What the runs leave behind, below the root.
const WORK: &str = "target/bench";

/// What is to be done.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Task {
    /// Run everything and write numbers and page.
    Measure,
    /// Run everything for a shorter time and write a page beside the repository's.
    Try,
    /// Run nothing, and make the page of the numbers there are.
    Page,
    /// Run nothing.
    Check,
    /// Count instructions and take them for reference.
    Count,
    /// Count instructions and compare them with the reference.
    CompareCounts,
}

/// How long is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pace {
    Whole,
    Quick,
}

impl Pace {
    fn warm_up_seconds(self) -> &'static str {
        match self {
            Self::Whole => "0.3",
            Self::Quick => "0.1",
        }
    }

    fn measurement_seconds(self) -> &'static str {
        match self {
            Self::Whole => "0.7",
            Self::Quick => "0.2",
        }
    }

    fn samples(self) -> &'static str {
        match self {
            Self::Whole => "20",
            Self::Quick => "10",
        }
    }

    /// Of a program that takes less than a second.
    fn runs(self) -> usize {
        match self {
            Self::Whole => 11,
            Self::Quick => 3,
        }
    }
}

/// Does the `task`.
pub(crate) fn run(task: Task) -> Outcome {
    let root = workspace_root();
    if cfg!(debug_assertions) && !matches!(task, Task::Page | Task::Check) {
        return Err(Box::new(BenchError::Unoptimised));
    }
    let targets = Targets::read(&root.join(TARGETS))?;
    known_programs(&targets, &root.join(TARGETS))?;
    let (record, page) = (root.join(MEASURED), root.join(PAGE));
    match task {
        Task::Measure => {
            let before = Measured::read(&record).unwrap_or_default();
            let measured = measure(root, Pace::Whole, before)?;
            // what cannot be shown is not kept
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
            say(&text, PAGE);
        }
        Task::Count => {
            let mut measured = Measured::read(&record)?;
            measured.instructions = count(root)?;
            measured.write(&record)?;
            write_whole(&page, &page::markdown(&targets, &measured)?)?;
            for kernel in &measured.instructions.kernels {
                println!(
                    "{}: {} instructions, spread {}",
                    kernel.name, kernel.instructions, kernel.spread
                );
            }
        }
        Task::CompareCounts => {
            let measured = Measured::read(&record)?;
            let moved = instructions::compare(&measured.instructions, &count(root)?)?;
            for kernel in &moved {
                println!("{kernel}");
            }
            println!(
                "{} kernels counted, {} as in {MEASURED} to the instruction",
                KERNELS.len(),
                KERNELS.len() - moved.len()
            );
        }
    }
    Ok(())
}

/// The part of the page that a person wants to see at once.
fn say(page: &str, path: &str) {
    let tally = page.lines().skip_while(|line| !line.starts_with("| "));
    for line in tally.take_while(|line| !line.starts_with("## ")) {
        println!("{line}");
    }
    println!("{path}");
}

/// Every program that a row names is one that is run.
fn known_programs(targets: &Targets, path: &Path) -> Result<(), BenchError> {
    for row in targets.rows() {
        if let Quantity::Process(name) | Quantity::Memory(name) = &row.of
            && !program::NAMES.contains(&name.as_str())
        {
            return Err(BenchError::Row {
                path: path.to_path_buf(),
                what: row.what.clone(),
                reason: format!(
                    "there is no program `{name}`, expected one of {}",
                    program::NAMES.join("; ")
                ),
            });
        }
    }
    Ok(())
}

/// The benchmark programs and kernels of the sources are those that were measured.
fn same_benchmarks(root: &Path, measured: &Measured) -> Result<(), BenchError> {
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
        Err(BenchError::OtherBenchmarks {
            not_measured,
            not_there,
            command: COMMAND,
        })
    }
}

/// Runs all benchmarks, programs and, where valgrind is, kernels; `before` lends its counts where it is not.
fn measure(root: &Path, pace: Pace, before: Measured) -> Result<Measured, BenchError> {
    let machine = machine::machine();
    let work = root.join(WORK);
    eprintln!("programs: build and records");
    let programs = Programs::prepare(root, &work.join("programs"))?;
    eprintln!("benchmarks");
    let mut benchmarks = Vec::new();
    for bench in criterion::programs(root)? {
        eprintln!("  {}", bench.path());
        benchmarks.extend(criterion::run(root, &bench, pace, &work.join("criterion"))?);
    }
    eprintln!("programs");
    let programs = programs.time(pace)?;
    let instructions = if pace == Pace::Quick {
        before.instructions
    } else if instructions::valgrind().is_none() {
        eprintln!("instructions: valgrind is not installed; the counts of {MEASURED} stay");
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
    })
}

fn count(root: &Path) -> Result<measured::Instructions, BenchError> {
    instructions::count(&root.join(WORK).join("callgrind"))
}

#[cfg(test)]
mod tests;

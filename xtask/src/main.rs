//! Tasks of this workspace: `cargo xtask <task>`.
//!
//! Each task has its own file. The tasks combine the library crates. A step that a second program
//! would need belongs in a library, not here.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a command-line program writes to the terminal"
)]
#![allow(
    clippy::indexing_slicing,
    reason = "a tool of this project only: an index out of bounds makes the gate fail and states its place"
)]

mod api;
mod bench;
mod book;
mod cargo;
#[cfg(test)]
mod circles;
mod faults;
mod files;
mod fixtures;
mod outside;
mod package;
mod reproduce;
mod snapshot;
mod traceability;
mod validate;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use reproduce::Paper;

/// Fixtures, reproductions of the papers, and validation.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Write fixtures/golden from the transcribed tables of fixtures/papers.
    Fixtures {
        /// Change nothing; fail if a golden file is not current, and name the command to run.
        #[arg(long)]
        check: bool,
    },
    /// Restore former faults, each in a copy of the tree, and require that the tests that detect
    /// the fault fail.
    Faults {
        /// Faults by the names of their patches; all faults if none is named.
        names: Vec<String>,
        /// Compile nothing; fail if a patch does not apply to the tree, or if a test does not
        /// exist.
        #[arg(long)]
        check: bool,
    },
    /// Reproduce the tables and figures of paper A (complex modulus from end-point accelerations)
    /// on virtual tests.
    ReproducePaperA(Comparison),
    /// Reproduce the tables and figures of paper B (complex modulus from three strains in a
    /// structure) on virtual tests.
    ReproducePaperB(Comparison),
    /// Reproduce the tables and figures of paper C (loss factor during creep recovery) on virtual
    /// tests.
    ReproducePaperC(Comparison),
    /// Reproduce the tables of paper D (identification of viscoelastic materials) on virtual tests.
    ReproducePaperD(Comparison),
    /// Reproduce the figures of paper E (impact force from impulse responses) on virtual bodies and
    /// measurements.
    ReproducePaperE(Comparison),
    /// Reproduce every paper and print its findings.
    ReproduceAll(Comparison),
    /// Check the pages of docs and make a book of them in target/book.
    Book {
        /// Only check: every page is in the summary, no link or anchor is dead, equations can be
        /// converted, names exist.
        #[arg(long)]
        check: bool,
        /// Build if mdbook is installed; otherwise report that it is missing.
        #[arg(long, conflicts_with = "check")]
        if_installed: bool,
    },
    /// Run cargo doc, convert the equations in its pages, and link the pages to those of the book.
    Doc,
    /// Preprocessor for the equations, which mdBook calls.
    #[command(hide = true)]
    BookEquations {
        #[command(subcommand)]
        question: Option<Question>,
    },
    /// Write docs/traceability.md: every numbered item of the thesis, with its code and its proof.
    Traceability {
        /// Change nothing; fail if the page is not current.
        #[arg(long)]
        check: bool,
    },
    /// Build a program outside the workspace with each library crate alone, and write
    /// docs/dependencies.md with the dependencies of each crate.
    Outside {
        /// Change nothing in the repository; fail if the page is not current.
        #[arg(long)]
        check: bool,
    },
    /// Write docs/api: all public items of each library crate.
    Api {
        /// Change nothing in the repository; fail if a listing is not current.
        #[arg(long)]
        check: bool,
    },
    /// Check the contents of the package of each crate, its manifest, and the oldest version of
    /// Rust that its dependencies allow.
    Package,
    /// Run the benchmarks and whole programs, count instructions, and write docs/performance.md.
    /// The machine must be idle.
    Bench(Measurement),
    /// Run one kernel for callgrind.
    #[command(hide = true)]
    BenchKernel { name: String },
    /// Check every claim of the software, and write its number next to the value known from another
    /// source: docs/validation.md.
    Validate {
        /// Folder of measured records; without it, everything that needs a record is listed as
        /// skipped.
        #[arg(long, env = "RODLAB_DATA")]
        data: Option<PathBuf>,
        /// Change nothing in the repository; fail if docs/validation.md is not current, and name
        /// the claims that differ.
        #[arg(long)]
        check: bool,
    },
}

/// First call of a preprocessor by mdBook: the question whether it supports a renderer.
#[derive(Subcommand)]
enum Question {
    /// Answer by the exit status: 0 if the renderer is supported.
    Supports { renderer: String },
}

#[derive(clap::Args)]
struct Measurement {
    /// Run nothing; fail if docs/performance.md does not agree with the stored numbers, or if the
    /// measured benchmarks are not those of the sources.
    #[arg(long)]
    check: bool,
    /// Measure for a shorter time and write the page to target/bench.
    #[arg(long, conflicts_with_all = ["check", "instructions"])]
    quick: bool,
    /// Only write the page again from the numbers of the last run.
    #[arg(long, conflicts_with_all = ["check", "quick", "instructions"])]
    page: bool,
    /// Only count the instructions of the hottest kernels, by callgrind; with --check, compare them
    /// with those of the page.
    #[arg(long)]
    instructions: bool,
    /// If valgrind is missing, or if machine or compiler are not those of the reference, count
    /// nothing and report this instead of failing.
    #[arg(long, requires_all = ["check", "instructions"])]
    if_installed: bool,
}

impl Measurement {
    fn task(&self) -> bench::Task {
        match (self.instructions, self.check) {
            (true, true) => bench::Task::CompareCounts {
                where_possible: self.if_installed,
            },
            (true, false) => bench::Task::Count,
            (false, true) => bench::Task::Check,
            (false, false) if self.quick => bench::Task::Try,
            (false, false) if self.page => bench::Task::Page,
            (false, false) => bench::Task::Measure,
        }
    }
}

#[derive(clap::Args)]
struct Comparison {
    /// Compare the result with the snapshot in the repository; the exit status is 1 if they differ.
    #[arg(long)]
    check: bool,
    /// Accept the result as the new snapshot.
    #[arg(long, conflicts_with = "check")]
    accept: bool,
}

fn main() -> ExitCode {
    if let Some(status) = api::as_rustdoc() {
        return status;
    }
    let outcome = match Arguments::parse().task {
        Task::Fixtures { check } => fixtures::run(check),
        Task::Faults { names, check } => faults::run(&names, check),
        Task::ReproducePaperA(comparison) => reproduce::run(&[Paper::A], &comparison),
        Task::ReproducePaperB(comparison) => reproduce::run(&[Paper::B], &comparison),
        Task::ReproducePaperC(comparison) => reproduce::run(&[Paper::C], &comparison),
        Task::ReproducePaperD(comparison) => reproduce::run(&[Paper::D], &comparison),
        Task::ReproducePaperE(comparison) => reproduce::run(&[Paper::E], &comparison),
        Task::ReproduceAll(comparison) => reproduce::run(&Paper::ALL, &comparison),
        Task::Book {
            check,
            if_installed,
        } => book::run(check, if_installed, tasks()),
        Task::Doc => book::document(),
        Task::BookEquations { question } => book::preprocess(
            question
                .as_ref()
                .map(|Question::Supports { renderer }| renderer.as_str()),
        ),
        Task::Outside { check } => outside::run(check),
        Task::Api { check } => api::run(check),
        Task::Package => package::run(),
        Task::Bench(measurement) => bench::run(measurement.task()),
        Task::BenchKernel { name } => bench::run_kernel(&name),
        Task::Validate { data, check } => validate::run(data.as_deref(), check),
        Task::Traceability { check } => traceability::run(check),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            let mut source = error.source();
            while let Some(cause) = source {
                eprintln!("  because: {cause}");
                source = cause.source();
            }
            ExitCode::FAILURE
        }
    }
}

/// Returns the names of the tasks of `cargo xtask`.
fn tasks() -> Vec<String> {
    Arguments::command()
        .get_subcommands()
        .map(|task| task.get_name().to_owned())
        .collect()
}

/// Error of a task, which states what is wrong, where, what was found and what was expected.
type Error = Box<dyn std::error::Error + Send + Sync>;

/// Result of every task.
type Outcome<T = ()> = Result<T, Error>;

/// Fails with `what` is wrong, and every fault in its own line, if there is a fault.
fn none_of(faults: &[String], what: &str) -> Outcome {
    match faults.len() {
        0 => Ok(()),
        count => Err(format!("{count} {what}:\n  {}", faults.join("\n  ")).into()),
    }
}

//! The program `rodlab`.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a command-line program talks to its user"
)]

use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

use clap::Parser;
use rodlab::arguments::{Arguments, SheetCommand};
use rodlab::job::Silent;
use rodlab::outcome::Verdict;
use rodlab::sheet::Sheet;
use rodlab::{RodlabError, job, output};

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let Some((job, command)) = arguments.command.sheet() else {
        return ExitCode::SUCCESS;
    };
    match run(job, command, &arguments) {
        Ok(Verdict::Answered) => ExitCode::SUCCESS,
        Ok(Verdict::NotAllowed { reason }) => {
            eprintln!("the data do not allow the result: {reason}");
            ExitCode::from(1)
        }
        Err(RodlabError::Sheet(error)) => {
            eprintln!("{:?}", miette::Report::new(*error));
            ExitCode::from(2)
        }
        Err(error) => {
            eprintln!("error: {error}");
            let mut source = std::error::Error::source(&error).and_then(|first| first.source());
            while let Some(cause) = source {
                eprintln!("  because: {cause}");
                source = cause.source();
            }
            ExitCode::from(2)
        }
    }
}

fn run(job: &'static str, command: &SheetCommand, say: &Arguments) -> Result<Verdict, RodlabError> {
    let sheet = Sheet::read(&command.sheet)?;
    if sheet.job.name() != job {
        return Err(RodlabError::OtherJob {
            path: command.sheet.clone(),
            found: sheet.job.name(),
            expected: job,
        });
    }
    let outcome = job::run(&sheet, &Silent, &AtomicBool::new(false))?;
    let folder = command
        .out
        .clone()
        .unwrap_or_else(|| output::default_folder(&command.sheet));
    let files = output::write(&outcome, &folder)?;
    if say.json {
        print!("{}", output::json_of(&outcome)?);
    } else if !say.quiet {
        for sentence in outcome.summary.iter().chain(&outcome.warnings) {
            println!("{sentence}");
        }
        println!("{} files in {}", files.len(), folder.display());
    }
    Ok(outcome.verdict)
}

//! Execution of the command line, and its exit status.

use std::fs;
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

use clap::CommandFactory;

use crate::arguments::{Arguments, Command};
use crate::batch::{self, Batch, Row, Summary, in_one_line};
use crate::closed_pipe::UntilClosed;
use crate::convert::convert;
use crate::finished::{self, finish};
use crate::inspect::inspect;
use crate::job::{self, Sheet, Silent};
use crate::output::TableFiles;
use crate::progress::Bar;
use crate::sheet::Language;
use crate::sheet_command::SheetCommand;
use crate::templates::{self, JobName, Rig};
use crate::verify::{Verified, verify_all};
use crate::view::View;
use crate::{InStep, RodlabError, Standing, output};

/// Message after an interruption.
pub const INTERRUPTED: &str = "interrupted: all files that exist are complete";

/// End of a run of the program, which determines the exit status.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// Exit status of a standing: 0, 1, 2 or 3. Any problem has already been reported.
    With(Standing),
    /// Interruption, with exit status 130.
    Interrupted,
}

impl Ending {
    /// The request is done.
    const DONE: Self = Self::With(Standing::Answered);
    /// A sheet, a file or a folder is wrong.
    pub const WRONG: Self = Self::With(Standing::WrongInput);

    /// The exit status.
    #[must_use]
    pub fn status(self) -> u8 {
        match self {
            Self::With(standing) => standing.exit_status(),
            Self::Interrupted => 130,
        }
    }
}

/// Executes the command line. Results go to `out`, diagnostics to `err`.
pub fn run(
    arguments: &Arguments,
    interrupted: &AtomicBool,
    out: &mut (dyn Write + Send),
    err: &mut dyn Write,
) -> Ending {
    match dispatch(arguments, interrupted, &mut UntilClosed::new(out), err) {
        Ok(ending) => ending,
        Err(RodlabError::Interrupted) => {
            let _ = writeln!(err, "{INTERRUPTED}");
            Ending::Interrupted
        }
        Err(error) => {
            complain(error, err);
            Ending::WRONG
        }
    }
}

/// Reports an error, with an excerpt if it is in a sheet.
fn complain(error: RodlabError, err: &mut dyn Write) {
    let _ = match error {
        RodlabError::Sheet(error) => write!(err, "{:?}", miette::Report::new(*error)),
        error => writeln!(err, "error: {}", in_one_line(&error)),
    };
}

fn dispatch(
    arguments: &Arguments,
    interrupted: &AtomicBool,
    out: &mut (dyn Write + Send),
    err: &mut dyn Write,
) -> Result<Ending, RodlabError> {
    match &arguments.command {
        Command::Job(job) => {
            let (job, command) = job.sheet()?;
            let words = (arguments.quiet, arguments.json);
            return one_sheet(job, &command, words, interrupted, out, err);
        }
        Command::Inspect { file } => {
            let found = inspect(file)?;
            if arguments.json {
                print_json(&found, out)?;
            } else {
                print(found.to_text().as_bytes(), out)?;
            }
        }
        Command::Convert {
            input,
            output,
            options,
        } => {
            let done = convert(input, output, options.options())?;
            let text = || done.to_text(input, output);
            tell(arguments, &done, text, out)?;
        }
        Command::Init {
            job,
            path,
            rig,
            ron,
        } => {
            let job = job.or(rig.map(Rig::job)).ok_or_else(|| {
                let jobs = JobName::ALL.map(JobName::name).join("`, `");
                let expected = format!(
                    "one of `{jobs}`: `rodlab init JOB`; or a rig: `rodlab init --rig RIG`"
                );
                RodlabError::request("the job of the new sheet", "not stated", expected)
            })?;
            let extension = if *ron { Language::Ron } else { Language::Toml }.extension();
            let path = path
                .clone()
                .unwrap_or_else(|| PathBuf::from(format!("{}.{extension}", job.name())));
            if *ron && path.extension().is_none_or(|ending| ending != extension) {
                return Err(RodlabError::request(
                    "the new sheet with --ron",
                    format!("`{}`", path.display()),
                    "a file name that ends in `.ron`",
                ));
            }
            templates::init(job, *rig, &path)?;
            if !arguments.quiet {
                let path = path.display();
                let next = format!("fill it in, then run `rodlab check {path}`");
                say(out, &format!("{path} is written: {next}"))?;
            }
        }
        Command::Demo { folder } => return demo(folder, arguments, interrupted, out, err),
        Command::Check { sheets } => return check(sheets, arguments.quiet, interrupted, out, err),
        Command::List { sheets } => return list(sheets, arguments, interrupted, out),
        Command::Verify { results, sheets } => {
            let found = results
                .iter()
                .map(|folder| verify_all(folder, sheets.as_deref()))
                .collect::<Result<Vec<_>, _>>()?
                .concat();
            let words = || in_lines(found.iter().flat_map(Verified::in_words));
            tell(arguments, &found, words, out)?;
            if !found.iter().all(Verified::is_as_it_was) {
                return Ok(Ending::With(Standing::InDoubt));
            }
        }
        Command::View { sheet, port } => {
            let view = View::of(sheet, *port)?;
            let address = view.address();
            say(out, &format!("Open {address} in a browser; Ctrl+C ends."))?;
            view.serve(interrupted)?;
        }
        Command::Sweep { plan, out: folder } => {
            let sweep = batch::sweep(plan, folder.as_deref())?;
            let (count, folder) = (sweep.sheets.len(), sweep.folder.display());
            let words = || format!("{count} sheets and sweep.csv in {folder}\n");
            tell(arguments, &sweep, words, out)?;
        }
        Command::Batch {
            sheets,
            out: folder,
            resume,
            shard,
            jobs,
            tables,
        } => {
            let batch = Batch {
                tests: batch::tests_of(sheets)?,
                out: folder.clone(),
                resume: *resume,
                shard: *shard,
                tables: *tables,
            };
            return many_sheets(&batch, jobs.map(Into::into), arguments, interrupted, out);
        }
        Command::Merge { folders, out: into } => {
            let summary = batch::collect(folders)?;
            let into = into.as_ref().or(folders.first());
            let into = into.map_or(Path::new("."), PathBuf::as_path);
            batch::write_summary(&summary, into)?;
            return conclude(&summary, into, arguments, out);
        }
        Command::Completions { shell } => {
            let mut text = Vec::new();
            clap_complete::generate(*shell, &mut Arguments::command(), "rodlab", &mut text);
            print(&text, out)?;
        }
        Command::Man { folder } => {
            let pages = manual()?;
            for (name, page) in &pages {
                output::write_whole(&folder.join(name), page)?;
            }
            if !arguments.quiet {
                let (count, folder) = (pages.len(), folder.display());
                say(out, &format!("{count} pages in {folder}"))?;
            }
        }
    }
    Ok(Ending::DONE)
}

/// Prints `what` as JSON or in `words`, as the command line requests.
fn tell(
    arguments: &Arguments,
    what: &impl serde::Serialize,
    words: impl FnOnce() -> String,
    out: &mut dyn Write,
) -> Result<(), RodlabError> {
    if arguments.json {
        print_json(what, out)
    } else if arguments.quiet {
        Ok(())
    } else {
        print(words().as_bytes(), out)
    }
}

fn in_lines(lines: impl Iterator<Item = String>) -> String {
    lines.map(|line| line + "\n").collect()
}

fn print_json(what: &impl serde::Serialize, out: &mut dyn Write) -> Result<(), RodlabError> {
    let text = serde_json::to_string_pretty(what).in_step("writing JSON")?;
    say(out, &text)
}

fn one_sheet(
    job: JobName,
    command: &SheetCommand,
    (quiet, json): (bool, bool),
    interrupted: &AtomicBool,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> Result<Ending, RodlabError> {
    let folder = command
        .out
        .clone()
        .unwrap_or_else(|| output::default_folder(&command.sheet));
    let bar = Bar::new(quiet || json);
    let tables = command.tables;
    let done = finish(
        &command.sheet,
        Some(job.name()),
        &folder,
        tables,
        &bar,
        interrupted,
    );
    drop(bar);
    let done = done.map_err(|error| {
        if command.is_own {
            withdraw(&command.sheet, &folder, err);
        }
        retract(&command.sheet, &folder, &error, err);
        if command.is_own {
            command.in_options(error)
        } else {
            error
        }
    })?;
    let standing = done.outcome.verdict.standing();
    if json {
        print(done.json.as_bytes(), out)?;
    } else if !quiet {
        for sentence in &done.outcome.summary {
            say(out, sentence)?;
        }
        for warning in &done.outcome.warnings {
            say(out, &format!("warning: {warning}"))?;
        }
        if !command.options.is_empty() {
            let (job, sheet) = (job.name(), command.sheet.display());
            let next = format!("edit it and run `rodlab {job} {sheet}`");
            say(out, &format!("The sheet is {sheet}: {next}"))?;
        }
        let count = done.files.len();
        let folder = folder.display();
        say(out, &format!("{standing}; {count} files in {folder}"))?;
    }
    let why = done.outcome.verdict.headline(&done.outcome.summary);
    let mut summary = done.outcome.summary.iter();
    let is_printed = !quiet && !json && summary.any(|sentence| sentence.contains(&why));
    if standing != Standing::Answered && !(is_printed && is_one_terminal()) {
        let _ = writeln!(err, "{standing}: {why}");
    }
    Ok(Ending::With(standing))
}

/// Returns true if both the standard output and the standard error are terminals. A reason that has
/// been printed with the result is then not repeated on the standard error.
fn is_one_terminal() -> bool {
    io::stdout().is_terminal() && io::stderr().is_terminal()
}

/// Removes the sheet that this run has written itself, so that the corrected command writes its
/// sheet under the same name. An earlier result in `folder` belongs to another sheet, and is kept.
fn withdraw(sheet: &Path, folder: &Path, err: &mut dyn Write) {
    if fs::remove_file(sheet).is_err() {
        return;
    }
    let earlier = if output::holds_result(folder) {
        format!("; the result in {} is an earlier one", folder.display())
    } else {
        String::new()
    };
    let _ = writeln!(
        err,
        "{}, the sheet of this command, was removed, because there is no result; `--save` keeps a sheet{earlier}",
        sheet.display()
    );
}

/// Replaces an earlier result in the folder of a sheet by the failure of this run. Otherwise the
/// old report could be mistaken for the report of this run.
fn retract(sheet: &Path, folder: &Path, error: &RodlabError, err: &mut dyn Write) {
    // the earlier result stays if files cannot be written, if the run was interrupted, or if the
    // command was for another job than the sheet
    let says_nothing = error.is_of_output()
        || matches!(
            error,
            RodlabError::Interrupted | RodlabError::OtherJob { .. }
        );
    if says_nothing || !sheet.is_file() || !output::holds_result(folder) {
        return;
    }
    let name = sheet.file_stem().unwrap_or_default().to_string_lossy();
    let row = Row::wrong_input(&name, &in_one_line(error));
    let place = folder.display();
    let _ = match batch::remember_failure(&row, folder) {
        Ok(()) => writeln!(
            err,
            "{place} has the files of an earlier run: its result.json was removed, and failure.json states why this run failed"
        ),
        Err(error) => writeln!(
            err,
            "warning: {place} has the files of an earlier run, and the failure of this run could not be recorded there: {}",
            in_one_line(&error)
        ),
    };
}

/// Reads all sheets and their files; an error in one sheet does not hide errors in others.
fn check(
    places: &[String],
    quiet: bool,
    interrupted: &AtomicBool,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> Result<Ending, RodlabError> {
    let mut ending = Ending::DONE;
    let mut sheets = Vec::with_capacity(places.len());
    for place in places {
        let path = Path::new(place);
        if path.is_dir() || (!path.exists() && place.contains(['*', '?', '['])) {
            match batch::tests_of(std::slice::from_ref(place)) {
                Ok(found) => sheets.extend(found.into_iter().map(|test| test.sheet)),
                Err(error) => {
                    ending = Ending::WRONG;
                    complain(error, err);
                }
            }
        } else {
            sheets.push(path.to_path_buf());
        }
    }
    for path in &sheets {
        match Sheet::read(path).and_then(|sheet| {
            let checked = job::check(&sheet, &Silent, interrupted)?;
            Ok((sheet, checked.warnings))
        }) {
            Ok((sheet, warnings)) => {
                if !quiet {
                    let hash = finished::identity_of(&sheet).sha256;
                    let (path, job) = (path.display(), sheet.job.name());
                    let found = format!("a sheet for `{job}`, its files can be read");
                    say(out, &format!("{path}: {found} (hash {hash:.12})"))?;
                    for warning in &warnings {
                        say(out, &format!("warning: {warning}"))?;
                    }
                }
            }
            Err(RodlabError::Interrupted) => return Err(RodlabError::Interrupted),
            Err(error) => {
                ending = Ending::WRONG;
                complain(error, err);
            }
        }
    }
    Ok(ending)
}

/// Lists sheets in the order of their names, and wrong sheets with their errors.
fn list(
    sheets: &[String],
    arguments: &Arguments,
    interrupted: &AtomicBool,
    out: &mut dyn Write,
) -> Result<Ending, RodlabError> {
    let listed = batch::list(&batch::tests_of(sheets)?, interrupted)?;
    let is_wrong = listed.iter().any(|one| one.error.is_some());
    let in_words = |one: &batch::Listed| {
        let what = match (&one.error, one.job, &one.key) {
            (None, Some(job), Some(key)) => {
                format!("{job:<9}  {:>3} files  {key:.12}", one.inputs.len())
            }
            (error, ..) => format!("wrong input: {}", error.as_deref().unwrap_or_default()),
        };
        format!("{}  {what}", one.test)
    };
    let words = || in_lines(listed.iter().map(in_words));
    tell(arguments, &listed, words, out)?;
    Ok(if is_wrong {
        Ending::WRONG
    } else {
        Ending::DONE
    })
}

fn many_sheets(
    batch: &Batch,
    jobs: Option<usize>,
    arguments: &Arguments,
    interrupted: &AtomicBool,
    out: &mut (dyn Write + Send),
) -> Result<Ending, RodlabError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(jobs.unwrap_or(0))
        .build()
        .in_step("starting threads")?;
    let bar = Bar::new(arguments.quiet || arguments.json);
    let words = !(arguments.quiet || arguments.json);
    // a line that cannot be printed does not stop any test, and is reported at the end
    let spoken = Mutex::new((&mut *out, Ok(())));
    let tell = |row: &Row| {
        if words && let Ok(mut spoken) = spoken.lock() {
            let (out, said) = &mut *spoken;
            if said.is_ok() {
                *said = bar.above(|| say(*out, &line(row)));
            }
        }
    };
    let rows = pool.install(|| batch.run(&tell, &bar, interrupted));
    drop(bar);
    let said = spoken.into_inner().map_or(Ok(()), |(_, said)| said);
    if interrupted.load(std::sync::atomic::Ordering::Relaxed) {
        return Err(RodlabError::Interrupted);
    }
    let summary = Summary::of(rows);
    if batch.shard.is_none() {
        batch::write_summary(&summary, &batch.out)?;
    }
    said?;
    conclude(&summary, &batch.out, arguments, out)
}

fn line(row: &Row) -> String {
    format!("{:<11}  {}: {}", row.status, row.test, row.headline)
}

fn conclude(
    summary: &Summary,
    folder: &Path,
    arguments: &Arguments,
    out: &mut (dyn Write + Send),
) -> Result<Ending, RodlabError> {
    if arguments.json {
        print(summary.to_json()?.as_bytes(), out)?;
    } else if !arguments.quiet {
        for remark in summary.remarks() {
            say(out, &remark)?;
        }
        let (sentence, folder) = (summary.sentence(), folder.display());
        say(out, &format!("{sentence}; {folder}"))?;
    }
    Ok(Ending::With(summary.worst()))
}

/// Returns the manual pages, as file names and contents.
fn manual() -> Result<Vec<(String, Vec<u8>)>, RodlabError> {
    let mut program = Arguments::command();
    program.build();
    let mut pages = Vec::new();
    let mut page_of = |command: clap::Command, name: String| -> Result<(), RodlabError> {
        let mut page = Vec::new();
        clap_mangen::Man::new(command)
            .title(name.to_uppercase())
            .date("") // the same pages on every day
            .render(&mut page)
            .in_step("writing the manual pages")?;
        pages.push((format!("{name}.1"), page));
        Ok(())
    };
    for command in program.get_subcommands().filter(|c| c.get_name() != "help") {
        page_of(command.clone(), format!("rodlab-{}", command.get_name()))?;
    }
    page_of(program.clone(), "rodlab".to_owned())?;
    Ok(pages)
}

/// Tests a virtual rod, from its plan to the report, with the commands that a user would type. Only
/// the last of these commands writes its result as JSON.
fn demo(
    folder: &Path,
    arguments: &Arguments,
    interrupted: &AtomicBool,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> Result<Ending, RodlabError> {
    let plan = folder.join("plan.toml");
    let sheet = folder.join("plan-result").join("modulus.toml");
    let report = output::default_folder(&sheet).join("report.html");
    let is_silent = arguments.quiet || arguments.json;
    let told = |out: &mut dyn Write, line: String| match is_silent {
        true => Ok(()),
        false => say(out, &line),
    };
    templates::init(JobName::Simulate, None, &plan).map_err(|error| match error {
        RodlabError::Exists { .. } => RodlabError::request(
            "the folder of the demo",
            format!("{}, which has a plan already", folder.display()),
            format!("a new folder, such as `rodlab demo {}-2`", folder.display()),
        ),
        error => error,
    })?;
    told(out, format!("> rodlab init simulate {}", plan.display()))?;
    for (job, sheet) in [(JobName::Simulate, plan), (JobName::Modulus, sheet)] {
        let (name, path) = (job.name(), sheet.display());
        told(out, format!("\n> rodlab {name} {path}"))?;
        let command = SheetCommand {
            sheet,
            out: None,
            tables: TableFiles::default(),
            is_own: false,
            options: Vec::new(),
        };
        let is_last = job == JobName::Modulus;
        let quiet = arguments.quiet || (arguments.json && !is_last);
        let json = arguments.json && is_last;
        let ending = one_sheet(job, &command, (quiet, json), interrupted, out, err)?;
        if ending != Ending::DONE {
            return Ok(ending);
        }
    }
    told(out, format!("\nThe report: {}", report.display()))?;
    Ok(Ending::DONE)
}

fn print(text: &[u8], out: &mut dyn Write) -> Result<(), RodlabError> {
    out.write_all(text).map_err(to_terminal)
}

fn say(out: &mut dyn Write, line: &str) -> Result<(), RodlabError> {
    writeln!(out, "{line}").map_err(to_terminal)
}

fn to_terminal(source: io::Error) -> RodlabError {
    RodlabError::write(Path::new("the standard output"), source)
}

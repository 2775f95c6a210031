//! Runs of sheets and of the program, and access to their results.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::AtomicBool;

use rodlab::job::{self, Sheet, Silent, parse};
use rodlab::outcome::{Cells, Quantity, Table, Verdict};
use rodlab::output::{SheetIdentity, json_of};
use rodlab::{Outcome, RodlabError};
use serde_json::Value;
use tempfile::TempDir;

/// A temporary folder, which is removed at the end of a test.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    /// A folder with the files of an example that are next to its sheet.
    pub(crate) fn of_example(name: &str) -> Self {
        let folder = Self::new();
        copy_example(name, folder.path());
        folder
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    pub(crate) fn file(&self, name: impl AsRef<Path>) -> PathBuf {
        self.path().join(name)
    }

    pub(crate) fn has(&self, name: impl AsRef<Path>) -> bool {
        self.file(name).exists()
    }

    pub(crate) fn write(&self, name: impl AsRef<Path>, contents: impl AsRef<[u8]>) {
        fs::write(self.file(name), contents).unwrap();
    }

    pub(crate) fn read(&self, name: impl AsRef<Path>) -> String {
        fs::read_to_string(self.file(name)).unwrap()
    }

    pub(crate) fn bytes(&self, name: impl AsRef<Path>) -> Vec<u8> {
        fs::read(self.file(name)).unwrap()
    }

    pub(crate) fn json(&self, name: impl AsRef<Path>) -> Value {
        serde_json::from_str(&self.read(name)).unwrap()
    }

    /// Writes the attachments of an outcome.
    pub(crate) fn keep(&self, outcome: &Outcome) {
        for file in &outcome.attachments {
            self.write(&file.name, &file.bytes);
        }
    }

    /// Replaces every line of a file by `change` of its number, from 0, and its text.
    pub(crate) fn edit(&self, name: &str, change: impl Fn(usize, &str) -> String) {
        let text = self.read(name);
        let lines = text.lines().enumerate();
        let changed = lines.map(|(number, line)| change(number, line) + "\n");
        self.write(name, changed.collect::<String>());
    }

    /// The outcome of a sheet in the folder.
    pub(crate) fn run(&self, text: &str) -> Result<Outcome, RodlabError> {
        outcome_of(self.path(), text)
    }

    /// Output of the program, run in the folder; the arguments are separated by spaces.
    pub(crate) fn rodlab(&self, call: &str) -> Output {
        rodlab(self.path(), &call.split(' ').collect::<Vec<_>>())
    }

    /// Output of the program. Fails unless it ends with the status 0.
    #[track_caller]
    pub(crate) fn done(&self, call: &str) -> String {
        let run = self.rodlab(call);
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        text(&run.stdout)
    }
}

/// The outcome of a sheet whose files are in `folder`.
pub(crate) fn outcome_of(folder: &Path, text: &str) -> Result<Outcome, RodlabError> {
    let sheet = Sheet {
        job: parse(Path::new("test.ron"), text)?,
        path: folder.join("test.ron"),
        text: text.to_owned(),
    };
    job::run(&sheet, &Silent, &AtomicBool::new(false))
}

/// The JSON text of an outcome whose sheet is not a file.
pub(crate) fn json(outcome: &Outcome) -> String {
    let identity = SheetIdentity {
        file: "test.ron".to_owned(),
        sha256: String::new(),
    };
    json_of(outcome, &identity).unwrap()
}

pub(crate) fn table<'a>(outcome: &'a Outcome, name: &str) -> &'a Table {
    let found = outcome.tables.iter().find(|t| t.name == name);
    found.unwrap_or_else(|| {
        let names: Vec<&String> = outcome.tables.iter().map(|t| &t.name).collect();
        panic!("{name} is none of {names:?}")
    })
}

fn cells<'a>(outcome: &'a Outcome, of: &str, name: &str) -> &'a Cells {
    let columns = &table(outcome, of).columns;
    let found = columns.iter().find(|c| c.name == name);
    let found = found.unwrap_or_else(|| {
        let names: Vec<&String> = columns.iter().map(|c| &c.name).collect();
        panic!("{name} is none of {names:?}")
    });
    &found.cells
}

pub(crate) fn column<'a>(outcome: &'a Outcome, table: &str, name: &str) -> &'a [f64] {
    match cells(outcome, table, name) {
        Cells::Numbers(values) => values,
        _ => panic!("{name} is a column of words"),
    }
}

/// The words of a column of words or verdicts.
pub(crate) fn words<'a>(outcome: &'a Outcome, table: &str, name: &str) -> &'a [String] {
    match cells(outcome, table, name) {
        Cells::Words(words) | Cells::Validity { words, .. } => words,
        _ => panic!("{name} is a column of numbers"),
    }
}

pub(crate) fn quantity<'a>(outcome: &'a Outcome, name: &str) -> &'a Quantity {
    let found = outcome.quantities.iter().find(|q| q.name == name);
    found.unwrap_or_else(|| {
        let names: Vec<&String> = outcome.quantities.iter().map(|q| &q.name).collect();
        panic!("{name} is none of {names:?}")
    })
}

/// The quantity with this name. Fails unless it differs from `truth` by at most the given number of
/// standard errors, and its standard error is at most the given fraction of `truth`.
#[track_caller]
pub(crate) fn is_found<'a>(
    outcome: &'a Outcome,
    name: &str,
    truth: f64,
    [errors, share]: [f64; 2],
) -> &'a Quantity {
    let found = quantity(outcome, name);
    let (value, error) = estimate(outcome, name);
    let off = (value - truth).abs() / error;
    assert!(
        off < errors && error < share * truth,
        "{found:?} {:#?}",
        outcome.summary
    );
    found
}

/// Value and standard error of a quantity.
pub(crate) fn estimate(outcome: &Outcome, name: &str) -> (f64, f64) {
    let found = quantity(outcome, name);
    (found.value.unwrap(), found.standard_error.unwrap())
}

/// Names of the figures, in their order.
pub(crate) fn figures_of(outcome: &Outcome) -> String {
    joined(outcome.figures.iter().map(|figure| figure.name.as_str()))
}

/// Names of the tables, in their order.
pub(crate) fn tables_of(outcome: &Outcome) -> String {
    joined(outcome.tables.iter().map(|table| table.name.as_str()))
}

/// Names of the attachments, in their order.
pub(crate) fn attachments_of(outcome: &Outcome) -> String {
    joined(outcome.attachments.iter().map(|file| file.name.as_str()))
}

fn joined<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.collect::<Vec<_>>().join(", ")
}

/// Outcome of a run. Fails unless the run is answered without a doubt.
#[track_caller]
pub(crate) fn answered<E: std::fmt::Debug>(run: Result<Outcome, E>) -> Outcome {
    let outcome = run.unwrap();
    let told = (&outcome.summary, &outcome.warnings, &outcome.log);
    assert_eq!(outcome.verdict, Verdict::Answered, "{told:#?}");
    outcome
}

/// Reasons of an outcome that is in doubt.
#[track_caller]
pub(crate) fn doubts(outcome: &Outcome) -> &[String] {
    match &outcome.verdict {
        Verdict::InDoubt { reasons } => reasons,
        other => panic!("{other:?} {:?}", outcome.summary),
    }
}

/// Reason of an outcome that is not allowed.
#[track_caller]
pub(crate) fn refusal(outcome: &Outcome) -> &str {
    match &outcome.verdict {
        Verdict::NotAllowed { reason } => reason,
        other => panic!("{other:?} {:?}", outcome.summary),
    }
}

/// Access to the message of an error.
pub(crate) trait Refused {
    /// Returns the message. Fails if there is no error.
    fn refused(self) -> String;
}

impl<T, E: std::fmt::Display> Refused for Result<T, E> {
    #[track_caller]
    fn refused(self) -> String {
        match self {
            Ok(_) => panic!("it is not refused"),
            Err(error) => error.to_string(),
        }
    }
}

/// Assertions on texts. For several texts, one of them must satisfy the assertion.
pub(crate) trait Words {
    /// Fails unless `part` is contained.
    fn must_say(&self, part: &str);
    /// Fails unless a text starts with `part`.
    fn must_begin(&self, part: &str);

    fn must_say_all(&self, parts: &[&str]) {
        parts.iter().for_each(|part| self.must_say(part));
    }
}

impl Words for str {
    #[track_caller]
    fn must_say(&self, part: &str) {
        assert!(self.contains(part), "{part} is not in\n{self}");
    }

    #[track_caller]
    fn must_begin(&self, part: &str) {
        assert!(self.starts_with(part), "{part} does not begin\n{self}");
    }
}

impl Words for [String] {
    #[track_caller]
    fn must_say(&self, part: &str) {
        let is_said = self.iter().any(|text| text.contains(part));
        assert!(is_said, "{part} is in none of {self:#?}");
    }

    #[track_caller]
    fn must_begin(&self, part: &str) {
        let is_said = self.iter().any(|text| text.starts_with(part));
        assert!(is_said, "{part} begins none of {self:#?}");
    }
}

pub(crate) fn path_of_example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("examples")
        .join(name)
}

/// Copies the files of an example that are next to its sheet.
pub(crate) fn copy_example(name: &str, folder: &Path) {
    for entry in fs::read_dir(path_of_example(name)).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            fs::copy(&path, folder.join(path.file_name().unwrap())).unwrap();
        }
    }
}

/// Output of the program, run in `folder`.
pub(crate) fn rodlab(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .args(arguments)
        .output()
        .unwrap()
}

/// Output of the program. Fails unless it ends with status 0.
#[track_caller]
pub(crate) fn done(folder: &Path, arguments: &[&str]) -> String {
    let run = rodlab(folder, arguments);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    text(&run.stdout)
}

pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Bytes of a two-dimensional array in the format of NumPy, from its rows.
pub(crate) fn npy(rows: &[impl AsRef<[f64]>]) -> Vec<u8> {
    let columns = rows[0].as_ref().len();
    let shape = format!("({}, {columns})", rows.len());
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    bytes.extend(format!("{header:<117}\n").bytes());
    let values = rows.iter().flat_map(|row| row.as_ref());
    bytes.extend(values.flat_map(|value| value.to_le_bytes()));
    bytes
}

pub(crate) fn write_npy(path: &Path, rows: &[impl AsRef<[f64]>]) {
    fs::write(path, npy(rows)).unwrap();
}

pub(crate) fn with_causes(error: &RodlabError) -> String {
    let mut said = error.to_string();
    let mut source = std::error::Error::source(error);
    while let Some(cause) = source {
        if !said.contains(&cause.to_string()) {
            said += &format!(": {cause}");
        }
        source = cause.source();
    }
    said
}

/// Writes a table of these columns without names.
pub(crate) fn write_columns(path: &Path, columns: &[Vec<f64>]) {
    let line = |n: usize| {
        let cells: Vec<String> = columns.iter().map(|x| format!("{:e}", x[n])).collect();
        cells.join(",")
    };
    let count = columns.iter().map(Vec::len).min().unwrap();
    let lines: Vec<String> = (0..count).map(line).collect();
    fs::write(path, lines.join("\n")).unwrap();
}

/// A message with `FORMATS` in place of the list of all formats, which a new format would change.
pub(crate) fn without_formats(message: &str) -> String {
    let names = labio::format::readers().iter().map(|reader| reader.name());
    message.replace(&names.collect::<Vec<_>>().join(", "), "FORMATS")
}

//! Runs of a sheet or of the program, and what they found.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::atomic::AtomicBool;

use rodlab::job::{self, Sheet, Silent, parse};
use rodlab::outcome::{Cells, Quantity, Table};
use rodlab::output::{SheetIdentity, json_of};
use rodlab::{Outcome, RodlabError};

/// The outcome of a sheet whose files are in `folder`.
pub(crate) fn outcome_of(folder: &Path, text: &str) -> Result<Outcome, RodlabError> {
    let path = folder.join("test.ron");
    let sheet = Sheet {
        job: parse(&path, text)?,
        path,
        text: text.to_owned(),
    };
    job::run(&sheet, &Silent, &AtomicBool::new(false))
}

/// The text of the result of a sheet that is not on disk.
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

/// The numbers of a column.
pub(crate) fn column<'a>(outcome: &'a Outcome, table: &str, name: &str) -> &'a [f64] {
    match cells(outcome, table, name) {
        Cells::Numbers(values) => values,
        _ => panic!("{name} is a column of words"),
    }
}

/// The words of a column, those of a verdict too.
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

/// The program, run in `folder`.
pub(crate) fn rodlab(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .args(arguments)
        .output()
        .unwrap()
}

pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
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

/// A message with `FORMATS` in place of the names of all formats, which a new format changes.
pub(crate) fn without_formats(message: &str) -> String {
    let names = labio::format::readers().iter().map(|reader| reader.name());
    message.replace(&names.collect::<Vec<_>>().join(", "), "FORMATS")
}

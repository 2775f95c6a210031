//! Runs of a sheet or of the program, and what they found.

use std::path::Path;
use std::process::{Command, Output};
use std::sync::atomic::AtomicBool;

use rodlab::job::{self, Sheet, Silent, parse};
use rodlab::outcome::{Cells, Quantity};
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

/// The numbers of a column.
pub(crate) fn column<'a>(outcome: &'a Outcome, table: &str, name: &str) -> &'a [f64] {
    let tables: Vec<&String> = outcome.tables.iter().map(|t| &t.name).collect();
    let of = outcome.tables.iter().find(|t| t.name == table);
    let of = of.unwrap_or_else(|| panic!("{table} is none of {tables:?}"));
    let names: Vec<&String> = of.columns.iter().map(|c| &c.name).collect();
    let column = of.columns.iter().find(|c| c.name == name);
    let column = column.unwrap_or_else(|| panic!("{name} is none of {names:?}"));
    match &column.cells {
        Cells::Numbers(values) => values,
        _ => panic!("{name} is a column of words"),
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

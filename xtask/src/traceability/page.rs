//! docs/traceability.md: a table for each part of the thesis, with links.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::numbered::{Kind, Part};
use super::reproduction::{is_file, snapshot, source};
use super::row::Row;
use super::workspace::split;
use super::{COMMAND, ROWS};

/// The page.
pub(crate) fn markdown(rows: &[Row]) -> String {
    let mut page = format!(
        "<!-- Made by `{COMMAND}` from {ROWS}: do not edit by hand. -->\n\n\
         # From the thesis to code and proof\n\n\
         Every equation, table and figure that S. Ödeen numbers in his thesis (Luleå 1993), where it is implemented, and the \
         tests that prove it. `{COMMAND} --check` fails where an item has no row, where code or test are not there any more, \
         where a source cites an equation that does not exist, and where code does not cite the equation that it implements. Figures and tables are drawn and recomputed by the tasks \
         named; what they hold is compared with snapshots. How to add a row stands in \
         [CONTRIBUTING.md](../CONTRIBUTING.md#traceability).\n\n"
    );
    page.push_str(&counts(rows));
    for part in Part::ALL {
        let heading = match part {
            Part::Survey => part.title().to_owned(),
            paper => format!("Paper {paper:?}: {}", paper.title()),
        };
        let _ = write!(
            page,
            "\n## {heading}\n\n| item | what it says | where | proof | note |\n|---|---|---|---|---|\n"
        );
        for row in rows.iter().filter(|row| row.part() == part) {
            page.push_str(&line(row));
        }
    }
    page
}

/// How much there is of what.
fn counts(rows: &[Row]) -> String {
    let mut table = "| part | equations | tables | figures | tests that prove them |\n\
                     |---|---:|---:|---:|---:|\n"
        .to_owned();
    let mut add = |name: &str, rows: &[&Row]| {
        let of = |kind| rows.iter().filter(|row| row.kind() == kind).count();
        let tests: BTreeSet<&String> = rows.iter().flat_map(|row| &row.proved).collect();
        let [equations, tables, figures] = Kind::ALL.map(of);
        let _ = writeln!(
            table,
            "| {name} | {equations} | {tables} | {figures} | {} |",
            tests.len()
        );
    };
    for part in Part::ALL {
        let of_part: Vec<&Row> = rows.iter().filter(|row| row.part() == part).collect();
        add(&part.to_string(), &of_part);
    }
    add("together", &rows.iter().collect::<Vec<_>>());
    table
}

fn line(row: &Row) -> String {
    let item = row.item();
    let mut places: Vec<String> = row.implemented.iter().map(|to| link(to)).collect();
    let mut proofs: Vec<String> = row.proved.iter().map(|to| link(to)).collect();
    for reference in &row.reproduced {
        if let Some((task, what)) = reference.split_once("::") {
            if is_file(what) {
                places.push(format!("`{what}` by [`{task}`](../{})", source(task)));
            } else {
                proofs.push(format!("`{what}` of [`{task}`](../{})", snapshot(task)));
            }
        }
    }
    format!(
        "| {} {} | {} | {} | {} | {} |\n",
        item.kind,
        item.number,
        cell(&row.says),
        places.join(", "),
        proofs.join(", "),
        cell(&row.note),
    )
}

/// A link to the file of a reference, named by its item.
fn link(reference: &str) -> String {
    match split(reference) {
        Some((file, item)) => format!(
            "[`{}`](../{file})",
            item.strip_prefix("tests::").unwrap_or(item)
        ),
        None => format!("`{reference}`"),
    }
}

/// Text in a cell: one line, and no bar that would end the cell.
fn cell(text: &str) -> String {
    text.split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
        .replace('|', "\\|")
}

//! Tables and quantities as rows of text.

use rodfigure::unit_as_read;
use serde::Serialize;

use super::number::{in_line, with_error};
use crate::outcome::{Cells, Column, Quantity, Table};

/// Rows visible at once.
const FIRST: usize = 12;
/// Most rows on the page; the file has the rest.
const IN_ALL: usize = 400;

/// Most characters of a text that is not broken.
const SHORT: usize = 24;

/// A quantity.
#[derive(Serialize)]
pub(super) struct QuantityRow<'a> {
    name: &'a str,
    value: String,
    unit: String,
    valid: bool,
    verdict: &'a str,
}

impl<'a> QuantityRow<'a> {
    pub(super) fn of(quantity: &'a Quantity) -> Self {
        Self {
            name: &quantity.name,
            value: with_error(quantity.value, quantity.standard_error),
            unit: unit_as_read(&quantity.unit),
            valid: quantity.valid,
            verdict: &quantity.verdict,
        }
    }
}

/// A table: its first rows, the rows to unfold, and the number of rows left to the file.
#[derive(Serialize)]
pub(super) struct TableRows<'a> {
    title: &'a str,
    file: String,
    columns: Vec<Heading<'a>>,
    rows: Vec<Vec<Cell>>,
    more: Vec<Vec<Cell>>,
    more_label: String,
    total: usize,
    left_out: usize,
}

#[derive(Serialize)]
struct Heading<'a> {
    name: &'a str,
    unit: String,
    class: &'static str,
}

#[derive(Serialize)]
struct Cell {
    text: String,
    class: &'static str,
}

/// The style class of a column: numbers aligned right, short words in one line.
fn class_of(cells: &Cells) -> &'static str {
    match cells {
        Cells::Numbers(_) => "n",
        Cells::Words(words) | Cells::Validity { words, .. } => {
            let is_short = |word: &String| word.chars().count() <= SHORT;
            if words.iter().all(is_short) {
                "short"
            } else {
                "words"
            }
        }
    }
}

impl<'a> TableRows<'a> {
    /// The rows of `table`, whose columns have equal length.
    #[allow(
        clippy::indexing_slicing,
        reason = "the files of a result are put together only of tables whose columns have one length, `total`"
    )]
    pub(super) fn of(table: &'a Table) -> Self {
        let total = table
            .columns
            .iter()
            .map(|c| c.cells.len())
            .max()
            .unwrap_or(0);
        // a few more rows are not worth folding
        let first = if total <= FIRST + 4 { total } else { FIRST };
        let shown = total.min(IN_ALL);
        let texts: Vec<Vec<String>> = table
            .columns
            .iter()
            .map(|column| match &column.cells {
                Cells::Numbers(values) => in_line(&values[..shown]),
                Cells::Words(words) | Cells::Validity { words, .. } => {
                    words.iter().take(shown).cloned().collect()
                }
            })
            .collect();
        let row = |row: usize| -> Vec<Cell> {
            let cell = |(column, texts): (&Column, &Vec<String>)| Cell {
                text: texts[row].clone(),
                class: class_of(&column.cells),
            };
            table.columns.iter().zip(&texts).map(cell).collect()
        };
        Self {
            title: &table.title,
            file: format!("{}.csv", table.name),
            columns: table
                .columns
                .iter()
                .map(|column| Heading {
                    name: &column.name,
                    unit: unit_as_read(&column.unit),
                    class: class_of(&column.cells),
                })
                .collect(),
            rows: (0..first).map(row).collect(),
            more: (first..shown).map(row).collect(),
            more_label: format!("Rows {} to {shown}", first + 1),
            total,
            left_out: total - shown,
        }
    }
}

//! Tables and quantities as rows of text.

use rodfigure::unit_as_read;
use serde::Serialize;

use crate::digits::prefix_for;
use crate::digits::{alone, in_line, with_error};
use crate::outcome::{Cells, Column, Quantity, Table};

/// Number of rows that are visible at first.
const FIRST: usize = 12;
/// Maximum number of rows on the page; the file contains the rest.
const IN_ALL: usize = 400;
/// Maximum number of columns that are visible at first, so that they fit on a sheet of paper.
const COLUMNS: usize = 8;
/// Maximum number of different verdicts that are denoted by letters.
const LETTERS: usize = 20;

/// Maximum number of characters of a text that is not broken into lines.
const SHORT: usize = 24;

/// Beginnings of the names of columns that explain other columns, and are not visible at first.
const EXPLAINING: [&str; 4] = [
    "random error of",
    "common error of",
    "covariance of",
    "variance of",
];

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
        // the prefix suits the larger of value and error
        let sizes = [quantity.value, quantity.standard_error]
            .into_iter()
            .flatten();
        let (size, prefix) = prefix_for(sizes.map(f64::abs).fold(0.0, f64::max), &quantity.unit);
        let scaled = |value: Option<f64>| value.map(|value| value / size);
        Self {
            name: &quantity.name,
            value: with_error(scaled(quantity.value), scaled(quantity.standard_error)),
            unit: unit_as_read(&format!("{}{}", prefix.replace('u', "µ"), quantity.unit)),
            valid: quantity.valid,
            verdict: &quantity.verdict,
        }
    }
}

/// Table as shown in the report: its principal columns with errors next to their values, a legend
/// of the letters that denote verdicts, and all columns to unfold.
#[derive(Serialize)]
pub(super) struct TableRows<'a> {
    title: &'a str,
    file: String,
    brief: View,
    has_errors: bool,
    legend: Vec<Letter>,
    constant: Option<String>,
    whole: Option<View>,
    whole_label: String,
    note: String,
}

/// Selected rows of selected columns.
#[derive(Serialize)]
struct View {
    columns: Vec<Heading>,
    rows: Vec<Vec<Cell>>,
}

#[derive(Clone, Serialize)]
struct Heading {
    name: String,
    unit: String,
    class: &'static str,
}

#[derive(Serialize)]
struct Cell {
    text: String,
    class: &'static str,
}

/// A letter and the verdict that it stands for.
#[derive(Serialize)]
struct Letter {
    letter: String,
    reason: String,
}

/// A column as it is shown.
struct Shown {
    heading: Heading,
    texts: Vec<String>,
}

/// Returns the style class of a column of words; short words stay on one line.
fn class_of(texts: &[String]) -> &'static str {
    let is_short = |word: &String| word.chars().count() <= SHORT;
    if texts.iter().all(is_short) {
        "short"
    } else {
        "words"
    }
}

fn heading(column: &Column, class: &'static str) -> Heading {
    Heading {
        name: column.name.clone(),
        unit: unit_as_read(&column.unit),
        class,
    }
}

fn picked<T: Clone>(values: &[T], rows: &[usize]) -> Vec<T> {
    rows.iter()
        .filter_map(|row| values.get(*row).cloned())
        .collect()
}

/// Returns `column` with its numbers or its words, without errors.
fn as_it_is(column: &Column, rows: &[usize]) -> Shown {
    match &column.cells {
        Cells::Numbers(values) => Shown {
            heading: heading(column, "n"),
            texts: in_line(&picked(values, rows)),
        },
        Cells::Words(words) | Cells::Validity { words, .. } => {
            let texts = picked(words, rows);
            Shown {
                heading: heading(column, class_of(&texts)),
                texts,
            }
        }
    }
}

/// Returns `column` with its standard errors next to the values.
fn beside_errors(column: &Column, values: &[f64], errors: &[f64], rows: &[usize]) -> Shown {
    let texts = picked(values, rows).into_iter().zip(picked(errors, rows));
    let texts = texts.map(|(value, error)| {
        if value.is_finite() {
            with_error(Some(value), Some(error))
        } else {
            String::new()
        }
    });
    Shown {
        heading: heading(column, "n"),
        texts: texts.collect(),
    }
}

/// Returns the standard errors of `column` from the column `next`, if `next` contains them.
fn errors_of<'a>(column: &Column, next: Option<&'a Column>) -> Option<&'a [f64]> {
    next.filter(|next| next.is_error_of(column))?
        .known_numbers()
}

/// Returns the value that all rows have; `None` if the values differ, or if there are three rows or
/// fewer.
fn constant(values: &[f64]) -> Option<f64> {
    let first = *values.first()?;
    let same = |value: &f64| value.total_cmp(&first).is_eq() || (value.is_nan() && first.is_nan());
    (values.len() > 3 && values.iter().all(same)).then_some(first)
}

fn spread(rows: &[usize], count: usize) -> Vec<usize> {
    if rows.len() <= count || count < 2 {
        return rows.to_vec();
    }
    let place = |n: usize| n * (rows.len() - 1) / (count - 1);
    (0..count)
        .filter_map(|n| rows.get(place(n)).copied())
        .collect()
}

/// Returns the verdicts of a column as letters, with their legend; `None` if there are too many
/// different verdicts.
fn by_letters<'a>(cells: &'a Cells) -> Option<(Vec<String>, Vec<Letter>)> {
    let Cells::Validity {
        valid,
        words,
        kinds,
    } = cells
    else {
        return None;
    };
    let of_row = |(row, words): (usize, &'a String)| -> Vec<&'a str> {
        match kinds.get(row) {
            Some(kinds) => kinds.clone(),
            None if words == "valid" => Vec::new(),
            None => vec![words.as_str()],
        }
    };
    let of_rows: Vec<Vec<&str>> = words.iter().enumerate().map(of_row).collect();
    let mut all: Vec<&str> = Vec::new();
    for kind in of_rows.iter().flatten() {
        if !all.contains(kind) {
            all.push(kind);
        }
        if all.len() > LETTERS.min(words.len() / 2) {
            return None;
        }
    }
    let letter = |kind: &str| -> String {
        let place = all.iter().position(|known| *known == kind);
        let letter = place.and_then(|place| ('a'..='z').nth(place));
        letter.map(String::from).unwrap_or_default()
    };
    let texts = valid.iter().zip(&of_rows).map(|(valid, kinds)| {
        let named: Vec<String> = kinds.iter().map(|kind| letter(kind)).collect();
        let sign = if *valid { "✓" } else { "✗" };
        format!("{sign} {}", named.join(" ")).trim_end().to_owned()
    });
    let legend = all.iter().map(|kind| Letter {
        letter: letter(kind),
        reason: (*kind).to_owned(),
    });
    Some((texts.collect(), legend.collect()))
}

fn view(columns: &[Shown]) -> View {
    let rows = columns.first().map_or(0, |column| column.texts.len());
    let cell = |column: &Shown, row: usize| Cell {
        text: column.texts.get(row).cloned().unwrap_or_default(),
        class: column.heading.class,
    };
    View {
        columns: columns
            .iter()
            .map(|column| column.heading.clone())
            .collect(),
        rows: (0..rows)
            .map(|row| columns.iter().map(|column| cell(column, row)).collect())
            .collect(),
    }
}

/// Returns the rows that show a table in brief, and a description of this choice. If the abscissae
/// increase, the rows are spread over the valid rows, or over all rows if fewer than [`FIRST`] are
/// valid; otherwise they are the first rows.
fn brief_rows(table: &Table, total: usize) -> (Vec<usize>, &'static str) {
    // up to four more rows are not worth folding
    if total <= FIRST + 4 {
        return ((0..total).collect(), "");
    }
    let abscissae = table.columns.first().and_then(Column::known_numbers);
    let grows = |values: &[f64]| values.is_sorted_by(|one, next| one < next);
    if !abscissae.is_some_and(grows) {
        return ((0..FIRST).collect(), "the first");
    }
    let valid: Option<Vec<usize>> = table.valid().map(|valid| {
        let rows = valid.iter().enumerate().filter(|(_, valid)| **valid);
        rows.map(|(row, _)| row).collect()
    });
    match valid.filter(|rows| rows.len() >= FIRST) {
        Some(rows) => (spread(&rows, FIRST), "spread over the valid ones"),
        None => (
            spread(&(0..total).collect::<Vec<_>>(), FIRST),
            "evenly spread",
        ),
    }
}

impl<'a> TableRows<'a> {
    /// Returns the rows of `table`, whose columns have equal length.
    pub(super) fn of(table: &'a Table) -> Self {
        let lengths = table.columns.iter().map(|column| column.cells.len());
        let total = lengths.max().unwrap_or(0);
        let (rows, which) = brief_rows(table, total);
        let mut brief = Vec::new();
        let (mut legend, mut constants) = (Vec::new(), Vec::new());
        let mut is_whole = rows.len() == total;
        let mut columns = table.columns.iter().peekable();
        let is_word = |column: &&Column| column.known_numbers().is_none();
        let words = table.columns.iter().filter(is_word).count();
        let (mut numbers, mut has_errors) = (0, false);
        while let Some(column) = columns.next() {
            let Some(values) = column.known_numbers() else {
                brief.push(match by_letters(&column.cells) {
                    Some((texts, letters)) => {
                        is_whole &= letters.is_empty();
                        let texts = picked(&texts, &rows);
                        let is_used = |letter: &Letter| {
                            let mut words = texts.iter().flat_map(|text| text.split(' '));
                            words.any(|word| word == letter.letter)
                        };
                        legend = letters.into_iter().filter(is_used).collect();
                        Shown {
                            heading: heading(column, "short"),
                            texts,
                        }
                    }
                    None => as_it_is(column, &rows),
                });
                continue;
            };
            let errors = errors_of(column, columns.peek().copied());
            if errors.is_some() {
                columns.next();
            } else if let Some(value) = constant(values) {
                let unit = unit_as_read(&column.unit);
                let text = if value.is_nan() {
                    "none".to_owned()
                } else {
                    alone(value)
                };
                constants.push(
                    format!("{} {text} {unit}", column.name)
                        .trim_end()
                        .to_owned(),
                );
                is_whole = false;
                continue;
            }
            let explains = EXPLAINING.iter().any(|of| column.name.starts_with(of));
            if explains || numbers + words >= COLUMNS.max(words + 2) {
                is_whole = false;
                continue;
            }
            numbers += 1;
            has_errors |= errors.is_some();
            brief.push(match errors {
                Some(errors) => beside_errors(column, values, errors, &rows),
                None => as_it_is(column, &rows),
            });
        }
        let all_rows = spread(&(0..total).collect::<Vec<_>>(), IN_ALL);
        let all = || -> Vec<Shown> {
            let columns = table.columns.iter();
            columns.map(|column| as_it_is(column, &all_rows)).collect()
        };
        Self {
            title: &table.title,
            file: format!("{}.csv", table.name),
            brief: view(&brief),
            has_errors,
            legend,
            constant: (!constants.is_empty()).then(|| constants.join("; ")),
            whole: (!is_whole).then(|| view(&all())),
            whole_label: format!(
                "All {} columns, {} of {total} rows",
                table.columns.len(),
                all_rows.len()
            ),
            note: if which.is_empty() {
                format!("{total} row{}", if total == 1 { "" } else { "s" })
            } else {
                format!("{total} rows, {} are shown, {which}", rows.len())
            },
        }
    }
}

//! Lines above a table, and their cells.

use std::borrow::Cow;

use super::unit_in_name::is_bracketed;
use super::{CsvDialect, CsvSeparator};
use crate::format::text;

/// Characters that begin a comment.
const COMMENT_SIGNS: [char; 2] = ['#', '%'];

/// Returns true if a line is a comment.
pub(super) fn is_comment(line: &[u8]) -> bool {
    matches!(line.trim_ascii_start().first(), Some(b'#' | b'%'))
}

/// The lines above the numbers.
pub(super) fn above<'a>(
    text: &'a str,
    dialect: &CsvDialect,
) -> impl Iterator<Item = (u64, &'a str)> {
    let last = dialect.header_lines;
    text::lines(text).take_while(move |(number, _)| *number <= last)
}

pub(super) fn without_comment(line: &str) -> &str {
    line.trim_start().trim_start_matches(COMMENT_SIGNS).trim()
}

/// Cells of a header line, without those at the positions `table`, which are numbers of the table.
pub(super) fn cells_beside<'a>(
    line: &'a str,
    separator: CsvSeparator,
    table: &[usize],
) -> Vec<Cow<'a, str>> {
    let mut cells = Vec::new();
    separator.cut(without_comment(line), &mut cells);
    let mut at = 0;
    cells.retain(|_| {
        at += 1;
        !table.contains(&(at - 1))
    });
    cells
}

/// Returns the cells of a header line if there are as many as in the rows of numbers. The separator
/// of names may differ from that of numbers.
pub(super) fn cells_of(line: &str, separator: CsvSeparator, n: usize) -> Option<Vec<Cow<'_, str>>> {
    let bare = line.trim_start_matches(COMMENT_SIGNS);
    let bare = if separator == CsvSeparator::Tab {
        bare
    } else {
        bare.trim_start()
    };
    let mut cells = Vec::new();
    if separator != CsvSeparator::Blanks {
        separator.cut(bare, &mut cells);
        // only the row of names, or only the rows of numbers, may end in a separator
        if cells.len() + 1 == n {
            cells.push(Cow::Borrowed(""));
        } else if cells.len() == n + 1 && cells.last().is_some_and(|cell| cell.is_empty()) {
            cells.pop();
        }
        if cells.len() == n {
            return Some(cells);
        }
    } else if n > 1 {
        for sign in [
            CsvSeparator::Tab,
            CsvSeparator::Semicolon,
            CsvSeparator::Bar,
            CsvSeparator::Comma,
        ] {
            sign.cut(bare, &mut cells);
            if cells.len() == n && cells.iter().all(|cell| !cell.is_empty()) {
                return Some(cells);
            }
        }
    }
    [words(bare), words_with_units(bare), cut_behind_units(bare)]
        .into_iter()
        .find(|cells| cells.len() == n)
}

/// Names or units separated by blanks; empty if names and units are mixed.
fn words(line: &str) -> Vec<Cow<'_, str>> {
    let words: Vec<&str> = line.split_ascii_whitespace().collect();
    let n_units = words.iter().filter(|word| is_bracketed(word)).count();
    if n_units > 0 && n_units < words.len() {
        return Vec::new();
    }
    words.into_iter().map(Cow::Borrowed).collect()
}

/// Names of one word, each optionally followed by a unit in brackets: `time [s] sample force [N]`.
fn words_with_units(line: &str) -> Vec<Cow<'_, str>> {
    let mut cells: Vec<Cow<'_, str>> = Vec::new();
    for word in line.split_ascii_whitespace() {
        match cells.last_mut() {
            Some(name) if is_bracketed(word) => *name = Cow::Owned(format!("{name} {word}")),
            _ => cells.push(Cow::Borrowed(word)),
        }
    }
    cells
}

/// Names of any number of words, each followed by its unit in brackets: `time [s] end A [m/s^2]`.
fn cut_behind_units(line: &str) -> Vec<Cow<'_, str>> {
    line.split_inclusive([']', ')'])
        .map(|cell| Cow::Borrowed(cell.trim()))
        .filter(|cell| !cell.is_empty())
        .collect()
}

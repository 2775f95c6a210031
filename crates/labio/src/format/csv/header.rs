//! Names, units and properties above a table.

use std::borrow::Cow;
use std::collections::HashMap;

use super::abscissa_name::{INTERVAL, Marker, names_abscissa};
use super::cells::is_number;
use super::table::Shape;
use super::{CsvDialect, CsvSeparator, malformed};
use crate::format::text;
use crate::{LabioError, Place};

/// Characters that begin a comment.
const COMMENT_SIGNS: [char; 2] = ['#', '%'];

/// Functions that may precede a quantity in brackets: `real(accelerance)` does not have the unit
/// `accelerance`.
const FUNCTIONS: [&str; 14] = [
    "real",
    "imag",
    "re",
    "im",
    "abs",
    "mag",
    "magnitude",
    "amplitude",
    "phase",
    "angle",
    "arg",
    "log",
    "log10",
    "db",
];

/// Units in headers, in addition to those of [`Unit`](crate::Unit).
const UNITS_IN_HEADERS: [&str; 34] = [
    "-",
    "1",
    "#",
    "%",
    "s",
    "ms",
    "us",
    "\u{b5}s",
    "\u{3bc}s",
    "ns",
    "min",
    "h",
    "Hz",
    "kHz",
    "MHz",
    "V",
    "mV",
    "N",
    "kN",
    "m",
    "mm",
    "m/s",
    "m/s^2",
    "m/s\u{b2}",
    "g",
    "Pa",
    "kPa",
    "MPa",
    "GPa",
    "C",
    "\u{b0}C",
    "K",
    "rad",
    "deg",
];

/// Returns true if a line is a comment.
pub(super) fn is_comment(line: &[u8]) -> bool {
    matches!(line.trim_ascii_start().first(), Some(b'#' | b'%'))
}

/// Contents of the header.
#[derive(Debug, Default)]
pub(super) struct Header {
    /// One name and unit for each column, or none at all.
    pub(super) columns: Vec<(String, String)>,
    pub(super) properties: Vec<(String, String)>,
    /// The text, from a line of our writer, that describes the abscissa.
    pub(super) abscissa: Option<String>,
    /// Keys and values for each column, counted from 1, as written by our writer.
    pub(super) of_columns: HashMap<usize, Vec<(String, String)>>,
}

impl Header {
    pub(super) fn read(
        text: &str,
        dialect: &CsvDialect,
        shape: &Shape,
    ) -> Result<Self, LabioError> {
        let mut header = Self::default();
        let (mut names, mut units) = (None, None);
        let all = Shape::n_cells(shape);
        for (number, line) in above(text, dialect) {
            let field = if dialect.name_line == Some(number) {
                &mut names
            } else if dialect.unit_line == Some(number) {
                &mut units
            } else {
                if !line.trim().is_empty() {
                    let table: &[usize] = match number >= shape.first_line {
                        true => &shape.columns,
                        false => &[],
                    };
                    header.property(number, line, dialect.separator, table);
                }
                continue;
            };
            let cells = cells_of(line, dialect.separator, all).ok_or_else(|| {
                malformed(
                    Place::Line(number),
                    "row of names or units",
                    &text::quoted(line),
                    &format!("{all} cells, as in the rows of numbers"),
                )
            })?;
            *field = Some(cells);
        }
        for (line, found) in [(dialect.name_line, &names), (dialect.unit_line, &units)] {
            if let (Some(line), None) = (line, found) {
                return Err(malformed(
                    Place::Line(line),
                    "row of names or units",
                    "not in the header",
                    &format!("one of its {} lines", dialect.header_lines),
                ));
            }
        }
        if names.is_some() || units.is_some() {
            let cell = |cells: &Option<Vec<Cow<'_, str>>>, at: usize| {
                cells
                    .as_ref()
                    .and_then(|cells| cells.get(at))
                    .map(|cell| cell.clone().into_owned())
            };
            header.columns = shape
                .columns
                .iter()
                .map(|&at| {
                    let name = cell(&names, at).unwrap_or_default();
                    match cell(&units, at) {
                        Some(unit) => (name, without_brackets(&unit).to_owned()),
                        None => split_unit(&name),
                    }
                })
                .collect();
        }
        if header.columns.is_empty() && shape.first_line <= dialect.header_lines {
            header.columns = header.columns_of_preamble(shape.columns.len());
        }
        Ok(header)
    }

    /// Returns names and units of a table of times and samples next to the settings of an
    /// oscilloscope, read from these settings; empty if they do not state the unit of time.
    fn columns_of_preamble(&self, n_columns: usize) -> Vec<(String, String)> {
        let said = |key: &str| {
            let found = self.properties.iter().find(|(known, _)| known == key);
            found.map(|(_, value)| value.as_str())
        };
        let time = said("Horizontal Units")
            .or_else(|| said(INTERVAL)?.split_whitespace().nth(1))
            .filter(|unit| is_unit(unit));
        match (n_columns, time) {
            (2, Some(time)) => [
                ("", time),
                (
                    said("Source").unwrap_or(""),
                    said("Vertical Units").unwrap_or(""),
                ),
            ]
            .map(|(name, unit)| (name.to_owned(), unit.to_owned()))
            .to_vec(),
            _ => Vec::new(),
        }
    }

    /// Stores a line that is neither names nor units; its cells at the positions `table` are
    /// numbers of the table.
    fn property(&mut self, number: u64, line: &str, separator: CsvSeparator, table: &[usize]) {
        let bare = line.trim_start().trim_start_matches(COMMENT_SIGNS).trim();
        let comment = bare.len() < line.trim().len();
        if let Some((key, value)) = key_and_value(bare) {
            if key == "abscissa" && comment && Marker::parse(value).is_some() {
                self.abscissa = Some(value.to_owned());
                return;
            }
            if let Some((column, key)) = key
                .strip_prefix("column ")
                .and_then(|rest| rest.split_once(": "))
                && let Ok(column) = column.parse()
            {
                let said = (key.to_owned(), value.to_owned());
                self.of_columns.entry(column).or_default().push(said);
                return;
            }
            self.properties.push((key.to_owned(), value.to_owned()));
            return;
        }
        let mut cells = Vec::new();
        separator.cut(bare, &mut cells);
        let mut at = 0;
        cells.retain(|_| {
            at += 1;
            !table.contains(&(at - 1))
        });
        if !table.is_empty() && cells.iter().all(|cell| cell.is_empty()) {
            return;
        }
        match cells.split_first() {
            Some((key, rest))
                if separator != CsvSeparator::Blanks && !rest.is_empty() && !key.is_empty() =>
            {
                let rest: Vec<&str> = rest.iter().map(AsRef::as_ref).collect();
                let value = rest.join(" ").trim().to_owned();
                self.properties.push((key.clone().into_owned(), value));
            }
            _ => {
                let key = format!("header line {number}");
                self.properties.push((key, bare.to_owned()));
            }
        }
    }
}

/// Splits a line `key = value`.
pub(super) fn key_and_value(line: &str) -> Option<(&str, &str)> {
    line.split_once(" = ")
        .or_else(|| Some((line.strip_suffix(" =")?, "")))
        .map(|(key, value)| (key.trim(), value.trim()))
        .filter(|(key, _)| !key.is_empty())
}

/// The lines above the numbers.
fn above<'a>(text: &'a str, dialect: &CsvDialect) -> impl Iterator<Item = (u64, &'a str)> {
    let last = dialect.header_lines;
    text::lines(text).take_while(move |(number, _)| *number <= last)
}

/// Returns the cells of a header line if there are as many as in the rows of numbers. The separator
/// of names may differ from that of numbers.
fn cells_of(line: &str, separator: CsvSeparator, n: usize) -> Option<Vec<Cow<'_, str>>> {
    let bare = line.trim_start_matches(COMMENT_SIGNS);
    let bare = if separator == CsvSeparator::Tab {
        bare
    } else {
        bare.trim_start()
    };
    let mut cells = Vec::new();
    if separator != CsvSeparator::Blanks {
        separator.cut(bare, &mut cells);
        // the row of names may lack a separator that ends the rows of numbers
        if cells.len() + 1 == n {
            cells.push(Cow::Borrowed(""));
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

fn is_bracketed(word: &str) -> bool {
    without_brackets(word).len() < word.len()
}

/// Finds the rows of names and of units directly above the numbers.
pub(super) fn find_names(text: &str, dialect: &mut CsvDialect) -> Result<(), LabioError> {
    let n = Shape::of(text, dialect)?;
    let n_cells = n.n_cells();
    let mut last = above(text, dialect)
        .filter(|(_, line)| !line.trim().is_empty())
        .collect::<Vec<_>>();
    last.drain(..last.len().saturating_sub(2));
    let mut rows = last
        .iter()
        .rev()
        .map(|&(number, line)| (number, cells_of(line, dialect.separator, n_cells)));
    let (Some((number, Some(cells))), above) = (rows.next(), rows.next()) else {
        return Ok(());
    };
    let is_word = |cell: &Cow<'_, str>| !cell.is_empty() && !is_number(cell, dialect.decimal_mark);
    if !cells.iter().any(is_word) || n.first_line <= number {
        return Ok(());
    }
    // an oscilloscope may call its channels 1, 2, ...
    let counts = |names: &[Cow<'_, str>]| {
        let mut numbered = names.iter().zip(0_usize..).skip(1);
        names.first().is_some_and(is_word)
            && numbered.all(|(name, number)| name.parse() == Ok(number))
    };
    let filled = || cells.iter().filter(|cell| !cell.is_empty());
    let bracketed = filled().all(|cell| is_bracketed(cell));
    // one unit in four may be unknown
    let units = 4 * filled().filter(|cell| is_unit(cell)).count() >= 3 * filled().count();
    match above {
        Some((names, Some(cells_above)))
            if bracketed
                || (units && (cells_above.iter().all(is_word) || counts(&cells_above))) =>
        {
            dialect.name_line = Some(names);
            dialect.unit_line = Some(number);
        }
        _ if bracketed => dialect.unit_line = Some(number),
        _ => dialect.name_line = Some(number),
    }
    Ok(())
}

fn without_brackets(text: &str) -> &str {
    text.strip_prefix('[')
        .and_then(|inner| inner.strip_suffix(']'))
        .or_else(|| {
            text.strip_prefix('(')
                .and_then(|inner| inner.strip_suffix(')'))
        })
        .map_or(text, str::trim)
}

fn is_unit(text: &str) -> bool {
    let text = without_brackets(text);
    UNITS_IN_HEADERS.contains(&text) || text::known_unit(text).is_some()
}

/// Splits name and unit in `Time [s]`, `Time (s)`, `Time/s` or, for an abscissa only, `time_s`.
fn split_unit(name: &str) -> (String, String) {
    let split = |head: &str, unit: &str| (head.trim().to_owned(), unit.trim().to_owned());
    if let Some((head, unit)) = name.strip_suffix(']').and_then(|n| n.rsplit_once('[')) {
        return split(head, unit);
    }
    if let Some((head, unit)) = name.strip_suffix(')').and_then(|n| n.rsplit_once('(')) {
        let function = FUNCTIONS.contains(&head.trim().to_ascii_lowercase().as_str());
        let number = unit.bytes().all(|byte| byte.is_ascii_digit());
        if !function && !number && !head.trim().is_empty() {
            return split(head, unit);
        }
    }
    for (slash, _) in name.match_indices('/') {
        let (head, unit) = name.split_at(slash);
        let unit = unit.strip_prefix('/').unwrap_or(unit);
        // x/L is a coordinate relative to a length, not x in litres
        let is_length = matches!(unit.trim(), "l" | "L");
        if !head.trim().is_empty() && is_unit(unit.trim()) && !is_length && !is_unit(head.trim()) {
            let begin = head.rfind([' ', '_']).filter(|&at| at > 0);
            let (shorter, whole) = name.split_at(begin.unwrap_or(slash));
            let whole = whole.trim_start_matches([' ', '_', '/']);
            // the unit of `acc_m/s2` begins before the slash, that of `end A/V` behind it
            let is_compound = text::known_unit(whole).is_some_and(|unit| unit.quantity().is_some());
            return if begin.is_some() && is_compound {
                split(shorter, whole)
            } else {
                split(head, unit)
            };
        }
    }
    if let Some((head, unit)) = name.rsplit_once('_')
        && names_abscissa(head)
        && UNITS_IN_HEADERS.contains(&unit)
    {
        return split(head, unit);
    }
    (name.to_owned(), String::new())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_behind_a_name_is_split_off() {
        let split = |name: &str| {
            let (name, unit) = split_unit(name);
            format!("{name}|{unit}")
        };
        assert_eq!(split("Time [s]"), "Time|s");
        assert_eq!(split("frequency(Hz)"), "frequency|Hz");
        assert_eq!(split("Time/s"), "Time|s");
        assert_eq!(split("v/m/s"), "v|m/s");
        assert_eq!(split("a (m/s^2)"), "a|m/s^2");
        assert_eq!(split("time_ms"), "time|ms");
        assert_eq!(split("acc_m/s2"), "acc|m/s2");
        assert_eq!(split("free end m/s^2"), "free end|m/s^2");
        assert_eq!(split("end A/V"), "end A|V");
        for plain in [
            "m/s",
            "real(accelerance)",
            "at 0.15 m (1)",
            "Dev0/Ai0",
            "signal/voltage",
            "x/L",
            "force_s",
            "time_of",
            "(s)",
        ] {
            assert_eq!(split(plain), format!("{plain}|"));
        }
    }
}

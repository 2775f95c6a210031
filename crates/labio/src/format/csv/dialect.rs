//! Detection of the separator, decimal mark and header of a table.

use std::borrow::Cow;

use memchr::{memchr, memchr_iter};

use super::cells::{filled, holds_numbers, is_number};
use super::header_lines::is_comment;
use super::names::find_names;
use super::{CsvDialect, CsvSeparator, malformed};
use crate::format::text::{self, DecimalMark};
use crate::{LabioError, Place};

/// Number of lines searched, not counting comments; headers of laboratory files are shorter.
pub(super) const LINES_SEARCHED: usize = 1000;

/// Number of rows at which a block of numbers is large enough to be the table.
const ROWS_ENOUGH: u64 = 256;

/// The dialects that are tried; among dialects with equally many numbers, the first one wins.
const CANDIDATES: [(CsvSeparator, DecimalMark); 10] = [
    (CsvSeparator::Tab, DecimalMark::Point),
    (CsvSeparator::Tab, DecimalMark::Comma),
    (CsvSeparator::Semicolon, DecimalMark::Point),
    (CsvSeparator::Semicolon, DecimalMark::Comma),
    (CsvSeparator::Comma, DecimalMark::Point),
    (CsvSeparator::Bar, DecimalMark::Point),
    (CsvSeparator::Bar, DecimalMark::Comma),
    (CsvSeparator::Blanks, DecimalMark::Point),
    (CsvSeparator::Blanks, DecimalMark::Comma),
    // numbers in quotes
    (CsvSeparator::Comma, DecimalMark::Comma),
];

impl CsvSeparator {
    fn sign(self) -> Option<u8> {
        match self {
            Self::Comma => Some(b','),
            Self::Semicolon => Some(b';'),
            Self::Tab => Some(b'\t'),
            Self::Bar => Some(b'|'),
            Self::Blanks => None,
        }
    }

    /// Cuts a line into cells and removes the blanks around them.
    pub(super) fn cut<'a>(self, line: &'a str, cells: &mut Vec<Cow<'a, str>>) {
        cells.clear();
        match self.sign() {
            None => cells.extend(line.split_ascii_whitespace().map(Cow::Borrowed)),
            Some(sign) if memchr(b'"', line.as_bytes()).is_none() => {
                cells.extend(text::cells(line, sign).map(Cow::Borrowed));
            }
            Some(sign) => {
                let mut reader = ::csv::ReaderBuilder::new()
                    .delimiter(sign)
                    .has_headers(false)
                    .trim(::csv::Trim::All)
                    .from_reader(line.as_bytes());
                let mut record = ::csv::StringRecord::new();
                // reading does not fail: a line of text is one record of valid UTF-8
                if reader.read_record(&mut record).unwrap_or(false) {
                    cells.extend(record.iter().map(|cell| Cow::Owned(cell.to_owned())));
                }
            }
        }
    }
}

/// Consecutive lines with equally many cells, all of them numbers or empty.
#[derive(Debug, Clone, Copy)]
struct Run {
    first_line: u64,
    n_rows: u64,
    n_cells: u64,
    /// Number of cells that contain a number.
    n_numbers: u64,
}

/// Returns the runs of numbers in one dialect, up to the first run that is long enough.
fn runs(text: &str, separator: CsvSeparator, mark: DecimalMark) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    let mut open = false;
    let mut cells = Vec::new();
    let mut n_searched = 0;
    for (line, row) in text::lines(text) {
        if row.trim().is_empty() {
            continue;
        }
        if is_comment(row.as_bytes()) {
            open = false;
            continue;
        }
        n_searched += 1;
        if n_searched > LINES_SEARCHED {
            break;
        }
        separator.cut(row, &mut cells);
        let n_numbers = cells.iter().filter(|cell| !cell.is_empty()).count() as u64;
        let numeric = n_numbers > 0
            && cells
                .iter()
                .all(|cell| cell.is_empty() || is_number(cell, mark));
        if !numeric {
            open = false;
            continue;
        }
        let n_cells = cells.len() as u64;
        match runs.last_mut() {
            Some(run) if open && run.n_cells == n_cells => {
                run.n_rows += 1;
                run.n_numbers += n_numbers;
                if run.n_rows >= ROWS_ENOUGH {
                    break;
                }
            }
            _ => runs.push(Run {
                first_line: line,
                n_rows: 1,
                n_cells,
                n_numbers,
            }),
        }
        open = true;
    }
    runs
}

/// Returns the largest run and its dialect; the run starts at the first line of numbers with the
/// same count of cells.
fn largest(text: &str) -> Option<(CsvSeparator, DecimalMark, Run)> {
    let mut best: Option<(CsvSeparator, DecimalMark, Run)> = None;
    for (separator, mark) in CANDIDATES {
        let runs = runs(text, separator, mark);
        let Some(largest) = runs.iter().rev().max_by_key(|run| run.n_numbers) else {
            continue;
        };
        if best.is_some_and(|(_, _, run)| run.n_numbers >= largest.n_numbers) {
            continue;
        }
        // an unusual line among the numbers must not turn the rows above it into a header
        let first_line = runs
            .iter()
            .map(|run| (run.n_cells, run.first_line))
            .find(|(n_cells, _)| *n_cells == largest.n_cells)
            .map_or(largest.first_line, |(_, first_line)| first_line);
        let above = first_line..largest.first_line;
        let first_line = if stands_beside_preamble(text, separator, mark, above) {
            largest.first_line
        } else {
            first_line
        };
        best = Some((
            separator,
            mark,
            Run {
                first_line,
                ..*largest
            },
        ));
    }
    best
}

/// Returns the part of a file in which its table must begin.
pub(super) fn searched(bytes: &[u8]) -> &[u8] {
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return bytes; // the bytes of UTF-16 do not show where its lines end
    }
    let mut n_lines = 0;
    let mut begin = 0;
    for end in memchr_iter(b'\n', bytes) {
        let line = bytes.get(begin..end).unwrap_or(&[]);
        begin = end + 1;
        if !line.trim_ascii().is_empty() && !is_comment(line) {
            n_lines += 1;
        }
        if n_lines == LINES_SEARCHED {
            return bytes.split_at(begin).0;
        }
    }
    bytes
}

/// Returns true if the lines `preamble` contain settings of an oscilloscope next to the first rows
/// of the table: the line after them has an empty first cell, and every line of `preamble` has
/// numbers in the columns that are filled in that line.
fn stands_beside_preamble(
    text: &str,
    separator: CsvSeparator,
    mark: DecimalMark,
    preamble: std::ops::Range<u64>,
) -> bool {
    let mut row = Vec::new();
    let Some((_, first)) = text::lines(text).find(|(number, _)| *number == preamble.end) else {
        return false;
    };
    separator.cut(first, &mut row);
    let columns: Vec<usize> = filled(&row).collect();
    columns.first().is_some_and(|&at| at > 0)
        && text::lines(text)
            .take_while(|(number, _)| *number < preamble.end)
            .filter(|(number, line)| *number >= preamble.start && !line.trim().is_empty())
            .all(|(_, line)| {
                let mut cells = Vec::new();
                separator.cut(line, &mut cells);
                cells.len() == row.len() && holds_numbers(&cells, &columns, mark)
            })
}

pub(super) fn holds_table(text: &str) -> bool {
    largest(text).is_some_and(|(_, _, run)| run.n_numbers > 1)
}

/// Returns true if the cells of a table separated by commas are pairs of an integer and of digits
/// after a decimal comma, such as `0,0033,-1,25`: no cell has a decimal point, every second cell
/// has digits only, and one of them begins with a zero, which no integer does, or the line above
/// has half as many names.
fn has_digits_of_fractions(text: &str, dialect: &CsvDialect, run: Run) -> bool {
    if dialect.separator != CsvSeparator::Comma || !run.n_cells.is_multiple_of(2) {
        return false;
    }
    // `Zeit,Kraft` above `0,1,2,5`
    let has_half_the_names = text::lines(text)
        .take_while(|(number, _)| *number < run.first_line)
        .filter(|(_, row)| !row.trim().is_empty())
        .last()
        .is_some_and(|(_, row)| {
            let names: Vec<&str> = text::cells(row, b',').collect();
            2 * names.len() as u64 == run.n_cells
                && names
                    .iter()
                    .all(|name| !name.is_empty() && !is_number(name, DecimalMark::Point))
        });
    let mut begins_with_zero = false;
    let rows = text::lines(text).skip_while(|(number, _)| *number < run.first_line);
    for (_, row) in rows
        .filter(|(_, row)| !row.trim().is_empty())
        .take(LINES_SEARCHED)
    {
        for (at, cell) in text::cells(row, b',').enumerate() {
            let digits = cell.strip_prefix(['-', '+']).filter(|_| at % 2 == 0);
            let digits = digits.unwrap_or(cell);
            if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
                return false;
            }
            begins_with_zero |= at % 2 == 1 && digits.len() > 1 && digits.starts_with('0');
        }
    }
    begins_with_zero || has_half_the_names
}

/// Returns the error for the first cell that is not a number in consecutive lines with equally many
/// cells, of which at least half begin like numbers: dates, numbers with separators of thousands, or
/// a column of text. Returns `None` if no three such lines follow each other.
pub(super) fn text_among_numbers(text: &str) -> Option<LabioError> {
    let begins_like_number = |cell: &&Cow<'_, str>| {
        let digits = cell.trim_start_matches(['-', '+', '.', ',']);
        digits.starts_with(|first: char| first.is_ascii_digit())
    };
    let mut best: Option<(usize, LabioError)> = None;
    let mut cells = Vec::new();
    for (separator, mark) in CANDIDATES {
        let (mut n_rows, mut n_cells, mut n_numbers) = (0, 0, 0);
        let mut first = None;
        for (line, row) in text::lines(text).take(LINES_SEARCHED) {
            separator.cut(row, &mut cells);
            let is_text = |at: &usize| cells.get(*at).is_some_and(|cell| !is_number(cell, mark));
            let other = filled(&cells).find(is_text);
            let n_like = cells.iter().filter(begins_like_number).count();
            let (Some(at), true) = (other, cells.len() > 1 && 2 * n_like >= cells.len()) else {
                n_rows = 0;
                continue;
            };
            if n_rows == 0 || n_cells != cells.len() {
                let found = cells
                    .get(at)
                    .map_or_else(String::new, |cell| text::quoted(cell));
                first = Some((line, at, found));
                (n_rows, n_cells, n_numbers) = (0, cells.len(), 0);
            }
            n_rows += 1;
            n_numbers += cells.iter().filter(|cell| is_number(cell, mark)).count();
            if n_rows < 3 || best.as_ref().is_some_and(|(most, _)| *most >= n_numbers) {
                continue;
            }
            if let Some((line, at, found)) = &first {
                let place = Place::cell(*line, *at);
                best = Some((n_numbers, malformed(place, "cell", found, "a number")));
            }
        }
    }
    best.map(|(_, error)| error)
}

pub(super) fn detect(text: &str) -> Result<CsvDialect, LabioError> {
    let Some((separator, decimal_mark, run)) = largest(text) else {
        return Err(text_among_numbers(text).unwrap_or_else(|| {
            malformed(
                Place::Line(1),
                "table",
                "not found",
                &format!("rows of numbers within the first {LINES_SEARCHED} lines"),
            )
        }));
    };
    let mut dialect = CsvDialect::new(separator, decimal_mark, run.first_line - 1);
    find_names(text, &mut dialect)?;
    let single = |run: &Run| run.n_cells == 1;
    let either_mark = separator == CsvSeparator::Comma
        && run.n_cells == 2
        && runs(text, CsvSeparator::Blanks, DecimalMark::Comma)
            .iter()
            .filter(|other| single(other))
            .any(|other| other.n_rows == run.n_rows);
    let is_named = dialect.name_line.is_some_and(|named| {
        // one name alone is not separated from another by a comma
        text::lines(text).any(|(number, line)| number == named && line.contains(','))
    });
    if !is_named && (either_mark || has_digits_of_fractions(text, &dialect, run)) {
        return Err(malformed(
            Place::Line(run.first_line),
            "comma",
            "either a separator or a decimal mark",
            "names above the numbers, such as `time,force`, if commas separate the columns, or decimal points if they do not; a program can state `separator` and `decimal_mark` of a `CsvDialect`",
        ));
    }
    Ok(dialect)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> (CsvSeparator, DecimalMark, u64) {
        let dialect = detect(text).unwrap();
        (
            dialect.separator,
            dialect.decimal_mark,
            dialect.header_lines,
        )
    }

    #[test]
    fn separator_and_decimal_mark_are_found_by_the_numbers() {
        use CsvSeparator::{Bar, Blanks, Comma, Semicolon, Tab};
        use DecimalMark::{Comma as C, Point as P};
        assert_eq!(found("a,b\n1.5,2\n2,3\n"), (Comma, P, 1));
        assert_eq!(found("1.5, 2\n2, 3\n"), (Comma, P, 0));
        assert_eq!(found("a;b\n1,5;2\n2;3\n"), (Semicolon, C, 1));
        assert_eq!(found("a;b\n1.5;2\n2;3\n"), (Semicolon, P, 1));
        assert_eq!(found("a\tb\n1,5\t2\n2\t3\n"), (Tab, C, 1));
        assert_eq!(found("x\n\n a   b\n 1,5 2\n 2   3\n"), (Blanks, C, 3));
        assert_eq!(found("a|b\n1.5|2\n"), (Bar, P, 1));
        assert_eq!(
            found("a,b\n\"1,5\",\"2,5\"\n\"2,5\",\"3,5\"\n"),
            (Comma, C, 1)
        );
        assert_eq!(found("1.5-2j,3+4j\n"), (Comma, P, 0));
        // names separated by a comma make the comma a separator
        assert_eq!(found("a,b\n1,5\n2,5\n"), (Comma, P, 1));
    }

    #[test]
    fn a_number_in_the_header_is_not_the_table() {
        let text = "Samples,1000\n1000\n17\nt,F,a\n0,1,2\n1,2,3\n";
        assert_eq!(found(text), (CsvSeparator::Comma, DecimalMark::Point, 4));
        // but an unusual line among the numbers does not end the header
        let text = "t,F\n0,1\n1,oops\n2,3\n3,4\n4,5\n";
        assert_eq!(found(text), (CsvSeparator::Comma, DecimalMark::Point, 1));
    }

    #[test]
    fn a_comma_that_may_be_either_is_refused() {
        assert_eq!(
            detect("0,914\n0,537\n").unwrap_err().to_string(),
            "csv, line 1: comma is either a separator or a decimal mark, expected names above the numbers, such as `time,force`, if commas separate the columns, or decimal points if they do not; a program can state `separator` and `decimal_mark` of a `CsvDialect`"
        );
        // the cells look like four integers, but no integer is written 0033
        let decimals = "0,0644,0,7247\n0,0033,-0,3823\n";
        let said = detect(decimals).unwrap_err().to_string();
        assert!(
            said.contains("either a separator or a decimal mark"),
            "{said}"
        );
        assert_eq!(
            found("1,20,3,40\n5,60,-7,80\n"),
            (CsvSeparator::Comma, DecimalMark::Point, 0)
        );
        assert_eq!(
            detect("no numbers here\n").unwrap_err().to_string(),
            "csv, line 1: table is not found, expected rows of numbers within the first 1000 lines"
        );
    }
}

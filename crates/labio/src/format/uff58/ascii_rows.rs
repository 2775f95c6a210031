//! Record 12 of a data set 58 as text: rows of numbers in fixed columns.

use super::fortran_real::{parse, push};
use super::header::{Header, malformed};
use super::lines::{Line, Lines, decode};
use crate::LabioError;

/// Widths of the columns of `E13.5` and `E20.12`.
const SINGLE: usize = 13;
const DOUBLE: usize = 20;

/// Widths of the fields of a full row.
pub(super) fn layout(header: &Header) -> &'static [usize] {
    match (header.double, header.even, header.complex) {
        (false, _, _) => &[SINGLE; 6],
        (true, true, _) => &[DOUBLE; 4],
        (true, false, false) => &[SINGLE, DOUBLE, SINGLE, DOUBLE],
        (true, false, true) => &[SINGLE, DOUBLE, DOUBLE],
    }
}

/// Reads the `n` numbers after the header. After an error, `values` contains those read so far.
pub(super) fn read(
    lines: &mut Lines<'_>,
    header: &Header,
    n: usize,
    values: &mut Vec<f64>,
) -> Result<(), LabioError> {
    let widths = layout(header);
    let row_width: usize = widths.iter().sum();
    // a number takes at least two bytes, including the blank next to it
    values.reserve(n.min(lines.rest().len() / 2 + 1));
    while values.len() < n {
        if n - values.len() >= widths.len() {
            let mut ahead = *lines;
            if let Some(row) = ahead.next_line_of(row_width)
                && full_row(row, widths, values)
            {
                *lines = ahead;
                continue;
            }
        }
        let place = lines.place();
        let missing = |found: &str| {
            malformed(
                place,
                format!("record 12, value {}", values.len() + 1),
                found,
                format!("{n} values, as record 7 states"),
            )
        };
        let line = lines
            .peek_line()
            .ok_or_else(|| missing("the end of the file"))?;
        if line.is_separator() {
            return Err(missing("the end of the data set"));
        }
        lines.next_line();
        any_row(line, widths, n, values)?;
    }
    Ok(())
}

/// Reads a row whose columns are all used; returns false and reads nothing for any other row.
#[inline]
fn full_row(row: &[u8], widths: &[usize], values: &mut Vec<f64>) -> bool {
    let before = values.len();
    let mut rest = row;
    for &width in widths {
        let Some((field, tail)) = rest.split_at_checked(width) else {
            break;
        };
        match parse(field) {
            Some(value) if !cuts_a_number(field, tail) => values.push(value),
            _ => {
                values.truncate(before);
                return false;
            }
        }
        rest = tail;
    }
    true
}

/// Returns true if the border between `field` and `tail` may cut a number: neither side has a blank
/// there, and the two sides are not complete numbers that touch because the writer fills its
/// columns.
fn cuts_a_number(field: &[u8], tail: &[u8]) -> bool {
    let (Some(last), Some(first)) = (field.last(), tail.first()) else {
        return false;
    };
    if last.is_ascii_whitespace()
        || first.is_ascii_whitespace()
        || matches!(first, b'-' | b'+') && (has_exponent(field) || is_word(field))
    {
        return false;
    }
    !(has_exponent(field) && matches!(tail, [b'0'..=b'9', b'.', ..] | [b'.', b'0'..=b'9', ..]))
}

/// Returns true if the field ends like the word for a non-finite value.
fn is_word(field: &[u8]) -> bool {
    matches!(field.last(), Some(b'n' | b'N' | b'f' | b'F' | b'y' | b'Y'))
}

/// Returns true if the number ends with an exponent of two or three digits.
fn has_exponent(field: &[u8]) -> bool {
    let digits = field
        .iter()
        .rev()
        .take_while(|byte| byte.is_ascii_digit())
        .count();
    let before = field.get(..field.len() - digits).unwrap_or_default();
    let marked = matches!(
        before,
        [.., b'+' | b'-' | b'E' | b'e' | b'D' | b'd' | b'Q' | b'q']
    );
    marked && (2..=3).contains(&digits)
}

/// Reads a row of any kind: a last row that is partial or filled with zeros, a row with trailing
/// blanks, or a row separated by blanks instead of columns.
fn any_row(
    line: Line<'_>,
    widths: &[usize],
    n: usize,
    values: &mut Vec<f64>,
) -> Result<(), LabioError> {
    let before = values.len();
    if let Err(no_number) = columns(line.bytes, widths, values) {
        let error = malformed(
            line.place,
            format!("record 12, value {}", values.len() + 1),
            format!("`{}`", decode(no_number.trim_ascii())),
            "a number",
        );
        values.truncate(before);
        for text in line.bytes.split(u8::is_ascii_whitespace) {
            match parse(text) {
                Some(value) => values.push(value),
                None if text.is_empty() => {}
                None => {
                    values.truncate(before);
                    return Err(error);
                }
            }
        }
    }
    if let Some(surplus) = values.get(n..)
        && let Some(value) = surplus
            .iter()
            .find(|value| **value != 0.0 || value.is_nan())
    {
        let error = malformed(
            line.place,
            format!("record 12, after value {n}, the last"),
            value.to_string(),
            "nothing, or zeros that fill the row",
        );
        values.truncate(n);
        return Err(error);
    }
    values.truncate(n);
    Ok(())
}

/// Reads the columns up to the end of the row; the error is a column that is not a number.
fn columns<'a>(row: &'a [u8], widths: &[usize], values: &mut Vec<f64>) -> Result<(), &'a [u8]> {
    let mut rest = row.trim_ascii_end();
    for &width in widths {
        if rest.is_empty() {
            return Ok(());
        }
        let (field, tail) = rest.split_at(rest.len().min(width));
        match parse(field) {
            Some(value) if !cuts_a_number(field, tail) => values.push(value),
            _ => return Err(field),
        }
        rest = tail;
    }
    if rest.is_empty() { Ok(()) } else { Err(rest) }
}

/// Writes numbers row by row, each in its columns.
pub(super) struct RowWriter<'a> {
    widths: &'static [usize],
    column: usize,
    output: &'a mut Vec<u8>,
}

impl<'a> RowWriter<'a> {
    pub(super) fn new(header: &Header, output: &'a mut Vec<u8>) -> Self {
        Self {
            widths: layout(header),
            column: 0,
            output,
        }
    }

    #[inline]
    pub(super) fn put(&mut self, value: f64) {
        if self.widths.get(self.column) == Some(&SINGLE) {
            push::<SINGLE, 6>(self.output, value);
        } else {
            push::<DOUBLE, 13>(self.output, value);
        }
        self.column += 1;
        if self.column == self.widths.len() {
            self.end_row();
        }
    }

    /// Ends the last row, full or not.
    pub(super) fn finish(mut self) {
        if self.column > 0 {
            self.end_row();
        }
    }

    fn end_row(&mut self) {
        self.output.push(b'\n');
        self.column = 0;
    }
}

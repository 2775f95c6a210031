//! The numbers of a table.

use std::borrow::Cow;

use num_complex::Complex64;

use super::cells::holds_numbers;
use super::{CsvDialect, malformed};
use crate::format::Strictness;
use crate::format::rounding::WrittenValues;
use crate::format::text::{self, DecimalMark};
use crate::{LabioError, Ordinate, Place};

/// Number of defects that are listed individually.
const DEFECTS_LISTED: usize = 100;

/// The cells of a row that belong to the table.
#[derive(Debug)]
pub(super) struct Shape {
    /// Positions of the cells that are columns, from 0.
    pub(super) columns: Vec<usize>,
    pub(super) n_cells: usize,
    /// First line with numbers.
    pub(super) first_line: u64,
}

impl Shape {
    /// Finds the columns from the first row of numbers. Cells that are empty there and have no name
    /// are not columns. Rows directly above it that have numbers in the same columns, with text
    /// next to them, belong to the table.
    pub(super) fn of(text: &str, dialect: &CsvDialect) -> Result<Self, LabioError> {
        let mut cells = Vec::new();
        let first = text::lines(text)
            .skip_while(|(number, _)| *number <= dialect.header_lines)
            .find(|(_, line)| !line.trim().is_empty());
        let Some((mut first_line, line)) = first else {
            return Err(LabioError::NoData {
                format: super::FORMAT,
            });
        };
        dialect.separator.cut(line, &mut cells);
        let n_cells = cells.len();
        let mut above = [Vec::new(), Vec::new()];
        for (cells, line) in above.iter_mut().zip([dialect.name_line, dialect.unit_line]) {
            let found = line.and_then(|line| text::lines(text).find(|(number, _)| *number == line));
            if let Some((_, text)) = found {
                dialect.separator.cut(text, cells);
            }
        }
        let named = |at: usize| {
            above
                .iter()
                .any(|cells| cells.get(at).is_some_and(|cell| !cell.is_empty()))
        };
        let columns: Vec<usize> = cells
            .iter()
            .enumerate()
            .filter(|(at, cell)| !cell.is_empty() || named(*at))
            .map(|(at, _)| at)
            .collect();
        if columns.first().is_some_and(|&at| at > 0) && dialect.name_line.is_none() {
            // adds the rows above `first_line` that have numbers in all columns, up to the first
            // that does not
            let above: Vec<(u64, &str)> = text::lines(text)
                .take_while(|(number, _)| *number < first_line)
                .collect();
            for (number, line) in above.into_iter().rev() {
                dialect.separator.cut(line, &mut cells);
                let full =
                    cells.len() == n_cells && holds_numbers(&cells, &columns, dialect.decimal_mark);
                if !full {
                    break;
                }
                first_line = number;
            }
        }
        Ok(Self {
            columns,
            n_cells,
            first_line,
        })
    }
}

/// The columns of a table.
#[derive(Debug)]
pub(super) struct Table {
    pub(super) columns: Vec<Ordinate>,
    /// The column that may be the abscissa, with its digits.
    pub(super) digits: WrittenValues,
    /// Line of the first number.
    pub(super) first_line: u64,
    /// Line of each row.
    pub(super) lines: Vec<u64>,
}

struct Defects<'a> {
    strictness: Strictness,
    list: &'a mut Vec<LabioError>,
    /// Number of unlisted defects, and the line of the first of them.
    further: (usize, u64),
}

impl Defects<'_> {
    fn add(&mut self, line: u64, error: LabioError) -> Result<(), LabioError> {
        if self.strictness == Strictness::Strict || self.list.len() < DEFECTS_LISTED {
            return self.strictness.pass_over(error, self.list);
        }
        if self.further.0 == 0 {
            self.further.1 = line;
        }
        self.further.0 += 1;
        Ok(())
    }

    fn finish(self) {
        let (count, line) = self.further;
        if count > 0 {
            self.list.push(malformed(
                Place::Line(line),
                "rest of the table",
                &format!("{count} further defects"),
                "none",
            ));
        }
    }
}

/// Reads the rows. `abscissa` is the column whose digits are kept; the returned table does not list
/// it among its columns.
#[allow(
    clippy::indexing_slicing,
    reason = "the columns of a shape are among its cells, and a row with another number of cells is refused before they are read"
)]
pub(super) fn read(
    text: &str,
    dialect: &CsvDialect,
    shape: &Shape,
    abscissa: Option<usize>,
    strictness: Strictness,
    list: &mut Vec<LabioError>,
    keep_lines: bool,
) -> Result<Table, LabioError> {
    let mark = dialect.decimal_mark;
    let mut table = Table {
        columns: vec![Ordinate::Real(Vec::new()); shape.columns.len()],
        digits: WrittenValues::default(),
        first_line: shape.first_line,
        lines: Vec::new(),
    };
    let mut defects = Defects {
        strictness,
        list,
        further: (0, 0),
    };
    let mut used = vec![false; shape.n_cells];
    for &at in &shape.columns {
        used[at] = true;
    }
    let mut cells: Vec<Cow<'_, str>> = Vec::new();
    let mut read: Vec<Option<Value>> = Vec::new();
    let mut n_rows = 0;
    for (line, row) in text::lines(text).skip_while(|(number, _)| *number < shape.first_line) {
        if text::trimmed(row).is_empty() {
            continue;
        }
        dialect.separator.cut(row, &mut cells);
        let beside = line > dialect.header_lines
            && cells
                .iter()
                .zip(&used)
                .any(|(cell, used)| !cell.is_empty() && !used);
        let cell = |at: usize| cells[at].as_ref();
        read.clear();
        if cells.len() == shape.n_cells && !beside {
            read.extend(shape.columns.iter().map(|&at| value(cell(at), mark)));
        }
        if read.iter().all(Option::is_none) {
            let expected = format!("a row of {} numbers", shape.columns.len());
            let error = malformed(Place::Line(line), "row", &text::quoted(row), &expected);
            defects.add(line, error)?;
            continue;
        }
        for (((column, values), read), &at) in table
            .columns
            .iter_mut()
            .enumerate()
            .zip(&read)
            .zip(&shape.columns)
        {
            let text = cell(at);
            if text.is_empty() {
                continue; // the column has ended; if not, the gap is found at its next number
            }
            let place = Place::cell(line, at);
            if values.len() < n_rows {
                let found = match n_rows - values.len() {
                    1 => "a number below an empty cell".to_owned(),
                    gap => format!("a number below {gap} empty cells"),
                };
                let expected = "no empty cell above it in the column";
                defects.add(line, malformed(place, "cell", &found, expected))?;
                while values.len() < n_rows {
                    push(values, Value::Real(f64::NAN));
                    if abscissa == Some(column) {
                        table.digits.push(f64::NAN, 0.0);
                    }
                }
            }
            let wrong = |field, expected| malformed(place, field, &text::quoted(text), expected);
            let value = match *read {
                Some(value) => value,
                None => {
                    defects.add(line, wrong("cell", "a number"))?;
                    Value::Real(f64::NAN)
                }
            };
            if abscissa == Some(column) {
                let (number, digits) = match value {
                    Value::Real(number) => (number, text),
                    Value::Complex(number) if number.im == 0.0 => {
                        (number.re, text::real_part(text).unwrap_or(text))
                    }
                    Value::Complex(_) => return Err(wrong("abscissa", "a real number")),
                };
                if !number.is_finite() {
                    defects.add(line, wrong("abscissa", "a finite number"))?;
                }
                table.digits.push(number, text::half_unit(digits, mark));
                push(values, Value::Real(number));
            } else {
                push(values, value);
            }
        }
        n_rows += 1;
        if keep_lines {
            table.lines.push(line);
        }
    }
    defects.finish();
    if n_rows == 0 {
        return Err(LabioError::NoData {
            format: super::FORMAT,
        });
    }
    Ok(table)
}

#[derive(Clone, Copy)]
enum Value {
    Real(f64),
    Complex(Complex64),
}

fn value(text: &str, mark: DecimalMark) -> Option<Value> {
    match text::real(text, mark) {
        Some(value) => Some(Value::Real(value)),
        None => text::complex(text, mark).map(Value::Complex),
    }
}

/// Appends a value; a column becomes complex at its first complex number.
fn push(values: &mut Ordinate, value: Value) {
    match (&mut *values, value) {
        (Ordinate::Real(values), Value::Real(value)) => values.push(value),
        (Ordinate::Complex(values), Value::Real(value)) => values.push(Complex64::new(value, 0.0)),
        (Ordinate::Complex(values), Value::Complex(value)) => values.push(value),
        (Ordinate::Real(reals), Value::Complex(value)) => {
            let mut all: Vec<Complex64> = reals.iter().map(|&re| Complex64::new(re, 0.0)).collect();
            all.push(value);
            *values = Ordinate::Complex(all);
        }
    }
}

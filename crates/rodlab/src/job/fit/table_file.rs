//! Table in a file: columns by name or number, and their values with the lines of the file.

use labio::format::csv::{Columns, CsvOptions, TableColumn, read_columns};
use labio::format::{self, Strictness};
use labio::{LabioError, Ordinate, Place};

use super::result_table;
use super::units::{self, UnitsSheet, Wanted};
use crate::outcome::{InputFile, LogEntry};
use crate::records::Selector;
use crate::{RodlabError, cut_short};

/// A table that was read.
pub(super) struct TableFile {
    /// Path relative to the sheet.
    pub(super) path: String,
    pub(super) input: InputFile,
    pub(super) warnings: Vec<String>,
    /// The first line after the table that is not a row, in words; `None` if there is no such line.
    pub(super) beyond: Option<String>,
    pub(super) log: Vec<LogEntry>,
    columns: Columns,
    /// Place of the table in the sheet, such as `tables[0]`.
    table: String,
}

/// Returns the line of a defect if it affects a whole row.
fn line_of_row(defect: &LabioError) -> Option<u64> {
    match defect {
        LabioError::Malformed {
            place: Place::Line(line),
            ..
        } => Some(*line),
        _ => None,
    }
}

/// Values of a column in SI units, one for each row.
pub(super) type Values = Vec<f64>;

impl TableFile {
    /// Reads the table in `bytes`. Lines after the last row that are not rows of numbers are left
    /// out and logged. Such a line between rows is refused, because otherwise a row could be
    /// missing from the table unnoticed.
    pub(super) fn of(bytes: &[u8], path: String, table: &str) -> Result<Self, RodlabError> {
        let reading = |error| RodlabError::step(format!("{table}: reading {path}"), error);
        let mut log = Vec::new();
        let original = bytes;
        let bytes: &[u8] = &result_table::as_numbers(original, &path, &mut log);
        let format = format::recognise(bytes).map(format::Reader::name);
        if format.is_some_and(|format| format != "csv") {
            return Err(RodlabError::request(
                format!("{table}.files"),
                format!(
                    "{path}, a file in the format {}",
                    format.unwrap_or_default()
                ),
                "a text table, such as one saved as CSV",
            ));
        }
        let options = CsvOptions::default();
        let mut columns = read_columns(bytes, Strictness::Tolerant, &options).map_err(reading)?;
        let last = columns.lines.last().copied().unwrap_or(0);
        let mut warnings = Vec::new();
        let mut beyond: Vec<String> = Vec::new();
        for defect in std::mem::take(&mut columns.defects) {
            match line_of_row(&defect) {
                Some(line) if line <= last => return Err(reading(defect)),
                Some(_) => beyond.push(defect.to_string()),
                None => {}
            }
            log.push(LogEntry::rejected(path.clone(), defect));
        }
        // a cut-off number can only be in a row if the row is the last line of the file
        if beyond.is_empty() {
            warnings.extend(cut_short::warning(original, "csv", &path).map(|text| text + "."));
        }
        Ok(Self {
            input: InputFile::of(&path, "csv", original),
            path,
            warnings,
            beyond: beyond.into_iter().next(),
            log,
            columns,
            table: table.to_owned(),
        })
    }

    /// Returns the lines of the rows, from 1.
    pub(super) fn lines(&self) -> &[u64] {
        &self.columns.lines
    }

    /// Returns the place of a column for error messages: field of the sheet and file.
    pub(super) fn place(&self, field: &str) -> String {
        format!("{}.{field} ({})", self.table, self.path)
    }

    /// Returns the place of a value for error messages: field of the sheet, file and line.
    pub(super) fn place_of(&self, field: &str, row: usize) -> String {
        let line = self.lines().get(row).copied().unwrap_or(0);
        format!("{}.{field} ({}, line {line})", self.table, self.path)
    }

    /// Returns the column of `selector`, by its name or its number from 1.
    fn column(&self, selector: &Selector, field: &str) -> Result<&TableColumn, RodlabError> {
        let columns = &self.columns.columns;
        selector.column(columns, |column| &column.name, &self.place(field))
    }

    /// Returns the values of a column in SI units, all finite.
    pub(super) fn values(
        &self,
        selector: &Selector,
        wanted: Wanted,
        units: &UnitsSheet,
        field: &str,
    ) -> Result<Values, RodlabError> {
        let column = self.column(selector, field)?;
        let unit = units::of(column, wanted, units, (&self.table, &self.place(field)))?;
        let mut values = self.numbers(column, field)?;
        for value in &mut values {
            *value = unit.to_si(*value);
        }
        Ok(values)
    }

    /// Returns the values of a column in any unit, all finite; numbers of steps, for example.
    pub(super) fn keys(&self, selector: &Selector, field: &str) -> Result<Values, RodlabError> {
        self.numbers(self.column(selector, field)?, field)
    }

    fn numbers(&self, column: &TableColumn, field: &str) -> Result<Values, RodlabError> {
        let Ordinate::Real(values) = &column.values else {
            return Err(RodlabError::request(
                self.place(field),
                format!("`{}`, a column of complex numbers", column.name),
                "real numbers, two columns for a complex modulus",
            ));
        };
        if let Some(row) = values.iter().position(|value| !value.is_finite()) {
            return Err(RodlabError::request(
                self.place_of(field, row),
                format!("not a finite number in the column `{}`", column.name),
                "a finite number in every row",
            ));
        }
        if values.len() < self.columns.n_rows() {
            return Err(RodlabError::request(
                self.place_of(field, values.len()),
                format!("an empty cell in the column `{}`", column.name),
                "a number in every row",
            ));
        }
        Ok(values.clone())
    }
}

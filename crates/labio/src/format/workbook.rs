//! Excel workbooks, `.xlsx` of 2007 and later and `.xls` of 97 to 2003: each worksheet with numbers
//! is a table as in a [text file](super::csv).
//!
//! The numbers are the stored values of the cells and, for formulas, the last values that Excel
//! computed, not the shorter numbers that a cell displays; a formula without a value is rejected.
//! Names, units, other information above the numbers and the abscissa are found as in a text
//! table. Charts and worksheets without numbers
//! are left out; the names of these worksheets become properties. If several worksheets have
//! numbers, series are named `worksheet/column`.
//!
//! Needs the feature `workbook`.
//!
//! # Strictness
//!
//! The rules of a text table apply; errors state the place as row and column of the area of
//! numbers. A cell with a date or an error (`#DIV/0!`) is not a number. Encrypted files, files of
//! older versions, and contents beyond a [`MemoryLimit`] are rejected in a strict or a tolerant
//! reading.

mod xls;

use std::io::{Cursor, Read as _};

use calamine::{DataRef, Reader as _, Xlsx as XlsxFile};
use zip::ZipArchive;

use crate::error::malformed;
use crate::format::csv::{CsvAbscissa, CsvDialect, CsvOptions, read_with, text_among_numbers};
use crate::format::memory::Budget;
use crate::format::{MemoryLimit, Reader, Strictness};
use crate::{Contents, LabioError, Place};

const FORMAT: &str = "xlsx";

/// Workbooks of Excel 2007 and later: ZIP archives of XML files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Xlsx;

impl Reader for Xlsx {
    fn name(&self) -> &'static str {
        FORMAT
    }

    fn recognises(&self, head: &[u8]) -> bool {
        let has = |name: &[u8]| head.windows(name.len()).any(|window| window == name);
        let is_archive = head.starts_with(b"PK\x03\x04");
        is_archive && (has(b"[Content_Types].xml") || has(b"xl/"))
    }

    fn read(&self, bytes: &[u8], strictness: Strictness) -> Result<Contents, LabioError> {
        read_at(bytes, strictness, CsvAbscissa::ByContent)
    }

    fn reads_tables(&self) -> bool {
        true
    }
}

/// Workbooks of Excel 97 to 2003: compound files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Xls;

impl Reader for Xls {
    fn name(&self) -> &'static str {
        xls::FORMAT
    }

    fn recognises(&self, head: &[u8]) -> bool {
        head.starts_with(xls::SIGNATURE)
    }

    fn read(&self, bytes: &[u8], strictness: Strictness) -> Result<Contents, LabioError> {
        read_at(bytes, strictness, CsvAbscissa::ByContent)
    }

    fn reads_tables(&self) -> bool {
        true
    }
}

/// Reads a workbook whose tables have the given kind of abscissa.
pub(super) fn read_at(
    bytes: &[u8],
    strictness: Strictness,
    abscissa: CsvAbscissa,
) -> Result<Contents, LabioError> {
    let (format, worksheets) = if Xls.recognises(bytes) {
        (xls::FORMAT, xls::worksheets(bytes)?)
    } else {
        (FORMAT, worksheets(bytes)?)
    };
    let mut contents = Contents::of_format(format);
    let mut tables = Vec::new();
    let mut first_text = None;
    for Worksheet { name, text } in worksheets {
        if CsvDialect::of(text.as_bytes()).is_err() {
            if first_text.is_none() {
                let error = text_among_numbers(text.as_bytes());
                first_text = error.map(|error| in_worksheet(format, &name, error));
            }
            contents
                .properties
                .push(("worksheet without a table of numbers".to_owned(), name));
            continue;
        }
        let options = CsvOptions::default().with_abscissa(abscissa);
        match read_with(text.as_bytes(), strictness, &options) {
            Ok(table) => tables.push((name, table)),
            Err(error) => {
                let error = in_worksheet(format, &name, error);
                strictness.pass_over(error, &mut contents.defects)?;
            }
        }
    }
    let has_several = tables.len() > 1;
    for (name, table) in tables {
        let prefixed = |own: String| match (has_several, own.is_empty()) {
            (false, _) => own,
            (true, true) => name.clone(),
            (true, false) => format!("{name}/{own}"),
        };
        for mut series in table.series {
            series.name = prefixed(series.name);
            contents.series.push(series);
        }
        let properties = table.properties.into_iter();
        contents
            .properties
            .extend(properties.map(|(own, value)| (prefixed(own), value)));
        let defects = table.defects.into_iter();
        contents
            .defects
            .extend(defects.map(|defect| in_worksheet(format, &name, defect)));
    }
    if contents.series.is_empty() && contents.defects.is_empty() {
        return Err(first_text.unwrap_or(LabioError::NoData { format }));
    }
    Ok(contents)
}

/// Converts the error of a text table to the error of a worksheet.
fn in_worksheet(format: &'static str, name: &str, error: LabioError) -> LabioError {
    match error {
        LabioError::Malformed {
            place,
            field,
            found,
            expected,
            ..
        } => LabioError::Malformed {
            format,
            place,
            field: format!("worksheet `{name}`: {field}"),
            found,
            expected,
        },
        other => other,
    }
}

fn refused(what: &str, error: impl std::fmt::Display) -> LabioError {
    let expected = "a workbook that is not encrypted";
    malformed(FORMAT, Place::Byte(0), what, error.to_string(), expected)
}

/// A worksheet as a text table: one line per row, numbers with the fewest digits that read back to
/// the same bits.
struct Worksheet {
    name: String,
    text: String,
}

/// A table that is filled cell by cell.
#[derive(Default)]
struct Filled {
    /// Row, column and text of the cells that are not empty.
    cells: Vec<(u32, u32, String)>,
}

impl Filled {
    fn add(&mut self, (row, column): (u32, u32), value: &DataRef<'_>) {
        let text = match value {
            DataRef::Empty => return,
            // an integer is written as an integer, other numbers with the fewest digits
            DataRef::Int(number) => number.to_string(),
            DataRef::Float(number) => format!("{number:?}"),
            DataRef::String(text) => plain(text),
            DataRef::SharedString(text) => plain(text),
            DataRef::Bool(is) => is.to_string(),
            DataRef::DateTime(date) => format!("date {}", date.as_f64()),
            DataRef::DateTimeIso(text) | DataRef::DurationIso(text) => plain(text),
            DataRef::Error(error) => error.to_string(),
        };
        if !text.is_empty() {
            self.cells.push((row, column, text));
        }
    }

    fn named(mut self, name: String) -> Worksheet {
        self.cells.sort_by_key(|(row, column, _)| (*row, *column));
        let first = self.cells.iter().map(|(_, column, _)| *column).min();
        let (mut row, mut column) = (0, first.unwrap_or(0));
        let mut text = String::new();
        for (at_row, at_column, cell) in &self.cells {
            while row < *at_row {
                text.push('\n');
                row += 1;
                column = first.unwrap_or(0);
            }
            while column < *at_column {
                text.push('\t');
                column += 1;
            }
            text.push_str(cell);
        }
        text.push('\n');
        Worksheet { name, text }
    }
}

/// Returns a text without the characters that end a cell or a row.
fn plain(text: &str) -> String {
    text.replace(['\t', '\n', '\r'], " ").trim().to_owned()
}

fn worksheets(bytes: &[u8]) -> Result<Vec<Worksheet>, LabioError> {
    let broken = |error: calamine::XlsxError| refused("workbook", error);
    expect_to_fit(bytes)?;
    let mut file = XlsxFile::new(Cursor::new(bytes)).map_err(broken)?;
    let mut worksheets = Vec::new();
    for name in file.sheet_names() {
        // a chart sheet has no cells
        let Ok(mut cells) = file.worksheet_cells_reader(&name) else {
            continue;
        };
        let mut filled = Filled::default();
        while let Some(cell) = cells
            .next_cell_with_formula_metadata()
            .map_err(|error| refused(&format!("worksheet `{name}`"), error))?
        {
            if cell.formula.is_some() && matches!(cell.value, DataRef::Empty) {
                let (row, column) = cell.pos;
                let place = Place::Cell {
                    line: u64::from(row) + 1,
                    column: u64::from(column) + 1,
                };
                let field = format!("worksheet `{name}`: cell");
                let expected = "a workbook saved by a program that computes its formulas";
                return Err(malformed(
                    FORMAT,
                    place,
                    field,
                    "a formula without its value",
                    expected,
                ));
            }
            filled.add(cell.pos, &cell.value);
        }
        worksheets.push(filled.named(name));
    }
    Ok(worksheets)
}

/// Rejects an archive whose members, when unpacked, take more memory than the default limit, or
/// announce more texts than they can contain: memory would be reserved for all announced texts.
fn expect_to_fit(bytes: &[u8]) -> Result<(), LabioError> {
    let broken = |error: zip::result::ZipError| refused("archive", error);
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(broken)?;
    let limit = MemoryLimit::of_file(bytes.len());
    let mut budget = Budget::new(FORMAT, limit);
    for index in 0..archive.len() {
        let member = archive.by_index(index).map_err(broken)?;
        let name = member.name().map_err(broken)?.into_owned();
        // the announced length may be less than the unpacked length
        let mut unpacked = Vec::new();
        let read = member.take(limit.bytes()).read_to_end(&mut unpacked);
        read.map_err(|error| refused("archive", error))?;
        budget.take(unpacked.len(), 1, Place::Byte(0), &name)?;
        let is_wide = unpacked.starts_with(b"\xff\xfe") || unpacked.starts_with(b"\xfe\xff");
        let announced = memchr::memmem::find_iter(&unpacked, b"uniqueCount");
        let most = announced.map(|at| number_after(&unpacked, at)).max();
        if is_wide || most.is_some_and(|most| most.saturating_mul(SHORTEST_TEXT) > unpacked.len()) {
            return Err(refused(&name, "not what Excel writes"));
        }
    }
    Ok(())
}

/// Number of bytes of the shortest text in a list of texts, `<si/>`.
const SHORTEST_TEXT: usize = 5;

/// Returns the first number after offset `at`.
fn number_after(bytes: &[u8], at: usize) -> usize {
    let rest = bytes
        .iter()
        .skip(at)
        .skip_while(|byte| !byte.is_ascii_digit());
    let digits = rest.take_while(|byte| byte.is_ascii_digit());
    digits.fold(0, |number: usize, digit| {
        number
            .saturating_mul(10)
            .saturating_add(usize::from(digit - b'0'))
    })
}

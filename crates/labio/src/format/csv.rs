//! Text tables of numbers, with any separator, decimal mark and header.
//!
//! # Recognition by content
//!
//! - The encoding: UTF-8 with or without byte-order mark, UTF-16 with byte-order mark, otherwise
//!   ISO-8859-1.
//! - The dialect ([`CsvDialect`]): the separator and the decimal mark that give the largest block
//!   of numbers in the first thousand lines; everything above the block is the header. Commas
//!   that may be either, as in a file of `1,5` on every line without names, are rejected.
//! - A row of names and a row of units above the numbers; rows of other texts may follow. Units may
//!   also follow names: `Time [s]`, `Time (s)`, `Time/s`, `time_s`, and, if all columns are written
//!   so, `force_N`, `force, N`, `force in N`. If the numbers are separated by blanks, the names may
//!   be separated by tabs, semicolons, bars, commas or their units. All other lines of the header
//!   become properties.
//! - Settings of an instrument, in the header or in the columns next to the first rows of numbers:
//!   names, units, sampling interval and start as Tektronix, Keysight, Rigol, Siglent, GW Instek and
//!   Yokogawa write them. They supply what the rows of names and units do not state.
//! - Numbers with the exponent letter of Fortran (`1.5D-3`) and with the minus sign of Unicode.
//!   Overloads and lost samples become infinite or NaN, whether words (`NaN`, `∞`, `OVERFLOW`,
//!   `1.#INF`) or numbers (9.9E37 and 9.91E37 of instruments, 9.9E34 of DIAdem, the greatest number
//!   of single precision).
//! - Complex numbers in one cell, `1.5-2j`.
//! - The abscissa ([`CsvAbscissa`]): the first column that is called time; otherwise the first
//!   column of the table, if it has a unit of time, is a frequency or an index, or increases evenly
//!   in a table without names. Without such a column, and instead of an index, the abscissa is the
//!   time computed from the interval that the instrument states or, if it states none, the sample
//!   index.
//!
//! # Rounded times
//!
//! A column of times with few digits does not give exact times. If the digits are compatible with
//! an even spacing and determine its step to [`ROUNDED_STEP_TOLERANCE`], the abscissa is even with
//! that step. If they do not determine the step and values repeat, a strict reading rejects the
//! column and names the remedy, [`CsvAbscissa::Step`] or [`CsvAbscissa::Rate`]; a tolerant reading
//! uses the estimated step and reports a defect. All other columns are used as written, evenly
//! spaced or not.
//!
//! # Strictness
//!
//! A strict reading rejects the following faults; a tolerant one reports them as defects: a row
//! unlike the others (it is left out), a cell that is not a number or is empty above other numbers
//! of its column (its value is NaN), and a second column of times with other steps or another
//! start. Columns may end early.

mod abscissa;
mod abscissa_name;
mod cells;
mod columns;
mod dialect;
mod header;
mod header_lines;
mod names;
mod settings;
mod table;
mod unit_in_name;
mod write;

use std::borrow::Cow;

use crate::error;
use crate::format::text::{self, DecimalMark};
use crate::format::uff58::Uff58;
use crate::format::{Reader, Strictness, Writer};
use crate::{Contents, LabioError, Place};

pub use abscissa::ROUNDED_STEP_TOLERANCE;
pub use columns::{Columns, TableColumn, read_columns};

const FORMAT: &str = "csv";

/// Text tables. The writer uses comma separators, decimal points, names with units in brackets,
/// properties as comments, and the fewest digits that read back to the same bits; reading its files
/// gives the same contents.
///
/// # Examples
///
/// ```
/// use labio::Abscissa;
/// use labio::format::csv::Csv;
/// use labio::format::{Reader, Strictness};
///
/// let file = "Zeit;Kraft\n(ms);(N)\n0,0;1,5\n0,1;2,5\n0,2;0,5\n";
/// let contents = Csv.read(file.as_bytes(), Strictness::Strict)?;
/// assert_eq!(contents.series[0].name, "Kraft");
/// assert_eq!(contents.series[0].ordinate_axis.unit_text, "N");
/// assert_eq!(contents.series[0].abscissa, Abscissa::Even { start: 0.0, step: 0.1 });
/// # Ok::<(), labio::LabioError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Csv;

/// Separator between the cells of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum CsvSeparator {
    /// `,`
    Comma,
    /// `;`
    Semicolon,
    /// A tab.
    Tab,
    /// `|`
    Bar,
    /// Any number of blanks and tabs.
    Blanks,
}

/// Layout of a text table.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct CsvDialect {
    /// Separator between the cells of a row.
    pub separator: CsvSeparator,
    /// The sign between integer part and fraction.
    pub decimal_mark: DecimalMark,
    /// Number of lines above the numbers.
    pub header_lines: u64,
    /// Line of the names, from 1.
    pub name_line: Option<u64>,
    /// Line of the units, from 1.
    pub unit_line: Option<u64>,
}

impl CsvDialect {
    /// Creates a dialect with neither names nor units.
    #[must_use]
    pub fn new(separator: CsvSeparator, decimal_mark: DecimalMark, header_lines: u64) -> Self {
        Self {
            separator,
            decimal_mark,
            header_lines,
            name_line: None,
            unit_line: None,
        }
    }

    /// Sets the line of the names, from 1.
    #[must_use]
    pub fn with_names(mut self, line: u64) -> Self {
        self.name_line = Some(line);
        self
    }

    /// Sets the line of the units, from 1.
    #[must_use]
    pub fn with_units(mut self, line: u64) -> Self {
        self.unit_line = Some(line);
        self
    }

    /// Finds the dialect of a file from its content.
    ///
    /// # Errors
    ///
    /// [`LabioError::Malformed`] if there is no table of numbers in the first thousand lines, or if
    /// commas could be either separators or decimal marks.
    pub fn of(bytes: &[u8]) -> Result<Self, LabioError> {
        dialect::detect(&text::decode(bytes, FORMAT)?.0)
    }
}

/// Source of the abscissa.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum CsvAbscissa {
    /// The column that looks like an abscissa, see the [module](self).
    #[default]
    ByContent,
    /// The column with this number, from 1.
    Column(usize),
    /// The column chosen as in [`Self::ByContent`], with this step in the unit of the column; the
    /// values may deviate from even spacing by half a step plus their rounding.
    Step(f64),
    /// The column chosen as in [`Self::ByContent`], but sampled at this rate \[Hz\] if the column
    /// itself does not determine an even spacing, as for times rounded to single precision or to a
    /// few digits. The values may deviate from the rate by half a step plus their rounding; a
    /// column without a unit is assumed to be in seconds.
    Rate(f64),
    /// No column: every column is a series over the sample index.
    Index,
}

/// Known properties of a table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CsvOptions {
    /// The dialect; found by content if `None`.
    pub dialect: Option<CsvDialect>,
    /// The abscissa.
    pub abscissa: CsvAbscissa,
}

impl CsvOptions {
    /// Sets the dialect.
    #[must_use]
    pub fn with_dialect(mut self, dialect: CsvDialect) -> Self {
        self.dialect = Some(dialect);
        self
    }

    /// Sets the abscissa.
    #[must_use]
    pub fn with_abscissa(self, abscissa: CsvAbscissa) -> Self {
        Self { abscissa, ..self }
    }
}

/// Reads a table with known properties.
///
/// # Errors
///
/// [`LabioError`] with line and column of the unexpected text; also if the file contradicts
/// `options`.
///
/// # Examples
///
/// ```
/// use labio::Abscissa;
/// use labio::format::Strictness;
/// use labio::format::csv::{CsvAbscissa, CsvOptions, read_with};
///
/// // times in two digits
/// let file = b"t,F\n0.0e-6,1\n0.3e-6,2\n0.5e-6,3\n0.8e-6,4\n";
/// let options = CsvOptions::default().with_abscissa(CsvAbscissa::Step(2.5e-7));
/// let contents = read_with(file, Strictness::Strict, &options)?;
/// assert_eq!(contents.series[0].abscissa, Abscissa::Even { start: 0.0, step: 2.5e-7 });
/// # Ok::<(), labio::LabioError>(())
/// ```
pub fn read_with(
    bytes: &[u8],
    strictness: Strictness,
    options: &CsvOptions,
) -> Result<Contents, LabioError> {
    let (text, encoding, dialect) = opened(bytes, options)?;
    let mut contents = Contents::of_format(FORMAT);
    if encoding != text::Encoding::Utf8 {
        let encoding = encoding.name().to_owned();
        contents.properties.push(("encoding".to_owned(), encoding));
    }
    let shape = table::Shape::of(&text, &dialect)?;
    let header = header::Header::read(&text, &dialect, &shape)?;
    let choice = abscissa::Choice::of(&header, options.abscissa, shape.columns.len())?;
    let table = table::read(
        &text,
        &dialect,
        &shape,
        choice.column,
        strictness,
        &mut contents.defects,
        false,
    )?;
    abscissa::assemble(table, header, &choice, strictness, &mut contents)?;
    Ok(contents)
}

/// Returns the error for the first cell that is not a number in rows that would otherwise be a
/// table; `None` if the bytes are not a text with such rows.
pub(super) fn text_among_numbers(bytes: &[u8]) -> Option<LabioError> {
    let (text, _) = text::decode(bytes, FORMAT).ok()?;
    let is_binary = text
        .chars()
        .any(|c| c.is_ascii_control() && !c.is_whitespace());
    dialect::text_among_numbers(&text).filter(|_| !is_binary)
}

/// Returns text, encoding and dialect of a table.
fn opened<'a>(
    bytes: &'a [u8],
    options: &CsvOptions,
) -> Result<(Cow<'a, str>, text::Encoding, CsvDialect), LabioError> {
    let (text, encoding) = text::decode(bytes, FORMAT)?;
    if text.trim().is_empty() {
        return Err(LabioError::NoData { format: FORMAT });
    }
    let dialect = match &options.dialect {
        Some(dialect) => dialect.clone(),
        None => dialect::detect(&text)?,
    };
    Ok((text, encoding, dialect))
}

impl Reader for Csv {
    fn name(&self) -> &'static str {
        FORMAT
    }

    /// Returns true if the beginning of the file contains a table. Almost every text with numbers
    /// does, so the other formats must be tried first.
    fn recognises(&self, head: &[u8]) -> bool {
        let head = dialect::searched(head);
        let Ok((text, _)) = text::decode(head.get(..head.len() & !1).unwrap_or(head), FORMAT)
            .or_else(|_| text::decode(head, FORMAT))
        else {
            return false;
        };
        let foreign = text.starts_with("LabVIEW Measurement")
            || Uff58.recognises(head)
            || text
                .chars()
                .any(|c| c.is_ascii_control() && !c.is_whitespace());
        // the last line of a head may be cut off
        let whole = match text.rfind('\n') {
            Some(end) if head.len() >= 4096 => text.get(..end).unwrap_or(""),
            _ => &text,
        };
        !foreign && dialect::holds_table(whole)
    }

    fn read(&self, bytes: &[u8], strictness: Strictness) -> Result<Contents, LabioError> {
        read_with(bytes, strictness, &CsvOptions::default())
    }

    fn states_length(&self) -> bool {
        false
    }

    fn reads_tables(&self) -> bool {
        true
    }
}

impl Writer for Csv {
    fn name(&self) -> &'static str {
        FORMAT
    }

    fn write(
        &self,
        contents: &Contents,
        output: &mut dyn std::io::Write,
    ) -> Result<(), LabioError> {
        write::write(contents, output)
    }
}

fn malformed(place: Place, field: &str, found: &str, expected: &str) -> LabioError {
    error::malformed(FORMAT, place, field, found, expected)
}

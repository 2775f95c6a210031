//! Tables of numbers in text, whatever their separator, decimal mark and header are.
//!
//! # What is found by the content
//!
//! - The encoding: UTF-8 with or without mark, UTF-16 with mark, else ISO-8859-1.
//! - The dialect ([`CsvDialect`]): the separator and the decimal mark under which the first thousand lines hold the largest block of
//!   numbers; everything above the block is the header. The one case in which two readings are equal, a file of `1,5` on every line
//!   without names, is refused.
//! - A row of names and a row of units right above the numbers. Units also stand behind names: `Time [s]`, `Time (s)`, `Time/s`,
//!   `time_s`. Above numbers between blanks, names may be separated by tabulators, semicolons, bars, commas or their units. All other lines
//!   of the header become properties.
//! - Settings of an oscilloscope in the columns before the first rows of numbers become properties, and tell the units.
//! - Complex numbers in one cell, `1.5-2j`.
//! - The abscissa ([`CsvAbscissa`]): the first column that is called time, or the first column of all if it is in a unit of
//!   time, is a frequency or an index, or if there are no names and it increases evenly. Otherwise the samples are counted.
//!
//! # Rounded times
//!
//! A column of times in few digits is no clock. If an even spacing lies within the digits, and they determine its step to
//! [`ROUNDED_STEP_TOLERANCE`], the abscissa is even with that step; if they do not, and values repeat, a strict reading refuses
//! the column and names the remedy, [`CsvAbscissa::Step`] or [`CsvAbscissa::Rate`]. A tolerant reading takes the estimated step and says so in a defect. All other
//! columns are taken as they stand, evenly spaced or not.
//!
//! # Strictness
//!
//! Refused, and passed over with a defect in a tolerant reading: a row that is not like the others (it is left out), a cell that is no
//! number or is missing above others (NaN takes its place). Columns may end early.

mod abscissa;
mod dialect;
mod header;
mod table;
mod write;

use crate::error;
use crate::format::text::{self, DecimalMark};
use crate::format::uff58::Uff58;
use crate::format::{Reader, Strictness, Writer};
use crate::{Contents, LabioError, Place};

pub use abscissa::ROUNDED_STEP_TOLERANCE;

const FORMAT: &str = "csv";

/// Tables in text. The writer writes commas and points, names, units in brackets, properties as comments and the fewest
/// digits that read back to the same bits; its files read back to the same contents.
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

/// What separates the cells of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum CsvSeparator {
    /// `,`
    Comma,
    /// `;`
    Semicolon,
    /// A tabulator.
    Tab,
    /// `|`
    Bar,
    /// Any number of blanks and tabulators.
    Blanks,
}

/// How a table is written.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct CsvDialect {
    /// What separates the cells of a row.
    pub separator: CsvSeparator,
    /// The sign between whole numbers and fractions.
    pub decimal_mark: DecimalMark,
    /// Number of lines above the numbers.
    pub header_lines: u64,
    /// Line of the names, from 1.
    pub name_line: Option<u64>,
    /// Line of the units, from 1.
    pub unit_line: Option<u64>,
}

impl CsvDialect {
    /// A dialect with neither names nor units.
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

    /// The same with names in line `line`, from 1.
    #[must_use]
    pub fn with_names(self, line: u64) -> Self {
        Self {
            name_line: Some(line),
            ..self
        }
    }

    /// The same with units in line `line`, from 1.
    #[must_use]
    pub fn with_units(self, line: u64) -> Self {
        Self {
            unit_line: Some(line),
            ..self
        }
    }

    /// The dialect of a file, by its content.
    ///
    /// # Errors
    ///
    /// [`LabioError::Malformed`] if there is no table of numbers in the first thousand lines, or if a comma may be either mark.
    pub fn of(bytes: &[u8]) -> Result<Self, LabioError> {
        dialect::detect(&text::decode(bytes, FORMAT)?.0)
    }
}

/// Where the abscissa comes from.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum CsvAbscissa {
    /// From the column that looks like one, see the [module](self).
    #[default]
    ByContent,
    /// From this column, from 1.
    Column(usize),
    /// As by content, but with this step, in the unit of the column. The column may deviate from it by half a step and by its rounding.
    Step(f64),
    /// As by content, but sampled at this rate \[Hz\] where the column does not tell an even spacing by itself: times that were rounded to
    /// single precision or to a few digits. The column may deviate from it by half a step and by its rounding; without a unit it is taken for
    /// seconds.
    Rate(f64),
    /// There is none: every column is a series over the number of the sample.
    Index,
}

/// What is known of a file beforehand.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CsvOptions {
    /// The dialect, if not by content.
    pub dialect: Option<CsvDialect>,
    /// The abscissa.
    pub abscissa: CsvAbscissa,
}

impl CsvOptions {
    /// The same with the dialect given.
    #[must_use]
    pub fn with_dialect(self, dialect: CsvDialect) -> Self {
        Self {
            dialect: Some(dialect),
            ..self
        }
    }

    /// The same with the abscissa given.
    #[must_use]
    pub fn with_abscissa(self, abscissa: CsvAbscissa) -> Self {
        Self { abscissa, ..self }
    }
}

/// Reads a table of which something is known beforehand.
///
/// # Errors
///
/// [`LabioError`] with line and column of what is not as expected; also if the file contradicts `options`.
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
    let (text, encoding) = text::decode(bytes, FORMAT)?;
    if text.trim().is_empty() {
        return Err(LabioError::NoData { format: FORMAT });
    }
    let dialect = match &options.dialect {
        Some(dialect) => dialect.clone(),
        None => dialect::detect(&text)?,
    };
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
    )?;
    abscissa::assemble(table, header, &choice, strictness, &mut contents)?;
    Ok(contents)
}

impl Reader for Csv {
    fn name(&self) -> &'static str {
        FORMAT
    }

    /// Whether the beginning holds a table. Almost every text with numbers does: ask the other formats first.
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
        // the last line of a head may be torn
        let whole = match text.rfind('\n') {
            Some(end) if head.len() >= 4096 => text.get(..end).unwrap_or(""),
            _ => &text,
        };
        !foreign && dialect::holds_table(whole)
    }

    fn read(&self, bytes: &[u8], strictness: Strictness) -> Result<Contents, LabioError> {
        read_with(bytes, strictness, &CsvOptions::default())
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

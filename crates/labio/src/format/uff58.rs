//! Universal file data set 58, *function at nodal DOF*, as text (58) and with binary data (58b).
//!
//! # The format
//!
//! A universal file is a sequence of data sets, each between two lines ` -1`. The number of a data
//! set is on the line after the first ` -1`. Data set 164 contains the units for functions that
//! state none, data set 15 the coordinates of their nodes ([`POSITION`]); all others but 58 are
//! skipped, and their numbers are listed in [`Contents::properties`]. A data set 58 has eleven
//! records in fixed columns and then its numbers: abscissa (unless evenly spaced) and real or
//! complex ordinate of each point, in rows of `E13.5` and `E20.12` or, in a 58b, as IEEE numbers in
//! either byte order.
//!
//! # Series
//!
//! | part of [`Series`] | from |
//! |---|---|
//! | name | record 1 (`NONE` is an empty name) |
//! | kind | record 6, function type |
//! | abscissa | record 7 if evenly spaced, else the data |
//! | labels and texts of units of the axes | records 8 and 9 |
//! | unit of the ordinate | record 9, divided by that of record 10 if there is one; without texts, from the specific data types and the unit system of data set 164 |
//! | unit of the abscissa | record 8; without text there, s or Hz if the specific type is that of a time or a frequency |
//!
//! Everything else is in the properties, and the writer writes these back: `uff58.id2` to
//! `uff58.id5`, `uff58.function_id`, `uff58.version`, `uff58.load_case`, `uff58.response_entity`,
//! `.._node`, `.._direction`, likewise for `uff58.reference`, `uff58.z_value`, for each of
//! `abscissa`, `ordinate`, `denominator` and `z` its `.._type` (specific data type) and
//! `.._exponents` (of length, force and temperature), `uff58.denominator_label`, `.._unit`,
//! likewise for `z`, `uff58.encoding` and `uff58.precision`. An empty field (0, `NONE`) does not
//! become a property. Properties with other names are not written: the format has no place for
//! them.
//!
//! # Tolerated deviations
//!
//! Files of well-known programs contain the following deviations, none of which makes the data
//! ambiguous: columns that touch; numbers separated by blanks instead of columns; exponents with
//! `D`, with three digits, without a letter; a last row that is partial or filled with zeros;
//! separators and lines padded to 80 columns; a `-1` inside a data set; line ends of either kind;
//! texts in UTF-8 or Latin-1; a line end before the closing `-1` of a 58b, and a wrong number of
//! bytes in its first line, provided that the number of points leads to a separator. Anything else
//! is an error that names record and field; in a tolerant reading it is a defect, and the points
//! that could be read are kept.
//!
//! # Precision
//!
//! A 58b in double precision keeps every bit of the values (an uneven abscissa is written in double
//! precision too). Text keeps 13 digits in double and 6 in single precision. Start and step of an
//! even abscissa, and the z value, have 12 columns in the header of both forms: about 8 digits.
//! Steps in files of other programs have 6 digits; the property [`STEP_HALF_UNIT`] states their
//! precision.
//!
//! ```
//! use labio::format::{Reader, Strictness, Writer, uff58::{ByteOrder, Encoding, Precision, Uff58, Uff58Writer}};
//! use labio::{Abscissa, Contents, Ordinate, Series, SeriesAxis, SeriesKind};
//!
//! # fn main() -> Result<(), labio::LabioError> {
//! let mut contents = Contents::of_format("computed");
//! contents.series.push(Series {
//!     name: "end A".to_owned(),
//!     kind: SeriesKind::TimeResponse,
//!     abscissa: Abscissa::Even { start: 0.0, step: 1.0 / 51_200.0 },
//!     ordinate: Ordinate::Real(vec![0.0, 0.1, -1.0 / 3.0]),
//!     abscissa_axis: SeriesAxis { label: "Time".to_owned(), unit_text: "s".to_owned(), unit: None },
//!     ordinate_axis: SeriesAxis { label: "Acceleration".to_owned(), unit_text: "m/s^2".to_owned(), unit: None },
//!     properties: Vec::new(),
//! });
//! let writer = Uff58Writer {
//!     encoding: Encoding::Binary(ByteOrder::LittleEndian),
//!     precision: Precision::Double,
//! };
//! let mut file = Vec::new();
//! writer.write(&contents, &mut file)?;
//!
//! let read = Uff58.read(&file, Strictness::Strict)?;
//! assert_eq!(read.series[0].name, "end A");
//! assert_eq!(read.series[0].abscissa, contents.series[0].abscissa);
//! assert_eq!(read.series[0].ordinate, contents.series[0].ordinate);
//! # Ok(())
//! # }
//! ```

use std::io::Write;

use self::ascii_rows::RowWriter;
use self::binary_block::BlockWriter;
use self::header::{BinaryForm, Header, malformed};
use self::lines::{Line, Lines, decode};
use self::surroundings::Surroundings;
use super::{Reader, Strictness, Writer};
use crate::error::{not_representable, not_written};
use crate::{Abscissa, Contents, LabioError, Ordinate, Series};

mod ascii_rows;
mod binary_block;
mod fortran_real;
mod header;
mod lines;
mod series_header;
mod surroundings;

pub use series_header::response;
pub use surroundings::{POSITION, REFERENCE_POSITION, UNITS};

const FORMAT: &str = "uff58";

/// Property of the file: the number of a skipped data set, one property for each.
pub const SKIPPED: &str = "uff58.skipped_data_set";
/// Property of an evenly spaced series: half a unit of the last digit with which the step is
/// written. From the step and this half unit, [`customary_rate`](crate::format::customary_rate)
/// finds the nominal sampling rate.
pub const STEP_HALF_UNIT: &str = "uff58.step_half_unit";
/// Property of the file: number of data sets 58, present only if it is zero.
pub const N_DATA_SETS: &str = "uff58.n_data_sets_58";

/// Reads universal files; see the [module](self).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Uff58;

/// Order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ByteOrder {
    /// Least significant byte first.
    LittleEndian,
    /// Most significant byte first.
    BigEndian,
}

/// Encoding of the numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum Encoding {
    /// The encoding stated in the property `uff58.encoding` of the series; text if there is none.
    #[default]
    AsRead,
    /// Text.
    Ascii,
    /// IEEE numbers: data set 58b.
    Binary(ByteOrder),
}

/// Precision of the numbers written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum Precision {
    /// The precision stated in the property `uff58.precision` of the series; double if there is
    /// none.
    #[default]
    AsRead,
    /// 6 digits as text, 24 bits as IEEE numbers.
    Single,
    /// 13 digits as text, 53 bits as IEEE numbers.
    Double,
}

/// Writes universal files; see the [module](self).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Uff58Writer {
    /// Text or binary.
    pub encoding: Encoding,
    /// Single or double.
    pub precision: Precision,
}

impl Reader for Uff58 {
    fn name(&self) -> &'static str {
        FORMAT
    }

    /// Returns true for a line `    -1` followed by a line with a number that ends in its sixth
    /// column. A column of numbers that begins with -1 is not a universal file.
    fn recognises(&self, head: &[u8]) -> bool {
        let mut lines = Lines::new(head);
        let first = std::iter::from_fn(|| lines.next_line()).find(|line| !line.is_blank());
        first.is_some_and(|line| line.is_separator() && line.bytes.starts_with(b"    -1"))
            && lines.next_line().is_some_and(|line| {
                data_set_number(line).is_some() && line.bytes.get(5).is_some_and(u8::is_ascii_digit)
            })
    }

    fn read(&self, bytes: &[u8], strictness: Strictness) -> Result<Contents, LabioError> {
        let mut contents = Contents::of_format(FORMAT);
        let mut lines = Lines::new(bytes);
        let mut n_data_sets = 0_usize;
        let mut surroundings = Surroundings::default();
        while let Some(line) = lines.next_line() {
            if line.is_blank() {
                continue;
            }
            let outcome = if line.is_separator() {
                data_set(&mut lines, &mut contents, &mut surroundings)
            } else {
                let found = format!("`{}`", decode(line.bytes));
                Err(malformed(
                    line.place,
                    "line between data sets",
                    found,
                    "a line `    -1`",
                ))
            };
            match outcome {
                Ok(()) => n_data_sets += 1,
                Err(error) if strictness == Strictness::Tolerant => {
                    contents.defects.push(error);
                    if !line.is_separator() {
                        resume(&mut lines);
                    }
                }
                Err(error) => return Err(error),
            }
        }
        if n_data_sets == 0 && contents.series.is_empty() {
            return Err(contents
                .defects
                .into_iter()
                .next()
                .unwrap_or(LabioError::NoData { format: FORMAT }));
        }
        surroundings.complete(&mut contents);
        if contents.series.is_empty() {
            contents
                .properties
                .push((N_DATA_SETS.to_owned(), "0".to_owned()));
        }
        Ok(contents)
    }
}

/// Advances to just before the next separator, which may open a data set.
fn resume(lines: &mut Lines<'_>) {
    while let Some(line) = lines.peek_line() {
        if line.is_separator() {
            return;
        }
        lines.next_line();
    }
}

/// Returns number and letter of an identifier line.
fn data_set_number(line: Line<'_>) -> Option<(u32, bool)> {
    let (columns, rest) = line.bytes.split_at(line.bytes.len().min(6));
    let number = std::str::from_utf8(columns.trim_ascii())
        .ok()?
        .parse()
        .ok()?;
    Some((number, matches!(rest, [b'b' | b'B', ..])))
}

/// Reads or skips the data set opened by a separator, including its closing separator.
fn data_set(
    lines: &mut Lines<'_>,
    contents: &mut Contents,
    surroundings: &mut Surroundings,
) -> Result<(), LabioError> {
    let place = lines.place();
    let before = *lines;
    let identifier =
        |found: String| malformed(place, "identifier line", found, "the number of a data set");
    let line = lines
        .next_line()
        .ok_or_else(|| identifier("the end of the file".to_owned()))?;
    let Some((number, binary)) = data_set_number(line) else {
        if line.is_separator() {
            // of two separators in succession, the second may open a data set
            *lines = before;
        } else {
            lines.skip_past_separator();
        }
        return Err(identifier(format!("`{}`", decode(line.bytes))));
    };
    if number == 58 {
        return data_set_58(line, binary, lines, contents);
    }
    // functions can be read without these data sets: a data set of an unexpected layout is skipped
    // and listed
    let mut after = *lines;
    let read = match number {
        164 => surroundings.read_units(&mut after, contents),
        15 => surroundings.read_nodes(&mut after),
        _ => None,
    };
    if read.is_some() {
        *lines = after;
        return Ok(());
    }
    contents
        .properties
        .push((SKIPPED.to_owned(), number.to_string()));
    if lines.skip_past_separator() {
        return Ok(());
    }
    Err(malformed(
        lines.place(),
        format!("data set {number}"),
        "the end of the file",
        "a line `    -1` that closes it",
    ))
}

fn data_set_58(
    line: Line<'_>,
    binary: bool,
    lines: &mut Lines<'_>,
    contents: &mut Contents,
) -> Result<(), LabioError> {
    let mut after = *lines;
    let header = if binary {
        header::binary_form(line).map(Some)
    } else {
        Ok(None)
    }
    .and_then(|form| Ok((form, Header::read(&mut after)?)));
    let (form, header) = match header {
        Ok(header) => header,
        Err(error) => {
            lines.skip_past_separator();
            return Err(error);
        }
    };
    *lines = after;
    let mut values = Vec::new();
    let outcome = match form {
        Some(form) => binary_block::read(lines, form, &header, &mut values),
        None => text_data(lines, &header, &mut values),
    };
    if outcome.is_ok() || !values.is_empty() {
        contents
            .series
            .push(series_header::series(header, form, values));
    }
    if outcome.is_err() {
        *lines = after;
        lines.skip_past_separator();
    }
    outcome
}

/// Reads the rows and the closing separator.
fn text_data(
    lines: &mut Lines<'_>,
    header: &Header,
    values: &mut Vec<f64>,
) -> Result<(), LabioError> {
    let n_values = header
        .n_points
        .checked_mul(series_header::numbers_per_point(header))
        .ok_or_else(|| {
            malformed(
                lines.place(),
                "record 7, field 2 (number of values)",
                header.n_points.to_string(),
                "a smaller number",
            )
        })?;
    ascii_rows::read(lines, header, n_values, values)?;
    loop {
        let place = lines.place();
        let after = |found: String| {
            let field = format!("record 12, after value {n_values}, the last");
            malformed(
                place,
                field,
                found,
                "a line `    -1` that closes the data set",
            )
        };
        let line = lines
            .next_line()
            .ok_or_else(|| after("the end of the file".to_owned()))?;
        if line.is_separator() {
            return Ok(());
        }
        if !line.is_blank() {
            return Err(after(format!("`{}`", decode(line.bytes))));
        }
    }
}

impl Writer for Uff58Writer {
    fn name(&self) -> &'static str {
        FORMAT
    }

    fn write(&self, contents: &Contents, output: &mut dyn Write) -> Result<(), LabioError> {
        // a file without a data set could not be distinguished from a truncated one
        if contents.series.is_empty() {
            return Err(not_representable(FORMAT, "contents without a data set"));
        }
        let mut bytes = Vec::new();
        for series in &contents.series {
            self.encode(series, &mut bytes)?;
        }
        output
            .write_all(&bytes)
            .and_then(|()| output.flush())
            .map_err(not_written)
    }
}

impl Uff58Writer {
    fn encode(&self, series: &Series, output: &mut Vec<u8>) -> Result<(), LabioError> {
        let (header, binary) = series_header::header(series, self.encoding, self.precision)?;
        let mut text = "    -1\n".to_owned();
        header.write(binary, &mut text)?;
        output.extend(text.as_bytes());
        match binary {
            None => {
                output.reserve(text_size(&header));
                let mut rows = RowWriter::new(&header, output);
                each_number(series, |value| {
                    rows.put(value);
                    Ok(())
                })?;
                rows.finish();
            }
            Some(BinaryForm {
                byte_order,
                n_bytes,
            }) => {
                output.reserve(usize::try_from(n_bytes).unwrap_or(0));
                let mut block = BlockWriter::new(&header, byte_order, output);
                each_number(series, |value| block.put(value))?;
            }
        }
        output.extend(b"    -1\n");
        Ok(())
    }
}

/// Returns the number of bytes of the rows.
fn text_size(header: &Header) -> usize {
    let widths = ascii_rows::layout(header);
    let row: usize = widths.iter().sum::<usize>() + 1;
    (header.n_points * series_header::numbers_per_point(header)).div_ceil(widths.len()) * row
}

/// Passes the numbers of `series` to `put`, in the order of the format.
fn each_number(
    series: &Series,
    mut put: impl FnMut(f64) -> Result<(), LabioError>,
) -> Result<(), LabioError> {
    let abscissa: &[f64] = match &series.abscissa {
        Abscissa::Even { .. } => &[],
        Abscissa::Uneven(values) => values,
    };
    let mut abscissa = abscissa.iter();
    match &series.ordinate {
        Ordinate::Real(values) => {
            for &value in values {
                abscissa.next().map_or(Ok(()), |&x| put(x))?;
                put(value)?;
            }
        }
        Ordinate::Complex(values) => {
            for value in values {
                abscissa.next().map_or(Ok(()), |&x| put(x))?;
                put(value.re)?;
                put(value.im)?;
            }
        }
    }
    Ok(())
}

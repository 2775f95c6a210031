//! Records 1 to 11 of a data set 58, and the fields of its identifier line that make it a 58b.

use std::fmt;

use super::fortran_real;
use super::lines::{Line, Lines, decode};
use super::{ByteOrder, FORMAT};
use crate::error;
use crate::error::not_representable;
use crate::{LabioError, Place};

/// Number of records before the data.
pub(super) const N_RECORDS: usize = 11;

/// Information in the identifier line of a 58b about the bytes that follow its header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct BinaryForm {
    pub(super) byte_order: ByteOrder,
    /// Number of bytes of data, as stated.
    pub(super) n_bytes: u64,
}

/// A degree of freedom: entity, node and direction.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct DegreeOfFreedom {
    pub(super) entity: String,
    pub(super) node: i64,
    pub(super) direction: i64,
}

/// Record 8, 9, 10 or 11.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct AxisRecord {
    pub(super) data_type: i64,
    /// Exponents of length, force and temperature.
    pub(super) exponents: [i64; 3],
    pub(super) label: String,
    pub(super) unit: String,
}

/// The header of one data set.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Header {
    pub(super) id_lines: [String; 5],
    pub(super) function_type: u8,
    pub(super) function_id: i64,
    pub(super) version: i64,
    pub(super) load_case: i64,
    pub(super) response: DegreeOfFreedom,
    pub(super) reference: DegreeOfFreedom,
    pub(super) double: bool,
    pub(super) complex: bool,
    pub(super) n_points: usize,
    pub(super) even: bool,
    pub(super) start: f64,
    pub(super) step: f64,
    /// Half a unit of the last digit of the step as written; 0 if the step was not read from a
    /// file.
    pub(super) step_half_unit: f64,
    pub(super) z_value: f64,
    /// Abscissa, ordinate, denominator of the ordinate, z axis.
    pub(super) axes: [AxisRecord; 4],
}

/// Names of the four axes, for messages and properties.
pub(super) const AXES: [&str; 4] = ["abscissa", "ordinate", "denominator", "z"];

/// Creates an error at a field of a data set 58.
pub(super) fn malformed(
    place: Place,
    field: impl Into<String>,
    found: impl Into<String>,
    expected: impl Into<String>,
) -> LabioError {
    error::malformed(FORMAT, place, field, shortened(found.into()), expected)
}

fn shortened(text: String) -> String {
    const LONGEST: usize = 40;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", text.get(..end).unwrap_or_default()),
        None => text,
    }
}

/// The fixed columns of one record.
pub(super) struct Columns<'a> {
    record: usize,
    place: Place,
    text: &'a str,
}

impl<'a> Columns<'a> {
    /// Returns the columns of `text`, the line of a record at `place`.
    pub(super) fn of(record: usize, place: Place, text: &'a str) -> Self {
        Self {
            record,
            place,
            text,
        }
    }

    /// Returns characters `first` to `first + width`, without the blanks around them; columns
    /// beyond the end of the line count as blank.
    pub(super) fn text(&self, first: usize, width: usize) -> &str {
        let mut starts = self.text.char_indices().map(|(byte, _)| byte).skip(first);
        let Some(from) = starts.next() else {
            return "";
        };
        let field = match starts.nth(width - 1) {
            Some(to) => self.text.get(from..to),
            None => self.text.get(from..),
        };
        field.unwrap_or_default().trim()
    }

    /// Returns a name or label; `NONE` is the format's word for an empty one.
    fn name(&self, first: usize, width: usize) -> String {
        named(self.text(first, width))
    }

    /// Returns an integer; blank columns are 0, as in Fortran.
    pub(super) fn integer(
        &self,
        first: usize,
        width: usize,
        field: &str,
    ) -> Result<i64, LabioError> {
        let text = self.text(first, width);
        if text.is_empty() {
            return Ok(0);
        }
        text.parse()
            .map_err(|_| self.refused(field, text, "an integer"))
    }

    /// Returns a real number; blank columns are 0, as in Fortran.
    pub(super) fn real(&self, first: usize, width: usize, field: &str) -> Result<f64, LabioError> {
        let text = self.text(first, width);
        if text.is_empty() {
            return Ok(0.0);
        }
        fortran_real::parse(text.as_bytes())
            .filter(|value| value.is_finite())
            .ok_or_else(|| self.refused(field, text, "a finite number"))
    }

    fn refused(&self, field: &str, found: impl fmt::Display, expected: &str) -> LabioError {
        malformed(
            self.place,
            format!("record {}, {field}", self.record),
            format!("`{found}`"),
            expected,
        )
    }
}

fn named(text: &str) -> String {
    let text = text.trim();
    if text.eq_ignore_ascii_case("none") {
        String::new()
    } else {
        text.to_owned()
    }
}

/// Reads the identifier line after its `58b`.
pub(super) fn binary_form(line: Line<'_>) -> Result<BinaryForm, LabioError> {
    let text = decode(line.bytes);
    let columns = Columns {
        record: 0,
        place: line.place,
        text: &text,
    };
    let refused = |field: &str, found: i64, expected: &str| {
        malformed(
            line.place,
            format!("identifier line, {field}"),
            found.to_string(),
            expected,
        )
    };
    let byte_order = match columns.integer(7, 6, "byte order")? {
        1 => ByteOrder::LittleEndian,
        2 => ByteOrder::BigEndian,
        other => {
            let expected = "1 (little-endian) or 2 (big-endian)";
            return Err(refused("byte order", other, expected));
        }
    };
    let format = columns.integer(13, 6, "floating-point format")?;
    if format != 2 {
        let expected = "2 (IEEE 754), the only supported format";
        return Err(refused("floating-point format", format, expected));
    }
    let n_bytes = columns.integer(31, 12, "number of bytes")?;
    let n_bytes =
        u64::try_from(n_bytes).map_err(|_| refused("number of bytes", n_bytes, "0 or more"))?;
    Ok(BinaryForm {
        byte_order,
        n_bytes,
    })
}

impl Header {
    /// Reads the eleven records from `lines`.
    pub(super) fn read(lines: &mut Lines<'_>) -> Result<Self, LabioError> {
        let mut records: [Line<'_>; N_RECORDS] = [Line {
            bytes: b"",
            place: Place::Line(0),
        }; N_RECORDS];
        for (index, record) in records.iter_mut().enumerate() {
            let place = lines.place();
            *record = lines.next_line().ok_or_else(|| {
                malformed(
                    place,
                    format!("record {}", index + 1),
                    "the end of the file",
                    "a line",
                )
            })?;
        }
        let texts = records.map(|line| decode(line.bytes));
        let record = |number: usize| Columns {
            record: number,
            place: records
                .get(number - 1)
                .map_or(Place::Line(0), |line| line.place),
            text: texts.get(number - 1).map_or("", |text| text.as_ref()),
        };

        let dof = record(6);
        let function_type = dof.integer(0, 5, "field 1 (function type)")?;
        let function_type = u8::try_from(function_type)
            .map_err(|_| dof.refused("field 1 (function type)", function_type, "0 to 255"))?;
        let degree_of_freedom = |first: usize, what: &str| -> Result<DegreeOfFreedom, LabioError> {
            Ok(DegreeOfFreedom {
                entity: dof.name(first, 10),
                node: dof.integer(first + 10, 10, &format!("{what} node"))?,
                direction: dof.integer(first + 20, 4, &format!("{what} direction"))?,
            })
        };
        let response = degree_of_freedom(31, "response")?;
        let reference = degree_of_freedom(56, "reference")?;

        let form = record(7);
        let (double, complex) = match form.integer(0, 10, "field 1 (ordinate data type)")? {
            2 => (false, false),
            4 => (true, false),
            5 => (false, true),
            6 => (true, true),
            other => {
                let expected = "2, 4 (real, single or double) or 5, 6 (complex)";
                return Err(form.refused("field 1 (ordinate data type)", other, expected));
            }
        };
        let n_points = form.integer(10, 10, "field 2 (number of values)")?;
        let n_points = usize::try_from(n_points)
            .map_err(|_| form.refused("field 2 (number of values)", n_points, "0 or more"))?;
        let even = match form.integer(20, 10, "field 3 (abscissa spacing)")? {
            0 => false,
            1 => true,
            other => {
                let expected = "0 (uneven) or 1 (even)";
                return Err(form.refused("field 3 (abscissa spacing)", other, expected));
            }
        };
        let axis = |number: usize| -> Result<AxisRecord, LabioError> {
            let columns = record(number);
            Ok(AxisRecord {
                data_type: columns.integer(0, 10, "field 1 (specific data type)")?,
                exponents: [
                    columns.integer(10, 5, "field 2 (length exponent)")?,
                    columns.integer(15, 5, "field 3 (force exponent)")?,
                    columns.integer(20, 5, "field 4 (temperature exponent)")?,
                ],
                label: columns.name(26, 20),
                unit: columns.name(47, 20),
            })
        };
        Ok(Self {
            id_lines: [1, 2, 3, 4, 5].map(|number| named(record(number).text)),
            function_type,
            function_id: dof.integer(5, 10, "field 2 (function identification)")?,
            version: dof.integer(15, 5, "field 3 (version)")?,
            load_case: dof.integer(20, 10, "field 4 (load case)")?,
            response,
            reference,
            double,
            complex,
            n_points,
            even,
            start: form.real(30, 13, "field 4 (abscissa minimum)")?,
            step: form.real(43, 13, "field 5 (abscissa increment)")?,
            step_half_unit: fortran_real::half_unit(form.text(43, 13).as_bytes()).unwrap_or(0.0),
            z_value: form.real(56, 13, "field 6 (z-axis value)")?,
            axes: [axis(8)?, axis(9)?, axis(10)?, axis(11)?],
        })
    }

    /// Appends the identifier line and the eleven records.
    pub(super) fn write(
        &self,
        binary: Option<BinaryForm>,
        output: &mut String,
    ) -> Result<(), LabioError> {
        match binary {
            None => output.push_str("    58\n"),
            Some(form) => {
                let order = match form.byte_order {
                    ByteOrder::LittleEndian => 1,
                    ByteOrder::BigEndian => 2,
                };
                let n_bytes = integer(form.n_bytes, 12, "number of bytes")?;
                output.push_str(&format!(
                    "    58b{order:6}{:6}{N_RECORDS:12}{n_bytes}{:6}{:6}{:12}{:12}\n",
                    2, 0, 0, 0, 0
                ));
            }
        }
        for (number, line) in (1..).zip(&self.id_lines) {
            output.push_str(&text(line, 80, &format!("ID line {number}"))?);
            output.push('\n');
        }
        let dof = |dof: &DegreeOfFreedom, what: &str| -> Result<String, LabioError> {
            let node = integer(dof.node, 10, &format!("{what} node"))?;
            let direction = integer(dof.direction, 4, &format!("{what} direction"))?;
            let entity = text(&dof.entity, 10, &format!("{what} entity name"))?;
            Ok(format!(" {entity}{node}{direction}"))
        };
        output.push_str(&format!(
            "{:5}{}{}{}{}{}\n",
            self.function_type,
            integer(self.function_id, 10, "function identification")?,
            integer(self.version, 5, "version")?,
            integer(self.load_case, 10, "load case")?,
            dof(&self.response, "response")?,
            dof(&self.reference, "reference")?,
        ));
        let data_type = match (self.double, self.complex) {
            (false, false) => 2,
            (true, false) => 4,
            (false, true) => 5,
            (true, true) => 6,
        };
        output.push_str(&format!(
            "{data_type:10}{}{:10}{}{}{}\n",
            integer(self.n_points, 10, "number of values")?,
            u8::from(self.even),
            real(self.start, 0.0, "abscissa minimum")?,
            real(self.step, self.step_half_unit, "abscissa increment")?,
            real(self.z_value, 0.0, "z-axis value")?,
        ));
        for (axis, name) in self.axes.iter().zip(AXES) {
            output.push_str(&integer(axis.data_type, 10, &format!("{name} data type"))?);
            for exponent in axis.exponents {
                let what = format!("{name} unit exponent");
                output.push_str(&integer(exponent, 5, &what)?);
            }
            let label = text(&axis.label, 20, &format!("{name} label"))?;
            let unit = text(&axis.unit, 20, &format!("{name} unit"))?;
            output.push_str(&format!(" {label} {unit}\n"));
        }
        Ok(())
    }
}

fn cannot(what: String) -> LabioError {
    not_representable(FORMAT, what)
}

/// Formats `value` right-aligned.
fn integer(value: impl fmt::Display, width: usize, what: &str) -> Result<String, LabioError> {
    let value = value.to_string();
    if value.len() > width {
        return Err(cannot(format!("{what} {value} in {width} columns")));
    }
    Ok(format!("{value:>width$}"))
}

/// Formats `value` in 13 columns; the first column stays blank so that fields do not touch.
fn real(value: f64, half_unit: f64, what: &str) -> Result<String, LabioError> {
    let text = fortran_real::compact(value, half_unit, 12)
        .ok_or_else(|| cannot(format!("{what} {value}")))?;
    Ok(format!("{text:>13}"))
}

/// Formats `value` left-aligned; an empty text becomes `NONE`.
fn text(value: &str, width: usize, what: &str) -> Result<String, LabioError> {
    let value = value.trim();
    if value.chars().any(char::is_control) {
        return Err(cannot(format!(
            "{what} `{}`, which has control characters",
            value.escape_debug()
        )));
    }
    let value = if value.is_empty() { "NONE" } else { value };
    let found = value.chars().count();
    if found > width {
        return Err(cannot(format!(
            "{what} `{value}` of {found} characters in {width} columns"
        )));
    }
    Ok(format!("{value:<width$}"))
}

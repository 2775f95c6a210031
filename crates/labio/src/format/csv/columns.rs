//! Tables whose rows are not in the order of an abscissa.

use super::{CsvAbscissa, CsvOptions, abscissa, header, opened, table};
use crate::format::Strictness;
use crate::format::text;
use crate::{LabioError, Ordinate, Unit};

/// Columns of a text table as written, without an abscissa: for example frequencies that repeat for
/// each temperature.
#[derive(Debug)]
#[non_exhaustive]
pub struct Columns {
    /// Encoding of the text, such as `UTF-8`.
    pub encoding: &'static str,
    /// Columns from left to right.
    pub columns: Vec<TableColumn>,
    /// Line of each row, from 1.
    pub lines: Vec<u64>,
    /// Header lines that are neither names nor units, as keys and values.
    pub properties: Vec<(String, String)>,
    /// Parts that a tolerant reading has left out.
    pub defects: Vec<LabioError>,
}

/// Column of a table.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct TableColumn {
    /// Name, empty if the table has none.
    pub name: String,
    /// Unit as written, empty if there is none.
    pub unit_text: String,
    /// Unit, if `unit_text` is a known one.
    pub unit: Option<Unit>,
    /// Values in the unit of the file, one for each row up to the end of the column; NaN where a
    /// tolerant reading found no number.
    pub values: Ordinate,
}

impl Columns {
    /// Returns the number of rows.
    #[must_use]
    pub fn n_rows(&self) -> usize {
        self.lines.len()
    }
}

/// Reads a text table as columns: dialect, names, units and numbers are found as by
/// [`read_with`](super::read_with), and the same faults are rejected, but no column is used as the
/// abscissa.
///
/// # Errors
///
/// The errors of [`read_with`](super::read_with), except those that concern an abscissa.
///
/// # Examples
///
/// ```
/// use labio::format::Strictness;
/// use labio::format::csv::{CsvOptions, read_columns};
///
/// let file = b"f,E\nHz,MPa\n1,900\n10,950\n1,700\n10,800\n";
/// let table = read_columns(file, Strictness::Strict, &CsvOptions::default())?;
/// assert_eq!(table.columns[0].name, "f");
/// assert_eq!(table.columns[1].unit_text, "MPa");
/// assert_eq!(table.lines, [3, 4, 5, 6]);
/// # Ok::<(), labio::LabioError>(())
/// ```
pub fn read_columns(
    bytes: &[u8],
    strictness: Strictness,
    options: &CsvOptions,
) -> Result<Columns, LabioError> {
    let (text, encoding, dialect) = opened(bytes, options)?;
    let shape = table::Shape::of(&text, &dialect)?;
    let header = header::Header::read(&text, &dialect, &shape)?;
    let choice = abscissa::Choice::of(&header, CsvAbscissa::Index, shape.columns.len())?;
    let mut defects = Vec::new();
    let table = table::read(
        &text,
        &dialect,
        &shape,
        choice.column,
        strictness,
        &mut defects,
        true,
    )?;
    let of_column = |(at, values): (usize, Ordinate)| {
        let (label, unit_text) = header.columns.get(at).cloned().unwrap_or_default();
        let axis = text::axis(label, unit_text);
        TableColumn {
            name: axis.label,
            unit_text: axis.unit_text,
            unit: axis.unit,
            values,
        }
    };
    Ok(Columns {
        encoding: encoding.name(),
        columns: table
            .columns
            .into_iter()
            .enumerate()
            .map(of_column)
            .collect(),
        lines: table.lines,
        properties: header.properties,
        defects,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strict(text: &str) -> Result<Columns, LabioError> {
        read_columns(text.as_bytes(), Strictness::Strict, &CsvOptions::default())
    }

    #[test]
    fn rows_in_no_order_are_columns_with_their_lines() {
        let text = "f,E,T,Set\nHz, MPa, C, -\n0.1,8097.175545,-49.9612,0\n\n100,9228.5,-49.9912,0\n0.1,8438.976092,-42.4885,1\n";
        let table = strict(text).unwrap();
        let names: Vec<(&str, &str)> = table
            .columns
            .iter()
            .map(|column| (column.name.as_str(), column.unit_text.as_str()))
            .collect();
        assert_eq!(names, [("f", "Hz"), ("E", "MPa"), ("T", "C"), ("Set", "-")]);
        assert_eq!(table.lines, [3, 5, 6]);
        assert_eq!(table.n_rows(), 3);
        let Ordinate::Real(modulus) = &table.columns[1].values else {
            unreachable!("{table:?}")
        };
        assert_eq!(modulus, &[8097.175545, 9228.5, 8438.976092]);
    }

    #[test]
    fn a_row_that_is_none_is_rejected_or_said_with_its_line() {
        let text = b"Index f\n[#] [Hz]\n0 1e-1\n1 1e0\n]22[x\n".as_slice();
        let options = CsvOptions::default();
        let error = read_columns(text, Strictness::Strict, &options).unwrap_err();
        assert!(
            error.to_string().starts_with("csv, line 5: row is `]22[x`"),
            "{error}"
        );
        let table = read_columns(text, Strictness::Tolerant, &options).unwrap();
        assert_eq!((table.n_rows(), table.defects.len()), (2, 1));
    }
}

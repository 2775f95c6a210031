//! Printed table with its strings, units and errata, and its conversion to SI.
#![expect(
    dead_code,
    reason = "some fields are for the reader of the file; here they must only be there"
)]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::decimal::Decimal;
use super::error::FixtureError;
use super::si_table::{SiRow, SiTable, SiValue};
use super::unit::Unit;
use crate::ron_text::parse_ron;

/// Table, or group of constants, transcribed by hand from a paper. Numbers are texts, with their
/// digits as printed.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PrintedTable {
    /// Key of the work in literature.bib.
    key: String,
    /// Letter of the paper, or `survey`.
    paper: String,
    /// Name of the table in print, or `constants`.
    table: String,
    /// Sections in which it is printed.
    section: String,
    /// Lines of the text edition from which it was transcribed.
    lines: String,
    /// Title of the table.
    title: String,
    /// Note for readers of the table.
    #[serde(default)]
    note: Option<String>,
    columns: Vec<Column>,
    rows: Vec<Vec<String>>,
    /// Tolerances that differ from half a unit of the last printed digit.
    #[serde(default)]
    allowances: Vec<Allowance>,
    /// Errors in the print.
    #[serde(default)]
    errata: Vec<Erratum>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Column {
    name: String,
    /// Printed symbol of the column, if it differs from the name.
    #[serde(default)]
    symbol: Option<String>,
    holds: Holds,
}

/// Content of the cells of a column.
#[derive(Debug, Clone, Deserialize)]
enum Holds {
    /// Name of the row; several columns of this kind form the name together.
    Label,
    /// Words.
    Text,
    /// Numbers in this unit; `—` for an empty cell.
    Values(String),
    /// Numbers with their unit, as in `2.580 GPa`; a pure number has no unit.
    ValuesWithUnits,
}

/// Tolerance of one cell, with its reason.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Allowance {
    row: String,
    column: String,
    /// Number with the unit of the cell, or with another unit of the same kind.
    absolute: String,
    reason: String,
}

/// Printed value, correct value, and the reason for the correction.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Erratum {
    printed: String,
    right: String,
    evidence: String,
    /// Cell whose printed value must not be used, if any.
    #[serde(default)]
    corrects: Option<Correction>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Correction {
    row: String,
    column: String,
    /// Correct number with its unit.
    value: String,
}

/// Reads a RON file. Errors of the schema are reported with line, column and the text at that
/// place.
pub fn read_ron<T: DeserializeOwned>(path: &Path) -> Result<T, FixtureError> {
    let text = fs::read_to_string(path).map_err(|source| FixtureError::Io {
        path: path.to_path_buf(),
        source,
    })?;
    Ok(parse_ron(path, &text)?)
}

impl PrintedTable {
    /// Reads the table at `path`, in SI.
    pub fn read(path: &Path) -> Result<SiTable, FixtureError> {
        read_ron::<Self>(path)?.to_si(path)
    }

    fn to_si(&self, path: &Path) -> Result<SiTable, FixtureError> {
        self.check_column_names(path)?;
        let mut rows: Vec<SiRow> = Vec::with_capacity(self.rows.len());
        for cells in &self.rows {
            let row = self.row_to_si(path, cells)?;
            if rows.iter().any(|other| other.label == row.label) {
                return Err(duplicate(path, "row", &row.label));
            }
            rows.push(row);
        }
        let mut table = SiTable {
            source: path.to_path_buf(),
            key: self.key.clone(),
            paper: self.paper.clone(),
            table: self.table.clone(),
            title: self.title.clone(),
            lines: self.lines.clone(),
            errata: self.errata.len(),
            rows,
        };
        for correction in self
            .errata
            .iter()
            .filter_map(|erratum| erratum.corrects.as_ref())
        {
            let right = read_value(
                path,
                &correction.row,
                &correction.column,
                &correction.value,
                None,
            )?;
            table
                .value_mut(&correction.row, &correction.column)?
                .correct(right);
        }
        for allowance in &self.allowances {
            let tolerance = read_value(
                path,
                &allowance.row,
                &allowance.column,
                &allowance.absolute,
                None,
            )?;
            let value = table.value_mut(&allowance.row, &allowance.column)?;
            if value.unit != tolerance.unit {
                return Err(cell(
                    path,
                    &allowance.row,
                    &allowance.column,
                    &allowance.absolute,
                    "the unit of the cell",
                ));
            }
            value.tolerance = tolerance.value;
        }
        Ok(table)
    }

    fn check_column_names(&self, path: &Path) -> Result<(), FixtureError> {
        for (index, column) in self.columns.iter().enumerate() {
            if self
                .columns
                .iter()
                .skip(index + 1)
                .any(|other| other.name == column.name)
            {
                return Err(duplicate(path, "column", &column.name));
            }
        }
        Ok(())
    }

    fn row_to_si(&self, path: &Path, cells: &[String]) -> Result<SiRow, FixtureError> {
        let labels: Vec<&str> = self
            .columns
            .iter()
            .zip(cells)
            .filter(|(column, _)| matches!(column.holds, Holds::Label))
            .map(|(_, cell)| cell.as_str())
            .collect();
        let label = labels.join(" / ");
        if cells.len() != self.columns.len() {
            return Err(FixtureError::RowWidth {
                path: path.to_path_buf(),
                row: label,
                found: cells.len(),
                expected: self.columns.len(),
            });
        }
        let mut text = BTreeMap::new();
        let mut values = BTreeMap::new();
        for (column, cell) in self.columns.iter().zip(cells) {
            let name = &column.name;
            match &column.holds {
                Holds::Label | Holds::Text => {
                    text.insert(name.clone(), cell.clone());
                }
                Holds::Values(_) if cell == "—" => {}
                Holds::Values(unit) => {
                    values.insert(
                        name.clone(),
                        read_value(path, &label, name, cell, Some(unit))?,
                    );
                }
                Holds::ValuesWithUnits => {
                    values.insert(name.clone(), read_value(path, &label, name, cell, None)?);
                }
            }
        }
        Ok(SiRow {
            label,
            text,
            values,
        })
    }
}

/// Converts the printed cell `found` to SI. The unit is `column_unit` or, if that is `None`, the
/// text after the digits in the cell.
pub fn read_value(
    path: &Path,
    row: &str,
    column: &str,
    found: &str,
    column_unit: Option<&str>,
) -> Result<SiValue, FixtureError> {
    let wrong = |expected| cell(path, row, column, found, expected);
    let (digits, unit_name) = match column_unit {
        Some(unit) => (found, unit),
        None => found.split_once(' ').unwrap_or((found, "1")),
    };
    let unit = Unit::named(unit_name).ok_or_else(|| {
        cell(
            path,
            row,
            column,
            unit_name,
            "a unit of the list in crates/testbed/src/papers/unit.rs",
        )
    })?;
    let number =
        Decimal::parse(digits).ok_or_else(|| wrong("printed digits such as 2.580 or 4.55e-21"))?;
    let too_long = || wrong("a number whose SI value has at most 38 digits");
    Ok(SiValue {
        printed: match unit_name {
            "1" => digits.to_owned(),
            _ => format!("{digits} {unit_name}"),
        },
        corrected: None,
        unit: unit.si,
        value: unit.to_si(number).ok_or_else(too_long)?,
        tolerance: unit.tolerance(number).ok_or_else(too_long)?,
    })
}

fn cell(path: &Path, row: &str, column: &str, found: &str, expected: &'static str) -> FixtureError {
    FixtureError::Cell {
        path: path.to_path_buf(),
        row: row.to_owned(),
        column: column.to_owned(),
        found: found.to_owned(),
        expected,
    }
}

fn duplicate(path: &Path, what: &'static str, name: &str) -> FixtureError {
    FixtureError::Duplicate {
        path: path.to_path_buf(),
        what,
        name: name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = r#"#![enable(implicit_some)]
(
    key: "odeen1993",
    paper: "A",
    table: "Table 0",
    section: "1",
    lines: "1",
    title: "Two rods",
    columns: [
        (name: "test", holds: Label),
        (name: "length", symbol: "L", holds: Values("mm")),
        (name: "modulus", holds: ValuesWithUnits),
    ],
    rows: [
        ["1", "199", "2.580 GPa"],
        ["2", "—", "28 ms"],
    ],
    allowances: [
        (row: "1", column: "length", absolute: "2 mm", reason: "a rule of wood"),
    ],
    errata: [
        (printed: "28 ms", right: "28 us", evidence: "arithmetic", corrects: (row: "2", column: "modulus", value: "28 us")),
    ],
)
"#;

    fn read(text: &str) -> Result<SiTable, FixtureError> {
        let path = Path::new("table.ron");
        parse_ron::<PrintedTable>(path, text)?.to_si(path)
    }

    /// Returns the error message for [`TABLE`] with `piece` replaced by `by`.
    fn message(piece: &str, by: &str) -> String {
        assert_eq!(TABLE.matches(piece).count(), 1, "{piece}");
        read(&TABLE.replace(piece, by)).unwrap_err().to_string()
    }

    #[test]
    fn messages_say_where_and_what() {
        assert_eq!(
            message("\"199\", \"2.580 GPa\"", "\"199\""),
            "table.ron, row 1: 2 cells, expected 3"
        );
        assert_eq!(
            message("\"199\"", "\"19O\""),
            "table.ron, row 1, column length: found `19O`, expected printed digits such as 2.580 or 4.55e-21"
        );
        assert_eq!(
            message("GPa", "Gpa"),
            "table.ron, row 1, column modulus: found `Gpa`, expected a unit of the list in crates/testbed/src/papers/unit.rs"
        );
        assert_eq!(
            message("[\"2\", ", "[\"1\", "),
            "table.ron: row `1` occurs twice"
        );
        assert_eq!(
            message("name: \"modulus\"", "name: \"length\""),
            "table.ron: column `length` occurs twice"
        );
        assert_eq!(
            message("absolute: \"2 mm\"", "absolute: \"2 ms\""),
            "table.ron, row 1, column length: found `2 ms`, expected the unit of the cell"
        );
        assert_eq!(
            message("corrects: (row: \"2\"", "corrects: (row: \"3\""),
            "table.ron: no value in row `3`, column `modulus`"
        );
    }

    #[test]
    fn syntax_errors_give_line_column_and_field() {
        let text = message("title: \"Two rods\"", "title: 2");
        assert!(text.starts_with("table.ron, line 8, column "), "{text}");
        assert!(text.ends_with("in `title: 2,`"), "{text}");
        let text = message("lines: \"1\"", "line: \"1\"");
        assert!(text.starts_with("table.ron, line 7, column "), "{text}");
        assert!(text.contains("`line`"), "{text}");
    }
}

//! Tables in the form used for CSV, JSON and Python.

use std::fmt::Write;

use serde::{Serialize, Serializer};

use super::column_name::{name_of, unit_without_prefix};
use super::{Cells, Column, Table};

/// A column for other programs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PublishedColumn<'a> {
    /// Name with its unit, such as `storage_modulus_pa`; different from the names of the other
    /// columns of the table.
    pub name: String,
    /// Name in reports and figures, such as `E'`.
    pub words: &'a str,
    /// Unit, without a prefix; empty for pure numbers and words.
    pub unit: &'a str,
    /// Contents.
    pub cells: PublishedCells<'a>,
}

/// The cells of a [`PublishedColumn`].
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum PublishedCells<'a> {
    /// Numbers; NaN for a missing number (empty in CSV, null in JSON).
    Numbers(Vec<f64>),
    /// Words.
    Words(&'a [String]),
    /// Truth values.
    Flags(&'a [bool]),
}

impl PublishedCells<'_> {
    /// Appends the cell of `row` to `text`; appends nothing if there is no such cell.
    pub(crate) fn write_to(&self, text: &mut String, row: usize) {
        // writing to a string does not fail
        let _ = match self {
            Self::Numbers(values) => match values.get(row).filter(|value| value.is_finite()) {
                Some(value) => write!(text, "{value}"),
                None => Ok(()),
            },
            Self::Words(words) => text.write_str(words.get(row).map_or("", String::as_str)),
            Self::Flags(flags) => match flags.get(row) {
                Some(flag) => write!(text, "{flag}"),
                None => Ok(()),
            },
        };
    }
}

impl Table {
    /// Returns the columns for other programs. A column of verdicts becomes two columns, `valid`
    /// and `reasons`.
    #[must_use]
    pub fn published(&self) -> Vec<PublishedColumn<'_>> {
        let mut columns: Vec<PublishedColumn<'_>> = Vec::with_capacity(self.columns.len() + 1);
        for column in &self.columns {
            for mut column in published(column) {
                let same = |name: &str| columns.iter().any(|other| other.name == name);
                if same(&column.name) {
                    let numbered = (2..).map(|number| format!("{}_{number}", column.name));
                    column.name = numbered
                        .into_iter()
                        .find(|name| !same(name))
                        .unwrap_or_default();
                }
                columns.push(column);
            }
        }
        columns
    }
}

fn published(column: &Column) -> Vec<PublishedColumn<'_>> {
    let (unit, factor) = unit_without_prefix(&column.unit);
    let one = |name: String, cells| PublishedColumn {
        name,
        words: &column.name,
        unit,
        cells,
    };
    match &column.cells {
        Cells::Numbers(values) => {
            let values = values.iter().map(|value| factor * value).collect();
            vec![one(
                name_of(&column.name, unit),
                PublishedCells::Numbers(values),
            )]
        }
        Cells::Words(words) => vec![one(
            name_of(&column.name, unit),
            PublishedCells::Words(words),
        )],
        Cells::Validity { valid, words, .. } => vec![
            one("valid".to_owned(), PublishedCells::Flags(valid)),
            one("reasons".to_owned(), PublishedCells::Words(words)),
        ],
    }
}

impl Serialize for Table {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Published<'a> {
            name: &'a str,
            title: &'a str,
            columns: Vec<PublishedColumn<'a>>,
        }
        let published = Published {
            name: &self.name,
            title: &self.title,
            columns: self.published(),
        };
        published.serialize(serializer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_for_programs_has_plain_units_and_answers() {
        let verdicts = vec!["valid".to_owned(), "too short waves".to_owned()];
        let table = Table::new("modulus", "")
            .numbers("E'", "GPa", [2.5, f64::NAN])
            .numbers("end A", "m", [1.0, 2.0])
            .numbers("end-a", "m", [3.0, 4.0])
            .with(Column::validity(vec![true, false], verdicts));
        let columns = table.published();
        let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(
            names,
            [
                "storage_modulus_pa",
                "end_a_m",
                "end_a_m_2",
                "valid",
                "reasons"
            ]
        );
        let row = |row| {
            columns
                .iter()
                .map(|column| {
                    let mut text = String::new();
                    column.cells.write_to(&mut text, row);
                    text
                })
                .collect::<Vec<_>>()
        };
        assert_eq!(row(0), ["2500000000", "1", "3", "true", "valid"]);
        assert_eq!(row(1), ["", "2", "4", "false", "too short waves"]);
        let json = serde_json::to_value(&table).unwrap();
        assert_eq!(json["columns"][0]["cells"][1], serde_json::Value::Null);
        assert_eq!(json["columns"][0]["words"], "E'");
        assert_eq!(json["columns"][3]["cells"][0], true);
    }
}

//! Names, units and properties above a table.

use std::borrow::Cow;
use std::collections::HashMap;

use super::abscissa_name::{Marker, is_time};
use super::header_lines::{above, cells_beside, cells_of, without_comment};
use super::settings::{Settings, seconds};
use super::table::Shape;
use super::unit_in_name::{split_together, split_unit, without_brackets};
use super::{CsvDialect, CsvSeparator, malformed};
use crate::format::text;
use crate::{LabioError, Place};

/// Contents of the header.
#[derive(Debug, Default)]
pub(super) struct Header {
    /// One name and unit for each column, or none at all.
    pub(super) columns: Vec<(String, String)>,
    pub(super) properties: Vec<(String, String)>,
    /// The text, from a line of our writer, that describes the abscissa.
    pub(super) abscissa: Option<String>,
    /// Keys and values for each column, counted from 1, as written by our writer.
    pub(super) of_columns: HashMap<usize, Vec<(String, String)>>,
    pub(super) settings: Settings,
}

impl Header {
    pub(super) fn read(
        text: &str,
        dialect: &CsvDialect,
        shape: &Shape,
    ) -> Result<Self, LabioError> {
        let mut header = Self::default();
        let (mut names, mut units) = (None, None);
        let all = shape.n_cells;
        for (number, line) in above(text, dialect).filter(|(_, line)| !line.trim().is_empty()) {
            let table: &[usize] = match number >= shape.first_line {
                true => &shape.columns,
                false => &[],
            };
            let beside = cells_beside(line, dialect.separator, table);
            let is_read = header.settings.read(&beside);
            let field = if dialect.name_line == Some(number) {
                &mut names
            } else if dialect.unit_line == Some(number) {
                &mut units
            } else {
                let is_empty = !table.is_empty() && beside.iter().all(|cell| cell.is_empty());
                if !is_read && !is_empty {
                    header.property(number, line, dialect.separator, &beside);
                }
                continue;
            };
            let cells = cells_of(line, dialect.separator, all).ok_or_else(|| {
                malformed(
                    Place::Line(number),
                    "row of names or units",
                    &text::quoted(line),
                    &format!("{all} cells, as in the rows of numbers"),
                )
            })?;
            *field = Some(cells);
        }
        for (line, found) in [(dialect.name_line, &names), (dialect.unit_line, &units)] {
            if let (Some(line), None) = (line, found) {
                return Err(malformed(
                    Place::Line(line),
                    "row of names or units",
                    "not in the header",
                    &format!("one of its {} lines", dialect.header_lines),
                ));
            }
        }
        if names.is_none() && units.is_none() {
            let stated = header.settings.columns(shape.columns.len());
            header.columns = stated.unwrap_or_default();
            header.split_units();
        } else {
            let cell = |cells: &Option<Vec<Cow<'_, str>>>, at: usize| {
                cells
                    .as_ref()
                    .and_then(|cells| cells.get(at))
                    .map_or_else(String::new, |cell| cell.clone().into_owned())
            };
            let columns = shape.columns.iter();
            header.columns = columns
                .map(|&at| (cell(&names, at), cell(&units, at)))
                .collect();
            header.split_units();
            for (_, unit) in &mut header.columns {
                *unit = without_brackets(unit).to_owned();
            }
        }
        if units.is_none() {
            header.settings.complete(&mut header.columns);
        }
        Ok(header)
    }

    /// Splits names that have a unit in the same cell, for columns without a unit in another cell.
    fn split_units(&mut self) {
        if let Some(columns) = split_together(&self.columns) {
            self.columns = columns;
            return;
        }
        for (name, unit) in &mut self.columns {
            if unit.is_empty() {
                (*name, *unit) = split_unit(name);
            }
            if is_time(name, "") {
                *unit = match name.to_ascii_lowercase().as_str() {
                    "second" | "seconds" if unit.is_empty() => "s".to_owned(),
                    _ => seconds(unit).to_owned(),
                };
            }
        }
    }

    /// Stores a line that is neither names nor units, and its `cells`.
    fn property(
        &mut self,
        number: u64,
        line: &str,
        separator: CsvSeparator,
        cells: &[Cow<'_, str>],
    ) {
        let bare = without_comment(line);
        let comment = bare.len() < line.trim().len();
        if let Some((key, value)) = key_and_value(bare) {
            if key == "abscissa" && comment && Marker::parse(value).is_some() {
                self.abscissa = Some(value.to_owned());
                return;
            }
            if let Some((column, key)) = key
                .strip_prefix("column ")
                .and_then(|rest| rest.split_once(": "))
                && let Ok(column) = column.parse()
            {
                let said = (key.to_owned(), value.to_owned());
                self.of_columns.entry(column).or_default().push(said);
                return;
            }
            self.settings
                .read(&[Cow::Borrowed(key), Cow::Borrowed(value)]);
            self.properties.push((key.to_owned(), value.to_owned()));
            return;
        }
        match cells.split_first() {
            Some((key, rest))
                if separator != CsvSeparator::Blanks && !rest.is_empty() && !key.is_empty() =>
            {
                let rest: Vec<&str> = rest.iter().map(AsRef::as_ref).collect();
                let value = rest.join(" ").trim().to_owned();
                self.properties.push((key.clone().into_owned(), value));
            }
            _ => {
                let key = format!("header line {number}");
                self.properties.push((key, bare.to_owned()));
            }
        }
    }
}

/// Splits a line `key = value`.
pub(super) fn key_and_value(line: &str) -> Option<(&str, &str)> {
    line.split_once(" = ")
        .or_else(|| Some((line.strip_suffix(" =")?, "")))
        .map(|(key, value)| (key.trim(), value.trim()))
        .filter(|(key, _)| !key.is_empty())
}

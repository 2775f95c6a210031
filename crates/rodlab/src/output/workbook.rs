//! Workbook with all tables of a result.

use std::collections::BTreeMap;

use rust_xlsxwriter::{DocProperties, ExcelDateTime, Format, Workbook, XlsxError};

use crate::outcome::{PublishedCells, Table};
use crate::{InStep, RodlabError};

/// Maximum number of characters of the name of a sheet.
const MOST_CHARACTERS: usize = 31;

/// Characters that the name of a sheet must not contain.
const FORBIDDEN: [char; 7] = ['[', ']', ':', '*', '?', '/', '\\'];

/// Width of a column beyond the length of its name, in characters.
const MARGIN: f64 = 2.0;

/// Returns the workbook of `tables`, with one sheet for each table in their order. A sheet has the
/// names of the columns, the units and the rows. Numbers are written as numbers, and a missing
/// number is an empty cell. The bytes depend only on the tables.
pub(super) fn of(tables: &[Table]) -> Result<Vec<u8>, RodlabError> {
    written(tables).in_step(format!("writing {}", super::WORKBOOK))
}

fn written(tables: &[Table]) -> Result<Vec<u8>, XlsxError> {
    let mut workbook = Workbook::new();
    let date = ExcelDateTime::from_ymd(2000, 1, 1)?;
    workbook.set_properties(&DocProperties::new().set_creation_datetime(&date));
    let (bold, faint) = (Format::new().set_bold(), Format::new().set_italic());
    let mut names = BTreeMap::new();
    for table in tables {
        let sheet = workbook.add_worksheet();
        sheet.set_name(sheet_name(&table.name, &mut names))?;
        sheet.set_freeze_panes(2, 1)?;
        for (place, column) in (0_u16..).zip(table.published()) {
            sheet.write_string_with_format(0, place, &column.name, &bold)?;
            sheet.write_string_with_format(1, place, column.unit, &faint)?;
            sheet.set_column_width(place, column.name.chars().count() as f64 + MARGIN)?;
            match &column.cells {
                PublishedCells::Numbers(values) => {
                    for (row, value) in (2_u32..).zip(values) {
                        if value.is_finite() {
                            sheet.write_number(row, place, *value)?;
                        }
                    }
                }
                PublishedCells::Words(words) => {
                    for (row, word) in (2_u32..).zip(*words) {
                        sheet.write_string(row, place, word)?;
                    }
                }
                PublishedCells::Flags(flags) => {
                    for (row, flag) in (2_u32..).zip(*flags) {
                        sheet.write_boolean(row, place, *flag)?;
                    }
                }
            }
        }
    }
    workbook.save_to_buffer()
}

/// Returns a sheet name for a table that differs from all earlier ones; `names` counts how often
/// each name was requested.
fn sheet_name(name: &str, names: &mut BTreeMap<String, usize>) -> String {
    let allowed = name.chars().filter(|c| !FORBIDDEN.contains(c));
    let name: String = allowed.take(MOST_CHARACTERS).collect();
    let count = names.entry(name.to_lowercase()).or_insert(0);
    *count += 1;
    if *count == 1 {
        return name;
    }
    let number = format!("~{count}");
    let kept = MOST_CHARACTERS - number.chars().count();
    name.chars().take(kept).chain(number.chars()).collect()
}

//! Workbooks of Excel 97 to 2003, `.xls`: records of numbers and texts (BIFF8, [MS-XLS]) in the
//! stream `Workbook` of a compound file.

mod compound;
mod records;

use super::{Worksheet, plain};
use crate::LabioError;
use crate::format::MemoryLimit;
use crate::format::memory::Budget;
use records::{Cell, Record, SharedTexts, bytes, number, records, short_text, text};

pub(super) const FORMAT: &str = "xls";

/// First bytes of a compound file.
pub(super) const SIGNATURE: &[u8] = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1";

/// Types of records.
mod of {
    pub(super) const FORMULA: u16 = 0x0006;
    pub(super) const END: u16 = 0x000a;
    pub(super) const ENCRYPTED: u16 = 0x002f;
    pub(super) const CONTINUE: u16 = 0x003c;
    pub(super) const SHEET: u16 = 0x0085;
    pub(super) const NUMBERS: u16 = 0x00bd;
    pub(super) const STYLE: u16 = 0x00e0;
    pub(super) const SHARED_TEXTS: u16 = 0x00fc;
    pub(super) const SHARED_TEXT: u16 = 0x00fd;
    pub(super) const NUMBER: u16 = 0x0203;
    pub(super) const LABEL: u16 = 0x0204;
    pub(super) const BOOL_OR_ERROR: u16 = 0x0205;
    pub(super) const TEXT_OF_FORMULA: u16 = 0x0207;
    pub(super) const SHORT_NUMBER: u16 = 0x027e;
    pub(super) const DISPLAY: u16 = 0x041e;
    pub(super) const BEGIN: u16 = 0x0809;
}

fn refused(found: impl Into<String>) -> LabioError {
    crate::error::malformed(
        FORMAT,
        crate::Place::Byte(0),
        "document",
        found,
        "a workbook of Excel 97 to 2003 without password; otherwise one saved as .xlsx, or a table saved as .csv",
    )
}

fn cut_off() -> LabioError {
    refused("cut off or broken")
}

/// Returns the worksheets as text tables.
pub(super) fn worksheets(file: &[u8]) -> Result<Vec<Worksheet>, LabioError> {
    let stream = compound::workbook(file)?;
    let mut budget = Budget::new(FORMAT, MemoryLimit::of_file(file.len()));
    let mut sheets = Vec::new();
    let mut texts = SharedTexts::default();
    let (mut styles, mut dates) = (Vec::new(), Vec::new());
    for record in records(&stream, 0) {
        let Record { kind, data, .. } = record?;
        match kind {
            of::BEGIN if number(data, 0)? != 0x0600 => {
                return Err(refused("from Excel 95 or earlier"));
            }
            of::ENCRYPTED => return Err(refused("encrypted")),
            // worksheets only, not charts
            of::SHEET if bytes::<1>(data, 5)? == [0] => {
                let name = short_text(data.get(6..).unwrap_or(&[]))?;
                sheets.push((u32::from_le_bytes(bytes(data, 0)?) as usize, name));
            }
            of::STYLE => styles.push(number(data, 2)?),
            of::DISPLAY if shows_date(&text(data.get(2..).unwrap_or(&[]))?) => {
                dates.push(number(data, 0)?);
            }
            _ => {}
        }
        texts.take(kind, data);
    }
    let texts = texts.read(&mut budget)?;
    let is_date = |style: u16| {
        let display = styles.get(usize::from(style)).copied().unwrap_or(0);
        matches!(display, 14..=22 | 27..=36 | 45..=47 | 50..=58) || dates.contains(&display)
    };
    let mut worksheets = Vec::new();
    for (begin, name) in sheets {
        worksheets.push(worksheet(&stream, begin, &texts, &is_date, &mut budget)?.named(name));
    }
    Ok(worksheets)
}

/// Reads the cells of the worksheet that begins at offset `begin` of the stream.
fn worksheet(
    stream: &[u8],
    begin: usize,
    texts: &[String],
    is_date: &dyn Fn(u16) -> bool,
    budget: &mut Budget,
) -> Result<super::Filled, LabioError> {
    let mut filled = super::Filled::default();
    // empty rows also become lines, and the cells before a filled one become tabs
    let mut count = |n: usize, each: usize| budget.take(n, each, crate::Place::Byte(0), "cells");
    count(usize::from(u16::MAX), 1)?;
    let mut depth = 0_u32;
    let mut of_formula = None;
    for record in records(stream, begin) {
        let Record { kind, data, .. } = record?;
        depth = match kind {
            of::BEGIN => depth.saturating_add(1),
            // an embedded chart ends before the worksheet does
            of::END => depth.saturating_sub(1),
            _ => depth,
        };
        if depth == 0 {
            break;
        }
        if depth > 1 {
            continue;
        }
        let mut add = |cell: Cell, text: String| -> Result<(), LabioError> {
            count(
                1,
                text.len() + size_of::<(u32, u32, String)>() + usize::from(Cell::COLUMNS),
            )?;
            filled
                .cells
                .push((u32::from(cell.row), u32::from(cell.column), text));
            Ok(())
        };
        let shown = |cell: Cell, value: f64| match is_date(cell.style) {
            true => format!("date {value}"),
            false => format!("{value:?}"),
        };
        match kind {
            of::NUMBER => {
                let cell = Cell::of(data)?;
                add(cell, shown(cell, f64::from_le_bytes(bytes(data, 6)?)))?;
            }
            of::SHORT_NUMBER => {
                let cell = Cell::of(data)?;
                add(cell, shown(cell, short_number(bytes(data, 6)?)))?;
            }
            of::NUMBERS => {
                let cell = Cell::of(data)?;
                let body = data.get(4..data.len().saturating_sub(2)).unwrap_or(&[]);
                for (column, own) in (cell.column..Cell::COLUMNS).zip(body.chunks_exact(6)) {
                    let style = number(own, 0)?;
                    let cell = Cell {
                        column,
                        style,
                        ..cell
                    };
                    add(cell, shown(cell, short_number(bytes(own, 2)?)))?;
                }
            }
            of::SHARED_TEXT => {
                let index = u32::from_le_bytes(bytes(data, 6)?) as usize;
                add(
                    Cell::of(data)?,
                    plain(texts.get(index).ok_or_else(cut_off)?),
                )?;
            }
            of::LABEL => {
                let text = text(data.get(6..).unwrap_or(&[]))?;
                add(Cell::of(data)?, plain(&text))?;
            }
            of::BOOL_OR_ERROR => {
                let [value, is_error] = bytes(data, 6)?;
                add(Cell::of(data)?, of_byte(value, is_error != 0))?;
            }
            of::FORMULA => {
                let cell = Cell::of(data)?;
                let value: [u8; 8] = bytes(data, 6)?;
                match value {
                    // the text is in a separate record
                    [0, .., 0xff, 0xff] => of_formula = Some(cell),
                    [kind @ (1 | 2), _, value, .., 0xff, 0xff] => {
                        add(cell, of_byte(value, kind == 2))?;
                    }
                    [.., 0xff, 0xff] => {}
                    number => add(cell, shown(cell, f64::from_le_bytes(number)))?,
                }
            }
            of::TEXT_OF_FORMULA => {
                if let Some(cell) = of_formula.take() {
                    add(cell, plain(&text(data)?))?;
                }
            }
            _ => {}
        }
    }
    filled.cells.retain(|(_, _, text)| !text.is_empty());
    Ok(filled)
}

/// Returns the text of a truth value, or of the error of a cell.
fn of_byte(value: u8, is_error: bool) -> String {
    if is_error {
        return format!("#ERROR {value}");
    }
    (value != 0).to_string()
}

/// Returns a number stored in four bytes: an integer of 30 bits or the upper half of a double,
/// possibly divided by 100.
fn short_number(bytes: [u8; 4]) -> f64 {
    let all = u32::from_le_bytes(bytes);
    let value = if all & 2 == 0 {
        f64::from_bits(u64::from(all & !3) << 32)
    } else {
        f64::from(i32::from_le_bytes(bytes) >> 2)
    };
    if all & 1 == 0 { value } else { value / 100.0 }
}

/// Returns true if a cell with this number format shows a date or a time of day.
fn shows_date(display: &str) -> bool {
    let (mut quoted, mut bracketed, mut escaped) = (false, false, false);
    display.chars().any(|sign| {
        let hidden = quoted || bracketed || escaped;
        escaped = !hidden && matches!(sign, '\\' | '_' | '*');
        match sign {
            '"' if !bracketed => quoted = !quoted,
            '[' if !quoted => bracketed = true,
            ']' if !quoted => bracketed = false,
            _ => {}
        }
        !hidden
            && matches!(
                sign,
                'd' | 'D' | 'm' | 'M' | 'y' | 'Y' | 'h' | 'H' | 's' | 'S'
            )
    })
}

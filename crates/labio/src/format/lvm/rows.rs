//! The rows of a segment.

use super::channel::Channel;
use super::{END_OF_HEADER, END_SPECIAL, START_SPECIAL, Source, XColumns, malformed};
use crate::format::Strictness;
use crate::format::text::{self, DecimalMark};
use crate::{Contents, LabioError, Place};

/// The rows of a segment.
pub(super) struct Rows {
    pub(super) separator: char,
    pub(super) mark: DecimalMark,
    /// Number of columns before the comment.
    pub(super) width: usize,
    pub(super) x_columns: XColumns,
    /// Number of rows of a packet, if the header announces it.
    pub(super) block: Option<usize>,
    pub(super) n_rows: usize,
}

impl Rows {
    pub(super) fn read(
        &mut self,
        source: &mut Source<'_>,
        channels: &mut [Channel],
        strictness: Strictness,
        contents: &mut Contents,
    ) -> Result<(), LabioError> {
        let mut defect = |error: LabioError| strictness.pass_over(error, &mut contents.defects);
        while let Some((line, text)) = source.skip_blank(self.separator) {
            let first = self.cells(text).next().unwrap_or("");
            if first.starts_with(START_SPECIAL) {
                source.take();
                skip_special(source)?;
                continue;
            }
            if begins_header(first) {
                break;
            }
            source.take();
            let comment = self.row(line, text, channels, &mut defect)?;
            if let Some(comment) = comment {
                let place = format!("comment in line {line}");
                contents.properties.push((place, comment));
            }
            self.n_rows += 1;
        }
        let Some(block) = self.block.filter(|&block| block > 0) else {
            return Ok(());
        };
        if self.n_rows == 0 || !self.n_rows.is_multiple_of(block) {
            defect(malformed(
                Place::Line(source.last_line),
                "Samples",
                format!("{} rows", self.n_rows),
                &format!("{block} rows or a multiple, as stated in the header"),
            ))?;
        }
        Ok(())
    }

    /// The cells of a row; the separator is a tab, a comma or a semicolon.
    fn cells<'a>(&self, row: &'a str) -> impl Iterator<Item = &'a str> + use<'a> {
        text::cells(row, u8::try_from(self.separator).unwrap_or(b'\t'))
    }

    /// Reads one row; a cell that is empty where a sample is expected, or filled where none is
    /// expected, is a defect.
    fn row(
        &self,
        line: u64,
        text: &str,
        channels: &mut [Channel],
        defect: &mut dyn FnMut(LabioError) -> Result<(), LabioError>,
    ) -> Result<Option<String>, LabioError> {
        let row_of_block = match self.block {
            Some(block) if block > 0 => self.n_rows % block,
            _ => self.n_rows,
        };
        let mut cells = self.cells(text);
        let mut column = 0;
        let mut x = None;
        for channel in channels {
            let mut value = "";
            while column <= channel.column {
                value = cells.next().unwrap_or("");
                let is_x = match self.x_columns {
                    XColumns::No => false,
                    XColumns::One => column == 0,
                    XColumns::Multi => column.is_multiple_of(2),
                };
                if is_x {
                    x = Some((column, value));
                } else if column == 0 && !value.is_empty() {
                    let expected = "an empty cell, as `X_Columns` is `No`";
                    defect(malformed(
                        Place::cell(line, 0),
                        "X_Value",
                        text::quoted(value),
                        expected,
                    ))?;
                }
                column += 1;
            }
            let awaited = channel.samples.is_none_or(|samples| row_of_block < samples);
            if value.is_empty() && (!awaited || channel.samples.is_none()) {
                continue;
            }
            if !awaited {
                let samples = channel.samples.unwrap_or(0);
                let expected = format!("an empty cell after {samples} samples");
                defect(malformed(
                    Place::cell(line, channel.column),
                    &channel.label,
                    text::quoted(value),
                    &expected,
                ))?;
                continue;
            }
            let number = text::real(value, self.mark);
            if number.is_none() {
                let place = Place::cell(line, channel.column);
                let found = text::quoted(value);
                defect(malformed(place, &channel.label, found, "a number"))?;
            }
            channel.values.push(number.unwrap_or(f64::NAN));
            if (channel.column == 1 || self.x_columns == XColumns::Multi)
                && let Some((column, text)) = x
            {
                let value = text::real(text, self.mark).filter(|value| value.is_finite());
                if value.is_none() {
                    let found = text::quoted(text);
                    defect(malformed(
                        Place::cell(line, column),
                        "X_Value",
                        found,
                        "a finite number",
                    ))?;
                }
                let half_unit = text::half_unit(text, self.mark);
                channel.x.push(value.unwrap_or(f64::NAN), half_unit);
            }
        }
        while column < self.width {
            cells.next();
            column += 1;
        }
        let comment = cells.next().unwrap_or("");
        if let Some(extra) = cells.find(|cell| !cell.is_empty()) {
            let expected = "no column after the comments";
            defect(malformed(
                Place::Line(line),
                "row",
                text::quoted(extra),
                expected,
            ))?;
        }
        Ok((!comment.is_empty()).then(|| comment.to_owned()))
    }
}

/// Returns true if a row whose first cell is `first` is a tag.
fn begins_header(first: &str) -> bool {
    const TAGS: [&str; 19] = [
        "Channels",
        "Date",
        "Delta_X",
        "Notes",
        "Samples",
        "Test_Name",
        "Test_Numbers",
        "Test_Series",
        "Time",
        "UUT_M/N",
        "UUT_Name",
        "UUT_S/N",
        "X0",
        "X_Dimension",
        "X_Unit_Label",
        "Y_Dimension",
        "Y_Unit_Label",
        "Description",
        END_OF_HEADER,
    ];
    first.starts_with(|c: char| c.is_ascii_uppercase() || c == '*') && TAGS.contains(&first)
}

/// Skips a special block, whose meaning is known only to the program that wrote it.
pub(super) fn skip_special(source: &mut Source<'_>) -> Result<(), LabioError> {
    loop {
        if source.header_line()?.1.starts_with(END_SPECIAL) {
            return Ok(());
        }
    }
}

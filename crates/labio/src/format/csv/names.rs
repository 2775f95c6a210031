//! Search for the rows of names and units above a table.

use std::borrow::Cow;

use super::CsvDialect;
use super::abscissa_name::{is_time, names_abscissa};
use super::cells::{filled, is_number};
use super::header_lines::{above, cells_beside, cells_of};
use super::settings::Settings;
use super::table::Shape;
use super::unit_in_name::{is_bracketed, is_unit, is_unit_in_full, split_unit};
use crate::LabioError;
use crate::format::text::DecimalMark;

/// Number of lines above the numbers among which names and units are looked for: programs write up
/// to thirty lines of texts for each column below its name.
const NAMES_WITHIN: usize = 64;

/// Finds the rows of names and of units above the numbers.
pub(super) fn find_names(text: &str, dialect: &mut CsvDialect) -> Result<(), LabioError> {
    let shape = Shape::of(text, dialect)?;
    let mut last: Vec<(u64, &str)> = above(text, dialect)
        .filter(|(_, line)| !line.trim().is_empty())
        .collect();
    last.drain(..last.len().saturating_sub(NAMES_WITHIN));
    let mut settings = Settings::default();
    for (_, line) in &last {
        settings.read(&cells_beside(line, dialect.separator, &[]));
    }
    let rows: Vec<Row<'_>> = last
        .into_iter()
        .rev()
        .map(|(number, line)| (number, cells_of(line, dialect.separator, shape.n_cells)))
        .collect();
    let Some((number, nearest)) = rows.first() else {
        return Ok(());
    };
    if shape.first_line <= *number || settings.replace_names() {
        return Ok(());
    }
    let names = Names {
        shape: &shape,
        mark: dialect.decimal_mark,
    };
    let above = rows
        .get(1)
        .and_then(|(number, cells)| Some((*number, cells.as_deref()?)));
    let (name_line, unit_line) = match nearest {
        Some(cells) if names.has_words(cells) => {
            match names.directly_above(*number, cells, above) {
                // a row of other texts may follow names and units
                (Some(line), None) => names.pair(&rows).unwrap_or((Some(line), None)),
                found => found,
            }
        }
        _ => names.pair(&rows).unwrap_or_default(),
    };
    (dialect.name_line, dialect.unit_line) = (name_line, unit_line);
    Ok(())
}

/// Number of a line, and its cells if there are as many as in the rows of numbers.
type Row<'a> = (u64, Option<Vec<Cow<'a, str>>>);

/// Lines of names and of units.
type NameAndUnitLine = (Option<u64>, Option<u64>);

/// Search for the rows of a header that are names and units of the columns of a table.
struct Names<'a> {
    shape: &'a Shape,
    mark: DecimalMark,
}

impl Names<'_> {
    fn is_word(&self, cell: &str) -> bool {
        !cell.is_empty() && !is_number(cell, self.mark)
    }

    /// The cells above the columns of the table.
    fn of_columns<'c>(&self, cells: &'c [Cow<'_, str>]) -> impl Iterator<Item = &'c str> {
        let columns = self.shape.columns.iter();
        columns.map(move |&at| cells.get(at).map_or("", AsRef::as_ref))
    }

    /// Returns true if a row has names or units: words, and not only a title above the first of
    /// several columns, such as `Data:`.
    fn has_words(&self, cells: &[Cow<'_, str>]) -> bool {
        let mut words = filled(cells).filter(|&at| {
            let cell = cells.get(at);
            cell.is_some_and(|cell| self.is_word(cell))
        });
        let Some(first) = words.next() else {
            return false;
        };
        if first > 0 || filled(cells).count() > 1 || self.shape.columns.len() < 2 {
            return true;
        }
        cells.first().is_some_and(|cell| {
            let (name, unit) = split_unit(cell);
            is_bracketed(cell) || !unit.is_empty() || names_abscissa(&name)
        })
    }

    fn are_words(&self, cells: &[Cow<'_, str>]) -> bool {
        self.of_columns(cells).all(|cell| self.is_word(cell))
    }

    fn are_units(&self, cells: &[Cow<'_, str>]) -> bool {
        self.of_columns(cells)
            .all(|cell| !cell.is_empty() && is_unit(cell))
    }

    /// Returns true for names such as `x-axis,1,2`: an oscilloscope may call its channels 1, 2, ...
    fn count(&self, names: &[Cow<'_, str>]) -> bool {
        let mut numbered = self.of_columns(names).zip(0_usize..).skip(1);
        self.of_columns(names)
            .next()
            .is_some_and(|first| self.is_word(first))
            && numbered.all(|(name, number)| name.parse() == Ok(number))
    }

    /// Returns the lines of names and of units, given the row `cells` directly above the numbers
    /// and the row `above` it.
    fn directly_above(
        &self,
        line: u64,
        cells: &[Cow<'_, str>],
        above: Option<(u64, &[Cow<'_, str>])>,
    ) -> NameAndUnitLine {
        let filled = || cells.iter().filter(|cell| !cell.is_empty());
        let bracketed = filled().all(|cell| is_bracketed(cell));
        // one unit in four may be unknown
        let units = 4 * filled().filter(|cell| is_unit(cell)).count() >= 3 * filled().count();
        match above {
            Some((names, cells_above))
                if bracketed
                    || (units && (self.are_words(cells_above) || self.count(cells_above))) =>
            {
                (Some(names), Some(line))
            }
            _ if bracketed => (None, Some(line)),
            // `Second,Volt`: a row of units written as words is not a row of names
            _ if cells.first().is_some_and(|first| is_time("", first))
                && filled().all(|cell| is_unit_in_full(cell)) =>
            {
                (None, Some(line))
            }
            _ => (Some(line), None),
        }
    }

    /// Returns a row of names directly above a row of units, farther from the numbers, or a row of
    /// units above the row of names next to the numbers.
    fn pair(&self, rows: &[Row<'_>]) -> Option<NameAndUnitLine> {
        let pairs = rows.windows(2).filter_map(|pair| match pair {
            [(below, Some(cells_below)), (above, Some(cells_above))] => {
                Some(((*below, cells_below), (*above, cells_above)))
            }
            _ => None,
        });
        let mut farther = pairs.clone();
        let in_order = farther.find(|((_, units), (_, names))| {
            self.are_units(units) && self.are_words(names) && !self.are_units(names)
        });
        if let Some(((units, _), (names, _))) = in_order {
            return Some((Some(names), Some(units)));
        }
        let (nearest, _) = rows.first()?;
        let mut reversed = pairs.take(1);
        let ((names, cells), (units, units_above)) = reversed.next()?;
        let is_reversed = names == *nearest
            && self.are_units(units_above)
            && self.are_words(cells)
            && !self.of_columns(cells).any(is_unit);
        is_reversed.then_some((Some(names), Some(units)))
    }
}

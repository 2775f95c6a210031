//! Cells that contain numbers.

use std::borrow::Cow;

use crate::format::text::{self, DecimalMark};

/// Returns true if the cell contains a real or a complex number.
pub(super) fn is_number(cell: &str, mark: DecimalMark) -> bool {
    text::real(cell, mark).is_some() || text::complex(cell, mark).is_some()
}

/// Returns true if all of `columns` contain numbers.
pub(super) fn holds_numbers(cells: &[Cow<'_, str>], columns: &[usize], mark: DecimalMark) -> bool {
    columns
        .iter()
        .all(|&at| cells.get(at).is_some_and(|cell| is_number(cell, mark)))
}

/// Positions of the cells that are not empty.
pub(super) fn filled(cells: &[Cow<'_, str>]) -> impl Iterator<Item = usize> {
    let cells = cells.iter().enumerate();
    cells.filter(|(_, cell)| !cell.is_empty()).map(|(at, _)| at)
}

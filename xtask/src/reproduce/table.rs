//! Table for readers (Markdown) and for programs (CSV).

use std::fmt::Write;

/// Makes a table with a row for each item: the heading of each column, and the cell of the item in
/// this column.
macro_rules! table_of {
    ($items:expr, |$item:pat_param| $($heading:expr => $cell:expr,)+) => {{
        let mut table = $crate::reproduce::Table::new(&[$($heading),+]);
        for $item in $items {
            table.row([$(ToString::to_string(&$cell)),+]);
        }
        table
    }};
}
pub(crate) use table_of;

/// Headings with their units, and rows of cells as displayed text.
#[derive(Debug, Clone, Default)]
pub(crate) struct Table {
    headings: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    pub(crate) fn new(headings: &[impl AsRef<str>]) -> Self {
        let headings = headings.iter().map(AsRef::as_ref);
        Self {
            headings: headings.map(str::to_owned).collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row; a short row is filled up with empty cells.
    pub(crate) fn row(&mut self, cells: impl IntoIterator<Item = impl Into<String>>) {
        let mut row: Vec<String> = cells.into_iter().map(Into::into).collect();
        row.resize(self.headings.len().max(row.len()), String::new());
        self.rows.push(row);
    }

    pub(crate) fn markdown(&self) -> String {
        let mut text = String::new();
        let mut line = |cells: &[String]| {
            // writing to a String never fails
            let _ = writeln!(text, "| {} |", cells.join(" | "));
        };
        line(&self.headings);
        line(&vec!["---".to_owned(); self.headings.len()]);
        for row in &self.rows {
            line(row);
        }
        text
    }

    /// Returns the table as comma-separated values; cells are quoted if RFC 4180 requires it.
    pub(crate) fn csv(&self) -> String {
        let quoted = |cell: &String| {
            if cell.contains([',', '"', '\n']) {
                format!("\"{}\"", cell.replace('"', "\"\""))
            } else {
                cell.clone()
            }
        };
        std::iter::once(&self.headings)
            .chain(&self.rows)
            .map(|row| row.iter().map(quoted).collect::<Vec<_>>().join(",") + "\n")
            .collect()
    }
}

//! Table for readers (Markdown) and for programs (CSV).

use std::fmt::Write;

/// Headings with their units, and rows of cells in the form in which they are shown.
#[derive(Debug, Clone, Default)]
pub(crate) struct Table {
    headings: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    pub(crate) fn new(headings: &[&str]) -> Self {
        Self {
            headings: headings.iter().map(|&heading| heading.into()).collect(),
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

#[cfg(test)]
mod tests {
    use super::Table;

    #[test]
    fn a_table_reads_both_ways() {
        let mut table = Table::new(&["test", "load, MPa"]);
        table.row(["1", "45"]);
        table.row(["2, \"again\""]);
        assert_eq!(
            table.markdown(),
            "| test | load, MPa |\n| --- | --- |\n| 1 | 45 |\n| 2, \"again\" |  |\n"
        );
        assert_eq!(
            table.csv(),
            "test,\"load, MPa\"\n1,45\n\"2, \"\"again\"\"\",\n"
        );
    }
}

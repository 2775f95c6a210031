//! Tables built column by column.

use std::borrow::Borrow;

use super::{Column, Table};

impl Table {
    /// Returns a table without columns.
    pub(crate) fn new(name: impl Into<String>, title: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            title: title.into(),
            columns: Vec::new(),
        }
    }

    /// The table with another column.
    pub(crate) fn with(mut self, column: Column) -> Self {
        self.columns.push(column);
        self
    }

    /// The table with another column of numbers; NaN stands for a missing number.
    pub(crate) fn numbers(
        self,
        name: impl Into<String>,
        unit: impl Into<String>,
        values: impl IntoIterator<Item: Borrow<f64>>,
    ) -> Self {
        let values = values.into_iter().map(|value| *value.borrow());
        self.with(Column::numbers(name, unit, values.collect()))
    }

    /// The table with another column of words.
    pub(crate) fn words(
        self,
        name: impl Into<String>,
        words: impl IntoIterator<Item: Into<String>>,
    ) -> Self {
        let words = words.into_iter().map(Into::into);
        self.with(Column::words(name, words.collect()))
    }
}

/// Table with one row for each element of a list.
pub(crate) struct Rows<'a, R> {
    rows: &'a [R],
    /// The table with the columns so far.
    pub(crate) table: Table,
}

impl<'a, R> Rows<'a, R> {
    /// Returns a table of `rows` without columns.
    pub(crate) fn of(rows: &'a [R], name: impl Into<String>, title: impl Into<String>) -> Self {
        let table = Table::new(name, title);
        Self { rows, table }
    }

    /// The table with a number of each row.
    pub(crate) fn number(
        self,
        name: impl Into<String>,
        unit: impl Into<String>,
        number: impl Fn(&'a R) -> f64,
    ) -> Self {
        let numbers = self.rows.iter().map(number);
        let table = self.table.numbers(name, unit, numbers);
        Self { table, ..self }
    }

    /// The table with a word of each row.
    pub(crate) fn word<W: Into<String>>(
        self,
        name: impl Into<String>,
        word: impl Fn(&'a R) -> W,
    ) -> Self {
        let words = self.rows.iter().map(word);
        let table = self.table.words(name, words);
        Self { table, ..self }
    }

    /// The table with the validity of each row, and words that state the reasons against it.
    pub(crate) fn validity(
        self,
        is_valid: impl Fn(&'a R) -> bool,
        verdict: impl Fn(&'a R) -> String,
    ) -> Self {
        let valid = self.rows.iter().map(is_valid).collect();
        let words = self.rows.iter().map(verdict).collect();
        let table = self.table.with(Column::validity(valid, words));
        Self { table, ..self }
    }
}

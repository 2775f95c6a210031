//! Tables of the papers in SI units, from `fixtures/golden`.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde::Deserialize;

#[derive(Deserialize)]
struct Table {
    rows: Vec<Row>,
}

#[derive(Deserialize)]
pub(crate) struct Row {
    pub(crate) label: String,
    #[serde(default)]
    pub(crate) text: BTreeMap<String, String>,
    pub(crate) values: BTreeMap<String, Value>,
}

#[derive(Deserialize)]
pub(crate) struct Value {
    pub(crate) value: f64,
    pub(crate) unit: String,
}

impl Row {
    pub(crate) fn value(&self, column: &str) -> f64 {
        self.values[column].value
    }
}

pub(crate) fn golden(name: &str) -> Vec<Row> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../fixtures/golden")
        .join(name);
    let table: Table = ron::from_str(&fs::read_to_string(path).unwrap()).unwrap();
    table.rows
}

pub(crate) fn constant(table: &str, name: &str) -> Value {
    let mut rows = golden(table).into_iter();
    let mut row = rows.find(|row| row.label == name).unwrap();
    row.values.remove("value").unwrap()
}

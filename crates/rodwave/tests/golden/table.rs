//! Golden tables: values in SI with the tolerance of their printed digits.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde::Deserialize;

#[derive(Deserialize)]
pub(crate) struct GoldenTable {
    pub(crate) rows: Vec<GoldenRow>,
}

#[derive(Deserialize)]
pub(crate) struct GoldenRow {
    pub(crate) label: String,
    pub(crate) text: BTreeMap<String, String>,
    pub(crate) values: BTreeMap<String, GoldenValue>,
}

#[derive(Deserialize, Clone, Copy)]
pub(crate) struct GoldenValue {
    pub(crate) value: f64,
    pub(crate) tolerance: f64,
}

impl GoldenTable {
    pub(crate) fn read(name: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../fixtures/golden")
            .join(name);
        ron::from_str(&fs::read_to_string(path).unwrap()).unwrap()
    }

    pub(crate) fn row(&self, label: &str) -> &GoldenRow {
        let row = self.rows.iter().find(|row| row.label == label);
        row.unwrap_or_else(|| panic!("no row {label}"))
    }

    pub(crate) fn constant(&self, label: &str) -> GoldenValue {
        self.row(label).values["value"]
    }
}

impl GoldenRow {
    pub(crate) fn value(&self, column: &str) -> f64 {
        self.values[column].value
    }
}

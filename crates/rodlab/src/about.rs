//! Free text fields of a sheet, which are copied to the report.

use serde::Deserialize;

/// Persons, place and date of a test; all fields are optional.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct About {
    /// The laboratory.
    pub laboratory: Option<String>,
    /// The operator of the test.
    pub operator: Option<String>,
    /// The date of the test.
    pub date: Option<String>,
    /// Name of the specimen in the laboratory.
    pub specimen: Option<String>,
    /// Other remarks.
    pub note: Option<String>,
}

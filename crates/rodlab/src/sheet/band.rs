//! A band of frequencies in a sheet.

use serde::Deserialize;

use super::{Exact, Frequency};

/// A band of frequencies.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BandSheet {
    /// Lower end, such as `"20 Hz"`.
    pub from: Exact<Frequency>,
    /// Upper end, such as `"5 kHz"`.
    pub to: Exact<Frequency>,
}

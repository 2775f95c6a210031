//! Inputs of the command other than records: sheets, units, tables, files of unknown format.

mod recognition;
mod sheet;
mod table;
mod unit;

pub use recognition::recognition;
pub use sheet::sheet;
pub use table::{ratio_table, response_table};
pub use unit::unit;

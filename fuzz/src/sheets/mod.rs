//! Inputs of the command beside records: sheets, units, tables, files of unknown kind.

mod recognition;
mod sheet;
mod table;
mod unit;

pub use recognition::recognition;
pub use sheet::sheet;
pub use table::{ratio_table, response_table};
pub use unit::unit;

//! Command-line program for a laboratory: turns recordings of struck rods into a report.
//!
//! A *test sheet* in TOML or RON describes a test: specimen, sensors, files, processing. A *job*
//! turns a sheet into an [`Outcome`]: quantities with their errors and validity, tables, figures,
//! and a log of the accepted and rejected data. The outcome is written as CSV, JSON, SVG and one
//! HTML page. This crate contains no numerical methods: it combines `labio`, `cmod`, `maxwellid`,
//! `impulse` and `rodwave`.
//!
//! | module | contents |
//! |---|---|
//! | [`process`], [`arguments`], [`program`], [`progress`] | the command line and its execution |
//! | [`finished`], [`batch`] | one sheet from file to result; many sheets |
//! | [`templates`] | commented sheets to start from |
//! | [`sheet`] | test sheets, and error messages about them |
//! | [`records`] | calibrated records from files |
//! | [`hits`] | accepted and rejected hits of the records, with reasons |
//! | [`inspect`], [`convert`] | contents of a file, and conversion to another format |
//! | [`responses`] | frequency responses of hits or of a file |
//! | [`job`] | the jobs of the commands |
//! | [`outcome`], [`standing`] | the results of a job, with figures of [`rodfigure`] |
//! | [`report`] | the report page |
//! | [`view`] | a sheet and its report side by side in a browser |
//! | [`output`] | writing of the result files, each complete or not at all |
//!
//! Exit status ([`Standing`]): 0, done; 1, the data do not allow the result; 2, a sheet, a file or
//! a folder is wrong; 3, there is an answer, but one of its checks fails. For 1 to 3 a message
//! states the reason, and for a wrong sheet also the place.

mod about;
pub mod arguments;
pub mod batch;
pub mod bodies;
mod closed_pipe;
mod context;
pub mod convert;
mod cut_short;
mod digits;
mod draw;
mod earlier;
pub mod error;
pub mod finished;
pub mod hits;
mod input;
pub mod inspect;
pub mod job;
mod laws;
mod material_file;
mod median;
mod number_file;
pub mod outcome;
pub mod output;
pub mod process;
pub mod program;
pub mod progress;
pub mod records;
pub mod report;
pub mod responses;
pub mod sheet;
pub mod sheet_command;
pub mod standing;
pub mod templates;
mod universal;
pub mod verify;
pub mod view;

pub(crate) use error::InStep;
pub use error::RodlabError;
pub use outcome::Outcome;
pub use standing::Standing;

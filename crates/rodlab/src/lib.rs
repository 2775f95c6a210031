//! The command of a laboratory: from recordings of struck rods to a report.
//!
//! A *test sheet* in RON says what was measured on what: specimen, sensors, files, processing. A *job* turns a sheet into an
//! [`Outcome`]: quantities with their errors and validity, tables, figures, and the log of what was accepted and what was not. The
//! outcome is written as CSV, JSON, SVG and one page of HTML. There are no numerics here: what is computed is computed by
//! `labio`, `cmod`, `maxwellid`, `impulse` and `rodwave`, and this crate composes them.
//!
//! | module | what it holds |
//! |---|---|
//! | [`process`], [`arguments`], [`program`], [`progress`] | the command line and what is done with it |
//! | [`finished`], [`batch`] | one sheet from file to result; many of them |
//! | [`templates`] | commented sheets to begin with |
//! | [`sheet`] | test sheets, and what is said of one that is wrong |
//! | [`records`] | files to calibrated records |
//! | [`hits`] | which hits of the records are accepted, and why the others are not |
//! | [`inspect`], [`convert`] | what is in a file, and the same in another format |
//! | [`responses`] | frequency responses of hits or of a file |
//! | [`responses`] | frequency responses of hits or of a file |
//! | [`inspect`], [`convert`] | what is in a file, and the same in another format |
//! | [`job`] | what each command does |
//! | [`outcome`], [`standing`], [`figure`] | what a job hands back |
//! | [`report`] | the page that is read |
//! | [`output`] | the files that are written of it, whole or not at all |
//!
//! Exit status: 0, done; 1, the data do not allow the result, and why; 2, a sheet, a file or a folder is wrong, and where; 3, there is an
//! answer, but a check fails ([`Standing`]).

pub mod arguments;
pub mod batch;
mod chosen;
mod closed_pipe;
pub mod convert;
mod cut_short;
mod digits;
pub mod error;
pub mod figure;
pub mod finished;
pub mod hits;
mod input;
pub mod inspect;
pub mod job;
mod number_file;
pub mod outcome;
pub mod output;
pub mod process;
pub mod program;
pub mod progress;
pub mod records;
pub mod report;
pub mod responses;
mod rounded;
pub mod sheet;
pub mod standing;
pub mod templates;
mod universal;

pub use error::RodlabError;
pub use outcome::Outcome;
pub use standing::Standing;

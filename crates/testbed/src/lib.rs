//! Common code of the tests of all crates: the papers' tables in SI, claims with their rows,
//! measured records, files that are written completely.
//!
//! Not published. No code here computes a result of our crates.
#![allow(
    missing_docs,
    clippy::missing_errors_doc,
    clippy::missing_panics_doc,
    clippy::must_use_candidate,
    reason = "read by the tests and tasks of this workspace only"
)]

pub mod claim;
pub mod difference;
pub mod generated;
pub mod hopkinson;
pub mod long_bar;
pub mod measured;
pub mod noise;
pub mod papers;
pub mod recorder;
pub mod ringing_rod;
pub mod ron_text;
pub mod struck_rod;

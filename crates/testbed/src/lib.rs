//! Common code of the tests of all crates: tables of the papers in SI, claims, virtual experiments,
//! measured records, generated files.
//!
//! The crate is not published. No code in this crate computes a result of the other crates.
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
pub mod half_sine;
pub mod hopkinson;
pub mod long_bar;
pub mod measured;
pub mod noise;
pub mod papers;
pub mod recorder;
pub mod ringing_rod;
pub mod ron_text;
pub mod struck_rod;

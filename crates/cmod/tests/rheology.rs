//! Fits of laws to moduli with known truth and noise of known covariance.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::float_cmp,
    missing_docs,
    clippy::indexing_slicing,
    reason = "a test that fails stops"
)]

mod cards;
mod common_errors;
mod comparison;
mod laws;
mod measured;
mod order;
mod refusals;
mod sweep;
mod verdicts;

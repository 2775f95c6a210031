//! Fits of laws to moduli with known true values and noise of known covariance.

mod cards;
mod common_errors;
mod comparison;
mod laws;
pub(crate) mod measured;
mod order;
mod over_time;
mod refusals;
mod sweep;
mod verdicts;

//! Integration tests of impulse: one program, a module for each subject.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::float_cmp,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a failing test may panic"
)]

mod assembly;
mod bad_input;
mod bodies;
mod claims;
mod force_in_band;
mod hard_to_break;
mod hopkinson;
mod measured_body;
mod measured_impulse_response;
mod no_allocation;
mod reconstruction;
mod reference_mpmath;
mod virtual_body;
mod virtual_laboratory;

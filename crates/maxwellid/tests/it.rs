//! Integration tests of maxwellid, in one program with a module for each subject.
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

mod arrhenius;
mod branched_laws;
mod claims;
mod common_errors;
mod coverage;
mod criterion;
mod hard_to_break;
mod identification;
mod lateral_inertia;
mod one_answer;
mod search;
mod selection;
mod selection_confusion;
mod selection_constant_q;
mod selection_settled;
mod specimen;
mod through_a_recorder;
mod transducers;
mod virtual_rod;
mod virtual_tests;
mod what_data_tell;

//! Integration tests of cmod: one program with one module per subject.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::float_cmp,
    reason = "a failing test may panic"
)]

mod branch;
mod causal;
mod checks;
mod creep_recovery;
mod free_vibration;
mod gauge_uncertainty;
mod golden;
mod golden_paper_a;
mod golden_paper_c;
mod hard_to_break;
mod lateral_inertia;
mod materials;
mod multi_point;
mod neighbours;
mod reference_lmfit;
mod reference_mpmath;
mod rheology;
mod self_calibration;
mod two_point;
mod virtual_rig;
mod virtual_tests;

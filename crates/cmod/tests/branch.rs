//! Branch tracking on virtual records that a chain of mass, rod and mass has made, not the equation that is inverted.
#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::indexing_slicing,
    reason = "in a test, a refusal where none is expected is a failure; bins of a table are counted by small numbers"
)]

mod adversary;
mod anchors;
mod hard_records;
mod refusals;
mod reliability;
mod rig;
mod table_1;
mod wrong_roots;

//! What the thesis prints, computed from its printed numbers: `fixtures/golden`.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::panic,
    reason = "a golden table that cannot be read must fail the test"
)]

mod paper_a;
mod paper_d;
mod paper_e;
mod table;

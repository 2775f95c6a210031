//! Elements, transition matrices and chains: closed forms, properties, paper E, and what is refused.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "in a test, a refusal where none is expected is a failure"
)]

mod bodies;
mod elements;
mod mobility;
mod paper_e;
mod refusals;
mod sections;

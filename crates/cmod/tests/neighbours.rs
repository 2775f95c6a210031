//! Free end with two sections, separate pulses, one gauge and a free end, resonances: on rods whose motion comes from the
//! recursion of impedances along a chain, which shares nothing with the equations that are inverted.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "in a test, a refusal where none is expected is a failure"
)]

#[path = "neighbours/comparison.rs"]
mod comparison;
#[path = "neighbours/errors.rs"]
mod errors;
#[path = "neighbours/exactness.rs"]
mod exactness;
#[path = "neighbours/few_hits.rs"]
mod few_hits;
#[path = "neighbours/rod.rs"]
mod rod;
#[path = "neighbours/systematic.rs"]
mod systematic;

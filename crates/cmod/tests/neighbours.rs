//! Free end with two sections, separate pulses, one gauge and a free end, resonances: on rods whose motion comes from the
//! recursion of impedances along a chain, which shares nothing with the equations that are inverted.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "in a test, a refusal where none is expected is a failure"
)]

mod comparison;
mod errors;
mod exactness;
mod few_hits;
mod rod;
mod systematic;

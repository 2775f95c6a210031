//! Gauges on a member of a structure. The strains come from a chain of rod, beams and lump by its impedances, which shares
//! nothing with the two waves that the methods look for.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::cast_precision_loss,
    clippy::indexing_slicing,
    reason = "in a test, a refusal where none is expected is a failure"
)]

mod advice;
mod coverage;
mod exact;
mod frame;
mod refusals;

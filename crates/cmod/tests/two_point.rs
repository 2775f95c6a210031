//! The two-point method in itself: roots, errors, masses, export. Records as of a laboratory are in `virtual_rig`.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "in a test, a refusal where none is expected is a failure"
)]

mod end_masses;
mod errors;
mod export;
mod rod;
mod roots_in_noise;

//! The two-point method itself: roots, errors, masses, export. Records as in a laboratory are in
//! `virtual_rig`.

mod end_masses;
mod errors;
mod export;
pub(crate) mod rod;

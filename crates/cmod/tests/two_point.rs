//! The two-point method in itself: roots, errors, masses, export. Records as of a laboratory are in
//! `virtual_rig`.

mod end_masses;
mod errors;
mod export;
mod rod;

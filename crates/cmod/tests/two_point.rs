//! The two-point method on exact ratios and on ratios with drawn errors: roots, errors, masses and
//! export. Tests with simulated records of a laboratory are in `virtual_rig`.

mod end_masses;
mod errors;
mod export;
pub(crate) mod rod;

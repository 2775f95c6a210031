//! Claims of the crate `labio`.

mod estimators;
mod files;
mod histories;
mod hits;
mod measured_files;
mod rigid_bodies;
#[path = "scipy_reference.rs"]
mod scipy_reference;
mod sensors;
mod several;
mod shock;
mod spectra;
mod windows;

//! Claims of the crate `labio`.

mod estimators;
mod files;
mod histories;
mod hits;
mod measured_files;
mod sensors;
mod several;
mod shock;
mod spectra;
mod windows;

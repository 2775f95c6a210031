//! Properties of any input: one function for each reader of files, for units, sheets and
//! tables.
//!
//! The functions do not depend on a fuzzer. The programs in `fuzz_targets` pass them the inputs of
//! libFuzzer; a test of `rodlab` includes the folders `records` and `sheets` as modules, and passes
//! the inputs in `corpus` and `regressions` to the functions. A function panics if its property is
//! violated.

mod records;
#[cfg(feature = "sheets")]
mod sheets;

pub use records::{csv, hdf5, isf, lecroy, lvm, mat5, npy, npz, tdms, uff58, wav, wfm};
#[cfg(feature = "sheets")]
pub use sheets::{ratio_table, recognition, response_table, sheet, unit};

//! Files of records: readers of `labio::format`.

mod blocks;
mod contents;
mod memory;
mod prints;
pub mod reader;
mod round_trip;

pub use prints::prints;
pub use reader::{csv, hdf5, isf, lecroy, lvm, mat5, npy, npz, tdms, uff58, wav, wfm};

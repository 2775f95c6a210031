//! Integration tests of labio: one program, a module for each subject.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stderr,
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::float_cmp,
    reason = "a failing test may panic, a skipped test prints a note, and numbers read from a text are exact"
)]

mod claims;
mod csv;
mod hard_to_break;
mod hdf5;
mod hits;
mod instrument;
mod lvm;
mod mat5;
mod npy;
mod oscilloscope;
mod recognition;
mod records;
mod reference_nptdms;
mod reference_pandas;
mod reference_pyuff;
mod reference_wav;
mod series;
mod sheets;
mod tdms;
mod uff58;
mod units;
mod wav;
mod workbook;
mod xls;

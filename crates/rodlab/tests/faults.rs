//! Faults that occur in laboratories, injected into runs of the program and counted: no data are
//! lost and the program does not panic.
//!
//! By default, a few points of every fault are tried. `RODLAB_FAULTS=all cargo test --locked
//! --workspace --test it faults:: -- --test-threads 1` tries all of them, which takes a quarter of
//! an hour, and writes the counts to `docs/faults.ron`, from which `cargo xtask validate` makes the
//! table in `docs/validation.md`.
#![cfg(unix)]

mod cut_records;
mod cut_sheets;
pub(crate) mod folder;
mod full_disk;
mod killed;
mod no_permission;
mod odd_files;
mod program;
mod record_files;
mod struck_mass;
mod system_calls;
mod tally;
mod two_runs;

use tally::{Extent, compared};

#[test]
fn records_that_were_cut() {
    compared("records that were cut", cut_records::rows(Extent::asked()));
}

#[test]
fn sheets_that_were_cut() {
    compared("sheets that were cut", cut_sheets::rows(Extent::asked()));
}

#[test]
fn a_disk_that_becomes_full() {
    compared("a disk that becomes full", full_disk::rows(Extent::asked()));
}

#[test]
fn what_may_not_be_read_or_written() {
    compared("no permission", no_permission::rows(Extent::asked()));
}

#[test]
fn runs_that_are_killed() {
    compared("a run that is killed", killed::rows(Extent::asked()));
}

#[test]
fn runs_that_are_killed_at_a_system_call() {
    compared(
        "a run that is killed at a system call",
        system_calls::rows(Extent::asked()),
    );
}

#[test]
fn runs_in_one_folder() {
    compared(
        "several runs in one folder",
        two_runs::rows(Extent::asked()),
    );
}

#[test]
fn odd_files_and_places() {
    compared("odd files and places", odd_files::rows(Extent::asked()));
}

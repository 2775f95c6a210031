//! Replay of all kept inputs, `fuzz/corpus`, and of all inputs that once caused a failure,
//! `fuzz/regressions`, through the bodies of the fuzz targets, without a fuzzer and with the
//! toolchain of the workspace.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::expect_used,
    clippy::panic,
    unreachable_pub,
    reason = "a body fails by a panic, and is public to the programs that fuzz"
)]

use std::collections::BTreeSet;
use std::fs;
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};

#[path = "../../../fuzz/src/records/mod.rs"]
mod records;
#[path = "../../../fuzz/src/sheets/mod.rs"]
mod sheets;

fn fuzz() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz")
}

/// The files of a folder in the order of their names; none if the folder does not exist.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
}

/// Calls `body` with every kept input of `target`.
fn replay(target: &str, body: fn(&[u8])) {
    let corpus = files(&fuzz().join("corpus").join(target));
    assert!(!corpus.is_empty(), "no file in the corpus of {target}");
    let regressions = files(&fuzz().join("regressions").join(target));
    let broken: Vec<&PathBuf> = corpus
        .iter()
        .chain(&regressions)
        .filter(|path| {
            let bytes = fs::read(path).unwrap();
            catch_unwind(|| body(&bytes)).is_err()
        })
        .collect();
    assert!(broken.is_empty(), "{target} does not hold for {broken:#?}");
}

macro_rules! targets {
    ($($module:ident: $($target:ident)*;)*) => {
        $($(
            #[test]
            fn $target() {
                replay(stringify!($target), $module::$target);
            }
        )*)*

        /// Targets that are replayed.
        const TARGETS: &[&str] = &[$($(stringify!($target)),*),*];
    };
}

targets! {
    records: csv hdf5 isf lecroy lvm mat5 npy npz tdms uff58 wav wfm;
    sheets: ratio_table recognition response_table sheet unit;
}

/// Every fuzz target and every folder of inputs is replayed.
#[test]
fn every_target_is_replayed() {
    let names = |folder: &str| -> BTreeSet<String> {
        let paths = files(&fuzz().join(folder));
        let stems = paths.iter().filter_map(|path| path.file_stem());
        stems
            .map(|stem| stem.to_string_lossy().into_owned())
            .collect()
    };
    let replayed: BTreeSet<String> = TARGETS.iter().map(ToString::to_string).collect();
    assert_eq!(names("fuzz_targets"), replayed);
    assert_eq!(names("corpus"), replayed);
    assert!(names("regressions").is_subset(&replayed));
}

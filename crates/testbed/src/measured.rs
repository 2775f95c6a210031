//! Location of the measured records that tests read.

use std::path::{Path, PathBuf};

/// Returns the folder of measured records: the one named by `RODLAB_DATA` or, without the variable,
/// `../shared/data` next to the repository. If neither exists, prints to the standard error that
/// the test is skipped.
///
/// # Panics
///
/// If `RODLAB_DATA` does not name a folder.
#[allow(clippy::print_stderr, reason = "a skipped test prints a note")]
pub fn folder() -> Option<PathBuf> {
    if let Some(named) = std::env::var_os("RODLAB_DATA") {
        let named = PathBuf::from(named);
        assert!(
            named.is_dir(),
            "RODLAB_DATA names {}, which is not a folder",
            named.display()
        );
        return Some(named);
    }
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    if beside.is_dir() {
        return Some(beside);
    }
    let thread = std::thread::current();
    eprintln!(
        "skipped: {} needs measured records; RODLAB_DATA is not set, and {} is not a folder",
        thread.name().unwrap_or("a test"),
        beside.display()
    );
    None
}

//! Every measured file is recognised by its content as what its name says.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "tests: a panic is the report, and what is skipped is told"
)]

use std::fs;
use std::path::{Path, PathBuf};

use labio::format;

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, found);
        } else {
            found.push(path);
        }
    }
}

#[test]
fn measured_files_are_what_their_names_say() {
    let Some(folder) = std::env::var_os("RODLAB_DATA") else {
        println!("skipped: RODLAB_DATA is not set");
        return;
    };
    let mut found = Vec::new();
    files(Path::new(&folder), &mut found);
    let mut n_recognised = 0;
    for path in found {
        let expected = match path.extension().and_then(|extension| extension.to_str()) {
            Some("npy") => "npy",
            Some("lvm") => "lvm",
            Some("uff") => "uff58",
            Some("tdms") => "tdms",
            Some("csv") => "csv",
            _ => continue,
        };
        let bytes = fs::read(&path).unwrap();
        let name = format::recognise(&bytes).map(format::Reader::name);
        assert_eq!(name, Some(expected), "{}", path.display());
        n_recognised += 1;
    }
    // as many as stood there when this was written
    assert!(n_recognised >= 28, "{n_recognised} files");
}

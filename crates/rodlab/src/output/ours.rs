//! Files in a folder that belong to an earlier result. Only files that a result of this program
//! lists are counted.

use std::collections::BTreeSet;
use std::path::Path;

use serde::Deserialize;

use super::{FAILURE, PROGRAM, RESULT, RESULT_VERSION, is_plain};
use crate::input;

/// Returns the names listed in the `result.json` or `failure.json` at `path`, and the name of this
/// file itself. Returns `None` if the file was not written by this program, cannot be read, is a
/// link, or has a later version of the structure.
pub(super) fn listed(path: &Path) -> Option<BTreeSet<String>> {
    #[derive(Deserialize)]
    struct Listing {
        result_version: u32,
        software: String,
        files: Vec<String>,
    }
    let listing: Listing = read(path)?;
    let known = (1..=RESULT_VERSION).contains(&listing.result_version);
    if !known || !is_of_this_program(&listing.software) {
        return None;
    }
    let own = path.file_name()?.to_str()?.to_owned();
    let mut files: BTreeSet<String> = listing.files.into_iter().filter(|f| is_plain(f)).collect();
    files.insert(own);
    Some(files)
}

/// Returns true if this program wrote the summary at `path`.
pub(super) fn is_summary(path: &Path) -> bool {
    #[derive(Deserialize)]
    struct Signed {
        software: String,
    }
    read::<Signed>(path).is_some_and(|signed| is_of_this_program(&signed.software))
}

/// Returns true if `folder` contains a result or a failure written by this program.
pub(crate) fn holds_result(folder: &Path) -> bool {
    [RESULT, FAILURE]
        .iter()
        .any(|name| listed(&folder.join(name)).is_some())
}

fn read<T: serde::de::DeserializeOwned>(path: &Path) -> Option<T> {
    // links are not followed: they may lead to a result in another folder
    path.symlink_metadata()
        .ok()
        .filter(|found| found.is_file())?;
    serde_json::from_slice(&input::read(path).ok()?).ok()
}

/// Returns true if `software` is the name of this program and a version, such as `rodlab 0.1.0`.
fn is_of_this_program(software: &str) -> bool {
    let version = software
        .strip_prefix(PROGRAM)
        .and_then(|rest| rest.strip_prefix(' '));
    let number = |part: &str| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit());
    version.is_some_and(|version| {
        let mut parts = version.splitn(3, '.');
        parts.next().is_some_and(number)
            && parts.next().is_some_and(number)
            && parts
                .next()
                .is_some_and(|patch| patch.starts_with(|c: char| c.is_ascii_digit()))
    })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::output::SOFTWARE;

    #[test]
    fn r19_only_a_result_of_this_program_says_which_files_are_its_own() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(RESULT);
        let of = |text: String| {
            fs::write(&path, text).unwrap();
            listed(&path)
        };
        let own = format!(
            r#"{{"result_version": 1, "software": "{SOFTWARE}", "files": ["a.csv", "../b.csv"]}}"#
        );
        let names = of(own.clone()).unwrap();
        assert!(names.iter().eq(["a.csv", RESULT]), "{names:?}");
        for foreign in [
            "{}".to_owned(),
            "not JSON".to_owned(),
            r#"{"files": ["a.csv"]}"#.to_owned(),
            own.replace(SOFTWARE, "rodlab"),
            own.replace(SOFTWARE, "rodlabel 1.0.0"),
            own.replace(SOFTWARE, "other 0.1.0"),
            own.replace("\"result_version\": 1", "\"result_version\": 999"),
            own.replace("\"result_version\": 1, ", ""),
        ] {
            assert_eq!(of(foreign.clone()), None, "{foreign}");
        }
    }
}

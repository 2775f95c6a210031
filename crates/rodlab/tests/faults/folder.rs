//! Files of a folder, and the check that they are those of one run.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Files below a folder, by their paths relative to it.
pub(crate) type Files = BTreeMap<PathBuf, Vec<u8>>;

/// All files below `folder`; none if it does not exist.
pub(crate) fn files_in(folder: &Path) -> Files {
    fn collect(folder: &Path, root: &Path, found: &mut Files) {
        for entry in fs::read_dir(folder).into_iter().flatten() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                collect(&path, root, found);
            } else {
                let name = path.strip_prefix(root).unwrap().to_path_buf();
                found.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    let mut found = Files::new();
    collect(folder, folder, &mut found);
    found
}

pub(crate) fn put(folder: &Path, files: &Files) {
    fs::create_dir_all(folder).unwrap();
    for (name, bytes) in files {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
}

/// Returns true for the name of a temporary file.
fn is_temporary(name: &Path) -> bool {
    let name = name.file_name().unwrap().to_string_lossy();
    name.starts_with(".rodlab-")
}

/// Returns an error unless every file with a final name equals that of one of `results` and, if
/// there is a `result.json`, all files belong to the same result.
pub(crate) fn is_whole(now: &Files, results: &[&Files]) -> Result<(), String> {
    let finals: Files = now
        .iter()
        .filter(|(name, _)| !is_temporary(name))
        .map(|(name, bytes)| (name.clone(), bytes.clone()))
        .collect();
    for (name, bytes) in &finals {
        if !results.iter().any(|files| files.get(name) == Some(bytes)) {
            return Err(format!("{} does not belong to any result", name.display()));
        }
    }
    if finals.contains_key(Path::new("result.json"))
        && !results.iter().any(|files| **files == finals)
    {
        let names: Vec<_> = finals.keys().collect();
        return Err(format!(
            "files of several runs, or not all of one: {names:?}"
        ));
    }
    Ok(())
}

/// Returns the first difference between two folders.
pub(crate) fn difference(now: &Files, expected: &Files) -> Option<String> {
    if !now.keys().eq(expected.keys()) {
        let (now, expected): (Vec<_>, Vec<_>) = (now.keys().collect(), expected.keys().collect());
        return Some(format!("{now:?}, expected {expected:?}"));
    }
    let other = now
        .iter()
        .find(|(name, bytes)| expected[*name] != **bytes)?;
    Some(format!("{} differs", other.0.display()))
}

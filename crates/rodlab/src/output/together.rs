//! Files of a folder that are replaced together: all of a run, or those of the run before.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde::Deserialize;
use tempfile::NamedTempFile;

use super::lock::FolderLock;
use super::{FAILURE, PART, RESULT, is_plain, named, on_disk, refusal, written};
use crate::{RodlabError, input};

/// Puts the files of a result into `folder`; `reads` are those that the run has read.
///
/// Everything is on the disk before the first file changes. Then `result.json` and `failure.json` of an earlier run go, with its
/// files that the new one has not, and the new ones come in their order: where a `result.json` is, all files are of one run.
pub(crate) fn replace_result(
    folder: &Path,
    files: &[(String, Vec<u8>)],
    reads: &[PathBuf],
) -> Result<Vec<PathBuf>, RodlabError> {
    let mut lock = locked(folder)?;
    let earlier = Earlier::of(folder, lock.listed()?);
    let new: BTreeSet<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    let stale: Vec<&str> = earlier
        .files
        .iter()
        .map(String::as_str)
        .filter(|name| !new.contains(name) && folder.join(name).is_file())
        .collect();
    for name in new.iter().chain(&stale) {
        let path = folder.join(name);
        may_change(&path, reads)?;
        if !earlier.has(name) && path.symlink_metadata().is_ok() {
            return Err(RodlabError::Taken { path });
        }
    }
    let staged = stage(folder, files)?;
    lock.list(new.iter().chain(&stale).copied())?;
    // from here on the folder is not complete
    for name in [RESULT, FAILURE].into_iter().chain(stale.iter().copied()) {
        remove(&folder.join(name))?;
    }
    let paths = name_all(folder, files, staged)?;
    lock.done();
    Ok(paths)
}

/// Puts a `failure.json` into `folder` in place of a `result.json`. The other files of the earlier result stay, and `text` is told their
/// names: where a disk with recordings was away, the report of last week is all there is.
pub(crate) fn replace_by_failure(
    folder: &Path,
    text: impl FnOnce(Vec<String>) -> Result<Vec<u8>, RodlabError>,
) -> Result<(), RodlabError> {
    let mut lock = locked(folder)?;
    let earlier = Earlier::of(folder, lock.listed()?);
    let others: Vec<String> = earlier
        .files
        .into_iter()
        .filter(|name| ![RESULT, FAILURE].contains(&name.as_str()) && folder.join(name).is_file())
        .collect();
    let failure = [(FAILURE.to_owned(), text(others.clone())?)];
    for name in [RESULT, FAILURE] {
        may_change(&folder.join(name), &[])?;
    }
    let staged = stage(folder, &failure)?;
    lock.list(others.iter().map(String::as_str))?;
    remove(&folder.join(RESULT))?;
    name_all(folder, &failure, staged)?;
    lock.done();
    Ok(())
}

/// Puts `files` into `folder` in place of those of the same names.
pub(crate) fn replace_files(
    folder: &Path,
    files: &[(String, Vec<u8>)],
) -> Result<Vec<PathBuf>, RodlabError> {
    let _lock = locked(folder)?;
    for (name, _) in files {
        may_change(&folder.join(name), &[])?;
    }
    let staged = stage(folder, files)?;
    name_all(folder, files, staged)
}

fn remove(path: &Path) -> Result<(), RodlabError> {
    match fs::remove_file(path) {
        Err(source) if source.kind() != ErrorKind::NotFound => Err(refusal(path, source)),
        _ => Ok(()),
    }
}

fn locked(folder: &Path) -> Result<FolderLock, RodlabError> {
    fs::create_dir_all(folder).map_err(|source| refusal(&folder.join(RESULT), source))?;
    let lock = FolderLock::of(folder)?;
    remove_parts(folder);
    Ok(lock)
}

/// Removes what runs that were ended have left under temporary names: nobody else writes here now.
fn remove_parts(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries {
        if entry.file_name().to_string_lossy().starts_with(PART) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// All files on the disk under temporary names.
fn stage(folder: &Path, files: &[(String, Vec<u8>)]) -> Result<Vec<NamedTempFile>, RodlabError> {
    let staged: Vec<NamedTempFile> = files
        .iter()
        .map(|(name, bytes)| written(&folder.join(name), bytes, PART))
        .collect::<Result<_, _>>()?;
    // a disk that is asked for two at a time writes its journal once for both
    let on_disk: Vec<Result<(), RodlabError>> = files
        .par_iter()
        .zip(&staged)
        .map(|((name, _), file)| on_disk(file, &folder.join(name)))
        .collect();
    on_disk.into_iter().collect::<Result<(), _>>()?;
    Ok(staged)
}

fn name_all(
    folder: &Path,
    files: &[(String, Vec<u8>)],
    staged: Vec<NamedTempFile>,
) -> Result<Vec<PathBuf>, RodlabError> {
    let mut paths = Vec::with_capacity(files.len());
    for ((name, _), file) in files.iter().zip(staged) {
        let path = folder.join(name);
        named(file, &path)?;
        paths.push(path);
    }
    // that the names outlast a power failure too; not every file system has it
    #[cfg(unix)]
    let _ = fs::File::open(folder).and_then(|folder| folder.sync_all());
    Ok(paths)
}

/// Refuses to touch what the run has read, and what somebody has protected.
fn may_change(path: &Path, reads: &[PathBuf]) -> Result<(), RodlabError> {
    let Ok(found) = path.symlink_metadata() else {
        return Ok(());
    };
    if let Ok(real) = path.canonicalize()
        && reads
            .iter()
            .any(|read| read.canonicalize().is_ok_and(|read| read == real))
    {
        return Err(RodlabError::OverInput {
            path: path.to_path_buf(),
        });
    }
    if found.is_file() && found.permissions().readonly() {
        let source = io::Error::new(ErrorKind::PermissionDenied, "the file is read-only");
        return Err(refusal(path, source));
    }
    Ok(())
}

/// What an earlier run has left in a folder.
struct Earlier {
    files: BTreeSet<String>,
    /// Whether there is a result that does not list its files, so that any file may be one of them.
    unlisted: bool,
}

impl Earlier {
    /// By its `result.json` or `failure.json`, and by the list of a run that was ended.
    fn of(folder: &Path, listed: BTreeSet<String>) -> Self {
        #[derive(Deserialize)]
        struct Listing {
            files: Option<Vec<String>>,
        }
        let mut files = listed;
        let mut unlisted = false;
        for name in [RESULT, FAILURE] {
            let Ok(text) = input::read(&folder.join(name)) else {
                continue;
            };
            let listing: Option<Listing> = serde_json::from_slice(&text).ok();
            match listing.and_then(|listing| listing.files) {
                Some(names) => files.extend(names.into_iter().filter(|name| is_plain(name))),
                None => unlisted = true,
            }
        }
        files.extend([RESULT, FAILURE].map(str::to_owned));
        Self { files, unlisted }
    }

    fn has(&self, name: &str) -> bool {
        self.unlisted || self.files.contains(name)
    }
}

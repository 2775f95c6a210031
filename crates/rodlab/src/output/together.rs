//! Replacement of the files of a folder together, so that all files belong to one run, either the
//! new run or the earlier one.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::thread;

use tempfile::NamedTempFile;

use super::lock::FolderLock;
use super::{EARLIER_REPORT, FAILURE, PART, REPORT, RESULT, named, on_disk, ours, written};
use crate::RodlabError;

/// Number of files synchronised with the disk at a time.
const AT_A_TIME: usize = 4;

/// Writes the files of a result to `folder`; `reads` are the files that the run has read.
///
/// All files are on the disk under temporary names before the first existing file changes. Then
/// `result.json` and `failure.json` of an earlier run are removed, together with the files of that
/// run that the new run does not write. Finally the new files get their names in order. If a
/// `result.json` exists, all files therefore belong to one run.
pub(crate) fn replace_result(
    folder: &Path,
    files: &[(&str, &[u8])],
    reads: &[PathBuf],
) -> Result<Vec<PathBuf>, RodlabError> {
    let mut lock = locked(folder)?;
    let earlier = Earlier::result(folder, lock.listed()?);
    let new: BTreeSet<&str> = files.iter().map(|(name, _)| *name).collect();
    let stale: Vec<&str> = earlier
        .files
        .iter()
        .map(String::as_str)
        .filter(|name| !new.contains(name) && folder.join(name).is_file())
        .collect();
    for name in new.iter().chain(&stale).chain(&[FAILURE]) {
        earlier.may_change(&folder.join(name), name, reads)?;
    }
    let staged = stage(folder, files)?;
    lock.list(new.iter().chain(&stale).copied())?;
    // from here on the folder is incomplete
    for name in [RESULT, FAILURE].into_iter().chain(stale.iter().copied()) {
        remove(&folder.join(name))?;
    }
    let paths = name_all(folder, files, staged)?;
    lock.done();
    Ok(paths)
}

/// Puts a `failure.json` into `folder` in place of a `result.json`. The report of the earlier
/// result is renamed [`EARLIER_REPORT`], the other files of this result stay as they are, and
/// `text` receives the names of all these files. They are kept because the failure may only be due
/// to a missing disk with the recordings.
pub(crate) fn replace_by_failure(
    folder: &Path,
    text: impl FnOnce(Vec<String>) -> Result<Vec<u8>, RodlabError>,
) -> Result<(), RodlabError> {
    let mut lock = locked(folder)?;
    let earlier = Earlier::result(folder, lock.listed()?);
    let mut others: BTreeSet<String> = earlier
        .files
        .iter()
        .filter(|name| ![RESULT, FAILURE].contains(&name.as_str()) && folder.join(name).is_file())
        .cloned()
        .collect();
    let renamed = others.remove(REPORT);
    if renamed {
        others.insert(EARLIER_REPORT.to_owned());
    }
    let changed = [REPORT, EARLIER_REPORT];
    let changed = changed.into_iter().filter(|_| renamed);
    for name in [RESULT, FAILURE].into_iter().chain(changed) {
        earlier.may_change(&folder.join(name), name, &[])?;
    }
    let text = text(others.iter().cloned().collect())?;
    let failure = [(FAILURE, text.as_slice())];
    let staged = stage(folder, &failure)?;
    let listed = others.iter().map(String::as_str).chain([REPORT, FAILURE]);
    lock.list(listed.filter(|name| renamed || *name != REPORT))?;
    remove(&folder.join(RESULT))?;
    if renamed {
        let new = folder.join(EARLIER_REPORT);
        fs::rename(folder.join(REPORT), &new).map_err(|source| RodlabError::write(&new, source))?;
    }
    name_all(folder, &failure, staged)?;
    lock.done();
    Ok(())
}

/// Puts the `files` of a summary into `folder`, in place of the files of an earlier summary. The
/// file called `signed` names this program.
pub(crate) fn replace_summary(
    folder: &Path,
    files: &[(&str, &[u8])],
    signed: &str,
) -> Result<Vec<PathBuf>, RodlabError> {
    let mut lock = locked(folder)?;
    let mut earlier = Earlier {
        files: lock.listed()?,
    };
    let names = || files.iter().map(|(name, _)| *name);
    if ours::is_summary(&folder.join(signed)) {
        earlier.files.extend(names().map(str::to_owned));
    }
    for name in names() {
        earlier.may_change(&folder.join(name), name, &[])?;
    }
    let staged = stage(folder, files)?;
    lock.list(names())?;
    let paths = name_all(folder, files, staged)?;
    lock.done();
    Ok(paths)
}

fn remove(path: &Path) -> Result<(), RodlabError> {
    match fs::remove_file(path) {
        Err(source) if source.kind() != ErrorKind::NotFound => {
            Err(RodlabError::write(path, source))
        }
        _ => Ok(()),
    }
}

fn locked(folder: &Path) -> Result<FolderLock, RodlabError> {
    if folder.is_file() {
        let source = io::Error::new(ErrorKind::NotADirectory, "it is a file, expected a folder");
        return Err(RodlabError::write(folder, source));
    }
    fs::create_dir_all(folder)
        .map_err(|source| RodlabError::write(&folder.join(RESULT), source))?;
    let lock = FolderLock::of(folder)?;
    remove_parts(folder);
    Ok(lock)
}

/// Removes temporary files of runs that ended early. Because of the lock, no other run is writing
/// to the folder.
fn remove_parts(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries {
        if entry.file_name().to_string_lossy().starts_with(PART) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Writes all files to the disk under temporary names.
fn stage(folder: &Path, files: &[(&str, &[u8])]) -> Result<Vec<NamedTempFile>, RodlabError> {
    let staged: Vec<NamedTempFile> = files
        .iter()
        .map(|(name, bytes)| written(&folder.join(name), bytes, PART))
        .collect::<Result<_, _>>()?;
    // Several files are synchronised at a time, because the file system then writes its journal
    // once for all of them. Threads of a pool are not used: they would start other tests while they
    // wait, and keep this folder locked meanwhile.
    let share = files.len().div_ceil(AT_A_TIME).max(1);
    thread::scope(|scope| {
        let waiting: Vec<_> = files
            .chunks(share)
            .zip(staged.chunks(share))
            .map(|(files, staged)| {
                scope.spawn(move || {
                    files
                        .iter()
                        .zip(staged)
                        .try_for_each(|((name, _), file)| on_disk(file, &folder.join(name)))
                })
            })
            .collect();
        waiting.into_iter().try_for_each(|thread| {
            thread
                .join()
                .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        })
    })?;
    Ok(staged)
}

fn name_all(
    folder: &Path,
    files: &[(&str, &[u8])],
    staged: Vec<NamedTempFile>,
) -> Result<Vec<PathBuf>, RodlabError> {
    let mut paths = Vec::with_capacity(files.len());
    for ((name, _), file) in files.iter().zip(staged) {
        let path = folder.join(name);
        named(file, &path)?;
        paths.push(path);
    }
    // protects the names against a power failure, too; not every file system supports this
    #[cfg(unix)]
    let _ = fs::File::open(folder).and_then(|folder| folder.sync_all());
    Ok(paths)
}

/// Refuses to change a file that the run has read, or that is read-only.
pub(super) fn may_change(path: &Path, reads: &[PathBuf]) -> Result<(), RodlabError> {
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
        return Err(RodlabError::write(path, source));
    }
    Ok(())
}

/// Files in a folder that may be replaced because an earlier run wrote them.
struct Earlier {
    files: BTreeSet<String>,
}

impl Earlier {
    /// Returns the files of the result in `folder`: those listed in its `result.json` or
    /// `failure.json`, and those `listed` by an unfinished run.
    fn result(folder: &Path, listed: BTreeSet<String>) -> Self {
        let mut files = listed;
        for name in [RESULT, FAILURE] {
            files.extend(ours::listed(&folder.join(name)).into_iter().flatten());
        }
        Self { files }
    }

    /// Refuses to change the file `name` at `path` if it does not belong to an earlier result, is
    /// read-only, or was read by the run.
    fn may_change(&self, path: &Path, name: &str, reads: &[PathBuf]) -> Result<(), RodlabError> {
        may_change(path, reads)?;
        if !self.files.contains(name) && path.symlink_metadata().is_ok() {
            return Err(RodlabError::Taken {
                path: path.to_path_buf(),
            });
        }
        Ok(())
    }
}

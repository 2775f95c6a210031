//! Lock of a folder for one writer at a time, with a list of the files being replaced.
//!
//! The lock is a lock of the operating system on a file in the folder. It is released however the
//! process ends, so that no stale lock remains. The file also lists the names of the files that are
//! being replaced. It is removed when a result is complete. If a run ends before that, the next run
//! finds in it the names of the files that the unfinished run may have written.

use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use super::gate::{self, Passage};
use crate::RodlabError;

pub(super) const NAME: &str = ".rodlab-lock";

/// Longest wait for another run to put its files into the folder, which normally takes some
/// milliseconds.
const PATIENCE: Duration = Duration::from_secs(30);
const PAUSE: Duration = Duration::from_millis(10);

/// Right to change a folder; it lasts until it is dropped.
#[derive(Debug)]
pub(super) struct FolderLock {
    path: PathBuf,
    file: File,
    /// True while the list is still needed.
    unfinished: bool,
    /// Dropped last, after the lock file has been removed.
    _passage: Passage<'static>,
}

impl FolderLock {
    /// Waits until no other run changes the existing `folder`.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Busy`] if another run changes the folder for too long; [`RodlabError::Write`]
    /// if the lock file cannot be written; [`RodlabError::Interrupted`] if the program is ending.
    pub(super) fn of(folder: &Path) -> Result<Self, RodlabError> {
        Self::within(PATIENCE, folder)
    }

    fn within(patience: Duration, folder: &Path) -> Result<Self, RodlabError> {
        let path = folder.join(NAME);
        let fail = |source| RodlabError::write(&path, source);
        let began = Instant::now();
        loop {
            let passage = gate::pass()?;
            let file = OpenOptions::new()
                .read(true)
                .write(true)
                .create(true)
                .truncate(false)
                .open(&path)
                .map_err(fail)?;
            match file.try_lock() {
                Ok(()) if is_at(&file, &path) => return Self::taken(path, file, passage),
                // the previous owner removed the file after it was opened here
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    if began.elapsed() > patience {
                        return Err(RodlabError::Busy {
                            folder: folder.to_path_buf(),
                            owner: owner(&path),
                        });
                    }
                    drop(passage);
                    thread::sleep(PAUSE);
                }
                // on a file system without locks each file is still complete, but the files of two
                // simultaneous runs may be mixed
                Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => {
                    return Self::taken(path, file, passage);
                }
                Err(TryLockError::Error(error)) => return Err(fail(error)),
            }
        }
    }

    fn taken(path: PathBuf, file: File, passage: Passage<'static>) -> Result<Self, RodlabError> {
        let mut lock = Self {
            path,
            file,
            unfinished: true,
            _passage: passage,
        };
        lock.unfinished = !lock.listed()?.is_empty();
        lock.sign()?;
        Ok(lock)
    }

    /// Returns the names listed by a run that did not finish.
    pub(super) fn listed(&mut self) -> Result<BTreeSet<String>, RodlabError> {
        let mut bytes = Vec::new();
        self.file
            .seek(SeekFrom::Start(0))
            .and_then(|_| self.file.read_to_end(&mut bytes))
            .map_err(|source| RodlabError::write(&self.path, source))?;
        let text = String::from_utf8_lossy(&bytes);
        // the first line names the owner; a last line without a line ending is incomplete
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        Ok(whole
            .lines()
            .skip(1)
            .filter(|name| super::is_plain(name))
            .map(str::to_owned)
            .collect())
    }

    /// Lists `names` before the first of them changes.
    pub(super) fn list<'n>(
        &mut self,
        names: impl Iterator<Item = &'n str>,
    ) -> Result<(), RodlabError> {
        // the text begins with a line ending, because the line before it may have none
        let text: String = std::iter::once("")
            .chain(names)
            .map(|name| format!("{name}\n"))
            .collect();
        self.file
            .seek(SeekFrom::End(0))
            .and_then(|_| self.file.write_all(text.as_bytes()))
            .and_then(|()| self.file.sync_all())
            .map_err(|source| RodlabError::write(&self.path, source))?;
        self.unfinished = true;
        Ok(())
    }

    /// Marks all listed files as complete.
    pub(super) fn done(mut self) {
        self.unfinished = false;
    }

    /// Writes the owner over the first line, which has a fixed length.
    fn sign(&mut self) -> Result<(), RodlabError> {
        let line = format!("process {:>10}\n", std::process::id());
        self.file
            .seek(SeekFrom::Start(0))
            .and_then(|_| self.file.write_all(line.as_bytes()))
            .map_err(|source| RodlabError::write(&self.path, source))
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        if !self.unfinished {
            // the file is removed while it is locked, so that a waiting run notices that its file
            // is no longer the one at this path
            let _ = fs::remove_file(&self.path);
        }
    }
}

fn is_at(file: &File, path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let number = |found: io::Result<fs::Metadata>| found.map(|m| (m.dev(), m.ino())).ok();
        number(fs::metadata(path)) == number(file.metadata())
    }
    #[cfg(not(unix))]
    {
        // on this system an open file cannot be replaced
        let _ = file;
        path.exists()
    }
}

/// Returns the owner of the lock, as written in the file.
fn owner(path: &Path) -> String {
    fs::read_to_string(path)
        .ok()
        .and_then(|text| text.lines().next().map(str::to_owned))
        .map(|line| line.split_whitespace().collect::<Vec<_>>().join(" "))
        .filter(|line| !line.is_empty())
        .unwrap_or_else(|| "another process".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_leaves_nothing_and_one_that_was_not_finished_leaves_its_list() {
        let folder = tempfile::tempdir().unwrap();
        let names = ["force.csv", "result.json"];
        drop(FolderLock::of(folder.path()).unwrap());
        assert!(!folder.path().join(NAME).exists());

        let mut lock = FolderLock::of(folder.path()).unwrap();
        lock.list(names.into_iter()).unwrap();
        drop(lock); // as if the process had ended
        let mut lock = FolderLock::of(folder.path()).unwrap();
        assert!(lock.listed().unwrap().iter().eq(names));
        lock.list(["force.svg"].into_iter()).unwrap();
        assert_eq!(lock.listed().unwrap().len(), 3);
        lock.done();
        assert!(!folder.path().join(NAME).exists());
    }

    #[test]
    fn a_name_that_was_not_written_to_its_end_is_none() {
        let folder = tempfile::tempdir().unwrap();
        let text = "process          1\n\nforce.csv\n../../precious\nresu";
        fs::write(folder.path().join(NAME), text).unwrap();
        let mut lock = FolderLock::of(folder.path()).unwrap();
        assert!(lock.listed().unwrap().iter().eq(["force.csv"]));
        lock.list(["result.json"].into_iter()).unwrap();
        // the incomplete name `resu` now has a line ending and is listed too; no file has this name
        assert!(lock.listed().unwrap().contains("result.json"));
    }

    #[test]
    fn who_has_waited_too_long_is_told_for_whom() {
        let folder = tempfile::tempdir().unwrap();
        let _first = FolderLock::of(folder.path()).unwrap();
        let said = FolderLock::within(2 * PAUSE, folder.path())
            .unwrap_err()
            .to_string();
        let owner = format!("by another run (process {})", std::process::id());
        assert!(said.contains(&owner), "{said}");
    }

    #[test]
    fn who_comes_second_waits() {
        let folder = tempfile::tempdir().unwrap();
        let first = FolderLock::of(folder.path()).unwrap();
        let place = folder.path().to_path_buf();
        let second = thread::spawn(move || FolderLock::of(&place).map(|_| Instant::now()));
        thread::sleep(Duration::from_millis(50));
        assert!(!second.is_finished());
        let freed = Instant::now();
        drop(first);
        assert!(second.join().unwrap().unwrap() >= freed);
    }
}

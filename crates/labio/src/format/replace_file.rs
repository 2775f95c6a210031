//! Atomic replacement of a file: at any time, the path has either the old file or the complete new
//! one.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process;

use crate::LabioError;
use crate::error::not_written;

/// Number of names tried before giving up: a name is in use only by another writer of this process
/// or by a leftover file.
const ATTEMPTS: u32 = 1000;

/// Passes `write` a new file in the folder of `path`, and renames it to `path` after everything is
/// on the disk; if an error occurs, removes the new file.
pub(super) fn replace(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> Result<(), LabioError>,
) -> Result<(), LabioError> {
    let (temporary, file) = create_beside(path).map_err(not_written)?;
    let mut output = BufWriter::new(file);
    let written = write(&mut output)
        .and_then(|()| {
            output
                .into_inner()
                .map_err(|error| not_written(error.into_error()))
        })
        .and_then(|file| file.sync_all().map_err(not_written))
        .and_then(|()| fs::rename(&temporary, path).map_err(not_written));
    if written.is_err() {
        // the first error is the one to report
        let _ = fs::remove_file(&temporary);
    }
    written
}

fn create_beside(path: &Path) -> io::Result<(PathBuf, File)> {
    let name = path
        .file_name()
        .ok_or_else(|| io::Error::new(ErrorKind::InvalidInput, "the path has no file name"))?;
    for attempt in 0..ATTEMPTS {
        let mut temporary = OsString::from(".");
        temporary.push(name);
        temporary.push(format!(".{}-{attempt}.part", process::id()));
        let temporary = path.with_file_name(temporary);
        match OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(&temporary)
        {
            Ok(file) => return Ok((temporary, file)),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    Err(io::Error::new(
        ErrorKind::AlreadyExists,
        "every temporary name is taken",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<OsString> {
        fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name())
            .collect()
    }

    #[test]
    fn a_file_is_replaced_when_all_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("record.uff");
        fs::write(&path, b"old").unwrap();
        replace(&path, |output| {
            output.write_all(b"new").unwrap();
            assert_eq!(fs::read(&path).unwrap(), b"old");
            Ok(())
        })
        .unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["record.uff"]);
    }

    #[test]
    fn an_error_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("record.uff");
        fs::write(&path, b"old").unwrap();
        let error = replace(&path, |output| {
            output.write_all(b"half").unwrap();
            Err(LabioError::NoData { format: "uff58" })
        });
        assert!(error.is_err());
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["record.uff"]);
    }

    #[test]
    fn two_writers_do_not_meet() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("record.uff");
        replace(&path, |outer| {
            replace(&path, |inner| {
                inner.write_all(b"inner").unwrap();
                Ok(())
            })?;
            outer.write_all(b"outer").unwrap();
            Ok(())
        })
        .unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"outer");
    }
}

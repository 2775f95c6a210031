//! Reading of regular files only, because opening a pipe without a writer would block forever.

use std::fs::{self, FileType};
use std::path::Path;

use crate::RodlabError;

/// Reads all bytes of the file at `path`.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, RodlabError> {
    of_a_file(path)?;
    fs::read(path).map_err(|source| RodlabError::read(path, source))
}

/// Reads the whole text of the file at `path`.
pub(crate) fn read_text(path: &Path) -> Result<String, RodlabError> {
    of_a_file(path)?;
    fs::read_to_string(path).map_err(|source| RodlabError::read(path, source))
}

fn of_a_file(path: &Path) -> Result<(), RodlabError> {
    let kind = fs::metadata(path)
        .map_err(|source| RodlabError::read(path, source))?
        .file_type();
    if kind.is_file() {
        return Ok(());
    }
    Err(RodlabError::NoRegularFile {
        path: path.to_path_buf(),
        found: name_of(kind),
    })
}

fn name_of(kind: FileType) -> &'static str {
    if kind.is_dir() {
        return "a folder";
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if kind.is_fifo() {
            return "a pipe";
        }
        if kind.is_socket() {
            return "a socket";
        }
        if kind.is_char_device() || kind.is_block_device() {
            return "a device";
        }
    }
    "not a regular file"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let said = read(folder.path()).unwrap_err().to_string();
        assert!(said.ends_with("it is a folder, expected a file"), "{said}");
    }
}

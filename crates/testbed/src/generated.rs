//! Writing and checking of generated files. A file is written completely or not at all, and one
//! function writes it or checks it.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Reason why a generated file is wrong.
#[derive(Debug, thiserror::Error)]
pub enum GeneratedError {
    /// The file differs from what the task would write.
    #[error("{} is not current at line {line}: run `{command}` and review the difference", path.display())]
    Stale {
        path: PathBuf,
        line: usize,
        command: &'static str,
    },
    /// The file does not exist.
    #[error("{} does not exist: run `{command}`", path.display())]
    Missing {
        path: PathBuf,
        command: &'static str,
    },
    /// The file could not be read or written.
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: io::Error },
}

/// Returns the root of the workspace, independent of the current folder.
pub fn workspace_root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .unwrap_or(Path::new("."))
}

/// Writes `contents` to `path` through a temporary file in the same folder, so that `path` never
/// contains a part of them.
pub fn write_whole(path: &Path, contents: &str) -> Result<(), GeneratedError> {
    let fail = |source| GeneratedError::Io {
        path: path.to_path_buf(),
        source,
    };
    let folder = path.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(folder).map_err(fail)?;
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        // the usual permissions of a new file, to which the umask applies; a temporary file has
        // none for others
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder).map_err(fail)?;
    file.write_all(contents.as_bytes()).map_err(fail)?;
    file.persist(path).map_err(|error| fail(error.error))?;
    Ok(())
}

/// Writes `contents` to `path`. With `check`, nothing is written: the function fails if the file
/// differs and names the `command` to run.
pub fn ensure_file_contents(
    path: &Path,
    contents: &str,
    check: bool,
    command: &'static str,
) -> Result<(), GeneratedError> {
    let found = match fs::read_to_string(path) {
        Ok(text) => Some(text.replace("\r\n", "\n")),
        Err(error) if error.kind() == io::ErrorKind::NotFound => None,
        Err(source) => {
            return Err(GeneratedError::Io {
                path: path.to_path_buf(),
                source,
            });
        }
    };
    match found {
        Some(text) if text == contents => Ok(()),
        _ if !check => write_whole(path, contents),
        None => Err(GeneratedError::Missing {
            path: path.to_path_buf(),
            command,
        }),
        Some(text) => Err(GeneratedError::Stale {
            path: path.to_path_buf(),
            line: 1 + text
                .lines()
                .zip(contents.lines())
                .take_while(|(a, b)| a == b)
                .count(),
            command,
        }),
    }
}

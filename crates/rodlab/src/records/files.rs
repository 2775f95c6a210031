//! Files found by the patterns of a sheet.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::RodlabError;

/// A file, with the first of the names or patterns that match it.
pub(super) struct FoundFile<'a> {
    pub(super) path: PathBuf,
    pub(super) pattern: &'a str,
}

/// Returns the files of all patterns, each once; `field` is the place of the patterns in the sheet.
pub(super) fn paths<'a>(
    patterns: &'a [String],
    folder: &Path,
    field: &str,
) -> Result<Vec<FoundFile<'a>>, RodlabError> {
    if patterns.is_empty() {
        return Err(RodlabError::request(
            field,
            "empty",
            "the name of at least one file",
        ));
    }
    let mut seen = BTreeSet::new();
    let mut paths = Vec::new();
    for pattern in patterns {
        let plain = folder.join(pattern);
        let found = if plain.exists() {
            vec![plain]
        } else {
            let Some(folder_text) = folder.to_str() else {
                return Err(RodlabError::request(
                    field,
                    format!(
                        "the pattern `{pattern}` in {}, whose name is not Unicode",
                        folder.display()
                    ),
                    "the names of the files, or a folder with a name in Unicode",
                ));
            };
            let escaped = glob::Pattern::escape(folder_text);
            let wanted = Path::new(&escaped).join(pattern);
            let listed = glob::glob(&wanted.to_string_lossy()).map_err(|error| {
                RodlabError::request(
                    field,
                    format!("`{pattern}`: {}", error.msg),
                    "a name or a pattern",
                )
            })?;
            let mut found: Vec<PathBuf> =
                listed
                    .collect::<Result<_, _>>()
                    .map_err(|error| RodlabError::Read {
                        path: error.path().to_path_buf(),
                        source: error.into(),
                    })?;
            found.sort();
            found
        };
        if found.is_empty() {
            return Err(RodlabError::NoFile {
                pattern: pattern.clone(),
                folder: folder.to_path_buf(),
                field: field.to_owned(),
            });
        }
        let new = found.into_iter().filter(|path| seen.insert(path.clone()));
        paths.extend(new.map(|path| FoundFile { path, pattern }));
    }
    Ok(paths)
}

/// Returns `path` relative to `folder`, with slashes.
pub(super) fn relative(path: &Path, folder: &Path) -> String {
    let short = path.strip_prefix(folder).unwrap_or(path);
    short.to_string_lossy().replace('\\', "/")
}

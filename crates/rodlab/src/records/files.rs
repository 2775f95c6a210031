//! Files found by the patterns of a sheet.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::RodlabError;
use crate::sheet::nearest;

/// A file, with the first of the names or patterns that match it.
pub(super) struct FoundFile<'a> {
    pub(super) path: PathBuf,
    pub(super) pattern: &'a str,
    /// Index of the pattern in its list.
    pub(super) entry: usize,
}

/// Returns the files of all patterns, each once; `field` is the place of the patterns in the sheet.
pub(super) fn paths<'a>(
    patterns: &'a [String],
    folder: &Path,
    field: &str,
) -> Result<Vec<FoundFile<'a>>, RodlabError> {
    RodlabError::refuse_empty(patterns, field, "the name of at least one file")?;
    let mut seen = BTreeSet::new();
    let mut paths = Vec::new();
    for (entry, pattern) in patterns.iter().enumerate() {
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
            let mut found: Vec<PathBuf> = listed
                .collect::<Result<_, _>>()
                .map_err(RodlabError::listing)?;
            found.sort();
            found
        };
        if found.is_empty() {
            return Err(RodlabError::NoFile {
                pattern: pattern.clone(),
                folder: folder.to_path_buf(),
                field: field.to_owned(),
                similar: similar_files(pattern, folder),
            });
        }
        let new = found.into_iter().filter(|path| seen.insert(path.clone()));
        paths.extend(new.map(|path| FoundFile {
            path,
            pattern,
            entry,
        }));
    }
    Ok(paths)
}

/// Returns the files of `folder` whose names are nearest to `pattern`, such as `hits-01.csv and 9
/// more`; `None` if no name is similar. Names that differ only in digits count as alike.
fn similar_files(pattern: &str, folder: &Path) -> Option<String> {
    let wanted = Path::new(pattern);
    let within = wanted.parent()?;
    let mut files: Vec<PathBuf> = fs::read_dir(folder.join(within))
        .ok()?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension() == wanted.extension() && path.is_file())
        .collect();
    files.sort();
    let forms: Vec<String> = files.iter().filter_map(|path| form(path)).collect();
    let meant = nearest(&form(wanted)?, &forms)?;
    let mut alike = files
        .iter()
        .filter(|path| form(path).as_ref() == Some(meant));
    let first = within.join(alike.next()?.file_name()?);
    let first = first.to_string_lossy().replace('\\', "/");
    Some(match alike.count() {
        0 => first,
        more => format!("{first} and {more} more"),
    })
}

/// Returns the name of a file, or a pattern, without extension, digits and wildcards.
fn form(path: &Path) -> Option<String> {
    let stem = path.file_stem()?.to_str()?;
    let is_letter = |c: &char| !c.is_ascii_digit() && !matches!(c, '*' | '?' | '[' | ']');
    Some(stem.chars().filter(is_letter).collect())
}

/// Returns `path` relative to `folder`, with slashes.
pub(super) fn relative(path: &Path, folder: &Path) -> String {
    let short = path.strip_prefix(folder).unwrap_or(path);
    short.to_string_lossy().replace('\\', "/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_without_a_match_names_similar_files() {
        let folder = tempfile::tempdir().unwrap();
        let here = folder.path();
        fs::create_dir(here.join("shots")).unwrap();
        for name in ["hits-01.csv", "hits-02.csv", "hits-10.csv", "shots/a.npy"] {
            fs::write(here.join(name), "").unwrap();
        }
        let all = Some("hits-01.csv and 2 more");
        for (pattern, expected) in [
            ("hit-*.csv", all),
            ("hits-3.csv", all),
            ("hits-*.npy", None),
            ("blows-*.csv", None),
            ("none/*.csv", None),
            ("shots/a1.npy", Some("shots/a.npy")),
            ("", None),
        ] {
            assert_eq!(
                similar_files(pattern, here).as_deref(),
                expected,
                "{pattern}"
            );
        }
    }
}

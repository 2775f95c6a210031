//! The Rust files that the crates of the workspace compile, and how a reference `file.rs::item` is looked up in them.

use std::collections::BTreeMap;
use std::fmt;
use std::fs;
use std::path::Path;

use super::error::TraceabilityError;
use super::source::{Defined, SourceFile};

/// Every file that is part of a library, of the tasks, or of an integration test, by its path from the root.
///
/// A file that no module declares is not among them: a test in it would never run.
#[derive(Debug, Default)]
pub(crate) struct Workspace {
    files: BTreeMap<String, SourceFile>,
}

/// Why a reference leads nowhere.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[non_exhaustive]
pub(crate) enum Unresolved {
    #[error("`{reference}` is no reference, expected {expected}")]
    Form {
        reference: String,
        expected: &'static str,
    },
    #[error("no crate compiles `{file}`{nearest}")]
    File { file: String, nearest: Nearest },
    #[error("`{file}` does not define `{item}`{nearest}")]
    Item {
        file: String,
        item: String,
        nearest: Nearest,
    },
    #[error("`{file}` does not define `{item}`, but {} does", elsewhere.join(", "))]
    Elsewhere {
        file: String,
        item: String,
        elsewhere: Vec<String>,
    },
    #[error("no task `{task}`{nearest}")]
    Task { task: String, nearest: Nearest },
    #[error("`{task}` writes no file `{file}`{nearest}")]
    Written {
        task: String,
        file: String,
        nearest: Nearest,
    },
    #[error("the snapshot of `{task}` has no key `{key}`{nearest}")]
    Key {
        task: String,
        key: String,
        nearest: Nearest,
    },
}

/// The known name that is nearest to a wrong one, if any is near.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Nearest(Option<String>);

impl Nearest {
    /// Among `known`, by insertions, deletions, exchanges and swaps; a third of the letters may differ.
    pub(crate) fn to<'a>(wrong: &str, known: impl Iterator<Item = &'a str>) -> Self {
        let limit = wrong.chars().count().div_ceil(3);
        let nearest = known
            .map(|name| (strsim::damerau_levenshtein(wrong, name), name))
            .filter(|(distance, _)| *distance <= limit)
            .min();
        Self(nearest.map(|(_, name)| name.to_owned()))
    }
}

impl fmt::Display for Nearest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            Some(name) => write!(f, ", expected perhaps `{name}`"),
            None => Ok(()),
        }
    }
}

impl Workspace {
    /// Parses every file of the workspace at `root`.
    pub(crate) fn read(root: &Path) -> Result<Self, TraceabilityError> {
        let mut workspace = Self::default();
        workspace.read_module(root, "xtask/src/main.rs", true)?;
        for package in entries(root, "crates")? {
            workspace.read_module(root, &format!("{package}/src/lib.rs"), true)?;
            let tests = format!("{package}/tests/it.rs");
            if root.join(&tests).is_file() {
                workspace.read_module(root, &tests, true)?;
            }
        }
        Ok(workspace)
    }

    /// Parses `file` and the modules that it declares.
    fn read_module(
        &mut self,
        root: &Path,
        file: &str,
        is_crate: bool,
    ) -> Result<(), TraceabilityError> {
        if self.files.contains_key(file) {
            return Ok(());
        }
        let path = root.join(file);
        let text =
            fs::read_to_string(&path).map_err(|source| TraceabilityError::Io { path, source })?;
        let parsed = SourceFile::parse(&text).map_err(|reason| TraceabilityError::Rust {
            file: file.to_owned(),
            reason,
        })?;
        let modules = parsed.modules.clone();
        self.files.insert(file.to_owned(), parsed);
        let (folder, name) = file.rsplit_once('/').unwrap_or(("", file));
        let children = if is_crate || name == "mod.rs" {
            folder.to_owned()
        } else {
            format!("{folder}/{}", name.trim_end_matches(".rs"))
        };
        for module in modules {
            let expected = match &module.path {
                Some(path) => vec![format!("{folder}/{path}")],
                None => vec![
                    format!("{children}/{}.rs", module.name),
                    format!("{children}/{}/mod.rs", module.name),
                ],
            };
            match expected.iter().find(|file| root.join(file).is_file()) {
                Some(file) => self.read_module(root, file, false)?,
                None => {
                    return Err(TraceabilityError::NoModule {
                        file: file.to_owned(),
                        module: module.name,
                        expected,
                    });
                }
            }
        }
        Ok(())
    }

    /// What `reference` names.
    pub(crate) fn resolve(&self, reference: &str) -> Result<Defined, Unresolved> {
        let (file, item) = split(reference).ok_or_else(|| Unresolved::Form {
            reference: reference.to_owned(),
            expected: "`file.rs::item` from the root of the workspace",
        })?;
        let source = self.files.get(file).ok_or_else(|| Unresolved::File {
            file: file.to_owned(),
            nearest: Nearest::to(file, self.files.keys().map(String::as_str)),
        })?;
        if let Some(defined) = source.items.get(item) {
            return Ok(*defined);
        }
        let elsewhere: Vec<String> = self
            .files
            .iter()
            .filter(|(_, source)| source.items.contains_key(item))
            .map(|(file, _)| format!("`{file}`"))
            .collect();
        Err(if elsewhere.is_empty() {
            Unresolved::Item {
                file: file.to_owned(),
                item: item.to_owned(),
                nearest: Nearest::to(item, source.items.keys().map(String::as_str)),
            }
        } else {
            Unresolved::Elsewhere {
                file: file.to_owned(),
                item: item.to_owned(),
                elsewhere,
            }
        })
    }

    /// The string literals of `file`, and of the files of the folder of its modules.
    pub(crate) fn strings(&self, file: &str) -> impl Iterator<Item = &str> {
        let folder = format!("{}/", file.trim_end_matches(".rs"));
        self.files
            .iter()
            .filter(move |(name, _)| *name == file || name.starts_with(&folder))
            .flat_map(|(_, source)| source.strings.iter().map(String::as_str))
    }

    /// The names that `file` defines.
    pub(crate) fn items(&self, file: &str) -> impl Iterator<Item = &str> {
        self.files
            .get(file)
            .into_iter()
            .flat_map(|source| source.items.keys().map(String::as_str))
    }

    #[cfg(test)]
    pub(crate) fn of(files: &[(&str, &str)]) -> Self {
        Self {
            files: files
                .iter()
                .map(|(name, text)| ((*name).to_owned(), SourceFile::parse(text).unwrap()))
                .collect(),
        }
    }
}

/// File and item of `file.rs::item`.
pub(crate) fn split(reference: &str) -> Option<(&str, &str)> {
    let (stem, item) = reference.split_once(".rs::")?;
    let file = reference.get(..stem.len() + ".rs".len())?;
    (!stem.is_empty() && !item.is_empty()).then_some((file, item))
}

/// What is in `folder`, as paths from `root`, sorted.
pub(crate) fn entries(root: &Path, folder: &str) -> Result<Vec<String>, TraceabilityError> {
    let path = root.join(folder);
    let fail = |source| TraceabilityError::Io {
        path: path.clone(),
        source,
    };
    let mut names = fs::read_dir(&path)
        .map_err(fail)?
        .map(|entry| entry.map(|entry| format!("{folder}/{}", entry.file_name().to_string_lossy())))
        .collect::<Result<Vec<_>, _>>()
        .map_err(fail)?;
    names.sort();
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;
    use testbed::generated::write_whole;

    fn written(files: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            write_whole(&folder.path().join(name), text).unwrap();
        }
        folder
    }

    /// Modules beside their file, in its folder, in `mod.rs` and by attribute; and a file that nobody declares.
    #[test]
    fn only_what_a_crate_compiles_is_found() {
        let folder = written(&[
            ("xtask/src/main.rs", "mod task;"),
            ("xtask/src/task.rs", ""),
            ("crates/a/src/lib.rs", "mod rod;"),
            ("crates/a/src/rod.rs", "mod end;"),
            ("crates/a/src/rod/end.rs", "pub struct End;"),
            ("crates/a/src/rod/forgotten.rs", "pub struct Forgotten;"),
            (
                "crates/a/tests/it.rs",
                "mod rig; #[path = \"two/part.rs\"] mod part; mod three;",
            ),
            ("crates/a/tests/rig/mod.rs", "mod hammer;"),
            ("crates/a/tests/rig/hammer.rs", "fn swing() {}"),
            ("crates/a/tests/two/part.rs", "#[test] fn by_attribute() {}"),
            ("crates/a/tests/three.rs", "mod whole;"),
            (
                "crates/a/tests/three/whole.rs",
                "#[test] fn in_the_folder() {}",
            ),
            ("crates/a/tests/data/readme.md", "no crate"),
            ("crates/b/src/lib.rs", ""),
        ]);
        let workspace = Workspace::read(folder.path()).unwrap();
        for reference in [
            "crates/a/src/rod/end.rs::End",
            "crates/a/tests/rig/hammer.rs::swing",
            "crates/a/tests/two/part.rs::by_attribute",
            "crates/a/tests/three/whole.rs::in_the_folder",
        ] {
            assert!(workspace.resolve(reference).is_ok(), "{reference}");
        }
        let forgotten = workspace.resolve("crates/a/src/rod/forgotten.rs::Forgotten");
        assert!(matches!(forgotten, Err(Unresolved::File { .. })));
    }

    #[test]
    fn a_module_without_a_file_and_a_file_that_is_no_rust_are_named() {
        let error = |text: &str| {
            let folder = written(&[("xtask/src/main.rs", text)]);
            Workspace::read(folder.path()).unwrap_err().to_string()
        };
        assert_eq!(
            error("mod task;"),
            "xtask/src/main.rs declares module `task`, expected xtask/src/task.rs or xtask/src/task/mod.rs"
        );
        assert!(error("fn fn").starts_with("xtask/src/main.rs: expected identifier"));
    }
}

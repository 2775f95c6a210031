//! Sheets of a campaign.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use crate::sheet::{self, Language};
use crate::{RodlabError, output};

/// A test of a campaign.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Test {
    /// Path of the sheet relative to the common folder of all sheets, without extension and with
    /// slashes; the folder of its result has this name. No part of it is `..`, so that a
    /// result stays in the folder of the campaign.
    pub name: String,
    /// Path of the sheet.
    pub sheet: PathBuf,
}

/// Returns the tests in `places`, in order of their names. A place is a sheet, a folder, which is
/// searched recursively for sheets, or a pattern.
///
/// Folders with a result of this program are skipped. Links to folders are followed, and no folder
/// is searched twice: if a folder has several names, the name without links is used.
///
/// # Errors
///
/// [`RodlabError::NoFile`] for a place without a sheet, [`RodlabError::Read`] for a folder that
/// cannot be read, and [`RodlabError::Request`] if the names of two sheets differ only in the
/// extension, or a name without its extension cannot name a folder.
pub fn tests_of(places: &[String]) -> Result<Vec<Test>, RodlabError> {
    let mut search = Search::default();
    let mut roots = Vec::new();
    for place in places {
        let found = found_at(place)?;
        for path in &found {
            roots.push((place, search.place(path)?));
        }
        if found.is_empty() {
            return Err(no_sheet(place));
        }
    }
    search.follow_links()?;
    match roots.iter().find(|(_, root)| !search.has_below(root)) {
        Some((place, _)) => Err(no_sheet(place)),
        None => named(search.sheets),
    }
}

fn no_sheet(place: &str) -> RodlabError {
    RodlabError::no_file(place, Path::new("."), "")
}

/// Returns the paths of a place: the place itself, or the matches of its pattern.
fn found_at(place: &str) -> Result<Vec<PathBuf>, RodlabError> {
    let path = PathBuf::from(place);
    if path.exists() {
        return Ok(vec![path]);
    }
    let listed = glob::glob(place).map_err(|error| {
        RodlabError::request(
            "sheets",
            format!("`{place}`, {error}"),
            "a sheet, a folder or a pattern",
        )
    })?;
    listed
        .map(|found| found.map_err(RodlabError::listing))
        .collect()
}

/// A folder or a sheet: its path as given, and its full path without `..`, which contains only
/// those links through which it was found.
#[derive(Debug, Clone)]
struct Place {
    shown: PathBuf,
    full: PathBuf,
}

impl Place {
    fn child(&self, name: &std::ffi::OsStr) -> Self {
        Self {
            shown: self.shown.join(name),
            full: self.full.join(name),
        }
    }
}

/// Sheets found so far.
#[derive(Debug, Default)]
struct Search {
    /// Paths of the sheets as given, by their full paths.
    sheets: BTreeMap<PathBuf, PathBuf>,
    /// Searched folders, without any links.
    folders: BTreeSet<PathBuf>,
    /// Links to folders, by their full paths, with the path as given.
    links: BTreeMap<PathBuf, PathBuf>,
    /// Followed links.
    followed: BTreeSet<PathBuf>,
}

impl Search {
    /// Adds the sheet at `path`, or the sheets in the folder at `path`, and returns the full path.
    fn place(&mut self, path: &Path) -> Result<PathBuf, RodlabError> {
        let shown = path.to_path_buf();
        if path.is_dir() {
            let full = real(path)?;
            self.folder(&Place {
                shown,
                full: full.clone(),
            })?;
            return Ok(full);
        }
        let parent = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let full = real(parent)?.join(path.file_name().unwrap_or_default());
        self.sheets.entry(full.clone()).or_insert(shown);
        Ok(full)
    }

    /// Adds all sheets in the folder and its subfolders: files `*.ron`, and files `*.toml` that
    /// name a job; links are kept for later.
    fn folder(&mut self, folder: &Place) -> Result<(), RodlabError> {
        if !self.folders.insert(real(&folder.shown)?) || output::holds_result(&folder.shown) {
            return Ok(());
        }
        let fail = |source| RodlabError::read(&folder.shown, source);
        let entries: Result<Vec<_>, _> = fs::read_dir(&folder.shown).map_err(fail)?.collect();
        let mut entries = entries.map_err(fail)?;
        entries.sort_by_key(fs::DirEntry::file_name);
        for entry in entries {
            let place = folder.child(&entry.file_name());
            if !place.shown.is_dir() {
                if is_sheet(&place.shown) {
                    self.sheets.entry(place.full).or_insert(place.shown);
                }
            } else if entry.file_type().map_err(fail)?.is_symlink() {
                self.links.entry(place.full).or_insert(place.shown);
            } else {
                self.folder(&place)?;
            }
        }
        Ok(())
    }

    /// Searches the folders to which links lead, in the order of the names of the links.
    fn follow_links(&mut self) -> Result<(), RodlabError> {
        while let Some((full, shown)) = self.links.pop_first() {
            self.followed.insert(full.clone());
            self.folder(&Place { shown, full })?;
        }
        Ok(())
    }

    /// Returns true if `root` is or contains a sheet or a followed link. A link is included because
    /// the sheets in its folder may be listed under paths that are not below `root`.
    fn has_below(&self, root: &Path) -> bool {
        let mut found = self.sheets.keys().chain(&self.followed);
        found.any(|path| path.starts_with(root))
    }
}

/// Returns true for a file `*.ron`, and for a file `*.toml` that names a job; TOML files of other
/// programs do not.
fn is_sheet(path: &Path) -> bool {
    let Some(ending) = path.extension() else {
        return false;
    };
    // a file that cannot be read is kept: the campaign reports the reason
    ending == Language::Ron.extension()
        || ending == Language::Toml.extension()
            && fs::read(path).map_or(true, |bytes| sheet::names_a_job(&bytes))
}

/// Returns the full path of a folder, without links.
fn real(folder: &Path) -> Result<PathBuf, RodlabError> {
    folder
        .canonicalize()
        .map_err(|source| RodlabError::read(folder, source))
}

/// Returns the tests, named after the full paths of their sheets.
fn named(sheets: BTreeMap<PathBuf, PathBuf>) -> Result<Vec<Test>, RodlabError> {
    let common: PathBuf = sheets
        .keys()
        .filter_map(|sheet| Some(sheet.parent()?.to_path_buf()))
        .reduce(|common, folder| {
            common
                .components()
                .zip(folder.components())
                .take_while(|(a, b)| a == b)
                .map(|(part, _)| part)
                .collect()
        })
        .unwrap_or_default();
    let mut tests: BTreeMap<String, PathBuf> = BTreeMap::new();
    for (full, shown) in sheets {
        let name = name_of(&full, &common).ok_or_else(|| {
            RodlabError::request(
                "sheets",
                shown.display().to_string(),
                "a sheet whose name without extension is a valid name for the folder of its result",
            )
        })?;
        if let Some(other) = tests.insert(name, shown.clone()) {
            return Err(RodlabError::request(
                "sheets",
                format!("{} and {}", other.display(), shown.display()),
                "names that differ in more than the extension: the folder of a result has the name of its sheet without extension",
            ));
        }
    }
    Ok(tests
        .into_iter()
        .map(|(name, sheet)| Test { name, sheet })
        .collect())
}

/// Returns the path of `sheet` below `common` without extension; `None` if the name without
/// extension means another folder, such as `..` from `...ron`.
fn name_of(sheet: &Path, common: &Path) -> Option<String> {
    let stem = sheet.file_stem()?;
    if stem == "." || stem == ".." {
        return None;
    }
    let folders = sheet.parent()?.strip_prefix(common).ok()?;
    let parts = folders.components().map(std::path::Component::as_os_str);
    let parts: Vec<_> = parts
        .chain([stem])
        .map(|part| part.to_string_lossy())
        .collect();
    Some(parts.join("/"))
}

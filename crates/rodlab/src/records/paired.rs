//! Files that belong to the same hits: files with all channels, or files of single channels.
//!
//! ```ron
//! channels: [
//!     (name: "hammer", files: ["force-*.csv"], from: 1),
//!     (name: "end A", files: ["free-*.csv"], from: 1),
//! ],
//! ```
//!
//! Files of single channels are paired by the text in place of the wildcards of their patterns,
//! here the `7` of `force-7.csv` and `free-7.csv`, and not by their order. Names without wildcards
//! are paired if they are the same entry of their lists.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::files::{self, FoundFile};
use super::{ChannelSheet, IN_SEPARATE_FILES, Records, wildcards};
use crate::RodlabError;

/// Files that together contain all channels of a hit, or of several hits if they contain several
/// records.
pub(super) struct FileSet<'a> {
    pub(super) first: PartFile<'a>,
    pub(super) others: Vec<PartFile<'a>>,
}

/// A file of a [`FileSet`], with the channels that are read from it.
pub(super) struct PartFile<'a> {
    pub(super) path: PathBuf,
    /// Path in the form in which a result lists it.
    pub(super) shown: String,
    /// The name or pattern that matches it.
    pub(super) pattern: &'a str,
    /// Place of the pattern in the sheet.
    pub(super) place: String,
    /// The channels, with their indices in the sheet.
    pub(super) channels: Vec<(usize, &'a ChannelSheet)>,
}

/// Files with the same mark belong together.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Mark {
    /// Index of the name or pattern in the list of its channel.
    entry: usize,
    /// Texts in place of the wildcards; empty for a name.
    texts: Vec<String>,
}

/// A channel with its own files.
struct OwnFiles<'a> {
    at: usize,
    channel: &'a ChannelSheet,
    place: String,
    found: BTreeMap<Mark, PartFile<'a>>,
}

impl FileSet<'_> {
    /// Returns the files, the first one first.
    pub(super) fn files(&self) -> impl Iterator<Item = &PartFile<'_>> {
        std::iter::once(&self.first).chain(&self.others)
    }

    /// Returns the name of the hit, such as `force-7.csv + free-7.csv`; more than two files are
    /// counted.
    pub(super) fn name(&self) -> String {
        let first = &self.first.shown;
        match self.others.as_slice() {
            [] => first.clone(),
            [second] => format!("{first} + {}", second.shown),
            others => format!("{first} + {} more", others.len()),
        }
    }
}

impl Records {
    /// Returns the files of all hits. Sets of files of single channels are in the order of their
    /// entries and of the texts in place of the wildcards.
    pub(super) fn file_sets(
        &self,
        folder: &Path,
        field: &str,
    ) -> Result<Vec<FileSet<'_>>, RodlabError> {
        let are_separate = self
            .channels
            .iter()
            .any(|channel| !channel.files.is_empty());
        let sets = if are_separate {
            self.sets_of_channels(folder, field)?
        } else {
            let place = format!("{field}.files");
            let found = files::paths(&self.files, folder, &place)?;
            let all = || self.channels.iter().enumerate().collect();
            let set = |found| FileSet {
                first: PartFile::new(found, folder, &place, all()),
                others: Vec::new(),
            };
            found.into_iter().map(set).collect()
        };
        for file in sets.iter().flat_map(FileSet::files) {
            expect_channels_once(file, field, are_separate)?;
        }
        Ok(sets)
    }

    /// Refuses files that are stated twice, or only for some of the channels.
    pub(super) fn check_files(&self, field: &str) -> Result<(), RodlabError> {
        let mut channels = self.channels.iter();
        let Some(with) = channels.position(|channel| !channel.files.is_empty()) else {
            return match self.files.as_slice() {
                [] => Err(RodlabError::request(
                    format!("{field}.files"),
                    "empty",
                    format!("the name of at least one file; {IN_SEPARATE_FILES}"),
                )),
                _ => Ok(()),
            };
        };
        if !self.files.is_empty() {
            return Err(RodlabError::request(
                format!("{field}.channels[{with}].files"),
                format!("stated in addition to {field}.files"),
                "only one of the two: `files` of the records for files with all channels, `files` in every channel for files with one channel each",
            ));
        }
        let mut channels = self.channels.iter();
        match channels.position(|channel| channel.files.is_empty()) {
            None => Ok(()),
            Some(without) => Err(RodlabError::request(
                format!("{field}.channels[{without}].files"),
                "not stated",
                format!("the files of this channel, because channels[{with}] has its own files"),
            )),
        }
    }

    fn sets_of_channels(
        &self,
        folder: &Path,
        field: &str,
    ) -> Result<Vec<FileSet<'_>>, RodlabError> {
        let channels = self.channels.iter().enumerate();
        let mut all = channels
            .map(|(at, channel)| OwnFiles::find(at, channel, folder, field))
            .collect::<Result<Vec<_>, _>>()?;
        if let Some((first, others)) = all.split_first() {
            for other in others {
                first.expect_partners_in(other)?;
                other.expect_partners_in(first)?;
            }
        }
        // every channel has one file for each mark, so that the n-th files belong together
        let mut files: Vec<_> = all
            .iter_mut()
            .map(|own| std::mem::take(&mut own.found).into_values())
            .collect();
        let mut sets = Vec::new();
        let mut seen = BTreeSet::new();
        while let Some(set) = FileSet::of(files.iter_mut().filter_map(Iterator::next)) {
            for file in set.files() {
                if !seen.insert(file.path.clone()) {
                    return Err(RodlabError::request(
                        file.place.as_str(),
                        format!("{}, which belongs to two hits", file.shown),
                        "each file in one hit only",
                    ));
                }
            }
            sets.push(set);
        }
        Ok(sets)
    }
}

impl<'a> FileSet<'a> {
    /// Combines the files of all channels; a file of several channels is one file.
    fn of(mut files: impl Iterator<Item = PartFile<'a>>) -> Option<Self> {
        let mut set = Self {
            first: files.next()?,
            others: Vec::new(),
        };
        for file in files {
            let mut before = std::iter::once(&mut set.first).chain(&mut set.others);
            match before.find(|before| before.path == file.path) {
                Some(same) => same.channels.extend(file.channels),
                None => set.others.push(file),
            }
        }
        Some(set)
    }
}

impl<'a> PartFile<'a> {
    fn new(
        found: FoundFile<'a>,
        folder: &Path,
        place: &str,
        channels: Vec<(usize, &'a ChannelSheet)>,
    ) -> Self {
        Self {
            shown: files::relative(&found.path, folder),
            pattern: found.pattern,
            place: place.to_owned(),
            channels,
            path: found.path,
        }
    }
}

impl<'a> OwnFiles<'a> {
    fn find(
        at: usize,
        channel: &'a ChannelSheet,
        folder: &Path,
        field: &str,
    ) -> Result<Self, RodlabError> {
        let place = format!("{field}.channels[{at}].files");
        let mut found = BTreeMap::new();
        for one in files::paths(&channel.files, folder, &place)? {
            let mark = Mark::of(&one, folder);
            let file = PartFile::new(one, folder, &place, vec![(at, channel)]);
            let shown = file.shown.clone();
            if let Some(before) = found.insert(mark, file) {
                return Err(RodlabError::request(
                    place,
                    format!("{} and {shown}", before.shown),
                    "files that differ in the text in place of the wildcards",
                ));
            }
        }
        Ok(Self {
            at,
            channel,
            place,
            found,
        })
    }

    /// Refuses a file without a partner among the files of the `other` channel.
    fn expect_partners_in(&self, other: &Self) -> Result<(), RodlabError> {
        let mut found = self.found.iter();
        let Some((mark, file)) = found.find(|(mark, _)| !other.found.contains_key(mark)) else {
            return Ok(());
        };
        let patterns: Vec<String> = other
            .channel
            .files
            .iter()
            .map(|p| format!("`{p}`"))
            .collect();
        let shown: Vec<&str> = other
            .found
            .values()
            .map(|file| file.shown.as_str())
            .collect();
        let matched = match shown.as_slice() {
            [first, _, _, _, ..] => format!("{first} and {} more", shown.len() - 1),
            few => few.join(", "),
        };
        let mark = if mark.texts.is_empty() {
            format!("entry {} of the list", mark.entry + 1)
        } else {
            format!(
                "with `{}` in place of the wildcards",
                mark.texts.join("`, `")
            )
        };
        Err(RodlabError::request(
            other.place.as_str(),
            format!("{}, which matches {matched}", patterns.join(", ")),
            format!(
                "also the partner of {} of channels[{}], {mark}: every hit needs a file of each channel",
                file.shown, self.at
            ),
        ))
    }
}

impl Mark {
    fn of(found: &FoundFile<'_>, folder: &Path) -> Self {
        let is_name = found.path == folder.join(found.pattern);
        Self {
            entry: found.entry,
            texts: if is_name {
                Vec::new()
            } else {
                wildcards::texts(found.pattern, &found.path, folder)
            },
        }
    }
}

/// Refuses a channel of a file that is read twice.
fn expect_channels_once(
    file: &PartFile<'_>,
    field: &str,
    are_separate: bool,
) -> Result<(), RodlabError> {
    for (n_before, (at, channel)) in file.channels.iter().enumerate() {
        let mut earlier = file.channels.iter().take(n_before);
        if let Some((before, _)) = earlier.find(|(_, other)| other.from == channel.from) {
            let advice = if are_separate {
                String::new()
            } else {
                format!("; {IN_SEPARATE_FILES}")
            };
            return Err(RodlabError::request(
                format!("{field}.channels[{at}].from"),
                channel.from.to_string(),
                format!(
                    "another channel of {} than channels[{before}]{advice}",
                    file.shown
                ),
            ));
        }
    }
    Ok(())
}

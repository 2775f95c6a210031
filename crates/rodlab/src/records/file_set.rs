//! Files that contain the channels of a hit.

use std::path::{Path, PathBuf};

use super::files::{self, FoundFile};
use super::{ChannelSheet, IN_SEPARATE_FILES, Records};
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

impl<'a> FileSet<'a> {
    /// Combines the files of all channels; a file of several channels is one file.
    pub(super) fn of(mut files: impl Iterator<Item = PartFile<'a>>) -> Option<Self> {
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
    pub(super) fn new(
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

impl Records {
    /// Returns the files of all hits.
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

//! Files of single channels, paired to hits.
//!
//! ```ron
//! channels: [
//!     (name: "hammer", files: ["force-*.csv"], from: 1),
//!     (name: "end A", files: ["free-*.csv"], from: 1),
//! ],
//! ```
//!
//! Files are paired by the text in place of the wildcards of their patterns, here the `7` of
//! `force-7.csv` and `free-7.csv`, and not by their order. Names without wildcards are paired if
//! they are the same entry of their lists.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::file_set::{FileSet, PartFile};
use super::files::{self, FoundFile};
use super::{ChannelSheet, Records, wildcards};
use crate::RodlabError;
use crate::sheet::quoted;

/// Mark of a file. Files of different channels with the same mark belong to one hit.
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

impl Records {
    /// Returns the files of all hits, in the order of their entries in the lists and of the texts
    /// in place of the wildcards.
    pub(super) fn sets_of_channels(
        &self,
        folder: &Path,
        field: &str,
    ) -> Result<Vec<FileSet<'_>>, RodlabError> {
        let channels = self.channels.iter().enumerate();
        let all = channels
            .map(|(at, channel)| OwnFiles::find(at, channel, folder, field))
            .collect::<Result<Vec<_>, _>>()?;
        if let Some((first, others)) = all.split_first() {
            for other in others {
                first.expect_partners_in(other)?;
                other.expect_partners_in(first)?;
            }
        }
        // every channel has one file for each mark, so that the n-th files belong together
        let files = all.into_iter().map(|own| own.found.into_values());
        let mut files: Vec<_> = files.collect();
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
        let patterns = quoted(&other.channel.files);
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
            format!("{patterns}, which matches {matched}"),
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

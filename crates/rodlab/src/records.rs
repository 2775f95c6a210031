//! Calibrated records from the files of a sheet.
//!
//! ```ron
//! records: (
//!     files: ["hits/*.npy"],
//!     sampling_rate: "51.2 kHz",
//!     channels: [
//!         (name: "hammer", from: 1, unit: "V", sensitivity: "2.25 mV/N ± 1 %"),
//!         (name: "end A", from: 2, unit: "V", sensitivity: "10.2 mV/g ± 2 %", inverted: true),
//!     ],
//! ),
//! ```
//!
//! If each channel has files of its own, `files` is stated in the channels: see `paired.rs`.

mod channel;
mod clipped;
mod expect;
mod file_set;
mod files;
mod merged;
mod paired;
mod part;
mod told;
mod wildcards;

pub use channel::{BridgeSheet, ChannelSheet, Selector, Sensitivity};
pub(crate) use clipped::{clipped, is_lost};
pub(crate) use expect::{channel_called, expect_motion};
pub use expect::{expect_different_files, expect_quantity};
pub(crate) use merged::expect_same_times;
pub(crate) use told::{is_rounded_step, state_rate, step_without_unit, text_of_unit};

use std::path::Path;

use labio::{Quantity, Record};
use serde::Deserialize;

use self::part::{Part, record_name};
use crate::digits::significant;
use crate::outcome::{InputFile, LogEntry};
use crate::sheet::{self, Frequency, NotFollowed};
use crate::{InStep, Outcome, RodlabError};

/// Reason why jobs with frequency responses refuse a time skew with an uncertainty.
pub(crate) const SKEW_NOT_FOLLOWED: &str =
    "the error of a frequency response due to a delay between its channels is not propagated";

/// Files and channels of the records.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Records {
    /// Names or patterns (`hits/*.csv`), relative to the sheet, of files with all channels; the
    /// files of a pattern are read in the order of their names. Empty if every channel has its own
    /// files.
    #[serde(default)]
    pub files: Vec<String>,
    /// Sampling rate, for files that do not record it (NPY), that record it rounded (by less than
    /// 0.1 %), or that have times which are not evenly spaced. In the last case every time must be
    /// within half a step of an even grid at this rate.
    pub sampling_rate: Option<NotFollowed<Frequency>>,
    /// Channels that are used; all others are ignored.
    pub channels: Vec<ChannelSheet>,
}

/// Advice for sensors whose signals are in separate files.
const IN_SEPARATE_FILES: &str =
    "if each channel has files of its own, state `files` in every channel";

/// Strain above which the unit of a channel must be wrong; even rubber stretches to only about ten
/// times its length.
const LARGEST_STRAIN: f64 = 10.0;

/// Records that were read, with their files.
#[derive(Debug, Default)]
pub struct Loaded {
    /// Records with the channels of the sheet, calibrated, in the order of the files.
    pub records: Vec<NamedRecord>,
    /// The files.
    pub inputs: Vec<InputFile>,
    /// Sentences about differences between sheet and files, and about ignored parts.
    pub warnings: Vec<String>,
    /// Log entries for hits that were left out because a sample is NaN or infinite.
    pub left_out: Vec<LogEntry>,
}

impl Loaded {
    /// Enters files, warnings and the hits left out in `outcome`, and returns the records.
    pub(crate) fn entered_in(self, outcome: &mut Outcome) -> Vec<NamedRecord> {
        outcome.inputs.extend(self.inputs);
        outcome.warnings.extend(self.warnings);
        outcome.log.extend(self.left_out);
        self.records
    }
}

/// A record with the name of its source.
#[derive(Debug, Clone)]
pub struct NamedRecord {
    /// Name, such as `hits.uff`, `hits.uff, record 3`, or `force-7.csv + free-7.csv`.
    pub name: String,
    /// The calibrated record; its channels have the names and the order of the sheet.
    pub record: Record,
}

/// Returns the files that match a name or pattern of a sheet in `folder`, in the form in which a
/// result lists them.
pub(crate) fn found_by(pattern: &str, folder: &Path) -> Result<Vec<String>, RodlabError> {
    let patterns = [pattern.to_owned()];
    let found = files::paths(&patterns, folder, "files")?;
    let relative = |found: &files::FoundFile<'_>| files::relative(&found.path, folder);
    Ok(found.iter().map(relative).collect())
}

/// A file that a name or pattern of a sheet matches.
pub(crate) struct MatchedFile {
    /// Path.
    pub(crate) path: std::path::PathBuf,
    /// Path in the form in which a result lists it.
    pub(crate) shown: String,
    /// The name or pattern.
    pub(crate) pattern: String,
}

/// Returns the files of all `patterns` in `folder`, each once; `field` is the place of the patterns
/// in the sheet.
pub(crate) fn matched_by(
    patterns: &[String],
    folder: &Path,
    field: &str,
) -> Result<Vec<MatchedFile>, RodlabError> {
    let found = files::paths(patterns, folder, field)?;
    let matched = |found: files::FoundFile<'_>| MatchedFile {
        shown: files::relative(&found.path, folder),
        pattern: found.pattern.to_owned(),
        path: found.path,
    };
    Ok(found.into_iter().map(matched).collect())
}

impl Records {
    /// Refuses sensitivities, gains, bridges and time skews with an uncertainty, for a job that
    /// does not propagate it. `field` is the place of the records in the sheet; `why` completes
    /// "because …".
    ///
    /// # Errors
    ///
    /// [`RodlabError::Request`] for the first channel with an uncertainty; [`RodlabError::Step`]
    /// for an invalid calibration.
    pub fn refuse_uncertain_calibrations(&self, field: &str, why: &str) -> Result<(), RodlabError> {
        for (at, channel) in self.channels.iter().enumerate() {
            let place = format!("{field}.channels[{at}]");
            let uncertainty = channel
                .chain(&place)?
                .map_or(0.0, |chain| chain.relative_uncertainty());
            if uncertainty > 0.0 {
                return Err(RodlabError::request(
                    place,
                    format!("calibrated to {} %", 100.0 * uncertainty),
                    format!("a calibration without ±, because {why}{}", sheet::ADVICE),
                ));
            }
        }
        self.refuse_uncertain_skews(field, why)
    }

    /// Refuses only time skews with an uncertainty.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Request`] for the first channel with such a time skew.
    pub fn refuse_uncertain_skews(&self, field: &str, why: &str) -> Result<(), RodlabError> {
        for (at, channel) in self.channels.iter().enumerate() {
            if let Some(skew) = &channel.time_skew {
                skew.exact(&format!("{field}.channels[{at}].time_skew"), why)?;
            }
        }
        Ok(())
    }

    /// Reads and calibrates the records; `field` is the place of the records in the sheet.
    ///
    /// # Errors
    ///
    /// [`RodlabError`] with the file and the unsuitable field of the sheet; also for two files with
    /// the same content, because they are one measurement.
    pub fn load(&self, folder: &Path, field: &str) -> Result<Loaded, RodlabError> {
        self.check(field)?;
        let mut loaded = Loaded::default();
        let mut lost = None;
        let mut statements = Vec::new();
        for set in self.file_sets(folder, field)? {
            let mut read = |file| self.read_part(file, field, &mut loaded, &mut statements);
            let first = read(&set.first)?;
            let others = set.others.iter().map(read).collect::<Result<Vec<_>, _>>()?;
            let file = set.name();
            match set.merged(first, others)? {
                Part::Lost { reason, error } => {
                    let warning = format!("{file} is left out: {reason}.");
                    loaded.warnings.push(warning);
                    loaded.left_out.push(LogEntry::rejected(file, reason));
                    lost = lost.or(Some(error));
                }
                Part::Records(records) => {
                    let n_records = records.len();
                    for (number, record) in (1..).zip(records) {
                        let name = record_name(&file, number, n_records);
                        let record = self.calibrated(record, &name, field)?;
                        loaded.records.push(NamedRecord { name, record });
                    }
                }
            }
        }
        expect_different_files(&loaded.inputs)?;
        let warnings = statements.iter().map(told::FileStatement::warning);
        loaded.warnings.extend(warnings);
        match lost {
            Some(error) if loaded.records.is_empty() => Err(error),
            _ => Ok(loaded),
        }
    }

    /// Refuses statements that are wrong whatever the files are.
    fn check(&self, field: &str) -> Result<(), RodlabError> {
        RodlabError::refuse_empty(
            &self.channels,
            format!("{field}.channels"),
            "at least one channel",
        )?;
        for (at, channel) in self.channels.iter().enumerate() {
            let mut earlier = self.channels.iter().take(at);
            if let Some(before) = earlier.position(|other| other.name == channel.name) {
                return Err(RodlabError::request(
                    format!("{field}.channels[{at}].name"),
                    format!("`{}`", channel.name),
                    format!("a name other than that of channels[{before}]"),
                ));
            }
        }
        self.check_files(field)
    }

    /// Calibrates `record`, which has the channels of the sheet.
    fn calibrated(
        &self,
        mut record: Record,
        name: &str,
        field: &str,
    ) -> Result<Record, RodlabError> {
        for (at, channel) in self.channels.iter().enumerate() {
            let place = format!("{field}.channels[{at}]");
            if let Some(chain) = channel.chain(&place)? {
                record = record
                    .calibrated(&channel.name, chain)
                    .in_step(format!("{place}, {name}"))?;
            }
        }
        if self
            .channels
            .iter()
            .any(|channel| channel.time_skew.is_some())
        {
            record = record.aligned().in_step(format!("{field}, {name}"))?;
        }
        let samples = record.samples();
        let channels = record.channels().iter().zip(samples.outer_iter());
        for (at, (channel, samples)) in channels.enumerate() {
            if channel.quantity() != Quantity::Strain {
                continue;
            }
            let largest = samples.iter().fold(0.0, |top: f64, x| top.max(x.abs()));
            if largest > LARGEST_STRAIN {
                return Err(RodlabError::request(
                    format!("{field}.channels[{at}].unit"),
                    format!("a strain of {} ({name})", significant(largest, 3)),
                    format!("at most {LARGEST_STRAIN}: microstrain is `um/m`"),
                ));
            }
        }
        Ok(record)
    }
}

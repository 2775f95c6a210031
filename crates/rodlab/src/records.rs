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

mod channel;
mod clipped;
mod expect;
mod files;
mod told;

pub use channel::{BridgeSheet, ChannelSheet, Selector, Sensitivity};
pub(crate) use clipped::{clipped, is_lost};
pub(crate) use expect::{channel_called, expect_motion};
pub use expect::{expect_different_files, expect_quantity};
pub(crate) use told::{is_rounded_step, state_rate, step_without_unit, text_of_unit};

use std::path::Path;

use labio::format;
use labio::{Channel, LabioError, Provenance, Quantity, Record};
use ndarray::Axis;
use serde::Deserialize;

use crate::digits::significant;
use crate::outcome::{InputFile, LogEntry};
use crate::sheet::{self, Frequency, NotFollowed};
use crate::{RodlabError, cut_short, input};

/// Reason why jobs with frequency responses refuse a time skew with an uncertainty.
pub(crate) const SKEW_NOT_FOLLOWED: &str =
    "the error of a frequency response due to a delay between its channels is not propagated";

/// Files and channels of the records.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Records {
    /// Names or patterns (`hits/*.csv`), relative to the sheet; the files of a pattern are read in
    /// the order of their names.
    pub files: Vec<String>,
    /// Sampling rate, for files that do not record it (NPY), that record it rounded (by less than
    /// 0.1 %), or that have times which are not evenly spaced. In the last case all times must be
    /// within half a step of this rate.
    pub sampling_rate: Option<NotFollowed<Frequency>>,
    /// Channels that are used; all others are ignored.
    pub channels: Vec<ChannelSheet>,
}

/// Advice for sensors whose signals are in separate files.
const IN_ONE_FILE: &str = "the channels of a hit are read from one file: join files that have one channel each (for `rodlab shpb`, state an entry of `records` for each file)";

/// Strain above which the unit of a channel must be wrong; even rubber stretches to only about ten
/// times its length.
const LARGEST_STRAIN: f64 = 10.0;

/// Records that were read, with their files.
#[derive(Debug)]
pub struct Loaded {
    /// Records with the channels of the sheet, calibrated, in the order of the files.
    pub records: Vec<NamedRecord>,
    /// The files.
    pub inputs: Vec<InputFile>,
    /// Sentences about differences between sheet and files, and about ignored parts.
    pub warnings: Vec<String>,
    /// Log entries for files with one hit that were left out because a sample is NaN or infinite.
    pub left_out: Vec<LogEntry>,
}

/// A record with the name of its source.
#[derive(Debug, Clone)]
pub struct NamedRecord {
    /// Name, such as `hits.uff` or `hits.uff, record 3`.
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
        let mut loaded = Loaded {
            records: Vec::new(),
            inputs: Vec::new(),
            warnings: Vec::new(),
            left_out: Vec::new(),
        };
        let mut lost = None;
        let mut statements = Vec::new();
        for found in files::paths(&self.files, folder, &format!("{field}.files"))? {
            let shown = files::relative(&found.path, folder);
            let bytes = input::read(&found.path)?;
            let n_inputs = loaded.inputs.len();
            lost = lost.or(self.load_bytes(&bytes, shown, field, &mut loaded, &mut statements)?);
            for input in loaded.inputs.iter_mut().skip(n_inputs) {
                input.pattern = Some(found.pattern.to_owned());
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

    /// Adds one file to `loaded`, or returns the error because of which the file is left out.
    #[allow(
        clippy::indexing_slicing,
        reason = "`chosen` has the places of series of the file for each channel of the sheet; where a channel is missing another is there"
    )]
    fn load_bytes(
        &self,
        bytes: &[u8],
        file: String,
        field: &str,
        loaded: &mut Loaded,
        statements: &mut Vec<told::FileStatement>,
    ) -> Result<Option<RodlabError>, RodlabError> {
        let mut contents = match &self.sampling_rate {
            Some(rate) => format::read_bytes_at(bytes, rate.si()),
            None => format::read_bytes(bytes),
        }
        .map_err(|error| self.not_read(error, &file, field))?;
        let chosen = self.complete(&mut contents, &file, field, statements)?;
        let provenance = Provenance::of_file(Path::new(&file), contents.format, bytes);
        let hash = provenance.hash();
        let input = InputFile::hashed(&file, contents.format, bytes, hash);
        loaded.inputs.push(input);
        loaded
            .warnings
            .extend(cut_short::warning(bytes, contents.format, &file).map(|text| text + "."));
        let found = contents.records(&provenance);
        // a missing series is an error, because series of later hits would take its place
        for (channel, index) in chosen
            .iter()
            .enumerate()
            .flat_map(|(channel, all)| all.iter().map(move |index| (channel, *index)))
        {
            if found.channel_names[index].is_none() {
                let why = found.left_out.into_iter().find(
                    |error| matches!(error, LabioError::NoChannel { index: i, .. } if *i == index),
                );
                let place = format!("{field}.channels[{channel}]");
                let Some(error) = why else {
                    return Err(RodlabError::request(
                        format!("{place}.from"),
                        self.channels[channel].from.to_string(),
                        format!("a time history in {file}"),
                    ));
                };
                // only a file with one hit is left out: a file with several hits would be assembled
                // wrongly
                let of_one_hit = chosen.iter().all(|all| all.len() == 1);
                if of_one_hit && is_lost_sample(&error) {
                    loaded
                        .warnings
                        .push(format!("{file} is left out: {error}."));
                    loaded
                        .left_out
                        .push(LogEntry::rejected(file.clone(), &error));
                    return Ok(Some(RodlabError::step(format!("{place}, {file}"), error)));
                }
                return Err(RodlabError::step(format!("{place}, {file}"), error));
            }
        }
        let mut names = Vec::with_capacity(chosen.len());
        for (at, all) in chosen.iter().enumerate() {
            let mut of_channel: Vec<&str> = all
                .iter()
                .filter_map(|index| found.channel_names[*index].as_deref())
                .collect();
            of_channel.sort_unstable();
            of_channel.dedup();
            let quoted: Vec<String> = of_channel.iter().map(|name| format!("`{name}`")).collect();
            match of_channel.as_slice() {
                [name] => names.push(*name),
                _ => {
                    return Err(RodlabError::request(
                        format!("{field}.channels[{at}].from"),
                        format!(
                            "{}, which belongs to several points",
                            self.channels[at].from
                        ),
                        format!("one of {} ({file})", quoted.join(", ")),
                    ));
                }
            }
        }
        let picked = found
            .records
            .iter()
            .map(|record| indices(record, &names))
            .collect::<Vec<_>>();
        let several = picked
            .iter()
            .filter(|(indices, _)| !indices.is_empty())
            .count()
            > 1;
        let mut number = 0;
        for (record, (indices, missing)) in found.records.iter().zip(&picked) {
            if indices.is_empty() {
                continue;
            }
            number += 1;
            let name = if several {
                format!("{file}, record {number}")
            } else {
                file.clone()
            };
            if let Some(missing) = missing {
                return Err(RodlabError::request(
                    format!("{field}.channels[{missing}].from"),
                    self.channels[*missing].from.to_string(),
                    format!(
                        "a channel on the time axis of {} ({name})",
                        self.channels[usize::from(*missing == 0)].from
                    ),
                ));
            }
            let record = self.calibrated(record, indices, &name, field)?;
            loaded.records.push(NamedRecord { name, record });
        }
        Ok(None)
    }

    /// Refuses statements that are wrong whatever the files are.
    fn check(&self, field: &str) -> Result<(), RodlabError> {
        if self.channels.is_empty() {
            return Err(RodlabError::request(
                format!("{field}.channels"),
                "empty",
                "at least one channel",
            ));
        }
        for (at, channel) in self.channels.iter().enumerate() {
            let mut earlier = self.channels.iter().take(at);
            if let Some(before) = earlier.position(|other| other.name == channel.name) {
                return Err(RodlabError::request(
                    format!("{field}.channels[{at}].name"),
                    format!("`{}`", channel.name),
                    format!("a name other than that of channels[{before}]"),
                ));
            }
            let mut earlier = self.channels.iter().take(at);
            if let Some(before) = earlier.position(|other| other.from == channel.from) {
                return Err(RodlabError::request(
                    format!("{field}.channels[{at}].from"),
                    channel.from.to_string(),
                    format!("another channel than channels[{before}]; {IN_ONE_FILE}"),
                ));
            }
        }
        Ok(())
    }

    /// Returns the channels of the sheet from `record`, calibrated and with their names in the
    /// sheet.
    #[allow(
        clippy::indexing_slicing,
        reason = "`indices` are the places of channels in the record"
    )]
    fn calibrated(
        &self,
        record: &Record,
        indices: &[usize],
        name: &str,
        field: &str,
    ) -> Result<Record, RodlabError> {
        let refused = |error| RodlabError::step(format!("{field}, {name}"), error);
        let channels = indices
            .iter()
            .zip(&self.channels)
            .map(|(index, channel)| {
                Channel::new(channel.name.as_str(), record.channels()[*index].quantity())
            })
            .collect::<Result<Vec<_>, _>>()
            .map_err(refused)?;
        let mut record = Record::new(
            record.samples().select(Axis(0), indices),
            record.sampling_rate_hz(),
            record.start_time(),
            channels,
            record.provenance().clone(),
        )
        .map_err(refused)?;
        for (at, channel) in self.channels.iter().enumerate() {
            let place = format!("{field}.channels[{at}]");
            if let Some(chain) = channel.chain(&place)? {
                record = record
                    .calibrated(&channel.name, chain)
                    .map_err(|error| RodlabError::step(format!("{place}, {name}"), error))?;
            }
        }
        if self
            .channels
            .iter()
            .any(|channel| channel.time_skew.is_some())
        {
            record = record.aligned().map_err(refused)?;
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

/// Returns true if a series is not a channel because one of its samples is not finite.
fn is_lost_sample(error: &LabioError) -> bool {
    matches!(
        error,
        LabioError::NoChannel {
            part: "ordinate",
            expected: "finite",
            ..
        }
    )
}

/// Returns the indices of the channels of `record` that are called `names`, and the index of the
/// first name that is missing.
fn indices(record: &Record, names: &[&str]) -> (Vec<usize>, Option<usize>) {
    let position = |name: &&str| record.channels().iter().position(|c| c.name() == *name);
    let found: Vec<Option<usize>> = names.iter().map(position).collect();
    let missing = found.iter().position(Option::is_none);
    (found.into_iter().flatten().collect(), missing)
}

//! Records of the channels that are read from one file.

use std::path::Path;

use labio::format;
use labio::{Channel, LabioError, Provenance, Record};
use ndarray::Axis;

use super::file_set::PartFile;
use super::{Loaded, Records, told};
use crate::outcome::InputFile;
use crate::sheet::quoted;
use crate::{InStep, RodlabError, cut_short, input};

/// Contents of a file of a hit.
pub(super) enum Part {
    /// Records that are not yet calibrated, with the channels of the file under their names in the
    /// sheet.
    Records(Vec<Record>),
    /// The only record of the file has a sample that is not finite.
    Lost {
        /// The reason for leaving out the hit.
        reason: String,
        /// The error, for a sheet whose hits are all left out.
        error: RodlabError,
    },
}

impl Part {
    /// Number of records in the file.
    pub(super) fn n_records(&self) -> usize {
        match self {
            Self::Records(records) => records.len(),
            Self::Lost { .. } => 1,
        }
    }

    /// Adds the name of the file to the reason for leaving out the hit.
    pub(super) fn in_file(self, file: &str) -> Self {
        match self {
            Self::Lost { reason, error } => Self::Lost {
                reason: format!("{file}: {reason}"),
                error,
            },
            records => records,
        }
    }
}

/// Returns the name of record `number` of `n_records` in a file or a set of files.
pub(super) fn record_name(file: &str, number: usize, n_records: usize) -> String {
    if n_records > 1 {
        format!("{file}, record {number}")
    } else {
        file.to_owned()
    }
}

impl Records {
    /// Reads `file`. The file and warnings about it are added to `loaded`, and doubtful statements
    /// of the file to `statements`.
    pub(super) fn read_part(
        &self,
        file: &PartFile<'_>,
        field: &str,
        loaded: &mut Loaded,
        statements: &mut Vec<told::FileStatement>,
    ) -> Result<Part, RodlabError> {
        let shown = file.shown.as_str();
        let bytes = input::read(&file.path)?;
        let mut contents = match &self.sampling_rate {
            Some(rate) => format::read_bytes_at(&bytes, rate.si()),
            None => format::read_bytes(&bytes),
        }
        .map_err(|error| self.not_read(error, shown, field))?;
        let chosen = self.complete(&mut contents, file, field, statements)?;
        let provenance = Provenance::of_file(Path::new(shown), contents.format, &bytes);
        loaded.inputs.push(InputFile {
            pattern: Some(file.pattern.to_owned()),
            ..InputFile::hashed(shown, contents.format, &bytes, provenance.hash())
        });
        let cut_short = cut_short::warning(&bytes, contents.format, shown);
        loaded.warnings.extend(cut_short.map(|text| text + "."));
        let found = contents.records(&provenance);
        let name_of = |index: usize| found.channel_names.get(index).and_then(Option::as_deref);
        // a missing series is an error, because series of later hits would take its place
        let missing = file
            .channels
            .iter()
            .zip(&chosen)
            .find_map(|(channel, all)| {
                let index = all.iter().find(|index| name_of(**index).is_none())?;
                Some((channel, *index))
            });
        if let Some(((at, channel), index)) = missing {
            let place = format!("{field}.channels[{at}]");
            let why = found.left_out.into_iter().find(
                |error| matches!(error, LabioError::NoChannel { index: i, .. } if *i == index),
            );
            let Some(error) = why else {
                return Err(RodlabError::request(
                    format!("{place}.from"),
                    channel.from.to_string(),
                    format!("a time history in {shown}"),
                ));
            };
            // a file with several hits is refused, because its remaining series would be combined
            // with those of other hits
            let is_left_out = chosen.iter().all(|all| all.len() == 1) && is_lost_sample(&error);
            let reason = error.to_string();
            let error = RodlabError::step(format!("{place}, {shown}"), error);
            return if is_left_out {
                Ok(Part::Lost { reason, error })
            } else {
                Err(error)
            };
        }
        let mut names = Vec::with_capacity(chosen.len());
        for ((at, channel), all) in file.channels.iter().zip(&chosen) {
            let mut of_channel: Vec<&str> = all.iter().filter_map(|i| name_of(*i)).collect();
            of_channel.sort_unstable();
            of_channel.dedup();
            let [name] = of_channel.as_slice() else {
                return Err(RodlabError::request(
                    format!("{field}.channels[{at}].from"),
                    format!("{}, which belongs to several points", channel.from),
                    format!("one of {} ({shown})", quoted(&of_channel)),
                ));
            };
            names.push(*name);
        }
        let picked = found
            .records
            .iter()
            .map(|record| (record, positions(record, &names)))
            .filter(|(_, positions)| positions.iter().any(Option::is_some))
            .collect::<Vec<_>>();
        let mut records = Vec::with_capacity(picked.len());
        for (number, (record, positions)) in (1..).zip(&picked) {
            let name = record_name(shown, number, picked.len());
            let channel_with = |is_wanted: fn(&Option<usize>) -> bool| {
                let mut channels = file.channels.iter().zip(positions);
                channels.find_map(|(channel, position)| is_wanted(position).then_some(channel))
            };
            if let Some((at, missing)) = channel_with(Option::is_none)
                && let Some((_, present)) = channel_with(Option::is_some)
            {
                return Err(RodlabError::request(
                    format!("{field}.channels[{at}].from"),
                    missing.from.to_string(),
                    format!("a channel on the time axis of {} ({name})", present.from),
                ));
            }
            let indices: Vec<usize> = positions.iter().flatten().copied().collect();
            let selected = selected(record, &indices, file).in_step(format!("{field}, {name}"))?;
            records.push(selected);
        }
        Ok(Part::Records(records))
    }
}

/// Returns the channels of `record` at `indices`, with the names of the channels of `file`.
#[allow(
    clippy::indexing_slicing,
    reason = "`indices` are the places of channels in the record"
)]
fn selected(record: &Record, indices: &[usize], file: &PartFile<'_>) -> Result<Record, LabioError> {
    let channels = indices
        .iter()
        .zip(&file.channels)
        .map(|(index, (_, channel))| {
            Channel::new(channel.name.as_str(), record.channels()[*index].quantity())
        })
        .collect::<Result<Vec<_>, _>>()?;
    Record::new(
        record.samples().select(Axis(0), indices),
        record.sampling_rate_hz(),
        record.start_time(),
        channels,
        record.provenance().clone(),
    )
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

/// Returns the indices of the channels of `record` that are called `names`; `None` for a name that
/// is missing.
fn positions(record: &Record, names: &[&str]) -> Vec<Option<usize>> {
    let position = |name: &&str| record.channels().iter().position(|c| c.name() == *name);
    names.iter().map(position).collect()
}

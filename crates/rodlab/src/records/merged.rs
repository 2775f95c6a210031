//! Records of several files of one hit, merged into one record.

use labio::{Channel, Record};
use ndarray::{ArrayView1, Axis, stack};

use super::file_set::FileSet;
use super::part::{Part, record_name};
use crate::{InStep, RodlabError};

/// Largest relative difference between sampling rates that count as equal.
const SAME_RATE: f64 = 1e-9;

/// Largest difference between start times that count as equal, in steps. It allows for start times
/// of up to 200 steps that are rounded to seven significant digits. The phase error between two
/// channels is then at most 3.2e-4 rad (at half the sampling rate).
const SAME_START: f64 = 1e-4;

/// Refuses a record whose samples are not at the times of the `first` record. Both records come
/// with their place or the name of their file.
///
/// # Errors
///
/// [`RodlabError::Request`] with numbers of samples, sampling rates and start times of both.
pub(crate) fn expect_same_times(
    (other, place): (&Record, &str),
    (first, of_first): (&Record, &str),
) -> Result<(), RodlabError> {
    let rate_hz = first.sampling_rate_hz();
    let steps = (other.start_time() - first.start_time()) * rate_hz;
    if (other.sampling_rate_hz() / rate_hz - 1.0).abs() <= SAME_RATE
        && other.n_samples() == first.n_samples()
        && steps.abs() <= SAME_START
    {
        return Ok(());
    }
    let times = |record: &Record| {
        format!(
            "{} samples at {} Hz from {} s",
            record.n_samples(),
            record.sampling_rate_hz(),
            record.start_time()
        )
    };
    Err(RodlabError::request(
        place,
        times(other),
        format!("those of {of_first}: {}", times(first)),
    ))
}

impl FileSet<'_> {
    /// Merges the records of all files, record by record: the channels are in the order of the
    /// sheet, the provenance is that of the first file. If a file has lost a sample, the hit is
    /// lost.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Request`] for files with different numbers of records, and for records with
    /// different times.
    pub(super) fn merged(&self, first: Part, others: Vec<Part>) -> Result<Part, RodlabError> {
        if others.is_empty() {
            return Ok(first);
        }
        let n_records = first.n_records();
        for (file, part) in self.others.iter().zip(&others) {
            if part.n_records() != n_records {
                return Err(RodlabError::request(
                    file.place.as_str(),
                    format!("{} with {}", file.shown, count(part.n_records())),
                    format!("{}, as in {}", count(n_records), self.first.shown),
                ));
            }
        }
        let of_first = match first {
            Part::Records(records) => records,
            lost => return Ok(lost.in_file(&self.first.shown)),
        };
        let mut of_others = Vec::with_capacity(others.len());
        for (file, part) in self.others.iter().zip(others) {
            match part {
                Part::Records(records) => of_others.push(records),
                lost => return Ok(lost.in_file(&file.shown)),
            }
        }
        let merged = of_first.iter().enumerate().map(|(n, first)| {
            let others: Vec<&Record> = of_others.iter().filter_map(|all| all.get(n)).collect();
            self.merged_record(first, &others, |file| record_name(file, n + 1, n_records))
        });
        Ok(Part::Records(merged.collect::<Result<_, _>>()?))
    }

    /// Merges one record of each file; `named` returns the name of the record in a file.
    fn merged_record(
        &self,
        first: &Record,
        others: &[&Record],
        named: impl Fn(&str) -> String,
    ) -> Result<Record, RodlabError> {
        for (file, other) in self.others.iter().zip(others) {
            let place = format!("{}, {}", file.place, named(&file.shown));
            expect_same_times((other, &place), (first, &named(&self.first.shown)))?;
        }
        let all = std::iter::once(first).chain(others.iter().copied());
        let mut rows: Vec<(usize, &Channel, ArrayView1<'_, f64>)> = Vec::new();
        for (file, record) in self.files().zip(all) {
            for ((at, _), (row, channel)) in file
                .channels
                .iter()
                .zip(record.channels().iter().enumerate())
            {
                let samples = record.samples().index_axis_move(Axis(0), row);
                rows.push((*at, channel, samples));
            }
        }
        rows.sort_by_key(|(at, ..)| *at);
        let samples: Vec<_> = rows.iter().map(|(.., samples)| *samples).collect();
        let refused = || format!("merging {}", named(&self.name()));
        Record::new(
            stack(Axis(0), &samples).in_step(refused())?,
            first.sampling_rate_hz(),
            first.start_time(),
            rows.into_iter()
                .map(|(_, channel, _)| channel.clone())
                .collect(),
            first.provenance().clone(),
        )
        .in_step(refused())
    }
}

/// Returns a number of records in words.
fn count(n: usize) -> String {
    match n {
        1 => "1 record".to_owned(),
        n => format!("{n} records"),
    }
}

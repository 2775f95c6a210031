//! Calibrated hits from files.

use std::path::{Path, PathBuf};

use numpy::{PyArray2, ToPyArray};
use pyo3::prelude::*;
use rodlab::RodlabError;
use rodlab::job::Job;

use crate::background::done;
use crate::errors::{raised_of_arguments, wrong};

/// Hit, with its record and the decisions on it.
#[pyclass(frozen, get_all, module = "rodlab._rodlab")]
#[derive(Debug)]
pub(crate) struct Hit {
    /// Name in the log of hits.
    name: String,
    /// True if the hit contributes to the average.
    accepted: bool,
    /// Reasons against the hit, and decisions made by hand.
    reasons: Vec<String>,
    /// Samples in SI, (n_channels, n_samples), float64.
    samples: Py<PyArray2<f64>>,
    /// Sampling rate in Hz.
    sampling_rate_hz: f64,
    /// Time of the first sample in s.
    start_time: f64,
}

/// Name, acceptance, reasons and record of one hit.
type Read = (String, bool, Vec<String>, labio::Record);

/// Returns the hits of the records in `text`, a sheet of frequency responses, with the (name, unit)
/// of each channel and the warnings.
#[pyfunction]
#[expect(
    clippy::type_complexity,
    reason = "it is taken apart at once, in Python"
)]
pub(crate) fn load(
    py: Python<'_>,
    text: &str,
    folder: PathBuf,
) -> PyResult<(Vec<Hit>, Vec<(String, &'static str)>, Vec<String>)> {
    let job = rodlab::job::parse(Path::new("arguments.ron"), text)
        .map_err(|error| raised_of_arguments(py, &error))?;
    let Job::Frf(sheet) = job else {
        return Err(wrong(py, "the text is a sheet of another job".to_owned()));
    };
    let (read, warnings) = done(py, None, move |_, _| -> Result<_, RodlabError> {
        let loaded = sheet.records.load(&folder, "records")?;
        let found = sheet.hits.find(loaded.records, &sheet.input, "hits")?;
        let hits: Vec<Read> = found
            .hits()
            .filter_map(|hit| {
                let entry = hit.log_entry();
                let record = hit.hit.record()?.clone();
                Some((entry.what, entry.accepted, entry.reasons, record))
            })
            .collect();
        Ok((hits, loaded.warnings))
    })?;
    let channels = read.first().map_or_else(Vec::new, |(_, _, _, record)| {
        let channels = record.channels().iter();
        channels
            .map(|channel| (channel.name().to_owned(), channel.quantity().unit()))
            .collect()
    });
    let hits = read
        .into_iter()
        .map(|(name, accepted, reasons, record)| Hit {
            name,
            accepted,
            reasons,
            samples: record.samples().to_pyarray(py).unbind(),
            sampling_rate_hz: record.sampling_rate_hz(),
            start_time: record.start_time(),
        })
        .collect();
    Ok((hits, channels, warnings))
}

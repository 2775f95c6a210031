//! Functions that run sheets from files or from memory, and the functions check, inspect, convert
//! and init.

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

use pyo3::prelude::*;
use rodlab::RodlabError;
use rodlab::convert::ConvertOptions;
use rodlab::finished::{finish, identity_of};
use rodlab::job::{self, Progress, Sheet};
use rodlab::output::{self, TableFiles};
use rodlab::sheet::{Exact, Frequency};
use rodlab::templates::{self, JobName, Rig};

use crate::background::done;
use crate::errors::{raised, raised_of_arguments, wrong};
use crate::outcome::Outcome;

/// Runs the sheet at `path`. With `write`, its files are written to `out`, or to the default folder
/// of the command if `out` is not given.
#[pyfunction]
#[pyo3(signature = (path, *, job=None, out=None, write=true, progress=None))]
pub(crate) fn run_sheet(
    py: Python<'_>,
    path: PathBuf,
    job: Option<String>,
    out: Option<PathBuf>,
    write: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Outcome> {
    let expected = job.map(|name| job_of(py, &name)).transpose()?;
    let work = move |progress: &dyn Progress, interrupted: &AtomicBool| {
        if write {
            let folder = out.unwrap_or_else(|| output::default_folder(&path));
            let job = expected.map(JobName::name);
            let done = finish(
                &path,
                job,
                &folder,
                TableFiles::default(),
                progress,
                interrupted,
            )?;
            return Outcome::new(done.outcome, done.sheet, done.files);
        }
        let sheet = Sheet::read(&path)?;
        let found = sheet.job.name();
        if let Some(expected) = expected.map(JobName::name).filter(|name| *name != found) {
            return Err(RodlabError::OtherJob {
                path,
                found,
                expected,
            });
        }
        let outcome = job::run(&sheet, progress, interrupted)?;
        Outcome::new(outcome, identity_of(&sheet), Vec::new())
    };
    done(py, progress, work)
}

/// Runs the sheet with the given `text`, whose relative paths refer to `folder`. Files are written
/// only if `out` is given.
#[pyfunction]
#[pyo3(signature = (text, folder, *, out=None, progress=None))]
pub(crate) fn run_text(
    py: Python<'_>,
    text: String,
    folder: PathBuf,
    out: Option<PathBuf>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Outcome> {
    let path = folder.join("arguments.ron");
    let job = job::parse(&path, &text).map_err(|error| raised_of_arguments(py, &error))?;
    let sheet = Sheet { path, text, job };
    done(py, progress, move |progress, interrupted| {
        let outcome = job::run(&sheet, progress, interrupted)?;
        if interrupted.load(Ordering::Relaxed) {
            return Err(RodlabError::Interrupted);
        }
        let identity = identity_of(&sheet);
        let inputs = outcome.inputs.iter();
        let reads: Vec<PathBuf> = inputs.map(|input| folder.join(&input.path)).collect();
        let files = match out {
            Some(out) => output::write(&outcome, &identity, &out, &reads)?,
            None => Vec::new(),
        };
        Outcome::new(outcome, identity, files)
    })
}

/// Reads the sheet at `path` and its files; returns the name of the job and the SHA-256 of the
/// sheet.
#[pyfunction]
pub(crate) fn check(py: Python<'_>, path: PathBuf) -> PyResult<(&'static str, String)> {
    done(py, None, move |progress, interrupted| {
        let sheet = Sheet::read(&path)?;
        job::check(&sheet, progress, interrupted)?;
        Ok((sheet.job.name(), identity_of(&sheet).sha256))
    })
}

/// Returns the contents of the recording at `path`, as JSON.
#[pyfunction]
pub(crate) fn inspect(py: Python<'_>, path: PathBuf) -> PyResult<String> {
    done(py, None, move |_, _| {
        json(&rodlab::inspect::inspect(&path)?)
    })
}

/// Writes the recording at `input` to `output` in another format. Returns a description of the
/// conversion as JSON.
#[pyfunction]
#[pyo3(signature = (input, output, *, tolerant=false, lossless=false, binary=false, force=false, sampling_rate=None))]
#[allow(clippy::too_many_arguments, reason = "they are keywords in Python")]
pub(crate) fn convert(
    py: Python<'_>,
    input: PathBuf,
    output: PathBuf,
    tolerant: bool,
    lossless: bool,
    binary: bool,
    force: bool,
    sampling_rate: Option<&str>,
) -> PyResult<String> {
    let rate = sampling_rate.map(str::parse::<Exact<Frequency>>);
    let rate = rate
        .transpose()
        .map_err(|error| wrong(py, format!("sampling_rate: {error}")))?;
    let options = ConvertOptions {
        tolerant,
        lossless,
        binary,
        force,
        rate_hz: rate.as_ref().map(Exact::si),
    };
    done(py, None, move |_, _| {
        json(&rodlab::convert::convert(&input, &output, options)?)
    })
}

/// Writes the commented sheet of `job`, or the one for the test rig `rig` of this job, to `path`,
/// which must not exist yet.
#[pyfunction]
#[pyo3(signature = (job, path, rig=None))]
pub(crate) fn init(py: Python<'_>, job: &str, path: PathBuf, rig: Option<&str>) -> PyResult<()> {
    let job = job_of(py, job)?;
    let rig = rig.map(|name| rig_of(py, name)).transpose()?;
    py.detach(|| templates::init(job, rig, &path))
        .map_err(|error| raised(py, &error))
}

fn rig_of(py: Python<'_>, name: &str) -> PyResult<Rig> {
    let found = Rig::ALL.into_iter().find(|rig| rig.name() == name);
    found.ok_or_else(|| {
        let names = Rig::ALL.map(Rig::name).join("`, `");
        wrong(py, format!("rig is `{name}`, expected one of `{names}`"))
    })
}

/// Runs a command line, given as words that begin with the name of the program. Returns the exit
/// status.
#[pyfunction]
pub(crate) fn command(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| rodlab::process::run(words))
}

fn job_of(py: Python<'_>, name: &str) -> PyResult<JobName> {
    let found = JobName::ALL.into_iter().find(|job| job.name() == name);
    found.ok_or_else(|| {
        let names = JobName::ALL.map(JobName::name).join("`, `");
        wrong(py, format!("job is `{name}`, expected one of `{names}`"))
    })
}

fn json(what: &impl serde::Serialize) -> Result<String, RodlabError> {
    serde_json::to_string(what).map_err(|error| RodlabError::step("writing JSON", error))
}

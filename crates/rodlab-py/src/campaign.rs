//! Campaigns of many sheets, and single tests of a campaign.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

use pyo3::prelude::*;
use rayon::ThreadPoolBuilder;
use rodlab::RodlabError;
use rodlab::batch::{self as campaign, Batch, Summary, Test};
use rodlab::job::Progress;
use rodlab::output::TableFiles;

use crate::background::done;

/// Returns the tests to which `places` (sheets, folders or patterns) refer as (name, path of the
/// sheet), in the order of the names.
#[pyfunction]
pub(crate) fn tests_of(py: Python<'_>, places: Vec<String>) -> PyResult<Vec<(String, PathBuf)>> {
    let tests = done(py, None, move |_, _| campaign::tests_of(&places))?;
    let pairs = tests.into_iter().map(|test| (test.name, test.sheet));
    Ok(pairs.collect())
}

/// Runs all tests to which `places` refer, `jobs` at a time, and writes their summary. Returns the
/// summary as JSON.
#[pyfunction]
#[pyo3(signature = (places, out, *, resume=false, jobs=None, progress=None))]
pub(crate) fn batch(
    py: Python<'_>,
    places: Vec<String>,
    out: PathBuf,
    resume: bool,
    jobs: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let work = move |progress: &dyn Progress, interrupted: &AtomicBool| {
        let pool = ThreadPoolBuilder::new()
            .num_threads(jobs.unwrap_or(0))
            .build()
            .map_err(|error| RodlabError::step("starting threads", error))?;
        let batch = Batch {
            tests: campaign::tests_of(&places)?,
            out,
            resume,
            shard: None,
            tables: TableFiles::default(),
        };
        let rows = pool.install(|| batch.run(&|_| {}, progress, interrupted));
        if interrupted.load(Ordering::Relaxed) {
            return Err(RodlabError::Interrupted);
        }
        let summary = Summary::of(rows);
        campaign::write_summary(&summary, &batch.out)?;
        summary.to_json()
    };
    done(py, progress, work)
}

/// Runs the test `name` of the campaign in `out`; with `resume`, only if it has no current result.
/// Returns its standing as a word.
#[pyfunction]
pub(crate) fn one_test(
    py: Python<'_>,
    name: String,
    sheet: PathBuf,
    out: PathBuf,
    resume: bool,
) -> PyResult<&'static str> {
    done(py, None, move |progress, interrupted| {
        let batch = Batch {
            tests: vec![Test { name, sheet }],
            out,
            resume,
            shard: None,
            tables: TableFiles::default(),
        };
        let rows = batch.run(&|_| {}, progress, interrupted);
        let row = rows.first().ok_or(RodlabError::Interrupted)?;
        Ok(row.status.word())
    })
}

//! Runs the benchmarks of the crates, and reads the files that criterion writes.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use super::Pace;
use super::error::BenchError;
use super::measured::{Benchmark, four_digits};

/// Benchmark program `crates/CRATE/benches/NAME.rs`.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct BenchProgram {
    pub(super) folder: String,
    pub(super) name: String,
}

impl BenchProgram {
    /// Returns the path as in [`Benchmark::program`].
    pub(super) fn path(&self) -> String {
        format!("{}/{}", self.folder, self.name)
    }
}

/// Returns all benchmark programs, in the order of their names.
pub(super) fn programs(root: &Path) -> Result<Vec<BenchProgram>, BenchError> {
    let mut programs = Vec::new();
    for folder in entries(&root.join("crates"))? {
        let benches = folder.join("benches");
        if !benches.is_dir() {
            continue;
        }
        for file in entries(&benches)? {
            if file.extension().is_some_and(|extension| extension == "rs") {
                programs.push(BenchProgram {
                    folder: stem(&folder),
                    name: stem(&file),
                });
            }
        }
    }
    programs.sort();
    Ok(programs)
}

/// Builds and runs one benchmark program at `pace`. Criterion writes to a folder below `home`,
/// which is emptied first.
pub(super) fn run(
    root: &Path,
    program: &BenchProgram,
    pace: Pace,
    home: &Path,
) -> Result<Vec<Benchmark>, BenchError> {
    let home = home.join(&program.folder).join(&program.name);
    if home.exists() {
        fs::remove_dir_all(&home).map_err(BenchError::at(&home))?;
    }
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command
        .args(["bench", "--quiet", "--locked", "--workspace", "--bench"])
        .arg(&program.name)
        .args(["--", "--noplot", "--quiet", "--nresamples", "10000"])
        .args(["--warm-up-time", pace.warm_up_seconds()])
        .args(["--measurement-time", pace.measurement_seconds()])
        .args(["--sample-size", pace.samples()])
        .current_dir(root)
        .env("CRITERION_HOME", &home)
        .stdin(Stdio::null());
    let shown = format!("cargo bench --workspace --bench {}", program.name);
    let output = command.output().map_err(|source| BenchError::Command {
        command: shown.clone(),
        reason: source.to_string(),
    })?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        let error = said
            .lines()
            .find(|line| line.contains("error") || line.contains("panicked"));
        let reason = match error {
            Some(line) => format!("{}, expected 0: {line}", output.status),
            None => format!("{}, expected 0", output.status),
        };
        return Err(BenchError::Command {
            command: shown,
            reason,
        });
    }
    let mut found = Vec::new();
    collect(&home, program, &mut found)?;
    if found.is_empty() {
        return Err(BenchError::Command {
            command: shown,
            reason: format!("no estimates below {}", home.display()),
        });
    }
    found.sort_by(|a, b| a.id.cmp(&b.id));
    Ok(found)
}

/// Collects the estimates in every folder `new` below `folder`.
fn collect(
    folder: &Path,
    program: &BenchProgram,
    found: &mut Vec<Benchmark>,
) -> Result<(), BenchError> {
    for entry in entries(folder)? {
        if !entry.is_dir() {
            continue;
        }
        if stem(&entry) == "new" {
            found.push(benchmark(&entry, program)?);
        } else {
            collect(&entry, program, found)?;
        }
    }
    Ok(())
}

fn benchmark(folder: &Path, program: &BenchProgram) -> Result<Benchmark, BenchError> {
    let (name, estimates) = (folder.join("benchmark.json"), folder.join("estimates.json"));
    let (description, values) = (json(&name)?, json(&estimates)?);
    let missing = |path: &Path, key: &str| BenchError::Json {
        path: path.to_path_buf(),
        reason: format!("no `{key}`, which this version of criterion should write"),
    };
    let id = description["full_id"]
        .as_str()
        .ok_or_else(|| missing(&name, "full_id"))?;
    let estimate = |key: &str| {
        values[key]["point_estimate"]
            .as_f64()
            .filter(|nanoseconds| nanoseconds.is_finite())
            .map(|nanoseconds| four_digits(nanoseconds * 1e-9))
            .ok_or_else(|| missing(&estimates, key))
    };
    let sample = folder.join("sample.json");
    let shortest = shortest(&json(&sample)?).ok_or_else(|| missing(&sample, "iters and times"))?;
    let throughput = &description["throughput"];
    Ok(Benchmark {
        program: program.path(),
        id: id.to_owned(),
        median: estimate("median")?,
        least: four_digits(shortest * 1e-9),
        deviation: estimate("median_abs_dev")?,
        elements: throughput["Elements"]
            .as_u64()
            .or_else(|| throughput["Bytes"].as_u64()),
    })
}

/// Returns the shortest mean time per iteration among the samples \[ns\].
fn shortest(sample: &Value) -> Option<f64> {
    let (iterations, times) = (sample["iters"].as_array()?, sample["times"].as_array()?);
    iterations
        .iter()
        .zip(times)
        .filter_map(|(iterations, time)| Some(time.as_f64()? / iterations.as_f64()?))
        .min_by(f64::total_cmp)
}

fn json(path: &Path) -> Result<Value, BenchError> {
    let text = fs::read_to_string(path).map_err(BenchError::at(path))?;
    serde_json::from_str(&text).map_err(|error| BenchError::Json {
        path: path.to_path_buf(),
        reason: error.to_string(),
    })
}

/// Returns the entries of a folder, in the order of their names.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, BenchError> {
    let fail = BenchError::at(folder);
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).map_err(fail)? {
        paths.push(entry.map_err(fail)?.path());
    }
    paths.sort();
    Ok(paths)
}

fn stem(path: &Path) -> String {
    path.file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

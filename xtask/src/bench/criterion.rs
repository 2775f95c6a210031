//! Runs the benchmarks of the crates, and reads the files that criterion writes.

use std::fs;
use std::path::Path;
use std::process::Stdio;

use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::Outcome;
use crate::cargo::{cargo, run as run_command};
use crate::files::{at, read};
use testbed::papers::files;

use super::Pace;
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
pub(super) fn programs(root: &Path) -> Outcome<Vec<BenchProgram>> {
    let mut programs = Vec::new();
    for folder in files(&root.join("crates"))? {
        let benches = folder.join("benches");
        if !benches.is_dir() {
            continue;
        }
        for file in files(&benches)? {
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
) -> Outcome<Vec<Benchmark>> {
    let home = home.join(&program.folder).join(&program.name);
    if home.exists() {
        fs::remove_dir_all(&home).map_err(at(&home))?;
    }
    let mut command = cargo();
    command
        .args(["bench", "--quiet", "--locked", "--workspace", "--bench"])
        .arg(&program.name)
        .args(["--", "--noplot", "--quiet", "--nresamples", "10000"])
        .args(["--warm-up-time", pace.choose("0.3", "0.1")])
        .args(["--measurement-time", pace.choose("0.7", "0.2")])
        .args(["--sample-size", pace.choose("20", "10")])
        .current_dir(root)
        .env("CRITERION_HOME", &home)
        .stdin(Stdio::null());
    run_command(&mut command)?;
    let mut found = Vec::new();
    collect(&home, program, &mut found)?;
    if found.is_empty() {
        return Err(format!("{}: no estimates below {}", program.name, home.display()).into());
    }
    found.sort_by(|a, b| a.id.cmp(&b.id));
    Ok(found)
}

/// Collects the estimates in every folder `new` below `folder`.
fn collect(folder: &Path, program: &BenchProgram, found: &mut Vec<Benchmark>) -> Outcome {
    for entry in files(folder)? {
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

/// Fields of `benchmark.json` that are read.
#[derive(Deserialize)]
struct Description {
    full_id: String,
    throughput: Option<Throughput>,
}

#[derive(Deserialize)]
enum Throughput {
    #[serde(alias = "Bytes")]
    Elements(u64),
}

/// Fields of `estimates.json` that are read \[ns\].
#[derive(Deserialize)]
struct Estimates {
    median: Estimate,
    median_abs_dev: Estimate,
}

#[derive(Deserialize)]
struct Estimate {
    point_estimate: f64,
}

/// Fields of `sample.json` that are read: the iterations and the time \[ns\] of each sample.
#[derive(Deserialize)]
struct Sample {
    iters: Vec<f64>,
    times: Vec<f64>,
}

fn benchmark(folder: &Path, program: &BenchProgram) -> Outcome<Benchmark> {
    let description: Description = json(&folder.join("benchmark.json"))?;
    let estimates: Estimates = json(&folder.join("estimates.json"))?;
    let sample: Sample = json(&folder.join("sample.json"))?;
    let times = sample.iters.iter().zip(&sample.times);
    let shortest = times.map(|(iterations, time)| time / iterations);
    let shortest = shortest.min_by(f64::total_cmp).ok_or("no samples")?;
    Ok(Benchmark {
        program: program.path(),
        id: description.full_id,
        median: four_digits(estimates.median.point_estimate * 1e-9),
        least: four_digits(shortest * 1e-9),
        deviation: four_digits(estimates.median_abs_dev.point_estimate * 1e-9),
        elements: description
            .throughput
            .map(|Throughput::Elements(count)| count),
    })
}

fn json<T: DeserializeOwned>(path: &Path) -> Outcome<T> {
    Ok(serde_json::from_str(&read(path)?)
        .map_err(|error| format!("{}: {error}", path.display()))?)
}

fn stem(path: &Path) -> String {
    path.file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

//! Whole programs, timed from outside: the command, its campaigns, the reproductions of the papers,
//! and the spectra of a long stream.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use super::measured::{Measured, Program, four_digits};
use super::{Pace, criterion};
use crate::Outcome;
use crate::cargo::{cargo, run};
use crate::files::{at, read};

/// Programs that take a minute or more; a quick run keeps their earlier measurements.
const LONG: [&str; 3] = [LONG_HITS, FORCES, MANY_MODULI];
/// Number of samples per channel: of the stream, and of a long hit.
const STREAMED: &str = "100000000";
const LONG_HIT: usize = 10_000_000;

/// Programs with their input, in a separate folder.
pub(super) struct Programs {
    folder: PathBuf,
    rodlab: PathBuf,
    stream: PathBuf,
    xtask: PathBuf,
    root: PathBuf,
}

/// Names that rows of docs/performance.ron may use.
pub(super) const NAMES: [&str; 15] = [
    HELP,
    MODULUS,
    LONG_HITS,
    FORCES,
    MODULI,
    MANY_MODULI,
    LAWS,
    STREAM,
    COPY,
    "reproduce-paper-a",
    "reproduce-paper-b",
    "reproduce-paper-c",
    "reproduce-paper-d",
    "reproduce-paper-e",
    ALL_PAPERS,
];
const HELP: &str = "rodlab --help";
const MODULUS: &str = "rodlab modulus, ten hits";
const LONG_HITS: &str = "rodlab modulus, two hits of 1e7 samples";
const FORCES: &str = "rodlab batch, 1000 forces";
const MODULI: &str = "rodlab batch, 100 moduli";
const MANY_MODULI: &str = "rodlab batch, 1000 moduli";
const LAWS: &str = "rodlab batch, 100 moduli with three laws";
const STREAM: &str = "spectra of a stream of 1e8 samples";
const COPY: &str = "cat of the stream";
const ALL_PAPERS: &str = "reproduce-all";

impl Programs {
    /// Builds the programs in the profile of the benchmarks, and makes the sheets and records.
    pub(super) fn prepare(root: &Path, folder: &Path) -> Outcome<Self> {
        // the profile of the benchmarks is used, to avoid building twice
        let mut build = cargo();
        build
            .args(["build", "--quiet", "--profile", "bench", "--locked"])
            .args([
                "--workspace",
                "--bin",
                "rodlab",
                "--example",
                "stream_long_record",
            ])
            .current_dir(root);
        // named one by one: `--benches` would also build the unit tests of the crates
        for bench in criterion::programs(root)? {
            build.args(["--bench", &bench.name]);
        }
        run(&mut build)?;
        let xtask = std::env::current_exe()?;
        let built = xtask.parent().unwrap_or(Path::new(".")).to_path_buf();
        let programs = Self {
            folder: folder.to_path_buf(),
            rodlab: built.join("rodlab"),
            stream: built.join("examples/stream_long_record"),
            xtask,
            root: root.to_path_buf(),
        };
        if folder.exists() {
            fs::remove_dir_all(folder).map_err(at(folder))?;
        }
        fs::create_dir_all(folder).map_err(at(folder))?;
        programs.ten_hits()?;
        programs.campaigns()?;
        run(&mut programs.streamed())?;
        Ok(programs)
    }

    /// Returns the program that streams the long record; its first run writes the record.
    fn streamed(&self) -> Command {
        let mut command = Command::new(&self.stream);
        command
            .args([STREAMED, "stream.f64"])
            .current_dir(&self.folder);
        command
    }

    /// Times all programs, several times if it is short. A quick run takes the times of
    /// the long programs from `before`.
    pub(super) fn time(&self, pace: Pace, before: &Measured) -> Outcome<Vec<Program>> {
        let short = pace.choose(11, 3);
        let results = self.folder.join("results");
        let mut timed = Vec::new();
        let mut add = |name: &str, runs: usize, command: &dyn Fn() -> Command| {
            if pace == Pace::Quick && LONG.contains(&name) {
                timed.extend(before.program(name).cloned());
                return Ok(());
            }
            eprintln!("  {name}");
            timed.push(timed_runs(name, runs, command)?);
            // the next program must not find these files, which may be a thousand reports
            if results.exists() {
                fs::remove_dir_all(&results).map_err(at(&results))?;
            }
            Outcome::Ok(())
        };
        add(HELP, 2 * short, &|| self.rodlab(&["--help"]))?;
        let quiet = |task: &str, of: &str| {
            let mut command = self.rodlab(&[task, of, "--quiet", "--out"]);
            command.arg(&results);
            command
        };
        add(MODULUS, short, &|| quiet("modulus", "ten-hits/modulus.ron"))?;
        if pace == Pace::Whole {
            self.long_hits()?;
        }
        add(LONG_HITS, 1, &|| quiet("modulus", "long/modulus.ron"))?;
        for (name, campaign) in [
            (FORCES, "forces"),
            (MODULI, "moduli"),
            (MANY_MODULI, "many"),
            (LAWS, "laws"),
        ] {
            add(name, 1, &|| quiet("batch", campaign))?;
        }
        let few = 3.min(short);
        add(STREAM, few, &|| self.streamed())?;
        add(COPY, few, &|| {
            let mut command = Command::new("cat");
            command.arg("stream.f64").current_dir(&self.folder);
            command
        })?;
        for paper in ["a", "b", "c", "d", "e"] {
            add(&format!("reproduce-paper-{paper}"), 1, &|| {
                let mut command = Command::new(&self.xtask);
                command
                    .arg(format!("reproduce-paper-{paper}"))
                    .current_dir(&self.root);
                command
            })?;
        }
        // the sum, because the task that reproduces all papers runs them one after the other
        let papers = timed
            .iter()
            .filter(|program| program.name.starts_with("reproduce-paper"));
        let all = four_digits(papers.clone().map(|program| program.median).sum());
        let peak_memory = papers.map(|program| program.peak_memory).max().flatten();
        timed.push(Program {
            name: ALL_PAPERS.to_owned(),
            runs: 1,
            median: all,
            least: all,
            greatest: all,
            peak_memory,
        });
        Ok(timed)
    }

    fn rodlab(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(&self.rodlab);
        command.args(arguments).current_dir(&self.folder);
        command
    }

    /// Writes ten hits with two channels of 65 536 samples: the plan of the example, with more and
    /// longer records.
    fn ten_hits(&self) -> Outcome {
        let example = self.root.join("crates/rodlab/examples/polypropylene");
        let folder = self.folder.join("ten-hits");
        let plan = changed(
            &example.join("plan.ron"),
            &[("hits: 5", "hits: 10"), ("\"31.25 ms\"", "\"1 s\"")],
        )?;
        write(&folder.join("plan.ron"), &plan)?;
        let sheet = changed(
            &example.join("modulus.ron"),
            &[("hits-*.npy", "records/hits-*.npy")],
        )?;
        write(&folder.join("modulus.ron"), &without_laws(&sheet))?;
        run(&mut self.rodlab(&[
            "simulate",
            "ten-hits/plan.ron",
            "--quiet",
            "--out",
            "ten-hits/records",
        ]))?;
        Ok(())
    }

    /// Writes two hits of the example, each channel extended to ten million samples by noise of a
    /// millionth of its largest sample.
    fn long_hits(&self) -> Outcome {
        let example = self.root.join("crates/rodlab/examples/polypropylene");
        let folder = self.folder.join("long");
        let sheet = changed(&example.join("modulus.ron"), &[])?;
        write(&folder.join("modulus.ron"), &without_laws(&sheet))?;
        for name in ["hits-1.npy", "hits-2.npy"] {
            let path = example.join(name);
            let bytes = fs::read(&path).map_err(at(&path))?;
            let long = continued(&bytes, LONG_HIT).ok_or_else(|| {
                let path = path.display();
                format!("{path}: expected two rows of doubles after a header of 128 bytes")
            })?;
            let path = folder.join(name);
            fs::write(&path, long).map_err(at(&path))?;
        }
        Ok(())
    }

    /// Writes folders of sheets: forces at a thousand velocities; and moduli from the records of
    /// the example, a hundred with laws, a hundred and a thousand without laws.
    fn campaigns(&self) -> Outcome {
        let examples = self.root.join("crates/rodlab/examples");
        for number in 0..1000 {
            let velocity = format!("{:.3} m/s ± 1 %", 0.5 + 0.001 * f64::from(number));
            let sheet = changed(
                &examples.join("cone/force.ron"),
                &[("0.93 m/s ± 1 %", &velocity)],
            )?;
            write(&self.folder.join(format!("forces/{number:04}.ron")), &sheet)?;
        }
        let records = examples.join("polypropylene/hits-*.npy");
        let with_laws = changed(
            &examples.join("polypropylene/modulus.ron"),
            &[("hits-*.npy", &records.display().to_string())],
        )?;
        for (campaign, tests, sheet) in [
            ("laws", 100, with_laws.clone()),
            ("moduli", 100, without_laws(&with_laws)),
            ("many", 1000, without_laws(&with_laws)),
        ] {
            for number in 0..tests {
                write(
                    &self.folder.join(format!("{campaign}/{number:04}.ron")),
                    &sheet,
                )?;
            }
        }
        Ok(())
    }
}

/// Returns an NPY file of two rows of doubles, extended to `samples` columns by noise from a linear
/// congruential generator.
pub(super) fn continued(file: &[u8], samples: usize) -> Option<Vec<u8>> {
    let (header, data) = file.split_at_checked(128)?;
    let header = std::str::from_utf8(header.get(10..)?).ok()?;
    let (before, rest) = header.split_once("'shape': (2, ")?;
    let (there, _) = rest.split_once(')')?;
    let there: usize = there.parse().ok()?;
    if data.len() != 2 * 8 * there {
        return None;
    }
    let shape = format!("{before}'shape': (2, {samples}), }}");
    let mut long = file.get(..10)?.to_vec();
    long.extend(format!("{shape:<117}\n").bytes());
    let mut state = 1_u64;
    for row in data.chunks_exact(8 * there) {
        let values = row
            .as_chunks()
            .0
            .iter()
            .map(|bytes| f64::from_le_bytes(*bytes));
        let greatest = values.fold(0.0, |greatest: f64, value| greatest.max(value.abs()));
        long.extend_from_slice(row);
        for _ in there..samples {
            let noise = 1e-6 * greatest * super::kernel::noise(&mut state);
            long.extend_from_slice(&noise.to_le_bytes());
        }
    }
    Some(long)
}

/// Returns the sheet without its fits.
fn without_laws(sheet: &str) -> String {
    let mut kept = String::new();
    let mut inside = false;
    for line in sheet.lines() {
        inside |= line.starts_with("    laws: (");
        if !inside {
            kept.push_str(line);
            kept.push('\n');
        }
        inside &= line != "    ),";
    }
    kept
}

/// Returns the text of an example after the `replacements`. A replaced text that the example does
/// not contain is an error.
fn changed(path: &Path, replacements: &[(&str, &str)]) -> Outcome<String> {
    let mut text = read(path)?;
    for (from, to) in replacements {
        if !text.contains(from) {
            let path = path.display();
            return Err(format!("{path}: no `{from}` to replace by `{to}`").into());
        }
        text = text.replace(from, to);
    }
    Ok(text)
}

fn write(path: &Path, text: &str) -> Outcome {
    fs::create_dir_all(path.parent().unwrap_or(Path::new("."))).map_err(at(path))?;
    Ok(fs::write(path, text).map_err(at(path))?)
}

/// Returns the wall-clock time of a run \[s\] and the maximum resident memory \[bytes\].
fn watched(command: &mut Command) -> Outcome<(f64, Option<u64>)> {
    let shown = format!("{command:?}");
    let fail = |reason: String| format!("`{shown}`: {reason}");
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    let started = Instant::now();
    let child = command.spawn().map_err(|error| fail(error.to_string()))?;
    let (process, done) = (child.id(), AtomicBool::new(false));
    thread::scope(|scope| {
        let watcher = scope.spawn(|| {
            let mut peak = None;
            while !done.load(Ordering::Relaxed) {
                peak = peak_memory(process).max(peak);
                thread::sleep(Duration::from_millis(1));
            }
            peak
        });
        let output = child.wait_with_output();
        let seconds = started.elapsed().as_secs_f64();
        done.store(true, Ordering::Relaxed);
        let peak = watcher.join().unwrap_or(None);
        let output = output.map_err(|error| fail(error.to_string()))?;
        if output.status.success() {
            Ok((seconds, peak))
        } else {
            let said = String::from_utf8_lossy(&output.stderr);
            let last = said.trim().lines().last().unwrap_or_default().to_owned();
            Err(fail(format!("{}, expected 0: {last}", output.status)).into())
        }
    })
}

/// Returns the largest resident memory that a running process has had, as Linux records it. A
/// program that ends within a millisecond may be missed.
fn peak_memory(process: u32) -> Option<u64> {
    let status = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kilobytes)
}

/// Returns the median and the extremes of `runs` runs. If `runs` is more than 1, an additional
/// first run is not timed.
fn timed_runs(name: &str, runs: usize, command: &dyn Fn() -> Command) -> Outcome<Program> {
    let mut peak = None;
    if runs > 1 {
        peak = watched(&mut command())?.1;
    }
    let mut seconds = Vec::with_capacity(runs);
    for _ in 0..runs.max(1) {
        let (time, memory) = watched(&mut command())?;
        seconds.push(time);
        peak = memory.max(peak);
    }
    seconds.sort_by(f64::total_cmp);
    let at = |index: usize| four_digits(seconds.get(index).copied().unwrap_or(f64::NAN));
    Ok(Program {
        name: name.to_owned(),
        runs: seconds.len(),
        median: at(seconds.len() / 2),
        least: at(0),
        greatest: at(seconds.len() - 1),
        peak_memory: peak,
    })
}

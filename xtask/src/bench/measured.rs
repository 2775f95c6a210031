//! docs/performance-measured.ron: the numbers of one run, from which the page is made.

use std::path::Path;

use serde::{Deserialize, Serialize};

use testbed::generated::write_whole;

use crate::Outcome;
use crate::files::read;
use testbed::ron_text::parse_ron;

/// Contents of the file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Measured {
    pub(super) machine: Machine,
    pub(super) benchmarks: Vec<Benchmark>,
    pub(super) programs: Vec<Program>,
    /// Instruction counts in the release profile.
    pub(super) instructions: Instructions,
    /// Instruction counts in the dev profile, which the gate uses.
    #[serde(default)]
    pub(super) instructions_in_gate: Instructions,
    /// Results of the previous run.
    #[serde(default)]
    pub(super) before: Vec<Before>,
}

/// Result of a row in the previous run, in the unit of the row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Before {
    pub(super) what: String,
    pub(super) ours: f64,
}

/// Machine on which the run was made.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Machine {
    pub(super) processor: String,
    pub(super) processors: usize,
    pub(super) system: String,
    pub(super) compiler: String,
    /// Mean number of processes that were running or waiting for a processor in the minute before
    /// the run; `None` if the system does not report it.
    pub(super) load_before: Option<f64>,
    /// True for a quick run.
    #[serde(default)]
    pub(super) quick: bool,
}

/// Result of criterion for one benchmark.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Benchmark {
    /// Crate and file of the benchmark, such as `rodwave/chain`.
    pub(super) program: String,
    /// Group and name of the benchmark.
    pub(super) id: String,
    /// Median time of an iteration \[s\].
    pub(super) median: f64,
    /// Shortest time \[s\], which a busy machine affects least.
    pub(super) least: f64,
    /// Median absolute deviation from the median \[s\].
    pub(super) deviation: f64,
    /// Elements per iteration, if the benchmark states them.
    pub(super) elements: Option<u64>,
}

/// Result of a whole process.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Program {
    pub(super) name: String,
    pub(super) runs: usize,
    /// Median of the wall-clock times \[s\].
    pub(super) median: f64,
    pub(super) least: f64,
    pub(super) greatest: f64,
    /// Maximum resident memory \[bytes\]; `None` if the machine does not report it.
    pub(super) peak_memory: Option<u64>,
}

/// Instruction counts of the hottest kernels.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Instructions {
    pub(super) counted_by: String,
    pub(super) compiler: String,
    pub(super) kernels: Vec<KernelCount>,
}

/// Instruction count of one call.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct KernelCount {
    pub(super) name: String,
    pub(super) instructions: u64,
    /// Difference between the largest and the smallest count of the runs.
    pub(super) spread: u64,
}

impl Measured {
    pub(super) fn read(path: &Path) -> Outcome<Self> {
        Ok(parse_ron(path, &read(path)?)?)
    }

    pub(super) fn write(&self, path: &Path) -> Outcome {
        let pretty = ron::ser::PrettyConfig::new()
            .depth_limit(2)
            .struct_names(false);
        let head = "// Measured by `cargo xtask bench`, which makes performance.md of it and of performance.ron: do not edit by hand.\n";
        let text = ron::ser::to_string_pretty(self, pretty)?;
        write_whole(path, &format!("{head}{text}\n"))?;
        Ok(())
    }

    /// Returns the counts for the profile in which this program is built.
    pub(super) fn own_instructions(&mut self) -> &mut Instructions {
        if cfg!(debug_assertions) {
            &mut self.instructions_in_gate
        } else {
            &mut self.instructions
        }
    }

    pub(super) fn benchmark(&self, id: &str) -> Option<&Benchmark> {
        self.benchmarks.iter().find(|benchmark| benchmark.id == id)
    }

    pub(super) fn program(&self, name: &str) -> Option<&Program> {
        self.programs.iter().find(|program| program.name == name)
    }
}

impl Benchmark {
    /// Returns the number of elements per second if an iteration takes `time` \[s\].
    pub(super) fn rate(&self, time: f64) -> Option<f64> {
        self.elements.map(|elements| elements as f64 / time)
    }
}

/// Rounds to four significant digits: a run is not repeatable to more digits, and the file remains
/// readable.
pub(super) fn four_digits(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

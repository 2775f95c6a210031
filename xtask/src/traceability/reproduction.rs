//! What the tasks `reproduce-paper-x` give: files that they write, and numbers that are compared with a snapshot.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde_json::Value;

use super::error::TraceabilityError;
use super::workspace::{Nearest, Unresolved, Workspace};

/// One task for each paper.
const TASKS: [(&str, &str); 5] = [
    ("reproduce-paper-a", "ReproducePaperA"),
    ("reproduce-paper-b", "ReproducePaperB"),
    ("reproduce-paper-c", "ReproducePaperC"),
    ("reproduce-paper-d", "ReproducePaperD"),
    ("reproduce-paper-e", "ReproducePaperE"),
];

/// What is known of one task.
#[derive(Debug, Default)]
struct Task {
    /// Names of files among the strings of its source.
    files: Vec<String>,
    /// Keys of its snapshot.
    keys: Vec<String>,
}

/// What the tasks give.
#[derive(Debug, Default)]
pub(crate) struct Reproductions {
    tasks: BTreeMap<&'static str, Task>,
}

impl Reproductions {
    /// Of the tasks that the command line of `workspace` has.
    pub(crate) fn read(root: &Path, workspace: &Workspace) -> Result<Self, TraceabilityError> {
        let mut tasks = BTreeMap::new();
        for (task, variant) in TASKS {
            let variant = format!("Task::{variant}");
            if !workspace
                .items("xtask/src/main.rs")
                .any(|item| item == variant)
            {
                continue;
            }
            let path = root.join(snapshot(task));
            let fail = |reason: String| TraceabilityError::Snapshot {
                path: path.clone(),
                reason,
            };
            let text = fs::read_to_string(&path).map_err(|error| fail(error.to_string()))?;
            let keys = match serde_json::from_str(&text) {
                Ok(Value::Object(entries)) => entries.keys().cloned().collect(),
                Ok(other) => return Err(fail(format!("found {other}, expected an object"))),
                Err(error) => return Err(fail(error.to_string())),
            };
            let files = workspace
                .strings(&source(task))
                .filter(|text| is_file(text))
                .map(str::to_owned)
                .collect();
            tasks.insert(task, Task { files, keys });
        }
        Ok(Self { tasks })
    }

    /// Whether `reference`, `task::file` or `task::key`, names something that the task gives.
    pub(crate) fn resolve(&self, reference: &str) -> Result<(), Unresolved> {
        let (task, what) = reference.split_once("::").ok_or_else(|| Unresolved::Form {
            reference: reference.to_owned(),
            expected: "`task::file` or `task::key`",
        })?;
        let given = self.tasks.get(task).ok_or_else(|| Unresolved::Task {
            task: task.to_owned(),
            nearest: Nearest::to(task, self.tasks.keys().copied()),
        })?;
        let (names, is_file) = match is_file(what) {
            true => (&given.files, true),
            false => (&given.keys, false),
        };
        if names.iter().any(|name| name == what) {
            return Ok(());
        }
        let (task, nearest) = (
            task.to_owned(),
            Nearest::to(what, names.iter().map(String::as_str)),
        );
        Err(if is_file {
            Unresolved::Written {
                task,
                file: what.to_owned(),
                nearest,
            }
        } else {
            Unresolved::Key {
                task,
                key: what.to_owned(),
                nearest,
            }
        })
    }

    #[cfg(test)]
    pub(crate) fn of(task: &'static str, files: &[&str], keys: &[&str]) -> Self {
        let owned = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        Self {
            tasks: [(
                task,
                Task {
                    files: owned(files),
                    keys: owned(keys),
                },
            )]
            .into(),
        }
    }
}

/// Whether the name is that of a figure or a table of numbers.
pub(crate) fn is_file(name: &str) -> bool {
    [".svg", ".csv"].iter().any(|ending| name.ends_with(ending))
}

/// The source of a task, from the root of the workspace.
pub(crate) fn source(task: &str) -> String {
    format!(
        "xtask/src/reproduce/{}.rs",
        task.trim_start_matches("reproduce-").replace('-', "_")
    )
}

/// The snapshot of a task, from the root of the workspace.
pub(crate) fn snapshot(task: &str) -> String {
    format!("xtask/snapshots/{task}.json")
}

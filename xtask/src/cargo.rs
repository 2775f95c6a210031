//! Calls of cargo and other programs, and what `cargo metadata` says of packages.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde::Deserialize;

use testbed::generated::workspace_root;

/// The cargo that runs this task.
pub(crate) fn cargo() -> Command {
    Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Where cargo keeps what it has compiled for this workspace.
pub(crate) fn target_folder() -> PathBuf {
    // a relative one is meant from where cargo was called, and a task runs there too
    let named = std::env::var_os("CARGO_TARGET_DIR").map(std::path::absolute);
    match named {
        Some(Ok(folder)) => folder,
        _ => workspace_root().join("target"),
    }
}

/// Why a call of cargo came to nothing.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CargoError {
    #[error("`{call}` ended with {status}:\n{said}")]
    Failed {
        call: String,
        status: String,
        said: String,
    },
    #[error("`{call}`: {source}")]
    NotStarted {
        call: String,
        source: std::io::Error,
    },
    #[error("`{call}` wrote what is not the JSON that was expected: {source}")]
    NotMetadata {
        call: String,
        source: serde_json::Error,
    },
}

/// What a successful call wrote.
#[derive(Debug)]
pub(crate) struct Said {
    pub(crate) output: String,
    pub(crate) remarks: String,
}

/// Runs `command` to its end.
pub(crate) fn run(command: &mut Command) -> Result<Said, CargoError> {
    let call = call(command);
    let ended = command.output();
    let output = match ended {
        Ok(output) => output,
        Err(source) => return Err(CargoError::NotStarted { call, source }),
    };
    let said = Said {
        output: String::from_utf8_lossy(&output.stdout).into_owned(),
        remarks: String::from_utf8_lossy(&output.stderr).into_owned(),
    };
    if output.status.success() {
        Ok(said)
    } else {
        Err(CargoError::Failed {
            call,
            status: output.status.to_string(),
            said: format!("{}{}", said.output, said.remarks),
        })
    }
}

fn call(command: &Command) -> String {
    let words: Vec<_> = command
        .get_args()
        .map(|word| word.to_string_lossy())
        .collect();
    let program = Path::new(command.get_program()).file_stem();
    let program = program.unwrap_or_default().to_string_lossy();
    format!("{program} {}", words.join(" "))
}

/// Packages and who depends on whom, as far as a task needs it.
#[derive(Debug, Deserialize)]
pub(crate) struct Metadata {
    pub(crate) packages: Vec<Package>,
    pub(crate) resolve: Resolve,
    pub(crate) workspace_members: Vec<String>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Package {
    pub(crate) id: String,
    pub(crate) name: String,
    pub(crate) version: String,
    pub(crate) rust_version: Option<String>,
    pub(crate) license: Option<String>,
    pub(crate) description: Option<String>,
    pub(crate) readme: Option<PathBuf>,
    pub(crate) repository: Option<String>,
    pub(crate) keywords: Vec<String>,
    pub(crate) categories: Vec<String>,
    /// Registries it may go to: an empty list is `publish = false`.
    pub(crate) publish: Option<Vec<String>>,
    pub(crate) features: std::collections::BTreeMap<String, Vec<String>>,
    pub(crate) targets: Vec<Target>,
    pub(crate) dependencies: Vec<Declared>,
}

impl Package {
    /// Runs in the compiler, and so is no part of a program.
    pub(crate) fn is_macro(&self) -> bool {
        self.targets
            .iter()
            .any(|target| target.kind.iter().any(|kind| kind == "proc-macro"))
    }
}

#[derive(Debug, Deserialize)]
pub(crate) struct Target {
    pub(crate) kind: Vec<String>,
}

/// A dependency as a manifest declares it.
#[derive(Debug, Deserialize)]
pub(crate) struct Declared {
    pub(crate) name: String,
    pub(crate) kind: Option<String>,
    pub(crate) optional: bool,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Resolve {
    pub(crate) nodes: Vec<Node>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Node {
    pub(crate) id: String,
    pub(crate) deps: Vec<Edge>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Edge {
    pub(crate) pkg: String,
    pub(crate) dep_kinds: Vec<EdgeKind>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct EdgeKind {
    /// None of a dependency of the program itself, else `build` or `dev`.
    pub(crate) kind: Option<String>,
    /// The platforms that it is for, if not all.
    pub(crate) target: Option<String>,
}

impl Metadata {
    /// Of the package whose manifest lies in `folder`, without touching the network, and with `selection` of features.
    pub(crate) fn of(folder: &Path, selection: &[&str]) -> Result<Self, CargoError> {
        let mut command = cargo();
        command
            .args(["metadata", "--offline", "--format-version", "1"])
            .args(selection)
            .current_dir(folder);
        let said = run(&mut command)?;
        serde_json::from_str(&said.output).map_err(|source| CargoError::NotMetadata {
            call: call(&command),
            source,
        })
    }

    pub(crate) fn package(&self, id: &str) -> Option<&Package> {
        self.packages.iter().find(|package| package.id == id)
    }

    /// The package of this name that a path, and no registry, leads to.
    pub(crate) fn local(&self, name: &str) -> Option<&Package> {
        self.packages
            .iter()
            .find(|package| package.name == name && package.id.starts_with("path+"))
    }

    /// What `id` depends on directly, by edges that `follows` lets through.
    pub(crate) fn below<'a>(
        &'a self,
        id: &str,
        follows: impl Fn(&EdgeKind) -> bool + 'a,
    ) -> impl Iterator<Item = &'a str> {
        self.resolve
            .nodes
            .iter()
            .filter(move |node| node.id == id)
            .flat_map(|node| &node.deps)
            .filter(move |edge| edge.dep_kinds.iter().any(&follows))
            .map(|edge| edge.pkg.as_str())
    }
}

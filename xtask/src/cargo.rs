//! Calls of cargo and other programs, and the packages of `cargo metadata`.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};

use serde::Deserialize;

use crate::Outcome;
use testbed::generated::workspace_root;

/// Returns the cargo that runs this task.
pub(crate) fn cargo() -> Command {
    Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Returns the folder in which cargo puts the compiled files of this workspace.
pub(crate) fn target_folder() -> PathBuf {
    // a relative path starts from the folder in which cargo was called; the task runs in that
    // folder
    let named = std::env::var_os("CARGO_TARGET_DIR").map(std::path::absolute);
    match named {
        Some(Ok(folder)) => folder,
        _ => workspace_root().join("target"),
    }
}

/// Output of a call.
#[derive(Debug)]
pub(crate) struct Said {
    pub(crate) output: String,
    pub(crate) remarks: String,
}

/// Runs `command` to its end, and returns its status and its output.
pub(crate) fn ended(command: &mut Command) -> Outcome<(ExitStatus, Said)> {
    let output = command.output();
    let output = output.map_err(|error| format!("`{}`: {error}", call(command)))?;
    let said = Said {
        output: String::from_utf8_lossy(&output.stdout).into_owned(),
        remarks: String::from_utf8_lossy(&output.stderr).into_owned(),
    };
    Ok((output.status, said))
}

/// Runs `command` to its end; a status other than 0 is an error.
pub(crate) fn run(command: &mut Command) -> Outcome<Said> {
    let (status, said) = ended(command)?;
    if status.success() {
        return Ok(said);
    }
    let Said { output, remarks } = said;
    Err(format!(
        "`{}` ended with {status}:\n{output}{remarks}",
        call(command)
    )
    .into())
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

/// Packages and their dependencies: the fields of `cargo metadata` that a task needs.
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
    /// Registries to which the package may be published: an empty list is `publish = false`.
    pub(crate) publish: Option<Vec<String>>,
    pub(crate) features: std::collections::BTreeMap<String, Vec<String>>,
    pub(crate) targets: Vec<Target>,
    pub(crate) dependencies: Vec<Declared>,
}

impl Package {
    /// Returns true for a procedural macro, which runs in the compiler and is not part of the
    /// program.
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

/// Dependency as declared in a manifest.
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
    /// `None` for a dependency of the program itself, otherwise `build` or `dev`.
    pub(crate) kind: Option<String>,
    /// Platforms of the dependency; `None` for all.
    pub(crate) target: Option<String>,
}

impl Metadata {
    /// Returns the metadata of the package whose manifest is in `folder`, without network access.
    /// The `selection` contains the arguments that select features.
    pub(crate) fn of(folder: &Path, selection: &[&str]) -> Outcome<Self> {
        let mut command = cargo();
        command
            .args(["metadata", "--offline", "--format-version", "1"])
            .args(selection)
            .current_dir(folder);
        let said = run(&mut command)?;
        serde_json::from_str(&said.output).map_err(|error| {
            format!(
                "`{}` did not write the expected JSON: {error}",
                call(&command)
            )
            .into()
        })
    }

    pub(crate) fn package(&self, id: &str) -> Option<&Package> {
        self.packages.iter().find(|package| package.id == id)
    }

    /// Returns the package with this name that has a path and no registry.
    pub(crate) fn local(&self, name: &str) -> Option<&Package> {
        self.packages
            .iter()
            .find(|package| package.name == name && package.id.starts_with("path+"))
    }

    /// Returns the direct dependencies of `id` along the edges that `follows` accepts.
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

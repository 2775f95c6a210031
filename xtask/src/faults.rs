//! `cargo xtask faults [NAME...]`: restores former faults one at a time, and runs the tests that
//! must fail with each of them.
//!
//! `xtask/faults/faults.ron` lists the faults; `xtask/faults/NAME.patch` restores one of them. The
//! tree, without the files that git ignores, is copied to `faults/tree` in the target folder and
//! built in `faults/target`, so that only crates that a patch affects are compiled again. A patch
//! that does not apply, a program that does not compile, and a test that passes or does not exist
//! are errors.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde::Deserialize;

use crate::cargo::{cargo, ended, run as run_command, target_folder};
use crate::files::{self, files_below};
use crate::{Outcome, none_of};
use testbed::generated::workspace_root;
use testbed::ron_text::parse_ron;

/// Folder of the patches and their list, relative to the root of the workspace.
const FOLDER: &str = "xtask/faults";

/// Former fault, and the tests that detect it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Fault {
    /// Name of the patch, without `.patch`.
    patch: String,
    /// Description in one sentence.
    fault: String,
    /// Tests that fail when the fault is restored.
    seen_by: Vec<Seen>,
}

/// Tests of one program.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Seen {
    package: String,
    program: Program,
    /// Names of the tests, as full paths in the program.
    tests: Vec<String>,
}

/// Test program of a package.
#[derive(Debug, Clone, Copy, Deserialize)]
enum Program {
    /// Unit tests.
    Lib,
    /// `tests/it.rs`.
    It,
}

/// Restores the faults named in `names`, or all if it is empty, and requires that their tests fail.
/// With `check`, only requires that each patch applies and that its tests exist.
pub(crate) fn run(names: &[String], check: bool) -> Outcome {
    let root = workspace_root();
    let faults = listed(root)?;
    let is_unknown = |name: &&String| faults.iter().all(|fault| fault.patch != **name);
    if let Some(found) = names.iter().find(is_unknown) {
        let expected: Vec<_> = faults.iter().map(|fault| &*fault.patch).collect();
        let expected = expected.join(", ");
        return Err(format!("there is no fault `{found}`, expected one of {expected}").into());
    }
    let copy = target_folder().join("faults").join("tree");
    let mut unseen = Vec::new();
    let is_chosen = |fault: &&Fault| names.is_empty() || names.contains(&fault.patch);
    for fault in faults.iter().filter(is_chosen) {
        let patch = root.join(FOLDER).join(format!("{}.patch", fault.patch));
        if check {
            run_command(git(root).args(["apply", "--check"]).arg(&patch))?;
            for seen in &fault.seen_by {
                has_tests(root, seen)?;
            }
            continue;
        }
        println!("{}: {}", fault.patch, fault.fault);
        mirror(root, &copy)?;
        run_command(git(&copy).arg("apply").arg(&patch))?;
        for seen in &fault.seen_by {
            let said = said_by_tests(&copy, fault, seen)?;
            for test in &seen.tests {
                let line = format!("test {test} ... FAILED");
                if said.lines().any(|said| said == line) {
                    println!("    {test} fails");
                } else {
                    println!("    {test} DOES NOT FAIL");
                    unseen.push(format!("{test} ({})", fault.patch));
                }
            }
        }
    }
    none_of(&unseen, "tests do not detect their fault")?;
    if check {
        println!("the patches of {} former faults apply", faults.len());
    }
    Ok(())
}

/// Returns the list. It must contain every patch of the folder, each with one test at least.
fn listed(root: &Path) -> Outcome<Vec<Fault>> {
    let folder = root.join(FOLDER);
    let list = folder.join("faults.ron");
    let faults: Vec<Fault> = parse_ron(&list, &files::read(&list)?)?;
    let patches = files_below(&folder, "patch")?;
    let names = patches.iter().filter_map(|path| path.file_stem());
    let found: Vec<_> = names.map(|name| name.to_string_lossy()).collect();
    let is_seen = |fault: &&Fault| fault.seen_by.iter().any(|seen| !seen.tests.is_empty());
    let listed = faults.iter().filter(is_seen);
    let mut listed: Vec<&str> = listed.map(|fault| &*fault.patch).collect();
    listed.sort_unstable();
    if listed != found || listed.len() != faults.len() {
        return Err(format!(
            "faults.ron lists {listed:?} with their tests, but {FOLDER} contains the patches {found:?}"
        )
        .into());
    }
    Ok(faults)
}

/// Requires that the package of `seen` contains functions with the names of the tests.
fn has_tests(root: &Path, seen: &Seen) -> Outcome {
    let folder = root.join("crates").join(&seen.package);
    let mut texts = String::new();
    for file in files_below(&folder, "rs")? {
        texts += &files::read(&file)?;
    }
    for test in &seen.tests {
        let name = test.rsplit("::").next().unwrap_or(test);
        let function = format!("fn {name}()");
        if !texts.contains(&function) {
            let package = &seen.package;
            return Err(
                format!("faults.ron names `{test}`, and {package} has no such test").into(),
            );
        }
    }
    Ok(())
}

/// Returns a `git` command that runs in `folder` and ignores a repository above this folder.
fn git(folder: &Path) -> Command {
    let mut git = Command::new("git");
    git.current_dir(folder);
    git.env("GIT_CEILING_DIRECTORIES", folder.parent().unwrap_or(folder));
    git
}

/// Copies the tree of `root` to `copy`, without the files that git ignores. An unchanged file is
/// not written again, so it keeps its time and is not compiled again.
fn mirror(root: &Path, copy: &Path) -> Outcome {
    let every = ["--cached", "--others", "--exclude-standard"];
    let files = run_command(git(root).args(["ls-files", "-z"]).args(every))?.output;
    for file in files.split_terminator('\0') {
        let (from, to) = (root.join(file), copy.join(file));
        // git lists a file that is deleted but not yet removed from the index
        let Ok(contents) = fs::read(&from) else {
            let _ = fs::remove_file(&to);
            continue;
        };
        if fs::read(&to).is_ok_and(|there| there == contents) {
            continue;
        }
        fs::create_dir_all(to.parent().unwrap_or(copy))
            .and_then(|()| fs::write(&to, contents))
            .map_err(files::at(&to))?;
    }
    Ok(())
}

/// Returns the output of the tests in `tree`, in which `fault` has been restored.
fn said_by_tests(tree: &Path, fault: &Fault, seen: &Seen) -> Outcome<String> {
    let program = match seen.program {
        Program::Lib => &["--lib"][..],
        Program::It => &["--test", "it"],
    };
    let mut command = cargo();
    command.args(["test", "--locked", "--package", &seen.package]);
    command.args(program).args(["--", "--exact"]);
    command.args(&seen.tests).current_dir(tree);
    command.env("CARGO_TARGET_DIR", target_folder().join("faults/target"));
    let (status, said) = ended(&mut command)?;
    if status.success() || said.output.contains("test result:") {
        return Ok(said.output);
    }
    let (patch, package, said) = (&fault.patch, &seen.package, said.output + &said.remarks);
    Err(format!("with {patch} the tests of {package} do not run:\n{said}").into())
}

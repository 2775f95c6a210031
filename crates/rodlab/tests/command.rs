//! The program as a person calls it: what it says, what it writes, and the status with which it ends.
#![allow(
    clippy::unwrap_used,
    reason = "a call that should succeed and does not is the failure that the test reports"
)]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use rodlab::templates::JobName;
use tempfile::TempDir;

fn rodlab(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .args(arguments)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Status and what was said on the standard error.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = rodlab(folder, arguments);
    assert_eq!(text(&output.stdout), "");
    format!(
        "status {}\n{}",
        output.status.code().unwrap(),
        text(&output.stderr)
    )
}

fn folder_with(files: &[(&str, &str)]) -> TempDir {
    let folder = TempDir::new().unwrap();
    for (name, contents) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, contents).unwrap();
    }
    folder
}

#[test]
fn a_misspelt_field_is_shown_with_the_nearest_name() {
    let folder = folder_with(&[("rod.ron", "// a rod\nModulus(\n    titel: \"a rod\",\n)\n")]);
    let said = refused(folder.path(), &["modulus", "rod.ron"]);
    assert!(said.starts_with("status 2\n"), "{said}");
    for part in [
        "rod.ron:3:5: Modulus.titel: there is no field `titel`",
        "3 │     titel: \"a rod\",",
        "did you mean `title`?",
    ] {
        assert!(said.contains(part), "{part} is not in\n{said}");
    }
}

#[test]
fn a_sheet_of_another_job_names_its_command() {
    let folder = folder_with(&[("rod.ron", JobName::Modulus.template())]);
    insta::assert_snapshot!(
        refused(folder.path(), &["frf", "rod.ron"]),
        @r"
    status 2
    error: rod.ron is a sheet for `modulus`, expected one for `frf`: run `rodlab modulus` on it
    "
    );
}

#[test]
fn a_sheet_that_is_not_there_is_named() {
    let folder = folder_with(&[]);
    let said = refused(folder.path(), &["modulus", "rod.ron"]);
    assert!(
        said.starts_with("status 2\nerror: cannot read rod.ron: "),
        "{said}"
    );
}

#[test]
fn init_replaces_nothing() {
    let folder = folder_with(&[]);
    let first = rodlab(folder.path(), &["init", "force"]);
    assert!(first.status.success());
    let written = fs::read_to_string(folder.path().join("force.ron")).unwrap();
    assert!(written.starts_with("//"));
    let said = refused(folder.path(), &["init", "force"]);
    assert!(
        said.starts_with("status 2\nerror: cannot write force.ron: "),
        "{said}"
    );
    assert_eq!(
        fs::read_to_string(folder.path().join("force.ron")).unwrap(),
        written
    );
}

#[test]
fn completions_and_manual_pages_know_every_command() {
    let folder = folder_with(&[]);
    let completions = rodlab(folder.path(), &["completions", "bash"]);
    assert!(text(&completions.stdout).contains("identify"));
    assert!(rodlab(folder.path(), &["man", "pages"]).status.success());
    let page = fs::read_to_string(folder.path().join("pages/rodlab-batch.1")).unwrap();
    assert!(page.contains("resume"), "{page}");
    let help = text(&rodlab(folder.path(), &["--help"]).stdout);
    for line in help
        .lines()
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
    {
        let name = line.split_whitespace().next().unwrap();
        if name.chars().all(|letter| letter.is_ascii_lowercase())
            && !["help", "rodlab"].contains(&name)
        {
            assert!(
                folder
                    .path()
                    .join(format!("pages/rodlab-{name}.1"))
                    .exists(),
                "{name}"
            );
        }
    }
}

#[cfg(unix)]
#[test]
fn a_disk_without_room_leaves_no_half_file() {
    // the device that is always full, by a link in the place of the folder's file
    let folder = folder_with(&[]);
    let completions = Command::new("sh")
        .arg("-c")
        .arg(format!(
            "{} completions bash > /dev/full",
            env!("CARGO_BIN_EXE_rodlab")
        ))
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(completions.status.code(), Some(2));
    assert!(
        text(&completions.stderr).starts_with("error: cannot write the standard output: "),
        "{}",
        text(&completions.stderr)
    );
}

//! Test that every task exists that a page or the gate names. Because this test needs the program,
//! cargo builds the tasks together with the tests, in one profile; the gate runs the tasks from
//! there.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

fn succeeds(arguments: &[&str]) -> bool {
    let mut xtask = Command::new(env!("CARGO_BIN_EXE_xtask"));
    xtask.args(arguments).output().unwrap().status.success()
}

#[test]
fn every_task_that_a_page_or_the_gate_names_is_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let named: BTreeSet<String> = [
        "README.md",
        "CONTRIBUTING.md",
        ".ci/run",
        "fixtures/README.md",
    ]
    .iter()
    .flat_map(|file| {
        let text = std::fs::read_to_string(root.join(file)).unwrap();
        let tasks = text.split("cargo xtask ").skip(1);
        let gate = text.split("\" xtask ").skip(1);
        tasks
            .chain(gate)
            .map(|rest| {
                let is_part = |c: &char| c.is_ascii_lowercase() || *c == '-';
                rest.chars().take_while(is_part).collect::<String>()
            })
            .filter(|task| !task.is_empty())
            .collect::<Vec<_>>()
    })
    .collect();
    assert!(named.len() > 8, "{named:?}");
    for task in &named {
        assert!(succeeds(&[task, "--help"]), "cargo xtask {task}");
    }
    assert!(!succeeds(&["reproduce-paper-f", "--help"]));
}

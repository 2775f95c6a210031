//! Runs that are killed at each of the system calls by which they change a folder; needs `strace`.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use super::folder::{Files, put};
use super::killed::after_the_kill;
use super::program::{PROGRAM, run};
use super::struck_mass;
use super::tally::{Came, Extent, Row};

/// System calls that create, fill, lock, rename and remove files.
const CALLS: &str =
    "mkdir,mkdirat,openat,write,fsync,flock,unlink,unlinkat,rename,renameat,renameat2";

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let injected = "every call that creates, fills, locks, renames or removes a file";
    let faults = [
        "killed: at a system call, first result, then run again",
        "killed: at a system call, over the result of another sheet, then run again",
    ];
    let works = Command::new("strace")
        .args(["-qq", "-o", "/dev/null", "true"])
        .status();
    if !works.is_ok_and(|status| status.success()) {
        return faults
            .map(|fault| Row::skipped(fault, injected, "no `strace`"))
            .into();
    }
    let folder = struck_mass::folder();
    let earlier = struck_mass::result(folder.path(), "modulus", "modulus.ron");
    let later = struck_mass::result(folder.path(), "force", "hit.ron");
    let before = [Files::new(), earlier];
    faults
        .iter()
        .zip(&before)
        .map(|(fault, before)| {
            let points = calls(before);
            assert!(points.len() > 30, "{points:?}");
            Row::of(
                *fault,
                injected,
                &extent.of(&points, 5),
                |(call, number)| {
                    let folder = struck_mass::folder();
                    put(&folder.file("out"), before);
                    let inject = format!("inject={call}:signal=KILL:when={number}");
                    let mut command = traced(folder.path(), "/dev/null");
                    command.args(["-e", &inject]);
                    let ran = run(with_program(&mut command));
                    if ran.status == Some(0) {
                        // the number of calls before `main` varies, so that the run may end before
                        // this call
                        return match after_the_kill(&ran, folder.path(), before, &later) {
                            Came::Stopped => Came::Stopped,
                            other => other,
                        };
                    }
                    after_the_kill(&ran, folder.path(), before, &later)
                },
            )
        })
        .collect()
}

fn traced(folder: &Path, log: &str) -> Command {
    let mut command = Command::new("strace");
    command
        .current_dir(folder)
        .env("SOURCE_DATE_EPOCH", "0")
        .args(["-f", "-qq", "-o", log, "-e", &format!("trace={CALLS}")]);
    command
}

fn with_program(command: &mut Command) -> &mut Command {
    command.args([PROGRAM, "force", "hit.ron", "--quiet", "--out", "out"])
}

/// Name and number of each of the [`CALLS`] of a run.
fn calls(before: &Files) -> Vec<(String, usize)> {
    let folder = struck_mass::folder();
    put(&folder.file("out"), before);
    let ran = run(with_program(&mut traced(folder.path(), "calls")));
    assert_eq!(ran.status, Some(0), "{}", ran.err);
    let log = folder.read("calls");
    let mut count: BTreeMap<String, usize> = BTreeMap::new();
    let mut points = Vec::new();
    for line in log.lines() {
        let name = line
            .split_whitespace()
            .nth(1)
            .and_then(|call| call.split('(').next());
        if let Some(name) = name.filter(|name| CALLS.split(',').any(|call| call == *name)) {
            let number = count.entry(name.to_owned()).or_default();
            *number += 1;
            points.push((name.to_owned(), *number));
        }
    }
    points
}

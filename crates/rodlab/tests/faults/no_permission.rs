//! Files and folders that the user of the program may not read or write. Because the administrator
//! has all permissions, the tests run as `nobody` if they are started by this user.

use std::fs::{self, Permissions};
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::path::Path;
use std::process::Command;

use super::folder::{difference, files_in, put};
use super::program::{PROGRAM, run};
use super::struck_mass;
use super::tally::{Came, Extent, Row};

/// A path, its permissions, and the command that uses it.
type Place = (&'static str, u32, &'static [&'static str]);

/// Paths without permission and their commands; all other files belong to another user and may be
/// read.
const PLACES: [Place; 10] = [
    ("hit.ron", 0o000, &["force", "hit.ron", "--out", "out"]),
    ("hit.ron", 0o000, &["check", "hit.ron"]),
    (
        "strains-1.npy",
        0o000,
        &["modulus", "modulus.ron", "--out", "out"],
    ),
    ("strains-1.npy", 0o000, &["inspect", "strains-1.npy"]),
    (
        "strains-1.npy",
        0o000,
        &["convert", "strains-1.npy", "out/new.csv"],
    ),
    ("out", 0o555, &["force", "hit.ron", "--out", "out"]),
    (
        "out",
        0o555,
        &["force", "hit.ron", "--out", "out/new/folder"],
    ),
    ("out", 0o555, &["convert", "strains-1.npy", "out/new.csv"]),
    ("out", 0o555, &["init", "force", "out/force.ron"]),
    (
        "out",
        0o555,
        &["batch", "hit.ron", "harder.ron", "--out", "out"],
    ),
];

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let _ = extent; // there are few
    let fault =
        "no permission: sheets and records that may not be read, folders that may not be written";
    let injected = "each of ten commands";
    let mut rows = vec![match user() {
        Some(user) => Row::of(fault, injected, &PLACES, |place| attempt(place, &user)),
        None => Row::skipped(
            fault,
            injected,
            "runs as administrator, and `setpriv` is missing",
        ),
    }];
    let folder = struck_mass::folder();
    let earlier = struck_mass::result(folder.path(), "force", "hit.ron");
    let names: Vec<_> = earlier.keys().cloned().collect();
    rows.push(Row::of(
        "no permission: a file of the earlier result was made read-only",
        "each of its files",
        &names,
        |name| {
            let folder = struck_mass::folder();
            let out = folder.file("out");
            put(&out, &earlier);
            fs::set_permissions(out.join(name), Permissions::from_mode(0o444)).unwrap();
            let mut command = Command::new(PROGRAM);
            command
                .args(["force", "harder.ron", "--quiet", "--out", "out"])
                .current_dir(folder.path());
            let ran = run(&mut command);
            match (ran.broke(), difference(&files_in(&out), &earlier)) {
                (Some(broke), _) => broke,
                (None, Some(other)) => Came::Lost(other),
                (None, None) => ran.refused(),
            }
        },
    ));
    rows
}

/// Prefix of a command that runs the program as an ordinary user. It is empty if an ordinary user
/// runs the tests, and `None` if there is no way to change the user.
fn user() -> Option<Vec<&'static str>> {
    let probe = tempfile::NamedTempFile::new().unwrap();
    if fs::metadata(probe.path()).unwrap().uid() != 0 {
        return Some(Vec::new());
    }
    let nobody = vec![
        "setpriv",
        "--reuid=65534",
        "--regid=65534",
        "--clear-groups",
    ];
    let works = Command::new(nobody[0])
        .args(&nobody[1..])
        .args([PROGRAM, "--version"])
        .output();
    works
        .is_ok_and(|output| output.status.success())
        .then_some(nobody)
}

fn attempt((place, mode, arguments): &Place, user: &[&str]) -> Came {
    let folder = struck_mass::folder();
    let path = folder.file(place);
    let out = folder.file("out");
    fs::create_dir(&out).unwrap();
    fs::write(out.join("kept.txt"), "kept").unwrap();
    open_to_all(folder.path());
    fs::set_permissions(&out, Permissions::from_mode(0o777)).unwrap();
    fs::set_permissions(&path, Permissions::from_mode(*mode)).unwrap();
    let mut words: Vec<&str> = user.to_vec();
    words.push(PROGRAM);
    words.extend(*arguments);
    let mut command = Command::new(words[0]);
    command
        .args(&words[1..])
        .current_dir(folder.path())
        .env("NO_COLOR", "1");
    let ran = run(&mut command);
    // the folder must be removable
    fs::set_permissions(&path, Permissions::from_mode(0o755)).unwrap();
    if let Some(broke) = ran.broke() {
        return broke;
    }
    let left: Vec<_> = files_in(&out).into_keys().collect();
    // a campaign names the failed tests on the standard output
    let said = format!("{}{}", ran.err, String::from_utf8_lossy(&ran.out));
    let named = ["hit.ron", "strains-1.npy", "out"]
        .iter()
        .any(|name| said.contains(name));
    match (ran.status, left.as_slice()) {
        (Some(2), [only]) if only == Path::new("kept.txt") && named => Came::Refused,
        (Some(2), left) => Came::Lost(format!("{arguments:?} left {left:?} and said {said}")),
        (status, _) => Came::Lost(format!("{arguments:?} ended with {status:?}: {said}")),
    }
}

fn open_to_all(folder: &Path) {
    fs::set_permissions(folder, Permissions::from_mode(0o755)).unwrap();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let mode = if path.is_dir() { 0o755 } else { 0o644 };
        fs::set_permissions(path, Permissions::from_mode(mode)).unwrap();
    }
}

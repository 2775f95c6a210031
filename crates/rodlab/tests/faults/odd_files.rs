//! Other objects in place of a file, folders with odd names, and readers that close the pipe.

use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Stdio};

use super::folder::{difference, files_in};
use super::program::{Ran, rodlab, run, shell};
use super::struck_mass;
use super::tally::{Came, Extent, Row};
use crate::runs::{Folder, copy_example};

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    vec![
        in_place_of_a_file(extent),
        in_place_of_a_record(extent),
        places(),
        outputs_over_inputs(),
        closed_output(),
    ]
}

fn pipe(path: &Path) {
    let made = Command::new("mkfifo").arg(path).status().unwrap();
    assert!(made.success());
}

/// Name of an odd kind of file, and the function that creates it at a path.
type Odd = (&'static str, fn(&Path));

const ODD: [Odd; 8] = [
    ("an empty file", |path| fs::write(path, "").unwrap()),
    ("a folder", |path| fs::create_dir(path).unwrap()),
    ("a pipe without writer", pipe),
    ("/dev/null", |path| symlink("/dev/null", path).unwrap()),
    ("/dev/zero", |path| symlink("/dev/zero", path).unwrap()),
    ("a link to nothing", |path| {
        symlink("nothing", path).unwrap();
    }),
    ("a link to itself", |path| {
        symlink(path.file_name().unwrap(), path).unwrap();
    }),
    ("bytes of no format", |path| {
        fs::write(path, b"\x7fELF\x02\x01\x01\x00\xff\xfe").unwrap();
    }),
];

fn in_place_of_a_file(extent: Extent) -> Row {
    let commands: [&[&str]; 7] = [
        &["inspect", "odd"],
        &["convert", "odd", "new.csv"],
        &["force", "odd", "--out", "out"],
        &["check", "odd"],
        &["batch", "odd", "--out", "out", "--resume"],
        &["batch", "odd", "hit.ron", "--out", "out", "--jobs", "1"],
        &["force", "hit.ron", "--out", "odd/out"],
    ];
    let points: Vec<_> = ODD
        .iter()
        .flat_map(|odd| commands.iter().map(move |command| (odd, *command)))
        // a folder is a valid place for a result
        .filter(|(odd, command)| !(odd.0 == "a folder" && command.contains(&"odd/out")))
        .collect();
    Row::of(
        "odd files: an empty file, a folder, a pipe, a device, a loop, no format, in place of an input or a folder",
        "each of seven commands",
        &extent.of(&points, 19),
        |((name, make), arguments)| {
            let folder = struck_mass::folder();
            make(&folder.file("odd"));
            let ran = run(&mut rodlab(folder.path(), arguments));
            if let Some(broke) = ran.broke() {
                return broke;
            }
            let said = format!("{}{}", ran.err, String::from_utf8_lossy(&ran.out));
            if ran.status != Some(2) || !said.contains("odd") {
                return Came::Lost(format!("{name}, {arguments:?}: {:?}, {said}", ran.status));
            }
            let out = files_in(&folder.file("out"));
            // the other test is run, whatever is wrong with this one
            let other =
                arguments.contains(&"hit.ron") && arguments[0] == "batch" && *name != "a folder";
            if other && !out.keys().any(|name| name.ends_with("hit/result.json")) {
                return Came::Lost(format!("{name} stopped another test: {said}"));
            }
            Came::Refused
        },
    )
}

fn in_place_of_a_record(extent: Extent) -> Row {
    type Changed = (&'static str, fn(&str) -> String);
    let sheets: [Changed; 3] = [
        ("by a pattern", str::to_owned),
        ("by its name", |sheet| {
            sheet.replace("strains-*.npy", "strains-1.npy")
        }),
        ("itself", |sheet| {
            sheet.replace("strains-*.npy", "modulus.ron")
        }),
    ];
    let points: Vec<_> = ODD
        .iter()
        .flat_map(|odd| sheets.iter().map(move |sheet| (odd, sheet)))
        .collect();
    Row::of(
        "odd files: the same in place of a record of a sheet, which may vanish; a sheet that names itself",
        "each of three sheets, checked and run",
        &extent.of(&points, 8),
        |((name, make), (how, change))| {
            let folder = struck_mass::folder();
            let sheet = folder.file("modulus.ron");
            let text = fs::read_to_string(&sheet).unwrap();
            fs::write(&sheet, change(&text)).unwrap();
            let record = folder.file("strains-1.npy");
            fs::remove_file(&record).unwrap();
            make(&record);
            let check = run(&mut rodlab(folder.path(), &["check", "modulus.ron"]));
            let ran = run(&mut rodlab(
                folder.path(),
                &["modulus", "modulus.ron", "--out", "out"],
            ));
            for ran in [&check, &ran] {
                if let Some(broke) = ran.broke() {
                    return broke;
                }
                let named = ran.err.contains("strains-1.npy") || ran.err.contains("modulus.ron");
                // a dangling link may be reported as no file or as an unreadable file, but must not
                // be ignored
                if ran.status != Some(2) || !named {
                    return Came::Lost(format!("{name} {how}: {:?}, {}", ran.status, ran.err));
                }
            }
            Came::Refused
        },
    )
}

/// Names of folders for sheets, records and results.
fn places() -> Row {
    let long = "n".repeat(300);
    let points: Vec<Vec<u8>> = vec![
        b"two words".to_vec(),
        "m\u{e4}tning \u{8a66}\u{9a13} \u{1f528}".into(),
        b"a[b]*c?{d}".to_vec(),
        b"--out".to_vec(),
        b"quote' and \" and \\".to_vec(),
        b"new\nline".to_vec(),
        b"latin-\xe5\xe4\xf6".to_vec(),
        // invalid places for a result
        b"/proc/rodlab".to_vec(),
        b"/dev/null/rodlab".to_vec(),
        long.into_bytes(),
    ];
    let reference = struck_mass::folder();
    let expected = struck_mass::result(reference.path(), "modulus", "modulus.ron");
    Row::of(
        "odd places: sheet, records and results in folders with blanks, brackets, other alphabets, bytes of no alphabet; places without room",
        "each of ten places",
        &points,
        |name| {
            let root = Folder::new();
            let place = root.path().join(OsStr::from_bytes(name));
            let out = place.join("results \u{e5}");
            if fs::create_dir(&place).is_ok() {
                copy_example("frame", &place);
                let mut command = rodlab(root.path(), &["modulus", "--quiet", "--out"]);
                command.arg(&out).arg(place.join("modulus.ron"));
                let ran = run(&mut command);
                if let Some(broke) = ran.broke() {
                    return broke;
                }
                return match (ran.status, difference(&files_in(&out), &expected)) {
                    (Some(0), None) => Came::Right,
                    (Some(0), Some(other)) => Came::Lost(other),
                    _ if files_in(&out).is_empty() => ran.refused(),
                    _ => Came::Lost("files of a result that was refused".to_owned()),
                };
            }
            let folder = struck_mass::folder();
            let mut command = rodlab(folder.path(), &["force", "hit.ron", "--out"]);
            let ran = run(command.arg(&place));
            ran.broke()
                .unwrap_or_else(|| match ran.err.starts_with("error: cannot write ") {
                    true => ran.refused(),
                    false => Came::Lost(ran.err.clone()),
                })
        },
    )
}

/// Results that would replace files of another origin, or input files of the run.
fn outputs_over_inputs() -> Row {
    let points: [(&str, &[&str]); 7] = [
        (
            "a page of somebody else",
            &["force", "hit.ron", "--out", "."],
        ),
        (
            "a sheet under the name of a sheet of the result",
            &["simulate", "plan.ron", "--out", "."],
        ),
        (
            "the sheet under the name of a sheet of the result",
            &["simulate", "modulus.ron", "--out", "."],
        ),
        (
            "the records of the sheet, in the result they are of",
            &["modulus", "made/modulus.ron", "--out", "made"],
        ),
        (
            "the input of a conversion",
            &["convert", "strains-1.npy", "./strains-1.npy"],
        ),
        (
            "the input of a conversion under another name",
            &["convert", "strains-1.npy", "link.npy"],
        ),
        (
            "a sheet under the name of a new one",
            &["init", "modulus", "modulus.ron"],
        ),
    ];
    Row::of(
        "odd places: results over files that are not of a result, or that the run reads",
        "each of seven commands",
        &points,
        |(what, arguments)| {
            let folder = struck_mass::folder();
            let path = folder.path();
            fs::write(path.join("report.html"), "mine").unwrap();
            symlink("strains-1.npy", path.join("link.npy")).unwrap();
            if what.starts_with("the sheet") {
                fs::rename(path.join("plan.ron"), path.join("modulus.ron")).unwrap();
            }
            if arguments.contains(&"made") {
                let made = run(&mut rodlab(
                    path,
                    &["simulate", "plan.ron", "--out", "made", "--quiet"],
                ));
                assert_eq!(made.status, Some(0), "{}", made.err);
            }
            let before = files_in(path);
            let ran = run(&mut rodlab(path, arguments));
            if let Some(broke) = ran.broke() {
                return broke;
            }
            match difference(&files_in(path), &before) {
                Some(other) => Came::Lost(format!("{what}: {other}")),
                None => ran.refused(),
            }
        },
    )
}

/// Commands with a closed output, or with a full disk for the output.
fn closed_output() -> Row {
    let commands: [(&str, i32); 9] = [
        ("inspect strains-1.npy", 0),
        ("inspect strains-1.npy --json", 0),
        ("completions bash", 0),
        ("force hit.ron --out out", 0),
        ("force hit.ron --out out --json", 0),
        ("check hit.ron harder.ron wrong.ron", 2),
        ("batch hit.ron harder.ron --out out", 0),
        ("batch hit.ron wrong.ron --out out", 2),
        ("init force new.ron", 0),
    ];
    let points: Vec<_> = commands
        .iter()
        .flat_map(|command| [(command, false), (command, true)])
        .collect();
    Row::of(
        "odd places: a standard output that is closed at once, or has no room",
        "each of nine commands",
        &points,
        |((arguments, expected), full)| {
            let folder = struck_mass::folder();
            folder.write("wrong.ron", "Force(");
            let ran = if *full {
                run(&mut shell(
                    folder.path(),
                    &format!("\"$0\" {arguments} > /dev/full"),
                ))
            } else {
                let words: Vec<&str> = arguments.split(' ').collect();
                unread(rodlab(folder.path(), &words))
            };
            if let Some(broke) = ran.broke() {
                return Came::Broke(format!("{arguments}: {broke:?}"));
            }
            // the requested work is done nevertheless
            let out = files_in(&folder.file("out"));
            let all = !arguments.contains("--out out")
                || out.keys().any(|name| name.ends_with("result.json"));
            // a closed pipe is not an error, a full disk is one
            let expected = if *full { 2 } else { *expected };
            if all && ran.status == Some(expected) {
                Came::Right
            } else {
                Came::Lost(format!("{arguments}: {:?}, {}", ran.status, ran.err))
            }
        },
    )
}

/// Runs a command whose standard output is closed before it writes.
fn unread(mut command: Command) -> Ran {
    let mut child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    Ran {
        status: output.status.code(),
        signal: std::os::unix::process::ExitStatusExt::signal(&output.status),
        out: Vec::new(),
        err: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

//! Runs that are killed while they write, at random times and at every block.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use super::folder::{Files, difference, files_in, is_whole, put};
use super::program::{Ran, rodlab, run, shell};
use super::struck_mass::{self, sheet};
use super::tally::{Came, Extent, Row};
use crate::runs::Folder;

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let folder = struck_mass::folder();
    let earlier = struck_mass::result(folder.path(), "modulus", "modulus.ron");
    let later = struck_mass::result(folder.path(), "force", "hit.ron");
    let longest = later.values().map(Vec::len).max().unwrap();
    let blocks: Vec<usize> = (0..=longest.div_ceil(512)).collect();
    let at_a_block = Row::of(
        "killed: in the middle of a write, over the result of another sheet, then run again",
        "every 512 bytes up to the longest file",
        &extent.of(&blocks, 5),
        |&blocks| {
            let folder = struck_mass::folder();
            put(&folder.file("out"), &earlier);
            // the system kills a process that writes beyond the limit
            let script = format!(
                "ulimit -c 0; ulimit -f {blocks}; exec \"$0\" force hit.ron --quiet --out out"
            );
            let ran = run(&mut shell(folder.path(), &script));
            after_the_kill(&ran, folder.path(), &earlier, &later)
        },
    );
    vec![
        at_a_block,
        conversion(extent),
        at_random(&earlier, &later, extent),
        campaign(extent),
    ]
}

/// Kills a conversion that replaces a file in a folder of other files: left-over files have
/// recognisable names.
fn conversion(extent: Extent) -> Row {
    let arguments = ["convert", "strains-1.npy", "new.npz", "--quiet", "--force"];
    let reference = struck_mass::folder();
    run(&mut rodlab(reference.path(), &arguments));
    let whole = fs::read(reference.path().join("new.npz")).unwrap();
    let blocks: Vec<usize> = (0..=whole.len().div_ceil(512)).collect();
    Row::of(
        "killed: in the middle of a conversion over an older file, then run again",
        "every 512 bytes of the new file",
        &extent.of(&blocks, 3),
        |&blocks| {
            let folder = struck_mass::folder();
            let new = folder.file("new.npz");
            fs::write(&new, "older").unwrap();
            let before = files_in(folder.path());
            let script = format!(
                "ulimit -c 0; ulimit -f {blocks}; exec \"$0\" {}",
                arguments.join(" ")
            );
            let ran = run(&mut shell(folder.path(), &script));
            let now = files_in(folder.path());
            let is_known = |name: &Path| {
                before.contains_key(name) || name.to_string_lossy().starts_with(".rodlab-")
            };
            if let Some(odd) = now.keys().find(|name| !is_known(name)) {
                return Came::Lost(format!("{} is left", odd.display()));
            }
            let held = &now[Path::new("new.npz")];
            let expected = if ran.signal.is_some() {
                b"older".as_slice()
            } else {
                &whole
            };
            if held != expected {
                return Came::Lost("a part of a conversion".to_owned());
            }
            let again = run(&mut rodlab(folder.path(), &arguments));
            if fs::read(&new).unwrap() != whole {
                return Came::Lost(format!("run again: {:?} {}", again.status, again.err));
            }
            Came::Stopped
        },
    )
}

/// Judges a folder after a run was killed: its files are complete, and the next run writes all of
/// them.
pub(crate) fn after_the_kill(ran: &Ran, folder: &Path, earlier: &Files, later: &Files) -> Came {
    if ran.signal.is_none() && ran.broke().is_some() {
        return Came::Broke(ran.err.clone());
    }
    let out = folder.join("out");
    let now = files_in(&out);
    if let Err(why) = is_whole(&now, &[earlier, later]) {
        return Came::Lost(why);
    }
    if ran.signal.is_none()
        && let Some(other) = difference(&now, later)
    {
        return Came::Lost(format!("a run that was not killed: {other}"));
    }
    let again = run(&mut rodlab(
        folder,
        &["force", "hit.ron", "--quiet", "--out", "out"],
    ));
    match difference(&files_in(&out), later) {
        Some(other) => Came::Lost(format!(
            "run again: {:?} {}, {other}",
            again.status, again.err
        )),
        None => Came::Stopped,
    }
}

/// Reproducible random numbers between 0 and 1 (SplitMix64).
fn numbers(mut seed: u64, count: usize) -> Vec<f64> {
    let next = || {
        seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = seed;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (mixed ^ (mixed >> 31)) as f64 / 2.0_f64.powi(64)
    };
    std::iter::repeat_with(next).take(count).collect()
}

/// Kills `command` after `delay` if it still runs.
fn killed_after(command: &mut std::process::Command, delay: Duration) -> Ran {
    let mut child = command
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(delay);
    let _ = child.kill();
    let status = child.wait().unwrap();
    Ran {
        status: status.code(),
        signal: std::os::unix::process::ExitStatusExt::signal(&status),
        out: Vec::new(),
        err: String::new(),
    }
}

fn at_random(earlier: &Files, later: &Files, extent: Extent) -> Row {
    let arguments = ["force", "hit.ron", "--quiet", "--out", "out"];
    let folder = struck_mass::folder();
    let began = Instant::now();
    run(&mut rodlab(folder.path(), &arguments));
    let duration = began.elapsed();
    Row::of(
        "killed: at random, over the result of another sheet, then run again",
        "300 delays up to the duration of a run",
        &extent.of(&numbers(1993, 300), 8),
        |part| {
            let folder = struck_mass::folder();
            put(&folder.file("out"), earlier);
            let mut command = rodlab(folder.path(), &arguments);
            let ran = killed_after(&mut command, duration.mul_f64(*part));
            after_the_kill(&ran, folder.path(), earlier, later)
        },
    )
}

/// Runs a campaign that is killed and resumed repeatedly until it is finished.
fn campaign(extent: Extent) -> Row {
    let tests = |folder: &Path| {
        fs::create_dir(folder.join("tests")).unwrap();
        for number in 1..=6 {
            let text = sheet(&format!("{number} m/s"));
            fs::write(folder.join(format!("tests/{number}.ron")), text).unwrap();
        }
        fs::write(folder.join("tests/wrong.ron"), "Force(").unwrap();
    };
    let reference = Folder::new();
    tests(reference.path());
    let arguments = ["batch", "tests", "--out", "out", "--quiet", "--resume"];
    let began = Instant::now();
    let ran = run(&mut rodlab(reference.path(), &arguments));
    let duration = began.elapsed();
    assert_eq!(ran.status, Some(2), "{}", ran.err);
    let whole = files_in(&reference.path().join("out"));
    let of_test = |files: &Files, test: &str| -> Files {
        let mut inside = Files::new();
        for (name, bytes) in files {
            if let Ok(short) = name.strip_prefix(test) {
                inside.insert(short.to_path_buf(), bytes.clone());
            }
        }
        inside
    };
    Row::of(
        "killed: a campaign at random, three times, then `--resume`",
        "60 times three delays up to its duration",
        &extent.of(&numbers(1994, 60), 2),
        |part| {
            let folder = Folder::new();
            tests(folder.path());
            let out = folder.file("out");
            for power in [1.0, 0.5, 0.3] {
                let delay = duration.mul_f64(part.powf(power));
                killed_after(&mut rodlab(folder.path(), &arguments), delay);
                let now = files_in(&out);
                for test in ["1", "2", "3", "4", "5", "6", "wrong"] {
                    if let Err(why) = is_whole(&of_test(&now, test), &[&of_test(&whole, test)]) {
                        return Came::Lost(format!("test {test}: {why}"));
                    }
                }
            }
            let again = run(&mut rodlab(folder.path(), &arguments));
            match difference(&files_in(&out), &whole) {
                Some(other) => Came::Lost(format!("resumed: {:?}, {other}", again.status)),
                None => Came::Stopped,
            }
        },
    )
}

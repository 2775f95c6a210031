//! Several runs that write to one folder at the same time.

use std::fs;
use std::thread;
use std::time::{Duration, Instant};

use super::folder::{difference, files_in};
use super::program::{rodlab, run};
use super::struck_mass::{self, sheet};
use super::tally::{Came, Extent, Row};
use crate::runs::Folder;

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    vec![
        runs(
            "two runs: the same sheet, one folder",
            [("force", "hit.ron"), ("force", "hit.ron")],
            extent,
        ),
        runs(
            "two runs: two sheets with the same names of files, one folder",
            [("force", "hit.ron"), ("force", "harder.ron")],
            extent,
        ),
        runs(
            "two runs: two sheets with other names of files, one folder",
            [("force", "hit.ron"), ("modulus", "modulus.ron")],
            extent,
        ),
        campaigns(extent),
    ]
}

/// Runs two sheets at the same time; the second starts later or earlier by a fraction of the
/// duration of the first.
fn runs(fault: &str, sheets: [(&'static str, &'static str); 2], extent: Extent) -> Row {
    let folder = struck_mass::folder();
    let mut durations = Vec::new();
    let results = sheets.map(|(job, sheet)| {
        let began = Instant::now();
        let files = struck_mass::result(folder.path(), job, sheet);
        durations.push(began.elapsed());
        files
    });
    let points: Vec<i32> = (-20..=20).collect();
    Row::of(
        fault,
        "41 differences in time",
        &extent.of(&points, 3),
        |&part| {
            let folder = struck_mass::folder();
            // the starts differ so that both write at the same time, whichever takes longer
            let apart = durations[0].as_secs_f64() - durations[1].as_secs_f64();
            let apart = apart + f64::from(part) / 40.0 * durations[0].as_secs_f64();
            let wait = [(-apart).max(0.0), apart.max(0.0)].map(Duration::from_secs_f64);
            let ran = thread::scope(|scope| {
                let started = [0, 1].map(|which| {
                    let (job, sheet) = sheets[which];
                    let folder = folder.path();
                    scope.spawn(move || {
                        thread::sleep(wait[which]);
                        run(&mut rodlab(
                            folder,
                            &[job, sheet, "--quiet", "--out", "out"],
                        ))
                    })
                });
                started.map(|run| run.join().unwrap())
            });
            for ran in &ran {
                if let Some(broke) = ran.broke() {
                    return broke;
                }
                if ran.status != Some(0) {
                    return Came::Lost(format!("status {:?}: {}", ran.status, ran.err));
                }
            }
            let now = files_in(&folder.file("out"));
            if results.contains(&now) {
                Came::Right
            } else {
                Came::Lost(format!("a mixture: {:?}", now.keys()))
            }
        },
    )
}

/// Two campaigns of the same tests at the same time.
fn campaigns(extent: Extent) -> Row {
    let folder = || {
        let folder = Folder::new();
        fs::create_dir(folder.file("tests")).unwrap();
        for number in 1..=4 {
            let text = sheet(&format!("{number} m/s"));
            folder.write(format!("tests/{number}.ron"), text);
        }
        folder
    };
    let arguments = ["batch", "tests", "--out", "out", "--quiet"];
    let reference = folder();
    run(&mut rodlab(reference.path(), &arguments));
    let whole = files_in(&reference.path().join("out"));
    let points: Vec<u64> = (0..20).collect();
    Row::of(
        "two runs: the same campaign, one folder",
        "20 differences in time",
        &extent.of(&points, 2),
        |&part| {
            let folder = folder();
            let ran = thread::scope(|scope| {
                let started = [0, 10 * part].map(|wait| {
                    let folder = folder.path();
                    scope.spawn(move || {
                        thread::sleep(Duration::from_millis(wait));
                        run(&mut rodlab(folder, &arguments))
                    })
                });
                started.map(|run| run.join().unwrap())
            });
            for ran in &ran {
                if let Some(broke) = ran.broke() {
                    return broke;
                }
            }
            match difference(&files_in(&folder.file("out")), &whole) {
                Some(other) => Came::Lost(other),
                None => Came::Right,
            }
        },
    )
}

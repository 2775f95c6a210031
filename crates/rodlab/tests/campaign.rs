//! Campaigns of many sheets: a bad test does not stop the others, finished tests are not repeated,
//! and the results of parts are merged.

mod earlier_results;
#[cfg(unix)]
mod interruption;
mod places;
mod standings;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crate::faults::folder::files_in;
use crate::runs::{Folder, Words, rodlab, text};

/// A mass that strikes a long rod.
fn sheet(velocity: &str, duration: &str) -> String {
    format!(
        r#"Force(title: "at {velocity}", problem: Impact(first: RigidMass("0.5 kg"), second: Impedance("1000 kg/s"),
        velocity: "{velocity}", duration: "{duration}", time_step: "10 us"))"#
    )
}

/// Seven tests in two folders: five that are good, one whose contact cannot be resolved, one with a
/// mistake.
fn campaign() -> Folder {
    let folder = Folder::new();
    let write = |name: &str, contents: &str| {
        let path = folder.file("campaign").join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, contents).unwrap();
    };
    for number in 1..=3 {
        write(
            &format!("slow/{number}.ron"),
            &sheet(&format!("{number} m/s"), "4 ms"),
        );
    }
    for number in 1..=2 {
        write(
            &format!("fast/{number}.ron"),
            &sheet(&format!("{number}0 m/s"), "4 ms"),
        );
    }
    let stiff =
        sheet("1 m/s", "1 ms").replace("time_step", "contact: Linear(\"1 TN/m\"), time_step");
    write("fast/stiff.ron", &stiff);
    write(
        "slow/wrong.ron",
        "Force(title: \"wrong\", problem: Impact(first: RigidMass(\"1 m\")))",
    );
    folder
}

/// Texts of all files below `folder`, by their paths relative to it.
fn files_below(folder: &Path) -> BTreeMap<PathBuf, String> {
    assert!(folder.is_dir(), "no {}", folder.display());
    let files = files_in(folder).into_iter();
    files.map(|(name, bytes)| (name, text(&bytes))).collect()
}

/// Fails with the first file and line in which two folders differ.
fn assert_same_files(one: &Path, other: &Path) {
    let (one, other) = (files_below(one), files_below(other));
    assert!(
        one.keys().eq(other.keys()),
        "{:?} and {:?}",
        one.keys(),
        other.keys()
    );
    for (name, contents) in &one {
        for (number, (a, b)) in contents.lines().zip(other[name].lines()).enumerate() {
            assert_eq!(a, b, "line {} of {}", number + 1, name.display());
        }
        assert_eq!(contents.len(), other[name].len(), "{}", name.display());
    }
}

#[test]
fn one_bad_test_stops_no_other() {
    let folder = campaign();
    let run = folder.rodlab("batch campaign --out results");
    assert_eq!(run.status.code(), Some(2), "{}", text(&run.stderr));
    let said = text(&run.stdout);
    let (warnings, mut lines): (Vec<&str>, Vec<&str>) =
        said.lines().partition(|line| line.starts_with("warning"));
    assert_eq!(lines.len(), 8, "{said}");
    assert!((1..=6).contains(&warnings.len()), "{said}");
    assert_eq!(
        lines.pop(),
        Some(
            "7 tests: 5 answered, 0 in doubt, 1 not allowed, 1 wrong input; 6 with warnings; results"
        )
    );
    lines.sort_unstable();
    lines[0].must_begin("answered     fast/1: In the band up to 10 kHz the peak force is ");
    lines[6].must_begin("wrong input  slow/wrong: campaign/slow/wrong.ron:1:");
    lines[5].must_begin("not allowed  fast/stiff: ");

    let summary = folder.read("results/summary.csv");
    let statuses: Vec<&str> = summary
        .lines()
        .map(|line| line.split(',').nth(3).unwrap())
        .collect();
    // statuses in the order of the names of the tests
    assert_eq!(
        statuses.join(", "),
        "status, answered, answered, not allowed, answered, answered, answered, wrong input"
    );
    let page = folder.read("results/index.html");
    page.must_say("href=\"slow/1/report.html\"");
    assert!(
        !page.contains("href=\"slow/wrong/"),
        "what failed has no report"
    );
    let quantities = folder.read("results/quantities.csv");
    assert_eq!(
        quantities
            .lines()
            .filter(|line| line.contains(",peak force,N,"))
            .count(),
        6
    );
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let folder = campaign();
    for (jobs, out) in [("1", "one"), ("4", "four")] {
        rodlab(
            folder.path(),
            &["batch", "campaign", "--out", out, "--jobs", jobs],
        );
    }
    assert_same_files(&folder.file("one"), &folder.file("four"));
}

#[test]
fn parts_of_a_campaign_make_the_whole() {
    let folder = campaign();
    folder.rodlab("batch campaign --out whole");
    for part in ["1/3", "2/3", "3/3"] {
        let run = rodlab(
            folder.path(),
            &["batch", "campaign", "--out", "parts", "--shard", part],
        );
        assert!(run.status.code().is_some_and(|status| status <= 2));
        assert!(!folder.has("parts/summary.csv"), "a part is no campaign");
    }
    let merged = folder.rodlab("merge parts");
    assert_eq!(merged.status.code(), Some(2));
    assert_same_files(&folder.file("parts"), &folder.file("whole"));
}

#[test]
fn what_is_no_campaign_is_named() {
    let folder = campaign();
    let said = |arguments: &[&str]| {
        let run = rodlab(folder.path(), arguments);
        format!(
            "status {}: {}",
            run.status.code().unwrap(),
            text(&run.stderr)
        )
    };
    let all = [
        said(&["batch", "nowhere", "--out", "results"]),
        said(&["merge", "campaign"]),
        said(&["merge", "nowhere"]).replace(
            "No such file or directory (os error 2)",
            "(the system's words)",
        ),
    ]
    .concat();
    insta::assert_snapshot!(all, @r"
    status 2: error: no file matches `nowhere` in the current folder
    status 2: error: no file matches `result.json or failure.json` in campaign
    status 2: error: cannot read nowhere: (the system's words)
    ");
    let shard = said(&["batch", "campaign", "--out", "results", "--shard", "4/3"]);
    shard.must_say("expected one such as 3/8, between 1/8 and 8/8");
}

//! Many sheets: one bad test stops no other, what is done is not done again, and parts make a
//! whole.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use tempfile::TempDir;

use crate::runs::{rodlab, text};

/// A mass that strikes a long rod.
fn sheet(velocity: &str, duration: &str) -> String {
    format!(
        r#"Force(title: "at {velocity}", problem: Impact(first: RigidMass("0.5 kg"), second: Impedance("1000 kg/s"),
        velocity: "{velocity}", duration: "{duration}", time_step: "10 us"))"#
    )
}

/// Seven tests in two folders: five that are good, one whose contact cannot be resolved, one with a
/// mistake.
fn campaign() -> TempDir {
    let folder = TempDir::new().unwrap();
    let write = |name: &str, contents: &str| {
        let path = folder.path().join("campaign").join(name);
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

/// All files below `folder`, by their names from there, as their lines.
fn files_below(folder: &Path) -> BTreeMap<PathBuf, String> {
    fn collect(folder: &Path, root: &Path, found: &mut BTreeMap<PathBuf, String>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                collect(&path, root, found);
            } else {
                let name = path.strip_prefix(root).unwrap().to_path_buf();
                found.insert(name, text(&fs::read(&path).unwrap()));
            }
        }
    }
    let mut found = BTreeMap::new();
    collect(folder, folder, &mut found);
    found
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
    let run = rodlab(folder.path(), &["batch", "campaign", "--out", "results"]);
    assert_eq!(run.status.code(), Some(2), "{}", text(&run.stderr));
    let said = text(&run.stdout);
    assert_eq!(said.lines().count(), 8, "{said}");
    let mut lines: Vec<&str> = said.lines().collect();
    assert_eq!(
        lines.pop(),
        Some(
            "7 tests: 5 answered, 0 in doubt, 1 not allowed, 1 wrong input; 6 with warnings; results"
        )
    );
    lines.sort_unstable();
    assert!(
        lines[0].starts_with("answered     fast/1: In the band up to 10 kHz the force comes to "),
        "{}",
        lines[0]
    );
    assert!(
        lines[6].starts_with("wrong input  slow/wrong: campaign/slow/wrong.ron:1:"),
        "{}",
        lines[6]
    );
    assert!(
        lines[5].starts_with("not allowed  fast/stiff: "),
        "{}",
        lines[5]
    );

    let summary = fs::read_to_string(folder.path().join("results/summary.csv")).unwrap();
    let statuses: Vec<&str> = summary
        .lines()
        .map(|line| line.split(',').nth(3).unwrap())
        .collect();
    // in order of the names
    assert_eq!(
        statuses,
        [
            "status",
            "answered",
            "answered",
            "not allowed",
            "answered",
            "answered",
            "answered",
            "wrong input"
        ]
    );
    let page = fs::read_to_string(folder.path().join("results/index.html")).unwrap();
    assert!(page.contains("href=\"slow/1/report.html\""));
    assert!(
        !page.contains("href=\"slow/wrong/"),
        "what failed has no report"
    );
    let quantities = fs::read_to_string(folder.path().join("results/quantities.csv")).unwrap();
    assert_eq!(
        quantities
            .lines()
            .filter(|line| line.contains(",peak force,N,"))
            .count(),
        6
    );
}

/// The rod of the examples as it was measured, and with a sensor that is wired the other way round.
fn right_and_inverted() -> TempDir {
    let folder = TempDir::new().unwrap();
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/polypropylene");
    for name in ["right", "inverted"] {
        let test = folder.path().join("campaign").join(name);
        fs::create_dir_all(&test).unwrap();
        for number in 1..=5 {
            let hit = format!("hits-{number}.npy");
            fs::copy(example.join(&hit), test.join(&hit)).unwrap();
        }
        let sheet = fs::read_to_string(example.join("modulus.ron")).unwrap();
        let wired = "(name: \"free end\", from: 2, unit: \"m/s2\"";
        assert!(sheet.contains(wired));
        let sheet = match name {
            "inverted" => sheet.replace(wired, &format!("{wired}, inverted: true")),
            _ => sheet,
        };
        fs::write(test.join("modulus.ron"), sheet).unwrap();
    }
    folder
}

#[test]
fn r11_an_inverted_sensor_is_in_doubt_in_one_word_everywhere() {
    let folder = right_and_inverted();
    let run = rodlab(folder.path(), &["batch", "campaign", "--out", "results"]);
    let said = text(&run.stdout);
    assert_eq!(run.status.code(), Some(3), "{said}{}", text(&run.stderr));
    assert!(
        said.contains("in doubt     inverted/modulus: the check of "),
        "{said}"
    );
    assert!(
        said.contains("answered     right/modulus: E' = 2.73 GPa"),
        "{said}"
    );
    assert!(
        said.contains(
            "2 tests: 1 answered, 1 in doubt, 0 not allowed, 0 wrong input; 2 with warnings"
        ),
        "{said}"
    );
    let read = |name: &str| fs::read_to_string(folder.path().join("results").join(name)).unwrap();
    let summary = read("summary.csv");
    assert!(
        summary.starts_with("test,job,title,status,warnings,result\n"),
        "{summary}"
    );
    assert!(
        summary.contains(",in doubt,") && summary.contains(",answered,"),
        "{summary}"
    );
    let page = read("index.html");
    assert!(
        page.contains("<td class=\"status in-doubt\">in doubt</td>"),
        "{page}"
    );
    assert!(
        page.contains("<td class=\"status answered\">answered</td>"),
        "{page}"
    );
    let json: serde_json::Value = serde_json::from_str(&read("summary.json")).unwrap();
    assert_eq!(json["in_doubt"], 1);
    assert_eq!(json["with_warnings"], 2);
    assert_eq!(json["tests"][0]["status"], "in doubt");
    assert!(json["tests"][0]["warnings"].as_u64().unwrap() > 0);
    let result: serde_json::Value =
        serde_json::from_str(&read("inverted/modulus/result.json")).unwrap();
    assert_eq!(result["verdict"]["answer"], "in doubt");
    let report = read("inverted/modulus/report.html");
    assert!(report.contains("<p class=\"standing in-doubt\">in doubt</p>"));

    // no number of it is valid, the law is fitted nevertheless
    let (mut of_inverted, mut of_law, mut valid_of_right) = (0, 0, 0);
    for line in read("quantities.csv").lines().skip(1) {
        let is_check = line.contains(",\"check: ");
        let (valid, in_doubt) = (line.contains(",true,"), line.ends_with(",in doubt"));
        if line.starts_with("inverted/") {
            assert!(in_doubt && (is_check || !valid), "{line}");
            of_inverted += 1;
            of_law += usize::from(line.contains("Zener"));
        } else {
            assert!(line.ends_with(",answered"), "{line}");
            valid_of_right += usize::from(valid);
        }
    }
    assert!(
        of_inverted > 10 && of_law > 0 && valid_of_right > 10,
        "{of_inverted} {of_law} {valid_of_right}"
    );

    let single = rodlab(
        folder.path(),
        &[
            "modulus",
            "campaign/inverted/modulus.ron",
            "--out",
            "single",
        ],
    );
    assert_eq!(single.status.code(), Some(3));
    assert!(
        text(&single.stderr).starts_with("in doubt: the check of "),
        "{}",
        text(&single.stderr)
    );
    let said = text(&single.stdout);
    assert!(
        said.starts_with(
            "Do not use this result until the failed checks are explained: the check of "
        ),
        "{said}"
    );
    assert!(said.contains("\nin doubt; "), "{said}");
}

#[test]
fn r11_a_campaign_that_was_merged_or_taken_up_has_the_same_standings() {
    let folder = right_and_inverted();
    rodlab(folder.path(), &["batch", "campaign", "--out", "results"]);
    let before = fs::read_to_string(folder.path().join("results/summary.json")).unwrap();
    for again in [
        &["batch", "campaign", "--out", "results", "--resume"][..],
        &["merge", "results"][..],
    ] {
        let run = rodlab(folder.path(), again);
        assert_eq!(run.status.code(), Some(3), "{again:?}");
        let after = fs::read_to_string(folder.path().join("results/summary.json")).unwrap();
        assert_eq!(after, before, "{again:?}");
    }
}

#[test]
fn r10_a_hit_that_is_there_twice_stops_its_test_and_no_other() {
    let folder = right_and_inverted();
    let test = folder.path().join("campaign/inverted");
    fs::copy(test.join("hits-2.npy"), test.join("hits-7.npy")).unwrap();
    let run = rodlab(folder.path(), &["batch", "campaign", "--out", "results"]);
    let said = text(&run.stdout);
    assert_eq!(run.status.code(), Some(2), "{said}");
    assert!(
        said.contains("wrong input  inverted/modulus: hits-2.npy and hits-7.npy have the same content: they are one measurement"),
        "{said}"
    );
    let check = rodlab(folder.path(), &["check", "campaign/inverted/modulus.ron"]);
    assert_eq!(
        check.status.code(),
        Some(2),
        "found before anything is computed"
    );
}

#[test]
fn r10_one_shot_under_two_names_is_no_second_test() {
    let folder = TempDir::new().unwrap();
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/nylon");
    for name in ["identify.ron", "shots-1.csv"] {
        fs::copy(example.join(name), folder.path().join(name)).unwrap();
    }
    fs::copy(
        example.join("shots-1.csv"),
        folder.path().join("shots-2.csv"),
    )
    .unwrap();
    let run = rodlab(folder.path(), &["check", "identify.ron"]);
    assert_eq!(run.status.code(), Some(2));
    let said = text(&run.stderr);
    assert!(
        said.contains("shots-1.csv and shots-2.csv have the same content"),
        "{said}"
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
    assert_same_files(&folder.path().join("one"), &folder.path().join("four"));
}

#[test]
fn parts_of_a_campaign_make_the_whole() {
    let folder = campaign();
    rodlab(folder.path(), &["batch", "campaign", "--out", "whole"]);
    for part in ["1/3", "2/3", "3/3"] {
        let run = rodlab(
            folder.path(),
            &["batch", "campaign", "--out", "parts", "--shard", part],
        );
        assert!(run.status.code().is_some_and(|status| status <= 2));
        assert!(
            !folder.path().join("parts/summary.csv").exists(),
            "a part is no campaign"
        );
    }
    let merged = rodlab(folder.path(), &["merge", "parts"]);
    assert_eq!(merged.status.code(), Some(2));
    assert_same_files(&folder.path().join("parts"), &folder.path().join("whole"));
}

#[test]
fn what_is_done_is_not_done_again_unless_something_has_changed() {
    let folder = campaign();
    rodlab(folder.path(), &["batch", "campaign", "--out", "results"]);
    let before = files_below(&folder.path().join("results"));
    let written = |name: &str| {
        let file = folder.path().join("results").join(name).join("result.json");
        fs::metadata(file).unwrap().modified().unwrap()
    };
    let first = written("slow/1");
    let second = written("slow/2");

    // one sheet changes, one is mended
    fs::write(
        folder.path().join("campaign/slow/2.ron"),
        sheet("2 m/s", "5 ms"),
    )
    .unwrap();
    fs::write(
        folder.path().join("campaign/slow/wrong.ron"),
        sheet("9 m/s", "4 ms"),
    )
    .unwrap();
    let run = rodlab(
        folder.path(),
        &["batch", "campaign", "--out", "results", "--resume"],
    );
    assert_eq!(run.status.code(), Some(1), "one test is still not allowed");
    assert_eq!(written("slow/1"), first, "done, and the same");
    assert_ne!(written("slow/2"), second, "its sheet has changed");
    let after = files_below(&folder.path().join("results"));
    assert!(!after.contains_key(Path::new("slow/wrong/failure.json")));
    assert!(after.contains_key(Path::new("slow/wrong/result.json")));
    assert_eq!(
        before[Path::new("slow/1/force.csv")],
        after[Path::new("slow/1/force.csv")]
    );
}

#[cfg(unix)]
#[test]
fn an_interruption_leaves_whole_files_and_the_rest_undone() {
    let folder = TempDir::new().unwrap();
    let sheets = folder.path().join("campaign");
    fs::create_dir_all(&sheets).unwrap();
    for number in 0..2000 {
        fs::write(
            sheets.join(format!("{number:04}.ron")),
            sheet("1 m/s", "20 ms"),
        )
        .unwrap();
    }
    let mut child = Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .current_dir(folder.path())
        .args(["batch", "campaign", "--out", "results", "--quiet"])
        .spawn()
        .unwrap();
    // once a few are there, it is told to stop
    let results = folder.path().join("results");
    let patience = Instant::now() + Duration::from_secs(60);
    while fs::read_dir(&results).map_or(0, Iterator::count) < 5 && Instant::now() < patience {
        std::thread::sleep(Duration::from_millis(5));
    }
    let id = child.id().to_string();
    Command::new("kill").args(["-INT", &id]).status().unwrap();
    let status = child.wait().unwrap();
    assert_eq!(status.code(), Some(130));
    let files = files_below(&results);
    assert!(files.len() < 2000 * 3, "it had not come to the end");
    for (name, contents) in &files {
        let name = name.to_string_lossy();
        assert!(!name.contains(".rodlab-"), "{name} is a temporary file");
        if name.ends_with("result.json") {
            assert!(contents.ends_with("}\n"), "{name} is not whole");
        }
    }
    assert!(!results.join("summary.csv").exists());
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
    status 2: error: no file matches `nowhere` in .
    status 2: error: no file matches `result.json or failure.json` in campaign
    status 2: error: cannot read nowhere: (the system's words)
    ");
    let shard = said(&["batch", "campaign", "--out", "results", "--shard", "4/3"]);
    assert!(
        shard.contains("expected as 3/8: from 1/8 to 8/8"),
        "{shard}"
    );
}

/// Names and statuses of the tests in a summary.
fn tests_in(folder: &Path) -> Vec<String> {
    let summary = fs::read_to_string(folder.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let tests = summary["tests"].as_array().unwrap().iter();
    tests
        .map(|test| test["test"].as_str().unwrap().to_owned())
        .collect()
}

#[test]
fn r19_results_stay_in_their_folder() {
    let folder = TempDir::new().unwrap();
    let put = |name: &str| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, sheet("1 m/s", "4 ms")).unwrap();
    };
    for name in ["a/x.ron", "here/b/y.ron", "here/b/c/z.ron"] {
        put(name);
    }
    let here = folder.path().join("here");
    let absolute = here.join("b/c").display().to_string();
    let cases: [(&[&str], &[&str]); 3] = [
        (&["../a", "b"], &["a/x", "here/b/c/z", "here/b/y"]),
        (
            &["../here/b/y.ron", "b/../../a/x.ron"],
            &["a/x", "here/b/y"],
        ),
        (&["b", &absolute, "./b/*.ron"], &["c/z", "y"]),
    ];
    let sheets = files_below(folder.path());
    for (number, (places, names)) in cases.into_iter().enumerate() {
        let out = format!("out-{number}");
        let run = rodlab(&here, &[&["batch", "--out", &out], places].concat());
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        assert_eq!(tests_in(&here.join(&out)), names);
        for name in names {
            assert!(here.join(&out).join(name).join("result.json").is_file());
        }
        fs::rename(here.join(&out), folder.path().join("done")).unwrap();
        fs::remove_dir_all(folder.path().join("done")).unwrap();
        assert_eq!(files_below(folder.path()), sheets, "nothing elsewhere");
    }
    // names that are none without the extension, and two that are one
    put("here/odd/...ron");
    put("here/two/x.ron");
    put("here/two/x.txt");
    let refused: [(&[&str], &str); 2] = [
        (&["odd"], "odd/...ron"),
        (&["two/x.ron", "two/x.txt"], "two/x.ron and two/x.txt"),
    ];
    for (places, named) in refused {
        let run = rodlab(&here, &[&["batch", "--out", "out"], places].concat());
        assert_eq!(run.status.code(), Some(2));
        assert!(text(&run.stderr).contains(named), "{}", text(&run.stderr));
        assert!(!here.join("out").exists());
    }
}

#[cfg(unix)]
#[test]
fn r19_a_folder_behind_links_is_looked_into_once() {
    use std::os::unix::fs::symlink;
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    for name in ["campaign/m/1.ron", "elsewhere/2.ron"] {
        fs::create_dir_all(at(name).parent().unwrap()).unwrap();
        fs::write(at(name), sheet("1 m/s", "4 ms")).unwrap();
    }
    // to itself, to a folder that is there too, to one outside by two names
    symlink(".", at("campaign/m/again")).unwrap();
    symlink("..", at("campaign/m/up")).unwrap();
    symlink("m", at("campaign/a")).unwrap();
    symlink("../elsewhere", at("campaign/first")).unwrap();
    symlink("../elsewhere", at("campaign/second")).unwrap();
    let run = rodlab(folder.path(), &["batch", "campaign", "--out", "results"]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert_eq!(tests_in(&at("results")), ["first/2", "m/1"]);
    // by the name of a link the tests are the same
    symlink("campaign", at("link")).unwrap();
    rodlab(
        folder.path(),
        &["batch", "link", "campaign", "--out", "by-link"],
    );
    assert_same_files(&at("results"), &at("by-link"));
}

#[test]
fn r19_resume_does_again_what_has_new_recordings_or_is_spoilt() {
    let folder = TempDir::new().unwrap();
    let frame = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/frame");
    let test = folder.path().join("campaign");
    fs::create_dir(&test).unwrap();
    let copy = |name: &str| fs::copy(frame.join(name), test.join(name)).unwrap();
    copy("modulus.ron");
    for hit in 1..=4 {
        copy(&format!("strains-{hit}.npy"));
    }
    let result = folder.path().join("results/modulus");
    let resumed = || {
        rodlab(
            folder.path(),
            &["batch", "campaign", "--out", "results", "--resume"],
        );
        let json = fs::read_to_string(result.join("result.json")).unwrap();
        let json: serde_json::Value = serde_json::from_str(&json).unwrap();
        let written = fs::metadata(result.join("result.json")).unwrap();
        (
            json["inputs"].as_array().unwrap().len(),
            written.modified().unwrap(),
        )
    };
    let first = resumed();
    assert_eq!(first.0, 4);
    assert_eq!(resumed(), first, "nothing has changed");
    copy("strains-5.npy");
    let second = resumed();
    assert_eq!(second.0, 5);
    assert_eq!(resumed(), second);

    let whole = files_below(&result);
    let table = result.join("modulus.csv");
    let spoilt: [&dyn Fn(); 2] = [
        &|| {
            let shorter = fs::read_to_string(&table).unwrap().replacen('1', "2", 1);
            fs::write(&table, shorter).unwrap();
        },
        &|| fs::remove_file(result.join("report.html")).unwrap(),
    ];
    for spoil in spoilt {
        spoil();
        assert_ne!(files_below(&result), whole);
        resumed();
        assert_eq!(files_below(&result), whole);
    }
}

#[test]
fn r19_a_failed_run_leaves_no_report_that_could_be_its_own() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("hit.ron");
    let good = sheet("2 m/s", "4 ms");
    let wrong = good.replace("0.5 kg", "0.5 m");
    let single = ["force", "hit.ron", "--out", "results/hit"];
    let many = ["batch", "hit.ron", "--out", "results"];
    let result = folder.path().join("results/hit");
    for command in [&single[..], &many] {
        fs::write(&path, &good).unwrap();
        assert_eq!(rodlab(folder.path(), command).status.code(), Some(0));
        let whole = files_below(&result);
        let report = whole[Path::new("report.html")].clone();
        fs::write(&path, &wrong).unwrap();
        assert_eq!(rodlab(folder.path(), command).status.code(), Some(2));
        let now = files_below(&result);
        let has = |name: &str| now.contains_key(Path::new(name));
        assert!(
            !has("report.html") && !has("result.json"),
            "{:?}",
            now.keys()
        );
        assert!(now[Path::new("failure.json")].contains("0.5 m"));
        assert_eq!(now[Path::new("earlier-report.html")], report);
        // it fails again, and is mended
        assert_eq!(rodlab(folder.path(), command).status.code(), Some(2));
        assert_eq!(files_below(&result), now);
        fs::write(&path, &good).unwrap();
        assert_eq!(rodlab(folder.path(), command).status.code(), Some(0));
        assert!(files_below(&result).keys().eq(whole.keys()));
    }
    // a sheet that is not there has not failed, nor has one that was given to another command
    for command in [
        ["force", "hti.ron", "--out", "results/hit"],
        ["frf", "hit.ron", "--out", "results/hit"],
    ] {
        assert_eq!(rodlab(folder.path(), &command).status.code(), Some(2));
        assert!(result.join("result.json").is_file());
    }
    // nor is a folder made, or a result of another program taken away
    fs::write(&path, &wrong).unwrap();
    fs::create_dir(folder.path().join("mine")).unwrap();
    fs::write(folder.path().join("mine/result.json"), "{}").unwrap();
    for out in ["new", "mine"] {
        let run = rodlab(folder.path(), &["force", "hit.ron", "--out", out]);
        assert_eq!(run.status.code(), Some(2));
    }
    rodlab(folder.path(), &["batch", "hit.ron", "--out", "."]);
    assert!(!folder.path().join("new").exists());
    let mine = fs::read_to_string(folder.path().join("mine/result.json")).unwrap();
    assert_eq!(mine, "{}");
}

#[test]
fn r20_a_sheet_with_a_byte_order_mark_is_as_one_without() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("hit.ron");
    fs::write(&path, format!("\u{feff}{}", sheet("2 m/s", "4 ms"))).unwrap();
    let result = folder.path().join("results/hit/result.json");
    let written = || {
        let run = rodlab(
            folder.path(),
            &["batch", "hit.ron", "--out", "results", "--resume"],
        );
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        fs::metadata(&result).unwrap().modified().unwrap()
    };
    assert_eq!(written(), written(), "its hash is that of the file");
}

#[test]
fn r19_a_summary_replaces_no_file_of_somebody_else() {
    let folder = campaign();
    fs::create_dir(folder.path().join("results")).unwrap();
    let page = folder.path().join("results/index.html");
    fs::write(&page, "a page of mine").unwrap();
    let run = rodlab(folder.path(), &["batch", "campaign", "--out", "results"]);
    assert_eq!(run.status.code(), Some(2));
    assert!(
        text(&run.stderr).contains("index.html"),
        "{}",
        text(&run.stderr)
    );
    assert_eq!(fs::read_to_string(&page).unwrap(), "a page of mine");
    fs::remove_file(&page).unwrap();
    for _ in 0..2 {
        rodlab(folder.path(), &["merge", "results"]);
        assert!(page.is_file());
    }
}

#[test]
fn r19_a_report_is_dated_by_its_inputs_and_is_the_same_again() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("hit.ron");
    fs::write(&path, sheet("2 m/s", "4 ms")).unwrap();
    let seconds = |n| std::time::UNIX_EPOCH + Duration::from_secs(n);
    let changed = |n| {
        let file = fs::File::options().write(true).open(&path).unwrap();
        file.set_modified(seconds(n)).unwrap();
    };
    let result = folder.path().join("hit-result");
    let run = |epoch: Option<&str>| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rodlab"));
        command
            .current_dir(folder.path())
            .args(["force", "hit.ron"]);
        match epoch {
            Some(epoch) => command.env("SOURCE_DATE_EPOCH", epoch),
            None => command.env_remove("SOURCE_DATE_EPOCH"),
        };
        assert_eq!(command.output().unwrap().status.code(), Some(0));
        files_below(&result)
    };
    changed(1_709_251_199);
    let first = run(None);
    assert!(first[Path::new("report.html")].contains("inputs of 2024-02-29 23:59:59 UTC"));
    assert_eq!(run(None), first);
    changed(1_709_251_200);
    assert_ne!(run(None), first);
    assert_eq!(run(Some("1709251199")), first);
}

/// Interrupts `command` while it computes, and returns how long it takes to end.
#[cfg(unix)]
fn time_to_end(folder: &Path, arguments: &[&str]) -> Duration {
    let mut child = Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .current_dir(folder)
        .args(arguments)
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(700));
    assert!(
        child.try_wait().unwrap().is_none(),
        "it should still compute"
    );
    let id = child.id().to_string();
    let told = Instant::now();
    Command::new("kill").args(["-INT", &id]).status().unwrap();
    let ended = child.wait_with_output().unwrap();
    let took = told.elapsed();
    assert_eq!(ended.status.code(), Some(130));
    assert!(text(&ended.stderr).contains("interrupted"));
    took
}

#[cfg(unix)]
#[test]
fn r20_a_computation_in_a_library_hears_an_interruption() {
    let folder = TempDir::new().unwrap();
    // a march of nearly a million steps, in one call of a library
    let bodies = r#"first: Chain(elements: [Cone(material: "nylon", near: "75 mm", far: "30 mm", length: "400 mm")]),
        second: LongRod(material: "nylon", diameter: "10 mm")"#;
    let long = format!(
        r#"Force(title: "long", materials: {{"nylon": (density: "1150 kg/m3",
        law: ConstantQ(modulus: "2.6 GPa", loss_factor: "0.094", at: "3 kHz"))}},
        problem: Impact({bodies}, velocity: "1 m/s", duration: "4 ms", time_step: "5 ns"))"#
    );
    fs::create_dir(folder.path().join("tests")).unwrap();
    for name in ["1", "2", "3"] {
        fs::write(folder.path().join(format!("tests/{name}.ron")), &long).unwrap();
    }
    for arguments in [
        &["force", "tests/1.ron", "--out", "out/1"][..],
        &["batch", "tests", "--out", "out", "--jobs", "2"],
    ] {
        let took = time_to_end(folder.path(), arguments);
        // half a second, and what a busy machine adds
        assert!(took < Duration::from_secs(2), "{took:?}");
    }
    let out = folder.path().join("out");
    assert!(!out.exists() || files_below(&out).is_empty());
}

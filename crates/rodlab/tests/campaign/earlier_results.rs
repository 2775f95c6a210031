//! Runs in a folder with results of an earlier run, or with files of another origin.

use super::*;
use crate::runs::{Folder, Words, path_of_example};

#[test]
fn what_is_done_is_not_done_again_unless_something_has_changed() {
    let folder = campaign();
    folder.rodlab("batch campaign --out results");
    let before = files_below(&folder.file("results"));
    let written = |name: &str| {
        let file = folder.file("results").join(name).join("result.json");
        fs::metadata(file).unwrap().modified().unwrap()
    };
    let first = written("slow/1");
    let second = written("slow/2");

    // one sheet is changed, another is corrected
    folder.write("campaign/slow/2.ron", sheet("2 m/s", "5 ms"));
    folder.write("campaign/slow/wrong.ron", sheet("9 m/s", "4 ms"));
    let run = folder.rodlab("batch campaign --out results --resume");
    assert_eq!(run.status.code(), Some(1), "one test is still not allowed");
    assert_eq!(written("slow/1"), first, "a finished test was repeated");
    assert_ne!(
        written("slow/2"),
        second,
        "a test with a changed sheet was not repeated"
    );
    let after = files_below(&folder.file("results"));
    assert!(!after.contains_key(Path::new("slow/wrong/failure.json")));
    assert!(after.contains_key(Path::new("slow/wrong/result.json")));
    assert_eq!(
        before[Path::new("slow/1/force.csv")],
        after[Path::new("slow/1/force.csv")]
    );
}

#[test]
fn r19_resume_does_again_what_has_new_recordings_or_is_spoilt() {
    let folder = Folder::new();
    let frame = path_of_example("frame");
    let test = folder.file("campaign");
    fs::create_dir(&test).unwrap();
    let copy = |name: &str| fs::copy(frame.join(name), test.join(name)).unwrap();
    copy("modulus.ron");
    for hit in 1..=4 {
        copy(&format!("strains-{hit}.npy"));
    }
    let result = folder.file("results/modulus");
    let resumed = || {
        folder.rodlab("batch campaign --out results --resume");
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
    let folder = Folder::new();
    let path = folder.file("hit.ron");
    let good = sheet("2 m/s", "4 ms");
    let wrong = good.replace("0.5 kg", "0.5 m");
    let single = ["force", "hit.ron", "--out", "results/hit"];
    let many = ["batch", "hit.ron", "--out", "results"];
    let result = folder.file("results/hit");
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
        // the sheet fails again, and is corrected
        assert_eq!(rodlab(folder.path(), command).status.code(), Some(2));
        assert_eq!(files_below(&result), now);
        fs::write(&path, &good).unwrap();
        assert_eq!(rodlab(folder.path(), command).status.code(), Some(0));
        assert!(files_below(&result).keys().eq(whole.keys()));
    }
    // a missing sheet, or one that is given to another command, leaves the earlier result
    for command in [
        ["force", "hti.ron", "--out", "results/hit"],
        ["frf", "hit.ron", "--out", "results/hit"],
    ] {
        assert_eq!(rodlab(folder.path(), &command).status.code(), Some(2));
        assert!(result.join("result.json").is_file());
    }
    // a failure creates no folder, and does not remove a result of another program
    fs::write(&path, &wrong).unwrap();
    fs::create_dir(folder.file("mine")).unwrap();
    folder.write("mine/result.json", "{}");
    for out in ["new", "mine"] {
        let run = rodlab(folder.path(), &["force", "hit.ron", "--out", out]);
        assert_eq!(run.status.code(), Some(2));
    }
    folder.rodlab("batch hit.ron --out .");
    assert!(!folder.has("new"));
    let mine = folder.read("mine/result.json");
    assert_eq!(mine, "{}");
}

#[test]
fn r20_a_sheet_with_a_byte_order_mark_is_as_one_without() {
    let folder = Folder::new();
    let path = folder.file("hit.ron");
    fs::write(&path, format!("\u{feff}{}", sheet("2 m/s", "4 ms"))).unwrap();
    let result = folder.file("results/hit/result.json");
    let written = || {
        folder.done("batch hit.ron --out results --resume");
        fs::metadata(&result).unwrap().modified().unwrap()
    };
    assert_eq!(written(), written(), "its hash is that of the file");
}

#[test]
fn r19_a_summary_replaces_no_file_of_somebody_else() {
    let folder = campaign();
    fs::create_dir(folder.file("results")).unwrap();
    let page = folder.file("results/index.html");
    fs::write(&page, "a page of mine").unwrap();
    let run = folder.rodlab("batch campaign --out results");
    assert_eq!(run.status.code(), Some(2));
    text(&run.stderr).must_say("index.html");
    assert_eq!(fs::read_to_string(&page).unwrap(), "a page of mine");
    fs::remove_file(&page).unwrap();
    for _ in 0..2 {
        folder.rodlab("merge results");
        assert!(page.is_file());
    }
}

#[test]
fn r19_a_report_is_dated_by_its_inputs_and_is_the_same_again() {
    let folder = Folder::new();
    let path = folder.file("hit.ron");
    fs::write(&path, sheet("2 m/s", "4 ms")).unwrap();
    let seconds = |n| std::time::UNIX_EPOCH + Duration::from_secs(n);
    let changed = |n| {
        let file = fs::File::options().write(true).open(&path).unwrap();
        file.set_modified(seconds(n)).unwrap();
    };
    let result = folder.file("hit-result");
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
    let changed_last = "inputs last changed 2024-02-29 23:59:59 UTC";
    assert!(first[Path::new("report.html")].contains(changed_last));
    assert_eq!(run(None), first);
    changed(1_709_251_200);
    assert_ne!(run(None), first);
    assert_eq!(run(Some("1709251199")), first);
}

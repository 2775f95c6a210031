//! Folders of sheets, and folders of their results.

use super::*;
use crate::runs::{Folder, Words, done};

/// Names of the tests in a summary.
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
    let folder = Folder::new();
    let put = |name: &str| {
        let path = folder.file(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, sheet("1 m/s", "4 ms")).unwrap();
    };
    for name in ["a/x.ron", "here/b/y.ron", "here/b/c/z.ron"] {
        put(name);
    }
    let here = folder.file("here");
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
        done(&here, &[&["batch", "--out", &out], places].concat());
        assert_eq!(tests_in(&here.join(&out)), names);
        for name in names {
            assert!(here.join(&out).join(name).join("result.json").is_file());
        }
        fs::rename(here.join(&out), folder.file("done")).unwrap();
        fs::remove_dir_all(folder.file("done")).unwrap();
        assert_eq!(
            files_below(folder.path()),
            sheets,
            "files were written elsewhere"
        );
    }
    // a name that is empty without its extension, and two names that are equal without it
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
        text(&run.stderr).must_say(named);
        assert!(!here.join("out").exists());
    }
}

#[cfg(unix)]
#[test]
fn r19_a_folder_behind_links_is_looked_into_once() {
    use std::os::unix::fs::symlink;
    let folder = Folder::new();
    let at = |name: &str| folder.file(name);
    for name in ["campaign/m/1.ron", "elsewhere/2.ron"] {
        fs::create_dir_all(at(name).parent().unwrap()).unwrap();
        fs::write(at(name), sheet("1 m/s", "4 ms")).unwrap();
    }
    // links to the folder itself, to a folder that is also listed, and two links to a folder
    // outside
    symlink(".", at("campaign/m/again")).unwrap();
    symlink("..", at("campaign/m/up")).unwrap();
    symlink("m", at("campaign/a")).unwrap();
    symlink("../elsewhere", at("campaign/first")).unwrap();
    symlink("../elsewhere", at("campaign/second")).unwrap();
    folder.done("batch campaign --out results");
    assert_eq!(tests_in(&at("results")), ["first/2", "m/1"]);
    // a link to the folder of the campaign gives the same tests
    symlink("campaign", at("link")).unwrap();
    folder.rodlab("batch link campaign --out by-link");
    assert_same_files(&at("results"), &at("by-link"));
}

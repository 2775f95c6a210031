//! Interruption of a campaign and of a computation.

use std::time::Instant;

use super::*;
use crate::runs::{Folder, Words};

#[test]
fn an_interruption_leaves_whole_files_and_the_rest_undone() {
    let folder = Folder::new();
    let sheets = folder.file("campaign");
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
    // after a few results it receives the signal to stop
    let results = folder.file("results");
    let patience = Instant::now() + Duration::from_secs(60);
    while fs::read_dir(&results).map_or(0, Iterator::count) < 5 && Instant::now() < patience {
        std::thread::sleep(Duration::from_millis(5));
    }
    let id = child.id().to_string();
    Command::new("kill").args(["-INT", &id]).status().unwrap();
    let status = child.wait().unwrap();
    assert_eq!(status.code(), Some(130));
    let files = files_below(&results);
    assert!(
        files.len() < 2000 * 3,
        "the campaign ended before the interruption"
    );
    for (name, contents) in &files {
        let name = name.to_string_lossy();
        assert!(!name.contains(".rodlab-"), "{name} is a temporary file");
        if name.ends_with("result.json") {
            assert!(contents.ends_with("}\n"), "{name} is not whole");
        }
    }
    assert!(!results.join("summary.csv").exists());
}

/// Interrupts `command` while it computes, and returns how long it takes to end.
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
    text(&ended.stderr).must_say("interrupted");
    took
}

#[test]
fn r20_a_computation_in_a_library_hears_an_interruption() {
    let folder = Folder::new();
    // a march of nearly a million steps, in one call of a library
    let bodies = r#"first: Chain(elements: [Cone(material: "nylon", near: "75 mm", far: "30 mm", length: "400 mm")]),
        second: LongRod(material: "nylon", diameter: "10 mm")"#;
    let long = format!(
        r#"Force(title: "long", materials: {{"nylon": (density: "1150 kg/m3",
        law: ConstantQ(modulus: "2.6 GPa", loss_factor: "0.094", at: "3 kHz"))}},
        problem: Impact({bodies}, velocity: "1 m/s", duration: "4 ms", time_step: "5 ns"))"#
    );
    fs::create_dir(folder.file("tests")).unwrap();
    for name in ["1", "2", "3"] {
        folder.write(format!("tests/{name}.ron"), &long);
    }
    for arguments in [
        &["force", "tests/1.ron", "--out", "out/1"][..],
        &["batch", "tests", "--out", "out", "--jobs", "2"],
    ] {
        let took = time_to_end(folder.path(), arguments);
        // tolerance: the end takes half a second, and more on a busy machine
        assert!(took < Duration::from_secs(2), "{took:?}");
    }
    let out = folder.file("out");
    assert!(!out.exists() || files_below(&out).is_empty());
}

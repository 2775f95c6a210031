//! The tour of `docs/tour.md`, command by command, on a copy of the examples: each command prints
//! the output shown on the page.
#![cfg(unix)]

use crate::runs::Folder;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A block of commands of the page, and the output shown for it.
#[derive(Debug, Default)]
struct Step {
    line: usize,
    commands: String,
    /// Lines of the output, in order; `...` stands for any text.
    said: Vec<String>,
}

/// Returns the blocks marked `sh`, each with the block marked `text` that follows it.
fn steps(page: &str) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    let mut inside = None;
    for (number, line) in page.lines().enumerate() {
        match (inside, line.trim()) {
            (None, "```sh") => {
                inside = Some("sh");
                steps.push(Step {
                    line: number + 1,
                    ..Step::default()
                });
            }
            (None, "```text") => inside = Some("text"),
            (None, fence) if fence.starts_with("```") => inside = Some("other"),
            (Some(_), "```") => inside = None,
            (Some("sh"), _) => {
                let step = steps.last_mut().unwrap();
                step.commands += line;
                step.commands += "\n";
            }
            (Some("text"), text) => {
                if let Some(step) = steps.last_mut() {
                    step.said.push(text.to_owned());
                }
            }
            _ => {}
        }
    }
    steps
}

/// Returns true if `line` is `pattern`, in which `...` stands for any text.
fn fits(pattern: &str, line: &str) -> bool {
    let mut rest = line;
    for (number, part) in pattern.split("...").enumerate() {
        match rest.find(part) {
            Some(at) if number > 0 || at == 0 => rest = &rest[at + part.len()..],
            _ => return false,
        }
    }
    rest.is_empty() || pattern.ends_with("...")
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let copied = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &copied);
        } else {
            fs::copy(&path, &copied).unwrap();
        }
    }
}

#[test]
fn the_tour_can_be_walked() {
    let crate_folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = fs::read_to_string(crate_folder.join("../../docs/tour.md")).unwrap();
    let place = Folder::new();
    copy(&crate_folder.join("examples"), place.path());
    let binaries = Path::new(env!("CARGO_BIN_EXE_rodlab")).parent().unwrap();
    let path = format!("{}:{}", binaries.display(), std::env::var("PATH").unwrap());
    let mut folder: PathBuf = place.path().to_path_buf();
    let steps = steps(&page);
    assert!(steps.len() >= 8, "a tour of {} steps", steps.len());
    let mut walked = 0;
    for step in steps {
        // the installation of the program is not part of the test
        if step.commands.contains("cargo ") || step.commands.contains("git ") {
            continue;
        }
        let run = Command::new("sh")
            .args([
                "-u",
                "-c",
                &format!(
                    "exec 2>&1\n{}\nprintf '%s' \"$PWD\" > \"$AT\"",
                    step.commands
                ),
            ])
            .current_dir(&folder)
            .env("PATH", &path)
            .env("NO_COLOR", "1")
            .env("AT", place.file(".at"))
            .output()
            .unwrap();
        let output = String::from_utf8(run.stdout).unwrap();
        let at = format!("docs/tour.md:{}, `{}`", step.line, step.commands.trim());
        assert!(
            run.status.success() && !output.contains("not found"),
            "{at} says\n{output}"
        );
        folder = place.read(".at").into();
        let mut printed = output.lines();
        for said in &step.said {
            assert!(
                printed.any(|line| fits(said, line.trim())),
                "{at} does not say\n{said}\nbut\n{output}"
            );
        }
        walked += 1;
    }
    assert!(walked >= 6, "{walked} steps were walked");
    pictures(place.path(), &crate_folder.join("../../docs/figures"));
}

/// The pictures of the README and the figures of the examples that they show.
const PICTURES: [(&str, &str); 7] = [
    ("rodlab-modulus", "polypropylene/rod-result/modulus"),
    ("frame-modulus", "frame/modulus-result/modulus"),
    ("epoxy-master_curve", "epoxy/fit-result/master_curve"),
    ("nylon-responses", "nylon/identify-result/responses"),
    ("cone-force", "cone/force-result/force"),
    (
        "polymer_bar-propagation",
        "polymer_bar/bar-result/propagation",
    ),
    ("shpb-stress_strain", "shpb/shpb-result/stress_strain"),
];

/// Compares the texts of the pictures with those of the examples that were run; with
/// `RODLAB_PICTURES=write` replaces the pictures.
fn pictures(examples: &Path, pictures: &Path) {
    // only texts are compared: coordinates of curves may differ by a tenth of a point between
    // processors
    let words = |path: &Path| -> Vec<String> {
        let svg =
            fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let texts = svg.split("<text").skip(1).filter_map(|part| {
            let (_, text) = part.split_once('>')?;
            Some(text.split('<').next()?.to_owned())
        });
        texts.collect()
    };
    for (picture, figure) in PICTURES {
        let picture = pictures.join(format!("{picture}.svg"));
        let figure = examples.join(format!("{figure}.svg"));
        if std::env::var("RODLAB_PICTURES").is_ok_and(|what| what == "write") {
            fs::copy(&figure, &picture).unwrap();
        }
        assert_eq!(
            words(&picture),
            words(&figure),
            "{}: RODLAB_PICTURES=write",
            picture.display()
        );
    }
}

#[test]
fn dots_stand_for_any_text() {
    assert!(fits("E' = ... GPa at 5 kHz", "E' = 2.6 GPa at 5 kHz"));
    assert!(fits("E' = ...", "E' = 2.6 GPa"));
    assert!(!fits("E' = ... GPa", "E' = 2.6 MPa"));
    assert!(!fits("= ...", "E' = 2.6"));
    assert!(!fits("E' = 2.6", "E' = 2.6 GPa"));
}

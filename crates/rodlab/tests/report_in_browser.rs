//! The report in a browser: opened, pointed at and zoomed, on a large screen and on a small one.
//!
//! The browser is chromium, google-chrome or the program that `RODLAB_BROWSER` names; without a
//! browser the test reports that it is skipped. With `RODLAB_KEEP` set to a folder, the opened
//! pages are kept there for inspection.

use crate::rich;
use std::io::Write as _;
use std::path::PathBuf;
use std::process::Command;
use std::{env, fs};

use serde_json::Value;

use crate::runs::{Folder, Words};

/// Script that records errors from the first line of the page on.
const EARS: &str = include_str!("report_in_browser/ears.js");
/// Script that uses the page like a person and records the results.
const HANDS: &str = include_str!("report_in_browser/hands.js");

fn browser() -> Option<PathBuf> {
    if let Some(named) = env::var_os("RODLAB_BROWSER") {
        return Some(named.into());
    }
    let path = env::var_os("PATH")?;
    [
        "chromium",
        "chromium-browser",
        "google-chrome",
        "google-chrome-stable",
    ]
    .iter()
    .flat_map(|name| env::split_paths(&path).map(move |folder| folder.join(name)))
    .find(|program| program.is_file())
}

/// Opens the page in a window of `width`, light or dark, and returns the records of its scripts.
fn visit(browser: &PathBuf, width: u32, dark: bool) -> Value {
    let folder = Folder::new();
    let folder_kept = env::var_os("RODLAB_KEEP").map(PathBuf::from);
    let folder = folder_kept.as_deref().unwrap_or(folder.path());
    rodlab::output::write(&rich::outcome(), &rich::sheet(), folder, &[]).unwrap();
    let report = fs::read_to_string(folder.join(rodlab::output::REPORT)).unwrap();
    assert_eq!(report.matches("<head>").count(), 1);
    let tried = report
        .replace("<head>", &format!("<head><script>{EARS}</script>"))
        .replace("</body>", &format!("<script>{HANDS}</script></body>"));
    fs::write(folder.join("tried.html"), tried).unwrap();
    // a window has a minimum width, a frame has none
    let frame = format!(
        r#"<!DOCTYPE html><title>frame</title><body style="margin:0"><iframe src="tried.html" style="border:0;width:{width}px;height:900px"></iframe><pre id="found"></pre>
<script>addEventListener("message", (e) => (document.getElementById("found").textContent = e.data));</script>"#
    );
    let framed = folder.join("frame.html");
    fs::write(&framed, frame).unwrap();
    let profile = Folder::new();
    let output = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--no-first-run",
        ])
        .args(["--virtual-time-budget=3000", "--window-size=1300,1000"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!(
            "--blink-settings=preferredColorScheme={}",
            u8::from(!dark)
        ))
        .arg("--dump-dom")
        .arg(format!(
            "file://{}",
            framed.canonicalize().unwrap().display()
        ))
        .output()
        .unwrap();
    let page = String::from_utf8_lossy(&output.stdout);
    let found = page
        .split_once("<pre id=\"found\">")
        .and_then(|(_, after)| after.split_once("</pre>"))
        .map(|(found, _)| {
            found
                .replace("&lt;", "<")
                .replace("&gt;", ">")
                .replace("&amp;", "&")
        })
        .unwrap_or_default();
    serde_json::from_str(&found).unwrap_or_else(|error| {
        panic!(
            "the page wrote nothing down ({error}): {found}\n{}",
            String::from_utf8_lossy(&output.stderr)
        )
    })
}

fn words(found: &Value, key: &str) -> String {
    found[key]
        .as_str()
        .unwrap_or_else(|| panic!("{key} in {found}"))
        .to_owned()
}

/// The number after `name` in the text that the page shows at the pointer.
fn number(words: &str, name: &str) -> f64 {
    let (_, after) = words
        .split_once(&format!("{name} "))
        .unwrap_or_else(|| panic!("{name} in {words}"));
    let digits = after.split([' ', ';']).next().unwrap().replace('−', "-");
    let Some((mantissa, power)) = digits.split_once("×10") else {
        return digits.parse().unwrap();
    };
    let power: String = power
        .chars()
        .map(|c| {
            "⁰¹²³⁴⁵⁶⁷⁸⁹"
                .chars()
                .position(|s| s == c)
                .map_or("-".into(), |d| d.to_string())
        })
        .collect();
    format!("{mantissa}e{power}").parse().unwrap()
}

#[test]
fn a_person_reads_zooms_and_finds_nothing_broken() {
    let Some(browser) = browser() else {
        // written to the standard error directly, because the test harness captures other output
        let said = "skipped: no browser (chromium or google-chrome on PATH, or RODLAB_BROWSER)";
        writeln!(std::io::stderr(), "{said}").unwrap();
        return;
    };
    for (width, dark) in [(1280, false), (360, true)] {
        let found = visit(&browser, width, dark);
        let here = format!("at {width} px, {}", if dark { "dark" } else { "light" });
        assert_eq!(found["width"], width, "{here}");
        assert_eq!(found["dark"], dark, "{here}");
        assert_eq!(found["too_wide"], 0, "pixels that do not fit {here}");
        for (key, what) in [
            ("errors", "errors"),
            ("disagree", "page and file"),
            ("overlaps", "texts on each other"),
            ("cut_off", "texts cut off"),
            ("faint", "contrast"),
        ] {
            assert_eq!(found[key], Value::Array(vec![]), "{what} {here}");
        }

        // the value shown at the pointer is that of the curve
        let read = words(&found, "pointed");
        let (f, magnitude) = (number(&read, "frequency"), number(&read, "measured"));
        let truth = rich::figures::magnitude(f);
        assert!(
            // the frequency is shown with five digits, the data with six, near a resonance
            (magnitude / truth - 1.0).abs() < 1e-3,
            "{read}, but {truth} m/s/N at {f} Hz, {here}"
        );
        read.must_say_all(&[" Hz", " m/s/N"]);

        for (act, changes) in [
            ("dragged", true),
            ("wheeled", true),
            ("plus", true),
            ("reset", false),
            ("linear", true),
            ("logarithmic", false),
        ] {
            let differs = words(&found, act) != words(&found, "first");
            assert_eq!(
                differs,
                changes,
                "ticks after {act} {here}: {}",
                words(&found, act)
            );
        }
        assert_eq!(
            words(&found, "dragged"),
            words(&found, "dragged_below"),
            "panels are zoomed together {here}"
        );
        assert_eq!(found["paper"], 680, "width on paper");
        assert_eq!(
            found["hidden"], 1,
            "curves that are gone after a click in the legend {here}"
        );
        let (one, two) = (words(&found, "key_one"), words(&found, "key_two"));
        assert!(
            number(&one, "frequency") < number(&two, "frequency"),
            "{one}, then {two} {here}"
        );
        assert!(words(&found, "nyquist").contains("GPa"), "{found}");
        assert!(
            words(&found, "pinched") != words(&found, "first"),
            "ticks after two fingers {here}"
        );
    }
}

//! A disk that becomes full while files are written.

use std::fs;
use std::path::Path;
use std::process::Command;

use super::folder::{Files, difference, files_in, put};
use super::program::{Ran, rodlab, run, shell};
use super::struck_mass::{self, sheet};
use super::tally::{Came, Extent, Row};
use crate::runs::Folder;

/// Bytes in one unit of `ulimit -f`.
const BLOCK: usize = 512;

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let folder = struck_mass::folder();
    let earlier = struck_mass::result(folder.path(), "force", "hit.ron");
    let later = struck_mass::result(folder.path(), "force", "harder.ron");
    let mut rows = vec![
        limited(
            "no file longer than a limit, first result",
            "force harder.ron --quiet --out out",
            (&Files::new(), &later),
            extent,
        ),
        limited(
            "no file longer than a limit, result over an earlier one",
            "force harder.ron --quiet --out out",
            (&earlier, &later),
            extent,
        ),
    ];
    let convert = "convert strains-1.npy out/strains.npz --quiet";
    let converted = made_by(convert);
    rows.push(limited(
        "no file longer than a limit, conversion",
        convert,
        (&Files::new(), &converted),
        extent,
    ));
    let init = "init modulus out/modulus.ron --quiet";
    rows.push(limited(
        "no file longer than a limit, new sheet",
        init,
        (&Files::new(), &made_by(init)),
        extent,
    ));
    rows.push(campaign(extent));
    rows.push(small_disk(&earlier, &later, extent));
    rows
}

fn made_by(arguments: &str) -> Files {
    let folder = struck_mass::folder();
    fs::create_dir(folder.file("out")).unwrap();
    let ran = run(&mut shell(
        folder.path(),
        &format!("exec \"$0\" {arguments}"),
    ));
    assert_eq!(ran.status, Some(0), "{}", ran.err);
    files_in(&folder.file("out"))
}

/// All limits in blocks, from 0 to the length of the longest of `files`.
fn limits(files: &Files) -> Vec<usize> {
    let longest = files.values().map(Vec::len).max().unwrap();
    (0..=longest.div_ceil(BLOCK)).collect()
}

/// Runs `arguments` with the files `before` in the folder `out` and a limit of the length of files.
fn limited(fault: &str, arguments: &str, (before, after): (&Files, &Files), extent: Extent) -> Row {
    Row::of(
        format!("full disk: {fault}"),
        "every 512 bytes up to the longest file",
        &extent.of(&limits(after), 4),
        |&blocks| {
            let folder = struck_mass::folder();
            let out = folder.file("out");
            put(&out, before);
            let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" {arguments}");
            let ran = run(&mut shell(folder.path(), &script));
            judged(&ran, &files_in(&out), before, after)
        },
    )
}

/// Requires all of the new files with status 0, otherwise all of the old ones and a reason.
fn judged(ran: &Ran, now: &Files, before: &Files, after: &Files) -> Came {
    if let Some(broke) = ran.broke() {
        return broke;
    }
    let done = ran.status == Some(0);
    match difference(now, if done { after } else { before }) {
        Some(other) => Came::Lost(format!("status {:?}: {other}", ran.status)),
        None if done => Came::Right,
        None => ran.refused(),
    }
}

/// Runs a campaign in the folder of an earlier one: its summary and each of its results are old or
/// new, and it is resumed with more space.
fn campaign(extent: Extent) -> Row {
    let sheets = Folder::new();
    let campaign = |folder: &Path, velocities: [&str; 2]| {
        fs::create_dir_all(folder.join("tests")).unwrap();
        for (number, velocity) in velocities.iter().enumerate() {
            fs::write(folder.join(format!("tests/{number}.ron")), sheet(velocity)).unwrap();
        }
    };
    let batch = ["batch", "tests", "--out", "out", "--quiet"];
    let mut results = Vec::new();
    for velocities in [["1 m/s", "2 m/s"], ["3 m/s", "4 m/s"]] {
        campaign(sheets.path(), velocities);
        let ran = run(&mut rodlab(sheets.path(), &batch));
        assert_eq!(ran.status, Some(0), "{}", ran.err);
        results.push(files_in(&sheets.path().join("out")));
    }
    let [before, after] = [&results[0], &results[1]];
    let part = |files: &Files, folder: &str| -> Files {
        let inside = files.iter().filter(|(name, _)| match name.parent() {
            Some(parent) => parent == Path::new(folder),
            None => false,
        });
        inside
            .map(|(name, bytes)| (name.clone(), bytes.clone()))
            .collect()
    };
    Row::of(
        "full disk: no file longer than a limit, campaign over an earlier one, then `--resume`",
        "every 512 bytes up to the longest file",
        &extent.of(&limits(after), 3),
        |&blocks| {
            let folder = Folder::new();
            campaign(folder.path(), ["3 m/s", "4 m/s"]);
            let out = folder.file("out");
            put(&out, before);
            let script = format!(
                "trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" batch tests --out out --quiet"
            );
            let ran = run(&mut shell(folder.path(), &script));
            if let Some(broke) = ran.broke() {
                return broke;
            }
            let now = files_in(&out);
            for place in ["", "0", "1"] {
                let now = part(&now, place);
                let is_one = [before, after]
                    .iter()
                    .any(|files| part(files, place) == now);
                // the summary may also be a new one, which names the tests that could not be
                // written
                let told = place.is_empty() && says_what_failed(&now);
                if !(is_one || told) {
                    return Came::Lost(format!("results/{place} does not belong to any campaign"));
                }
            }
            let again = run(&mut rodlab(
                folder.path(),
                &["batch", "tests", "--out", "out", "--quiet", "--resume"],
            ));
            if let Some(other) = difference(&files_in(&out), after) {
                return Came::Lost(format!("resumed: {:?}, {other}", again.status));
            }
            match ran.status {
                Some(0) => Came::Right,
                // with no space at all, the message may be lost, but the status is not 0
                _ if blocks == 0 || !ran.err.is_empty() || ran.status == Some(2) => Came::Refused,
                _ => Came::Lost("no reason".to_owned()),
            }
        },
    )
}

/// Returns true if a summary is whole and names a test that could not be written.
fn says_what_failed(summary: &Files) -> bool {
    let text = |name: &str| String::from_utf8(summary[Path::new(name)].clone()).unwrap();
    let counts: serde_json::Value = serde_json::from_str(&text("summary.json")).unwrap();
    let failed = counts["wrong_input"].as_u64().unwrap();
    let lines = text("summary.csv");
    let told = lines
        .lines()
        .filter(|line| {
            line.contains(",wrong input,0,\"cannot write")
                || line.contains(",wrong input,0,cannot write")
        })
        .count() as u64;
    failed > 0 && told == failed && text("index.html").trim_end().ends_with("</html>")
}

/// Runs a sheet on small disks; skipped without the permission to mount them.
fn small_disk(before: &Files, after: &Files, extent: Extent) -> Row {
    let fault = "full disk: a small disk with an earlier result on it";
    let injected = "every 4 kB of free space up to the whole result";
    let mounted = Command::new("unshare")
        .args(["-m", "sh", "-c", "mount -t tmpfs -o size=64k tmpfs /mnt"])
        .output();
    if !mounted.is_ok_and(|output| output.status.success()) {
        return Row::skipped(fault, injected, "no right to mount a disk");
    }
    let pages = |files: &Files| -> usize {
        // pages of 4 kB that the files occupy
        files.values().map(|bytes| bytes.len().div_ceil(4096)).sum()
    };
    let points: Vec<usize> = (0..=pages(after) + 4).collect();
    Row::of(fault, injected, &extent.of(&points, 3), |&free| {
        let folder = struck_mass::folder();
        put(&folder.file("before"), before);
        let size = 4 * (pages(before) + free + 1);
        let script = format!(
            "mkdir disk && mount -t tmpfs -o size={size}k tmpfs disk && cp -r before disk/out || exit 99
             \"$0\" force harder.ron --quiet --out disk/out; status=$?
             cp -r disk/out after && umount disk && exit $status"
        );
        let mut command = Command::new("unshare");
        command
            .args(["-m", "sh", "-c", &script, super::program::PROGRAM])
            .current_dir(folder.path())
            .env("NO_COLOR", "1")
            .env("SOURCE_DATE_EPOCH", "0");
        let ran = run(&mut command);
        judged(&ran, &files_in(&folder.file("after")), before, after)
    })
}

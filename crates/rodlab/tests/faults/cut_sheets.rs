//! Test sheets that end too early.

use std::fs;
use std::path::Path;

use super::program::{rodlab, run};
use super::tally::{Came, Extent, Row};
use crate::runs::{Folder, copy_example};

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    for (name, sheets) in [
        ("polypropylene", &["modulus", "plan"][..]),
        ("frame", &["modulus"]),
        ("nylon", &["identify", "plan"]),
        ("cone", &["force"]),
    ] {
        let folder = Folder::new();
        copy_example(name, folder.path());
        for sheet in sheets {
            let text = folder.bytes(format!("{sheet}.ron"));
            rows.push(row(
                &format!("cut sheet {name}/{sheet}.ron"),
                &text,
                folder.path(),
                extent,
            ));
        }
    }
    for job in [
        "frf", "modulus", "recovery", "fit", "identify", "mobility", "force", "shpb", "simulate",
    ] {
        let folder = Folder::new();
        let ran = run(&mut rodlab(folder.path(), &["init", job, "sheet.ron"]));
        assert_eq!(ran.status, Some(0), "{}", ran.err);
        let text = folder.bytes("sheet.ron");
        rows.push(row(
            &format!("cut template of {job}"),
            &text,
            folder.path(),
            extent,
        ));
    }
    rows
}

fn row(fault: &str, text: &[u8], folder: &Path, extent: Extent) -> Row {
    let mut points: Vec<usize> = (0..text.len()).step_by(10).collect();
    points.push(text.len());
    // after the last bracket there is only white space
    let end = text.trim_ascii_end().len();
    Row::of(
        format!("{fault}, `rodlab check`"),
        "every tenth byte, and the end",
        &extent.of(&points, 4),
        |&cut| {
            let name = format!("cut-{cut}.ron");
            fs::write(folder.join(&name), &text[..cut]).unwrap();
            let ran = run(&mut rodlab(folder, &["check", &name]));
            fs::remove_file(folder.join(&name)).unwrap();
            if let Some(broke) = ran.broke() {
                return broke;
            }
            // a template was read completely if the message reports that its recordings are missing
            let misses = ran.err.starts_with("error: no file matches")
                || ran.err.starts_with("error: cannot read") && !ran.err.contains(&name);
            let understood = ran.status == Some(0) || misses;
            match (understood, cut >= end) {
                (true, true) => Came::Right,
                (false, false) => ran.refused(),
                (true, false) => Came::Lost(format!("{cut} bytes were taken for a sheet")),
                (false, true) => Came::Lost(format!("a whole sheet was refused: {}", ran.err)),
            }
        },
    )
}

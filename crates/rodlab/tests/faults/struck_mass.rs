//! A sheet that takes a hundredth of a second and needs no records, and its results.

use std::path::Path;

use super::folder::{Files, files_in};
use super::program::{rodlab, run};
use crate::runs::{Folder, copy_example};

/// A mass that strikes a long rod.
pub(crate) fn sheet(velocity: &str) -> String {
    format!(
        r#"Force(title: "at {velocity}", problem: Impact(first: RigidMass("0.5 kg"), second: Impedance("1000 kg/s"),
        velocity: "{velocity}", duration: "2 ms", time_step: "10 us"))"#
    )
}

/// A folder with `hit.ron` for 2 m/s, `harder.ron` for 3 m/s and, with other files in its result,
/// `modulus.ron` of the frame.
pub(crate) fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("hit.ron", sheet("2 m/s"));
    folder.write("harder.ron", sheet("3 m/s"));
    copy_example("frame", folder.path());
    folder
}

pub(crate) fn result(folder: &Path, job: &str, sheet: &str) -> Files {
    let out = Folder::new();
    let place = out.path().join("out");
    let ran = run(&mut rodlab(
        folder,
        &[job, sheet, "--quiet", "--out", place.to_str().unwrap()],
    ));
    assert_eq!(ran.status, Some(0), "{}", ran.err);
    let files = files_in(&place);
    assert!(files.contains_key(Path::new("result.json")));
    files
}

//! `cargo xtask package`: checks the contents of the package of each crate, and the entries of its
//! manifest that a registry requires.
//!
//! This project publishes nothing itself, but others may build the crates from packages. A package
//! also shows which files a crate needs to be built: it contains no test data, and its sources read
//! no file outside it.

mod oldest;

use std::fs;
use std::path::Path;

use crate::cargo::{Metadata, Package, cargo, run as call};
use crate::{Outcome, none_of};
use testbed::generated::workspace_root;

/// Files that every package contains; cargo adds the first three.
const FILES: [&str; 8] = [
    ".cargo_vcs_info.json",
    "Cargo.lock",
    "Cargo.toml",
    "Cargo.toml.orig",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "README.md",
    "src/lib.rs",
];

/// Folders of a package, with the extensions of their files.
const FOLDERS: [(&str, &[&str]); 4] = [
    // templates, styles and scripts of reports, and snapshots of unit tests, are next to the code;
    // a snapshot that is not yet accepted ends in `.new`
    ("src/", &["rs", "html", "css", "js", "snap"]),
    ("benches/", &["rs"]),
    // sheets and records for the command
    ("examples/", &["rs", "md", "toml", "ron", "npy", "csv"]),
    ("templates/", &["toml", "ron"]),
];

/// Largest size of a package, not compressed \[bytes\]; a registry accepts 10 MB compressed.
const LARGEST: u64 = 4_000_000;

/// Checks the package of every crate.
pub(crate) fn run() -> Outcome {
    let root = workspace_root();
    let workspace = Metadata::of(root, &["--all-features"])?;
    let mut faults = Vec::new();
    for package in crates(&workspace) {
        let said = call(
            cargo()
                // uncommitted files are packaged too
                .args([
                    "package",
                    "--list",
                    "--allow-dirty",
                    "--no-verify",
                    "--offline",
                    "--locked",
                ])
                .args(["--package", &package.name])
                .current_dir(root),
        )?;
        let files: Vec<&str> = said.output.lines().collect();
        let folder = root.join("crates").join(&package.name);
        let mut found = of_files(&files);
        found.extend(of_manifest(package));
        found.extend(of_contents(root, &folder, &files));
        found.extend(
            said.remarks
                .lines()
                .filter(|line| line.starts_with("warning"))
                .map(|line| format!("cargo says {line}")),
        );
        println!(
            "{}: {} files, {} kB",
            package.name,
            files.len(),
            size(&folder, &files) / 1000
        );
        faults.extend(
            found
                .into_iter()
                .map(|fault| format!("{}: {fault}", package.name)),
        );
    }
    let names: Vec<_> = crates(&workspace).collect();
    let (oldest, of_oldest) = oldest::of(&names, &workspace);
    println!("{oldest}");
    faults.extend(of_oldest);
    none_of(&faults, "faults in packages")
}

/// Returns the crates of the workspace that are for other users: all except the tasks, the common
/// code of tests, and the Python package, which is distributed as a wheel.
fn crates(workspace: &Metadata) -> impl Iterator<Item = &Package> {
    workspace
        .workspace_members
        .iter()
        .filter_map(|id| workspace.package(id))
        .filter(|package| !["rodlab-py", "testbed", "xtask"].contains(&package.name.as_str()))
}

/// Returns the files that are missing and the files that do not belong in a package.
fn of_files(files: &[&str]) -> Vec<String> {
    let missing = FILES
        .iter()
        .filter(|file| !files.contains(file))
        .map(|file| format!("{file} is missing"));
    let stray = files
        .iter()
        .filter(|file| !FILES.contains(file) && !belongs(file))
        .map(|file| format!("{file} does not belong in a package: its folder or its ending is not one of those in xtask/src/package.rs"));
    missing.chain(stray).collect()
}

fn belongs(file: &str) -> bool {
    let name = file.rsplit('/').next().unwrap_or(file);
    let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending);
    let is_hidden = file.split('/').any(|part| part.starts_with('.'));
    !is_hidden
        && FOLDERS
            .iter()
            .any(|(folder, endings)| file.starts_with(folder) && endings.contains(&ending))
}

fn of_manifest(package: &Package) -> Vec<String> {
    let mut faults = Vec::new();
    for (key, value) in [
        ("description", &package.description),
        ("license", &package.license),
        ("repository", &package.repository),
        ("rust-version", &package.rust_version),
    ] {
        if value.as_ref().is_none_or(String::is_empty) {
            faults.push(format!("the manifest has no {key}"));
        }
    }
    if package.readme.is_none() {
        faults.push("the manifest has no readme".to_owned());
    }
    let keywords = &package.keywords;
    let fits =
        |word: &String| word.len() <= 20 && word.starts_with(|c: char| c.is_ascii_alphanumeric());
    if !(1..=5).contains(&keywords.len()) || !keywords.iter().all(fits) {
        faults.push(format!(
            "keywords are {keywords:?}, expected one to five of up to 20 letters"
        ));
    }
    if !(1..=5).contains(&package.categories.len()) {
        faults.push(format!(
            "categories are {:?}, expected one to five",
            package.categories
        ));
    }
    if package
        .publish
        .as_ref()
        .is_none_or(|registries| !registries.is_empty())
    {
        faults.push(
            "publish is not false, although two of the names belong to other crates in the registry".to_owned(),
        );
    }
    faults
}

/// Returns the faults of the contents: wrong licences, sources that read files outside the package,
/// and a size above the limit.
fn of_contents(root: &Path, folder: &Path, files: &[&str]) -> Vec<String> {
    let mut faults = Vec::new();
    for licence in ["LICENSE-APACHE", "LICENSE-MIT"] {
        let same = fs::read(folder.join(licence))
            .is_ok_and(|text| fs::read(root.join(licence)).is_ok_and(|ours| ours == text));
        if !same {
            faults.push(format!(
                "{licence} differs from that of the repository (it is a symbolic link, which some checkouts lose)"
            ));
        }
    }
    for file in files.iter().filter(|file| file.ends_with(".rs")) {
        match fs::read_to_string(folder.join(file)) {
            Ok(text) => faults.extend(outside(file, &text)),
            Err(error) => faults.push(format!("{file}: {error}")),
        }
    }
    let bytes = size(folder, files);
    if bytes > LARGEST {
        faults.push(format!("{bytes} bytes, expected at most {LARGEST}"));
    }
    faults
}

/// Returns a fault for each line of `file` that includes or reads a file outside the package.
fn outside(file: &str, text: &str) -> Vec<String> {
    let depth = file.matches('/').count();
    let mut faults = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let included = ["include!(\"", "include_str!(\"", "include_bytes!(\""]
            .iter()
            .find_map(|call| line.split_once(call))
            .is_some_and(|(_, path)| {
                path.starts_with('/')
                    || path
                        .split('"')
                        .next()
                        .is_some_and(|path| path.matches("../").count() > depth)
            });
        if included || line.contains("/fixtures/") {
            faults.push(format!(
                "{file}, line {}: reads a file outside the package: {}",
                number + 1,
                line.trim()
            ));
        }
    }
    faults
}

fn size(folder: &Path, files: &[&str]) -> u64 {
    files
        .iter()
        .filter_map(|file| fs::metadata(folder.join(file)).ok())
        .map(|file| file.len())
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stray_and_missing_files_are_named() {
        let mut files = FILES.to_vec();
        files.extend([
            "src/format/uff58.rs",
            "examples/nylon/record.npy",
            "templates/frf.ron",
        ]);
        assert_eq!(of_files(&files), Vec::<String>::new());
        files.retain(|file| *file != "LICENSE-MIT");
        files.extend([
            "src/a.rs.orig",
            "src/a.snap.new",
            "src/.a.swp",
            "tests/physics.rs",
            "notes.txt",
        ]);
        let faults = of_files(&files);
        assert_eq!(faults.len(), 6, "{faults:?}");
        assert_eq!(faults[0], "LICENSE-MIT is missing");
    }

    #[test]
    fn sources_that_leave_their_package_are_named() {
        let inside = "const A: &str = include_str!(\"../README.md\");";
        assert_eq!(outside("src/lib.rs", inside), Vec::<String>::new());
        assert_eq!(
            outside("src/a/b.rs", "include_bytes!(\"../../x.npy\")"),
            Vec::<String>::new()
        );
        assert_eq!(
            outside("src/lib.rs", "include_str!(\"../../x.csv\")").len(),
            1
        );
        assert_eq!(
            outside("src/a.rs", "path.join(\"../../fixtures/golden\")").len(),
            1
        );
    }
}

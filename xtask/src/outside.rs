//! `cargo xtask outside`: a program outside the workspace with each library crate alone, and
//! `docs/dependencies.md`.
//!
//! The program is the README of the crate: its `toml` block is the manifest, its `rust` block is
//! `main.rs`. The program is a workspace of its own, so that features and dependencies of other
//! crates have no effect. It uses the versions of our `Cargo.lock` and must compile without
//! warnings, with and without the features of the crate. The compiled files are stored in the
//! target folder of the workspace: a dependency with the same features is not compiled twice.

mod page;
mod program;
mod pulled_in;

use crate::cargo::Metadata;
use crate::{Outcome, none_of};
use testbed::generated::{ensure_file_contents, workspace_root};

pub(crate) use program::Program;
use pulled_in::PulledIn;

/// Library crate, with the other crates of this workspace on which it may depend.
#[derive(Debug)]
pub(crate) struct Library {
    pub(crate) name: &'static str,
    ours: &'static [&'static str],
}

/// Library crates. `rodlab` is not included, because it is a program with an internal library.
pub(crate) const LIBRARIES: [Library; 5] = [
    Library {
        name: "rodwave",
        ours: &[],
    },
    Library {
        name: "labio",
        ours: &[],
    },
    Library {
        name: "cmod",
        ours: &["rodwave"],
    },
    Library {
        name: "maxwellid",
        ours: &["rodwave"],
    },
    Library {
        name: "impulse",
        ours: &["rodwave"],
    },
];

/// Dependencies of the command, of tests or of tasks, which no library may have.
const NOT_FOR_LIBRARIES: [&str; 12] = [
    "clap",
    "criterion",
    "ctrlc",
    "indicatif",
    "insta",
    "miette",
    "minijinja",
    "proptest",
    "rodfigure",
    "ron",
    "serde_json",
    "tempfile",
];

/// Dependencies that may be included only by the feature with the same name.
const BY_FEATURE_ONLY: [&str; 2] = ["rayon", "serde"];

/// Other features that may include one of [`BY_FEATURE_ONLY`]: `workbook` includes calamine, which
/// needs serde.
const ALSO_BY_FEATURE: [(&str, &str); 1] = [("workbook", "serde")];

/// Dependencies of a library crate, without features and with each of its features.
#[derive(Debug)]
struct Alone<'a> {
    library: &'a Library,
    by_default: PulledIn,
    by_feature: Vec<(String, PulledIn)>,
}

/// Checks a program with each library crate alone and writes `docs/dependencies.md`; with `check`,
/// fails if that page is not current.
pub(crate) fn run(check: bool) -> Outcome {
    let root = workspace_root();
    let workspace = Metadata::of(root, &[])?;
    let mut listed = Vec::new();
    let mut faults = Vec::new();
    for library in &LIBRARIES {
        let program = Program::write(root, library.name, &workspace)?;
        let (by_default, by_feature) = program.pulled_in()?;
        faults.extend(by_default.faults(library, None));
        for (feature, pulled_in) in &by_feature {
            faults.extend(pulled_in.faults(library, Some(feature)));
        }
        program.check_alone("--no-default-features")?;
        if !by_feature.is_empty() {
            program.check_alone("--all-features")?;
        }
        println!(
            "{}: {} crates linked, {} on some platforms, {} while compiling; the program in its README compiles without warnings",
            library.name,
            by_default.everywhere.len(),
            by_default.somewhere.len(),
            by_default.compiling.len()
        );
        listed.push(Alone {
            library,
            by_default,
            by_feature,
        });
    }
    none_of(&faults, "dependencies are not allowed")?;
    ensure_file_contents(
        &root.join("docs").join("dependencies.md"),
        &page::of(&listed, &workspace),
        check,
        "cargo xtask outside",
    )?;
    Ok(())
}

impl PulledIn {
    /// Returns the dependencies that are not allowed, with `feature` or without any feature.
    fn faults(&self, library: &Library, feature: Option<&str>) -> Vec<String> {
        let name = library.name;
        let alone = feature.map_or_else(String::new, |feature| format!(" with `{feature}`"));
        let mut faults = Vec::new();
        for package in self.linked() {
            let package = package.split(' ').next().unwrap_or(package);
            let ours = LIBRARIES.iter().any(|library| library.name == package);
            if ours && !library.ours.contains(&package) {
                faults.push(format!(
                    "{name}{alone} pulls in {package}, expected only {:?} of our crates",
                    library.ours
                ));
            }
            if NOT_FOR_LIBRARIES.contains(&package) {
                faults.push(format!(
                    "{name}{alone} pulls in {package}, which belongs to the command, to tests or to tasks"
                ));
            }
            let brings_along =
                |feature: &str| feature == package || ALSO_BY_FEATURE.contains(&(feature, package));
            if BY_FEATURE_ONLY.contains(&package) && !feature.is_some_and(brings_along) {
                faults.push(format!(
                    "{name}{alone} pulls in {package}, expected only with the feature `{package}`"
                ));
            }
        }
        faults
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn linked(names: &[&str]) -> PulledIn {
        PulledIn {
            everywhere: names.iter().map(|name| (*name).to_owned()).collect(),
            ..PulledIn::default()
        }
    }

    #[test]
    fn what_a_library_must_not_pull_in_is_named() {
        let [rodwave, labio, cmod, ..] = &LIBRARIES;
        assert!(linked(&["num-complex"]).faults(rodwave, None).is_empty());
        assert!(
            linked(&["rodwave", "serde"])
                .faults(cmod, Some("serde"))
                .is_empty()
        );
        assert_eq!(
            linked(&["cmod", "clap", "serde"]).faults(labio, None),
            [
                "labio pulls in clap, which belongs to the command, to tests or to tasks",
                "labio pulls in cmod, expected only [] of our crates",
                "labio pulls in serde, expected only with the feature `serde`",
            ]
        );
    }
}

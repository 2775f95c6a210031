//! Program outside the workspace, made from the README of a crate, in a folder that cargo can
//! check.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::pulled_in::PulledIn;
use crate::cargo::{Metadata, cargo, run, target_folder};
use crate::{Outcome, files};
use testbed::generated::write_whole;

/// Path of the crates in a README, relative to the program of a reader.
const CLONE: &str = "../rodlab/crates/";

/// Profile of the workspace: crates that the workspace compiles with it are not compiled again
/// here.
const PROFILE: &str = "[profile.dev]\nopt-level = 2\ndebug = false\n";

/// Program that depends on one library crate and on nothing else.
#[derive(Debug)]
pub(crate) struct Program {
    krate: String,
    folder: PathBuf,
    features: Vec<String>,
}

impl Program {
    /// Writes the program for `krate` below the target folder, with the versions of our
    /// `Cargo.lock`.
    pub(crate) fn write(root: &Path, krate: &str, workspace: &Metadata) -> Outcome<Self> {
        let package = workspace
            .local(krate)
            .ok_or_else(|| format!("the workspace has no crate {krate}"))?;
        let features: Vec<String> = package
            .features
            .keys()
            .filter(|feature| *feature != "default")
            .cloned()
            .collect();
        let readme = root.join("crates").join(krate).join("README.md");
        let text = read(&readme)?;
        let declared = block(&text, "toml", &readme)?;
        let main = block(&text, "rust", &readme)?;
        let folder = target_folder().join("outside").join(krate);
        let manifest = manifest(krate, &declared, &features, root).ok_or_else(|| {
            format!(
                "{} declares\n{declared}\nexpected [dependencies] and the crate alone, at {CLONE}",
                readme.display()
            )
        })?;
        write_changed(&folder.join("Cargo.toml"), &manifest)?;
        write_changed(
            &folder.join("src").join("main.rs"),
            &format!("#![deny(warnings)]\n{main}"),
        )?;
        let program = Self {
            krate: krate.to_owned(),
            folder,
            features,
        };
        program.lock(root)?;
        Ok(program)
    }

    /// Copies our `Cargo.lock`, lets cargo remove unused packages, and checks that nothing else has
    /// changed.
    fn lock(&self, root: &Path) -> Outcome {
        let ours = read(&root.join("Cargo.lock"))?;
        let path = self.folder.join("Cargo.lock");
        write_whole(&path, &ours)?;
        Metadata::of(&self.folder, &[])?;
        let ours = locked(&ours);
        match locked(&read(&path)?)
            .into_iter()
            .find(|package| !ours.contains(package) && package.0 != self.name())
        {
            Some((name, version)) => Err(format!(
                "a program that uses only {} needs {name} {version}, which our Cargo.lock does not contain: run `cargo update --workspace` and review the difference",
                self.krate
            )
            .into()),
            None => Ok(()),
        }
    }

    fn name(&self) -> String {
        format!("outside-{}", self.krate)
    }

    /// Returns the dependencies of the crate without features, and with each feature alone.
    pub(crate) fn pulled_in(&self) -> Outcome<(PulledIn, Vec<(String, PulledIn)>)> {
        let with = |selection: &[&str]| {
            Metadata::of(&self.folder, selection).map(|graph| PulledIn::of(&self.krate, &graph))
        };
        let by_default = with(&["--no-default-features"])?;
        let by_feature = self
            .features
            .iter()
            .map(|feature| {
                let pulled_in = with(&["--no-default-features", "--features", feature])?;
                Ok((feature.clone(), pulled_in))
            })
            .collect::<Outcome<_>>()?;
        Ok((by_default, by_feature))
    }

    /// Runs `cargo check` on the program, with warnings as errors.
    pub(crate) fn check_alone(&self, selection: &str) -> Outcome {
        run(self.call("check").arg(selection))?;
        Ok(())
    }

    /// Returns a `cargo` command that runs in the folder of the program. The default features of
    /// the program enable all features of the crate.
    pub(crate) fn call(&self, verb: &str) -> Command {
        let mut command = cargo();
        command
            .args([verb, "--offline", "--locked", "--quiet"])
            .env("CARGO_TARGET_DIR", target_folder())
            .current_dir(&self.folder);
        command
    }
}

/// Returns the manifest of the program; `None` unless the dependency that the README declares is
/// the crate alone, with its path in a clone.
fn manifest(krate: &str, declared: &str, features: &[String], root: &Path) -> Option<String> {
    let clone = format!("\"{CLONE}{krate}\"");
    let lines: Vec<&str> = declared
        .lines()
        .filter(|line| !line.starts_with('#'))
        .collect();
    let ["[dependencies]", dependency] = lines.as_slice() else {
        return None;
    };
    if !(dependency.starts_with(&format!("{krate} = ")) && dependency.contains(&clone)) {
        return None;
    }
    // a literal string, because a path may contain backslashes
    let here = format!("'{}'", root.join("crates").join(krate).display());
    let named: Vec<String> = features
        .iter()
        .map(|feature| format!("\"{feature}\""))
        .collect();
    let forwarded: String = features
        .iter()
        .map(|feature| format!("{feature} = [\"{krate}/{feature}\"]\n"))
        .collect();
    Some(format!(
        "# Written by `cargo xtask outside` from the README of {krate}.\n\
         [package]\nname = \"outside-{krate}\"\nversion = \"0.0.0\"\nedition = \"2024\"\npublish = false\n\n\
         [workspace]\n\n\
         [features]\ndefault = [{}]\n{forwarded}\n\
         [dependencies]\n{}\n\n{PROFILE}",
        named.join(", "),
        dependency.replace(&clone, &here),
    ))
}

/// Returns the single block of `language` in a README.
fn block(text: &str, language: &str, path: &Path) -> Outcome<String> {
    let opening = format!("```{language}\n");
    let blocks: Vec<&str> = text
        .split(&opening)
        .skip(1)
        .filter_map(|rest| rest.split("```").next())
        .collect();
    match blocks.as_slice() {
        [block] => Ok((*block).to_owned()),
        _ => Err(format!(
            "{} has {} blocks of `{language}`, expected one, from which the program is made",
            path.display(),
            blocks.len()
        )
        .into()),
    }
}

/// Returns the names and versions in a `Cargo.lock`.
fn locked(lock: &str) -> Vec<(String, String)> {
    lock.split("[[package]]")
        .skip(1)
        .filter_map(|package| {
            let value = |key: &str| {
                package.lines().find_map(|line| {
                    line.strip_prefix(key)
                        .map(|value| value.trim_matches([' ', '=', '"']).to_owned())
                })
            };
            Some((value("name")?, value("version")?))
        })
        .collect()
}

/// Writes a file only if its contents have changed: cargo compiles only files that are newer than
/// its output.
fn write_changed(path: &Path, contents: &str) -> Outcome {
    if fs::read_to_string(path).is_ok_and(|found| found == contents) {
        return Ok(());
    }
    Ok(write_whole(path, contents)?)
}

/// Reads a file with the line ends that Git uses.
fn read(path: &Path) -> Outcome<String> {
    Ok(files::read(path)?.replace("\r\n", "\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_manifest_takes_the_crate_alone() {
        let root = Path::new("/clone");
        let alone = "[dependencies]\ncmod = { path = \"../rodlab/crates/cmod\" }\n";
        let features = ["serde".to_owned()];
        let text = manifest("cmod", alone, &features, root).unwrap();
        assert!(
            text.contains("default = [\"serde\"]\nserde = [\"cmod/serde\"]\n"),
            "{text}"
        );
        assert!(text.contains("cmod = { path = '/clone"), "{text}");
        for wrong in [
            "[dependencies]\ncmod = \"0.1\"\n",
            "[dependencies]\ncmod = { path = \"../rodlab/crates/cmod\" }\nndarray = \"0.17\"\n",
            "[dependencies]\nrodwave = { path = \"../rodlab/crates/rodwave\" }\n",
        ] {
            assert_eq!(manifest("cmod", wrong, &features, root), None, "{wrong}");
        }
    }

    #[test]
    fn a_readme_has_one_block_of_a_language() {
        let path = Path::new("README.md");
        let text = "a\n```rust\nfn main() {}\n```\nb\n```toml\n```\n```toml\n```\n";
        assert_eq!(block(text, "rust", path).unwrap(), "fn main() {}\n");
        let error = block(text, "toml", path).unwrap_err().to_string();
        assert!(error.contains("2 blocks of `toml`"), "{error}");
    }
}

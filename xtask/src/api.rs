//! `cargo xtask api`: the public interface of each library crate, one item per line, in `docs/api`.
//!
//! The items are those that rustdoc finds, with all features. Its JSON output needs
//! `RUSTC_BOOTSTRAP` with a stable rustdoc. In the environment of cargo, this variable would make
//! build scripts of dependencies run again. Therefore cargo calls this program as its rustdoc, and
//! only the real rustdoc gets the variable.

mod listing;

use std::ffi::OsString;
use std::process::{Command, ExitCode};

use crate::cargo::{Metadata, run as call, target_folder};
use crate::outside::{LIBRARIES, Program};
use crate::{Outcome, none_of};
use listing::Listing;
use testbed::generated::{ensure_file_contents, workspace_root};

/// Environment variable that names the rustdoc to be called when this program is called as rustdoc.
const RUSTDOC: &str = "XTASK_RUSTDOC";

/// Writes the listings; with `check`, compares them with the files.
pub(crate) fn run(check: bool) -> Outcome {
    let root = workspace_root();
    let workspace = Metadata::of(root, &[])?;
    let mut faults = Vec::new();
    let mut listings = Vec::new();
    for library in &LIBRARIES {
        let krate = library.name;
        let program = Program::write(root, krate, &workspace)?;
        // intermediate files are shared with the workspace; the output of rustdoc is kept apart
        // from the pages of `cargo doc`
        let written = target_folder().join("outside").join("json");
        call(
            program
                .call("doc")
                .args(["--no-deps", "--package", krate])
                .env("CARGO_BUILD_BUILD_DIR", target_folder())
                .env("CARGO_TARGET_DIR", &written)
                .env("RUSTDOC", std::env::current_exe()?)
                .env(RUSTDOC, rustdoc())
                .env_remove("CARGO_ENCODED_RUSTDOCFLAGS")
                .env("RUSTDOCFLAGS", "-Z unstable-options --output-format json"),
        )?;
        let path = written.join("doc").join(format!("{krate}.json"));
        let public = public_api::Builder::from_rustdoc_json(path)
            .omit_blanket_impls(true)
            .include_function_parameter_names(true)
            .build()
            .map_err(|error| {
                format!(
                    "{krate}: {error}. Each toolchain has its own format of rustdoc JSON: update `public-api` in Cargo.toml together with rust-toolchain.toml"
                )
            })?;
        let listing = Listing::of(krate, public.items().map(ToString::to_string));
        faults.extend(listing.not_nameable());
        println!("{krate}: {} public items", listing.len());
        listings.push((krate, listing));
    }
    let what = "types in signatures that a program that uses only this crate cannot name";
    none_of(&faults, what)?;
    for (krate, listing) in listings {
        ensure_file_contents(
            &root.join("docs").join("api").join(format!("{krate}.txt")),
            &listing.to_string(),
            check,
            "cargo xtask api",
        )?;
    }
    Ok(())
}

fn rustdoc() -> OsString {
    std::env::var_os("RUSTDOC").unwrap_or_else(|| "rustdoc".into())
}

/// Calls rustdoc with the arguments that cargo gave to this program; `None` if cargo did not call
/// this program as its rustdoc.
pub(crate) fn as_rustdoc() -> Option<ExitCode> {
    let rustdoc = std::env::var_os(RUSTDOC)?;
    let ended = Command::new(&rustdoc)
        .args(std::env::args_os().skip(1))
        .env("RUSTC_BOOTSTRAP", "1")
        .env_remove(RUSTDOC)
        .status();
    Some(match ended {
        Ok(status) if status.success() => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {}: {error}", rustdoc.to_string_lossy());
            ExitCode::FAILURE
        }
    })
}

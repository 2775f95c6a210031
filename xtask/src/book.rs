//! `cargo xtask book`: the pages of `docs` as a book in `target/book`, made by mdBook, with
//! equations as MathML.
//!
//! The pages are written for Git hosts, with `` $`x`$ `` and `math` fences. `docs/book.toml` names
//! this program as a preprocessor; `mdbook build docs` and `mdbook serve docs` therefore convert
//! the equations too.

mod check;
mod math;
mod page;
mod preprocessor;
mod reference;
mod rustdoc;
pub(crate) mod source;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

pub(crate) use preprocessor::run as preprocess;
pub(crate) use rustdoc::run as document;

use check::{Book, GENERATED};

use crate::files::at;
use crate::{Outcome, cargo, none_of};
use testbed::generated::workspace_root;
use testbed::papers::files;

/// Checks the pages and, unless `check` is set, builds the book. With `if_installed`, a missing
/// mdbook is reported and is not an error.
pub(crate) fn run(check: bool, if_installed: bool, tasks: Vec<String>) -> Outcome {
    let root = workspace_root();
    let (faults, tally) = Book::read(root, tasks)?.check();
    none_of(&faults, "faults in the pages")?;
    println!(
        "{} pages, {} links, {} equations, {} names of the code, {} mentions in the code: no fault",
        tally.pages, tally.links, tally.equations, tally.names, tally.mentions
    );
    if check {
        return Ok(());
    }
    if Command::new("mdbook").arg("--version").output().is_err() {
        let missing = "mdbook is not installed: install it by `cargo install mdbook --locked --no-default-features`";
        if if_installed {
            println!("not built: {missing}");
            return Ok(());
        }
        return Err(missing.into());
    }
    println!("{}", build(root)?.join("index.html").display());
    Ok(())
}

/// Runs mdBook on a copy of the pages, to which placeholders for pages not yet generated are added.
fn build(root: &Path) -> Outcome<PathBuf> {
    let pages = root.join("target").join("book-pages");
    let book = root.join("target").join("book");
    if pages.exists() {
        fs::remove_dir_all(&pages).map_err(at(&pages))?;
    }
    copy(&root.join("docs"), &pages)?;
    for (name, title) in GENERATED {
        let path = pages.join(name);
        if !path.exists() {
            fs::write(
                &path,
                format!("# {title}\n\nNot generated in this checkout.\n"),
            )
            .map_err(at(&path))?;
        }
    }
    let this = std::env::current_exe()?;
    let said = cargo::run(
        Command::new("mdbook")
            .arg("build")
            .arg(&pages)
            .arg("--dest-dir")
            .arg(&book)
            // replaces the command in book.toml, which would have cargo build this program first
            .env(
                "MDBOOK_PREPROCESSOR__EQUATIONS__COMMAND",
                format!("'{}' book-equations", this.display()),
            ),
    )?;
    let said = said.output + &said.remarks;
    if said.contains("WARN") || said.contains("ERROR") {
        return Err(
            format!("mdbook warns, but the book must be built without warnings:\n{said}").into(),
        );
    }
    Ok(book)
}

fn copy(from: &Path, to: &Path) -> Outcome {
    fs::create_dir_all(to).map_err(at(to))?;
    for source in files(from)? {
        let target = to.join(source.file_name().unwrap_or_default());
        if source.is_dir() {
            copy(&source, &target)?;
        } else {
            fs::copy(&source, &target).map_err(at(&source))?;
        }
    }
    Ok(())
}

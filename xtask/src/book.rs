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
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

pub(crate) use preprocessor::run as preprocess;
pub(crate) use rustdoc::run as document;

use check::{Book, GENERATED};

use crate::Outcome;
use testbed::generated::workspace_root;

/// Errors of the book.
#[derive(Debug, thiserror::Error)]
enum BookError {
    #[error("{} faults in the pages:\n{}", .0.len(), .0.join("\n"))]
    Faults(Vec<String>),
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: io::Error },
    #[error(
        "mdbook is not installed: install it by `cargo install mdbook --locked --no-default-features`"
    )]
    NoMdbook,
    #[error("mdbook ended with {status}:\n{output}")]
    Mdbook { status: String, output: String },
    #[error("mdbook warns, but the book must be built without warnings:\n{0}")]
    Warnings(String),
}

/// Checks the pages and, unless `check` is set, builds the book. With `if_installed`, a missing
/// mdbook is reported and is not an error.
pub(crate) fn run(check: bool, if_installed: bool, tasks: Vec<String>) -> Outcome {
    let root = workspace_root();
    let (faults, tally) = Book::read(root, tasks)?.check();
    if !faults.is_empty() {
        return Err(BookError::Faults(faults.iter().map(ToString::to_string).collect()).into());
    }
    println!(
        "{} pages, {} links, {} equations, {} names of the code, {} mentions in the code: no fault",
        tally.pages, tally.links, tally.equations, tally.names, tally.mentions
    );
    if check {
        return Ok(());
    }
    match build(root) {
        Err(BookError::NoMdbook) if if_installed => {
            println!("not built: {}", BookError::NoMdbook);
            Ok(())
        }
        Err(error) => Err(error.into()),
        Ok(book) => {
            println!("{}", book.join("index.html").display());
            Ok(())
        }
    }
}

/// Runs mdBook on a copy of the pages, to which placeholders for pages not yet generated are added.
fn build(root: &Path) -> Result<PathBuf, BookError> {
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
    let this = std::env::current_exe().map_err(at(Path::new("xtask")))?;
    let output = Command::new("mdbook")
        .arg("build")
        .arg(&pages)
        .arg("--dest-dir")
        .arg(&book)
        // replaces the command in book.toml, which would have cargo build this program first
        .env(
            "MDBOOK_PREPROCESSOR__EQUATIONS__COMMAND",
            format!("'{}' book-equations", this.display()),
        )
        .output()
        .map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => BookError::NoMdbook,
            _ => at(Path::new("mdbook"))(error),
        })?;
    let said = format!(
        "{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    if !output.status.success() {
        return Err(BookError::Mdbook {
            status: output.status.to_string(),
            output: said,
        });
    }
    if said.contains("WARN") || said.contains("ERROR") {
        return Err(BookError::Warnings(said));
    }
    Ok(book)
}

fn copy(from: &Path, to: &Path) -> Result<(), BookError> {
    fs::create_dir_all(to).map_err(at(to))?;
    for entry in fs::read_dir(from).map_err(at(from))? {
        let source = entry.map_err(at(from))?.path();
        let target = to.join(source.file_name().unwrap_or_default());
        if source.is_dir() {
            copy(&source, &target)?;
        } else {
            fs::copy(&source, &target).map_err(at(&source))?;
        }
    }
    Ok(())
}

fn at(path: &Path) -> impl Fn(io::Error) -> BookError {
    let path = path.to_path_buf();
    move |source| BookError::Io {
        path: path.clone(),
        source,
    }
}

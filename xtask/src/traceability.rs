//! `cargo xtask traceability`: docs/traceability.md, every numbered item of the thesis with its code and its proof.
//!
//! docs/traceability.ron says where an item is implemented and which test proves it. Here every such reference is looked up in
//! the parsed sources, the rows are compared with the list of what the thesis numbers, and citations of equations in the
//! sources are compared with the same list. What implements an equation has to cite it, so that the way back is open too.

mod citation;
mod error;
mod numbered;
mod page;
mod reproduction;
mod row;
mod source;
mod workspace;

use std::path::Path;

use crate::Outcome;
use testbed::generated::{ensure_file_contents, workspace_root};

use citation::Citation;
use error::{Fault, Faults};
use numbered::{Kind, Numbered, Part};
use reproduction::Reproductions;
use row::Row;
use workspace::{Unresolved, Workspace};

/// The command that makes the page.
const COMMAND: &str = "cargo xtask traceability";
/// What is written by hand, from the root of the workspace.
const ROWS: &str = "docs/traceability.ron";
/// What is made of it.
const PAGE: &str = "docs/traceability.md";

/// Writes the page, or with `check` fails if it is not what would be written. Fails where a row is missing or does not resolve.
pub(crate) fn run(check: bool) -> Outcome {
    let root = workspace_root();
    let rows = row::read(&root.join(ROWS))?;
    let workspace = Workspace::read(root)?;
    let reproductions = Reproductions::read(root, &workspace)?;
    let mut faults = complete(&rows, &numbered::all());
    for row in &rows {
        faults.extend(faults_of(row, root, &workspace, &reproductions));
    }
    let citations = citation::of_workspace(root)?;
    faults.extend(rows.iter().filter_map(|row| not_cited(row, &citations)));
    let equations = citations.len();
    faults.extend(citations.into_iter().filter_map(Citation::fault));
    if !faults.is_empty() {
        return Err(Box::new(Faults(faults)));
    }
    ensure_file_contents(&root.join(PAGE), &page::markdown(&rows), check, COMMAND)?;
    println!(
        "{} items traced, {} references to code, {} to tests, {equations} citations checked: {PAGE} is {}",
        rows.len(),
        rows.iter().map(|row| row.implemented.len()).sum::<usize>(),
        rows.iter().map(|row| row.proved.len()).sum::<usize>(),
        if check { "current" } else { "written" },
    );
    Ok(())
}

/// Whether each of the `expected` items has one row, in the order of the thesis, and no other has any.
fn complete(rows: &[Row], expected: &[Numbered]) -> Vec<Fault> {
    let mut faults = Vec::new();
    for item in expected {
        match rows.iter().filter(|row| row.item() == *item).count() {
            1 => {}
            0 => faults.push(Fault::Missing { item: item.clone() }),
            found => faults.push(Fault::Repeated {
                item: item.clone(),
                found,
            }),
        }
    }
    for row in rows {
        let item = row.item();
        if !expected.contains(&item) {
            faults.push(Fault::NotOfTheThesis {
                numbers: numbered::in_words(item.part, item.kind),
                item,
            });
        }
    }
    if faults.is_empty()
        && let Some((row, item)) = rows
            .iter()
            .zip(expected)
            .find(|(row, item)| row.item() != **item)
    {
        faults.push(Fault::Order {
            found: row.item(),
            expected: item.clone(),
        });
    }
    faults
}

/// The fault of an equation of a paper that no file of its implementation cites. The survey repeats the papers.
fn not_cited(row: &Row, citations: &[Citation]) -> Option<Fault> {
    let item = row.item();
    if item.part == Part::Survey || item.kind != Kind::Equation || !item.has_number() {
        return None;
    }
    let files: Vec<&str> = row
        .implemented
        .iter()
        .filter_map(|reference| workspace::split(reference).map(|(file, _)| file))
        .collect();
    let cited = citations
        .iter()
        .map(Citation::of)
        .any(|(cited, file)| *cited == item && files.contains(&file));
    (!cited).then(|| Fault::NotCited {
        item,
        files: files.join(", "),
    })
}

/// What is wrong with one row by itself.
fn faults_of(
    row: &Row,
    root: &Path,
    workspace: &Workspace,
    reproductions: &Reproductions,
) -> Vec<Fault> {
    let mut faults = Vec::new();
    let item = row.item();
    for (field, empty) in [
        ("says", row.says.trim().is_empty()),
        ("implemented", row.implemented.is_empty()),
        ("proved", row.proved.is_empty()),
    ] {
        if empty {
            faults.push(Fault::Empty {
                item: item.clone(),
                field,
            });
        }
    }
    let unresolved = |field, source: Unresolved| Fault::Unresolved {
        item: item.clone(),
        field,
        source,
    };
    let mut public = row.implemented.is_empty();
    for reference in &row.implemented {
        match workspace.resolve(reference) {
            Ok(found) if found.test => {
                public = true; // one fault a reference
                faults.push(Fault::TestAsCode {
                    item: item.clone(),
                    reference: reference.clone(),
                });
            }
            // what the tasks do is part of no public interface
            Ok(found) => public |= found.public || reference.starts_with("xtask/"),
            Err(source) => {
                public = true;
                faults.push(unresolved("implemented", source));
            }
        }
    }
    if !public {
        faults.push(Fault::Private {
            item: item.clone(),
            references: row.implemented.join(", "),
        });
    }
    for reference in &row.proved {
        match workspace.resolve(reference) {
            Ok(found) if found.test => {}
            Ok(_) => faults.push(Fault::NoTest {
                item: item.clone(),
                reference: reference.clone(),
            }),
            Err(source) => faults.push(unresolved("proved", source)),
        }
    }
    for reference in &row.reproduced {
        if let Err(source) = reproductions.resolve(reference) {
            faults.push(unresolved("reproduced", source));
        }
    }
    for link in row.links() {
        let file = link.split('#').next().unwrap_or(link);
        if !root.join("docs").join(file).is_file() {
            faults.push(Fault::DeadLink {
                item: item.clone(),
                link: link.to_owned(),
            });
        }
    }
    faults
}

#[cfg(test)]
mod tests;

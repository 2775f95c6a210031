//! Checks of a page: links, anchors, equations, names, and the order of sections.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::page::{Page, normal};
use super::source::{self, Crate};
use super::{math, reference};
use crate::Outcome;
use crate::files::{self, files_below};

/// Pages that other tasks write. The summary names them even if a checkout does not contain them
/// yet.
pub(super) const GENERATED: [(&str, &str); 2] = [
    ("validation.md", "Validation"),
    ("traceability.md", "Traceability"),
];

/// Last sections of every page on theory, in this order.
const LAST_SECTIONS: [&str; 5] = [
    "Validity",
    "When not to trust it",
    "In the code",
    "Checked by",
    "References",
];

/// Pages outside the book; their links into the book must be valid.
const FRONT_PAGES: [&str; 3] = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"];

/// Counts of the checked items.
#[derive(Debug, Default)]
pub(super) struct Tally {
    pub(super) pages: usize,
    pub(super) links: usize,
    pub(super) equations: usize,
    pub(super) names: usize,
    pub(super) mentions: usize,
}

/// Whole book, together with the references to it in the source code.
pub(super) struct Book<'a> {
    root: &'a Path,
    /// Pages by their paths, relative to the root.
    pages: BTreeMap<PathBuf, Page>,
    crates: Vec<Crate>,
    tasks: Vec<String>,
}

impl<'a> Book<'a> {
    /// Reads `root/docs`, the front pages and the crates; `tasks` are the tasks of `cargo xtask`.
    pub(super) fn read(root: &'a Path, tasks: Vec<String>) -> Outcome<Self> {
        let mut files = files_below(&root.join("docs"), "md")?;
        files.extend(FRONT_PAGES.iter().map(|name| root.join(name)));
        let mut pages = BTreeMap::new();
        for file in files {
            let name = file.strip_prefix(root).unwrap_or(&file).to_path_buf();
            pages.insert(name, Page::read(&files::read(&file)?));
        }
        Ok(Self {
            root,
            pages,
            crates: source::crates(root)?,
            tasks,
        })
    }

    pub(super) fn check(&self) -> (Vec<String>, Tally) {
        let mut faults = Vec::new();
        let mut tally = Tally::default();
        self.check_summary(&mut faults);
        for (file, page) in &self.pages {
            let mut fault = |line, what: String| faults.push(at(file, line, &what));
            for (line, what) in &page.faults {
                fault(*line, what.clone());
            }
            for link in &page.links {
                tally.links += 1;
                if let Err(what) = self.check_link(file, &link.target, link.picture) {
                    fault(link.line, what);
                }
            }
            for code in &page.code {
                if let Some(task) = code.text.strip_prefix("cargo xtask ") {
                    let task = task.split_whitespace().next().unwrap_or_default();
                    if !task.starts_with('<') && !self.tasks.iter().any(|known| known == task) {
                        fault(code.line, format!("`{}`: no such task", code.text));
                    }
                }
            }
            if !file.starts_with("docs") {
                continue;
            }
            tally.pages += 1;
            for equation in &page.equations {
                tally.equations += 1;
                if let Err(error) = math::of(equation) {
                    fault(equation.line, error);
                }
            }
            for (line, what) in reference::faults(page) {
                fault(line, what);
            }
            if file.starts_with("docs/theory") {
                tally.names += self.check_last_sections(page, &mut fault);
            }
        }
        for (file, equation) in self.crates.iter().flat_map(|one| &one.equations) {
            tally.equations += 1;
            if let Err(error) = math::of(equation) {
                faults.push(at(file, equation.line, &error));
            }
        }
        for (file, line, words) in self.crates.iter().flat_map(|one| &one.clauses) {
            let what = "a doc comment opens with a noun or a verb, not with a clause";
            faults.push(at(file, *line, &format!("{what}: {words}")));
        }
        tally.mentions = self.check_mentions(&mut faults);
        (faults, tally)
    }

    /// Checks that the summary contains every page once and nothing else.
    fn check_summary(&self, faults: &mut Vec<String>) {
        let file = Path::new("docs/SUMMARY.md");
        let mut fault = |line, what: String| faults.push(at(file, line, &what));
        let Some(summary) = self.pages.get(file) else {
            return fault(1, "does not exist".to_owned());
        };
        for (index, link) in summary.links.iter().enumerate() {
            if summary.links[..index]
                .iter()
                .any(|other| other.target == link.target)
            {
                fault(link.line, format!("{} is named twice", link.target));
            }
        }
        for name in self.pages.keys().filter(|name| name.starts_with("docs")) {
            let name = name.strip_prefix("docs").unwrap_or(name);
            if name != Path::new("SUMMARY.md")
                && !summary
                    .links
                    .iter()
                    .any(|link| Path::new(&link.target) == name)
            {
                fault(
                    1,
                    format!("{} is in the book and not in the summary", name.display()),
                );
            }
        }
    }

    /// Checks that the target of a link is a file of the repository and has the anchor. A picture
    /// must be in the book; a link may lead out of the book, because the preprocessor removes such
    /// links.
    fn check_link(&self, from: &Path, target: &str, picture: bool) -> Result<(), String> {
        let (path, anchor) = match target.split_once('#') {
            Some((path, anchor)) => (path, Some(anchor)),
            None => (target, None),
        };
        let file = if path.is_empty() {
            from.to_path_buf()
        } else {
            let folder = from.parent().unwrap_or(Path::new(""));
            normal(&folder.join(path)).ok_or(format!("{target} leaves the repository"))?
        };
        if picture && from.starts_with("docs") && !file.starts_with("docs") {
            return Err(format!("{target}: a picture outside of the book"));
        }
        let generated = GENERATED
            .iter()
            .any(|(name, _)| file == Path::new("docs").join(name));
        if !self.root.join(&file).exists() {
            return if generated && anchor.is_none() {
                Ok(())
            } else {
                Err(format!("{target}: {} does not exist", file.display()))
            };
        }
        match (anchor, self.pages.get(&file)) {
            (None, _) => Ok(()),
            // an anchor in a source file is the number of a line, which is not checked
            (Some(_), None) if file.extension().is_some_and(|extension| extension != "md") => {
                Ok(())
            }
            (Some(anchor), Some(page)) if page.headings.iter().any(|h| h.anchor == anchor) => {
                Ok(())
            }
            (Some(anchor), _) => Err(format!(
                "{target}: {} has no heading #{anchor}",
                file.display()
            )),
        }
    }

    /// Checks the last sections of a page on theory, and the names in two of these sections.
    /// Returns the number of names.
    fn check_last_sections(&self, page: &Page, fault: &mut impl FnMut(usize, String)) -> usize {
        let sections: Vec<_> = page.headings.iter().filter(|h| h.level == 2).collect();
        let last = &sections[sections.len().saturating_sub(LAST_SECTIONS.len())..];
        let found: Vec<_> = last.iter().map(|heading| heading.text.as_str()).collect();
        if found != LAST_SECTIONS {
            let line = last.first().map_or(1, |heading| heading.line);
            fault(
                line,
                format!("ends with the sections {found:?}; every page ends with {LAST_SECTIONS:?}"),
            );
            return 0;
        }
        let mut names = 0;
        for (section, needs) in [
            ("In the code", "a module of a crate"),
            ("Checked by", "a file of tests"),
        ] {
            let Some(index) = page.section_named(section) else {
                continue;
            };
            let mut found = 0;
            for code in page.code.iter().filter(|code| code.section == index + 1) {
                if code.text.starts_with("crates/") || code.text.starts_with("xtask/") {
                    found += usize::from(section == "Checked by");
                    names += 1;
                    if !self.root.join(&code.text).exists() {
                        fault(code.line, format!("`{}` does not exist", code.text));
                    }
                } else if let Some(undefined) = source::undefined(&code.text, &self.crates) {
                    found += usize::from(section == "In the code");
                    names += 1;
                    if !undefined.is_empty() {
                        fault(
                            code.line,
                            format!(
                                "`{}`: no source file defines {}",
                                code.text,
                                undefined.join(", ")
                            ),
                        );
                    }
                }
            }
            if found == 0 {
                fault(
                    page.headings[index].line,
                    format!("\"{section}\" names nothing; it needs {needs}"),
                );
            }
        }
        names
    }

    /// Returns the crates that the pages on theory name as their code. A crate that only contains
    /// programs may have no such page.
    fn crates_in_the_pages(&self) -> Vec<&str> {
        let code: Vec<_> = self
            .pages
            .iter()
            .filter(|(file, _)| file.starts_with("docs/theory"))
            .flat_map(|(_, page)| {
                let section = page.section_named("In the code").map(|index| index + 1);
                page.code
                    .iter()
                    .filter(move |code| Some(code.section) == section)
            })
            .collect();
        self.crates
            .iter()
            .map(|one| one.name.as_str())
            .filter(|name| {
                code.iter().any(|code| {
                    code.text
                        .strip_prefix(name)
                        .is_some_and(|rest| rest.is_empty() || rest.starts_with("::"))
                })
            })
            .collect()
    }

    /// Checks that every page named in the source code exists, that the source code names every
    /// page on theory, and that `lib.rs` of every crate whose code a page on theory names has a
    /// line on its theory. Returns the number of pages named in the source code.
    fn check_mentions(&self, faults: &mut Vec<String>) -> usize {
        let mut named = 0;
        let with_theory = self.crates_in_the_pages();
        for one in &self.crates {
            if with_theory.contains(&one.name.as_str()) && !one.front_page_has_theory {
                let file = Path::new("crates").join(&one.name).join("src/lib.rs");
                faults.push(at(&file, 1, "no line begins with `//! Theory: `"));
            }
            for mention in &one.mentions {
                named += 1;
                let from = Path::new("README.md");
                if let Err(what) = self.check_link(from, &mention.target, false) {
                    faults.push(at(&mention.file, mention.line, &what));
                }
            }
        }
        for file in self
            .pages
            .keys()
            .filter(|file| file.starts_with("docs/theory"))
        {
            let is_named = self
                .crates
                .iter()
                .flat_map(|one| &one.mentions)
                .filter_map(|mention| mention.target.split('#').next())
                .any(|page| Path::new(page) == file);
            if !is_named {
                faults.push(at(file, 1, "no comment of the source code names this page"));
            }
        }
        named
    }
}

/// Returns a fault with its place.
fn at(file: &Path, line: usize, what: &str) -> String {
    format!("{}:{line}: {what}", file.display())
}

#[cfg(test)]
mod tests;

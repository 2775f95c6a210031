//! Names in the source code that pages mention, and pages that the source code mentions.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use super::page::{Equation, Page};
use crate::Outcome;
use crate::files::{files_below, read};
use testbed::papers::files;

/// Library crate, with the parts that the book needs.
#[derive(Debug, Default)]
pub(super) struct Crate {
    pub(super) name: String,
    /// All definitions in its source: modules, types, traits, functions, constants.
    definitions: HashSet<String>,
    pub(super) mentions: Vec<Mention>,
    /// Equations in comments, each with its file.
    pub(super) equations: Vec<(PathBuf, Equation)>,
    /// Doc comments that open with a clause, with their lines.
    pub(super) clauses: Vec<(PathBuf, usize, String)>,
    /// True if `src/lib.rs` has a line that names its page on theory.
    pub(super) front_page_has_theory: bool,
}

/// Page of the book that a comment names.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Mention {
    pub(super) file: PathBuf,
    pub(super) line: usize,
    /// Path relative to the root of the repository, with `#` and the anchor if there is one.
    pub(super) target: String,
}

const KEYWORDS: [&str; 8] = [
    "mod ", "struct ", "enum ", "trait ", "fn ", "type ", "const ", "static ",
];

/// First words of doc comments that open with a clause instead of a noun or a verb that names the
/// thing.
const CLAUSES: [&str; 12] = [
    "What", "How", "Whether", "Where", "When", "That", "Which", "Why", "If", "Who", "Whose",
    "Because",
];

/// Returns the text of a line of a doc comment.
fn doc_comment(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let words = line
        .strip_prefix("///")
        .or_else(|| line.strip_prefix("//!"))?;
    Some(words.trim())
}

/// Reads all crates in `root/crates`, in the order of their names.
pub(super) fn crates(root: &Path) -> Outcome<Vec<Crate>> {
    let folders = files(&root.join("crates"))?;
    folders
        .iter()
        .map(|folder| Crate::read(root, folder))
        .collect()
}

impl Crate {
    fn read(root: &Path, folder: &Path) -> Outcome<Self> {
        let mut found = Self {
            name: folder
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned(),
            ..Self::default()
        };
        for file in files_below(&folder.join("src"), "rs")? {
            let text = read(&file)?;
            let file = file.strip_prefix(root).unwrap_or(&file).to_path_buf();
            found.take(&text, &file);
        }
        Ok(found)
    }

    fn take(&mut self, text: &str, file: &Path) {
        let comments = Page::read(&comments_of(text));
        self.equations.extend(
            comments
                .equations
                .into_iter()
                .map(|equation| (file.to_path_buf(), equation)),
        );
        let mut before = "";
        for (index, line) in text.lines().enumerate() {
            let opens = doc_comment(before).is_none();
            before = line;
            if !line.trim_start().starts_with("//") {
                self.take_definitions(line);
                continue;
            }
            if let Some(words) = doc_comment(line)
                && opens
                && CLAUSES.contains(&words.split(' ').next().unwrap_or_default())
            {
                self.clauses
                    .push((file.to_path_buf(), index + 1, words.to_owned()));
            }
            if file.ends_with("src/lib.rs") && line.starts_with("//! Theory: ") {
                self.front_page_has_theory = true;
            }
            let mentions = pages_named_in(line).map(|target| Mention {
                file: file.to_path_buf(),
                line: index + 1,
                target,
            });
            self.mentions.extend(mentions);
        }
    }

    fn take_definitions(&mut self, line: &str) {
        for keyword in KEYWORDS {
            if let Some(at) = line.find(keyword) {
                let name: String = line[at + keyword.len()..]
                    .trim_start_matches("r#")
                    .chars()
                    .take_while(|c| c.is_alphanumeric() || *c == '_')
                    .collect();
                if !name.is_empty() {
                    self.definitions.insert(name);
                }
            }
        }
    }
}

/// Returns the segments of the path `code` that no source file of its crate defines; `None` if
/// `code` does not begin with the name of a crate.
pub(super) fn undefined<'a>(code: &'a str, crates: &[Crate]) -> Option<Vec<&'a str>> {
    let (name, rest) = code.split_once("::").unwrap_or((code, ""));
    let of = crates.iter().find(|one| one.name == name)?;
    Some(
        rest.split(|c: char| !c.is_alphanumeric() && c != '_')
            .filter(|segment| !segment.is_empty() && !of.definitions.contains(*segment))
            .collect(),
    )
}

/// Returns the documentation in a source file as Markdown. Each line of code becomes an empty line,
/// which keeps the line numbers.
fn comments_of(text: &str) -> String {
    let mut markdown = String::new();
    for line in text.lines() {
        let line = line.trim_start();
        if let Some(comment) = line.strip_prefix("//!").or(line.strip_prefix("///")) {
            markdown.push_str(comment.strip_prefix(' ').unwrap_or(comment));
        }
        markdown.push('\n');
    }
    markdown
}

/// Returns every page `docs/….md` that the line names, with its anchor.
fn pages_named_in(line: &str) -> impl Iterator<Item = String> {
    let is_part = |c: char| c.is_alphanumeric() || matches!(c, '/' | '-' | '_' | '.' | '#');
    line.match_indices("docs/").filter_map(move |(at, _)| {
        let name = line[at..].split(|c| !is_part(c)).next()?;
        let name = name.trim_end_matches('.');
        let page = name.split('#').next()?;
        page.ends_with(".md").then(|| name.to_owned())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Crate {
        let mut example = Crate {
            name: "rodwave".to_owned(),
            ..Crate::default()
        };
        let text = "//! Theory: `docs/theory/chains.md#elements`.\n//!\n//! ```math\n//! x^2\n//! ```\npub mod chain;\npub struct Chain<'a>;\n// fn gone() {}\n/// What it is.\n/// Which goes on.\nfn one() {}\n/// Whole number.\n";
        example.take(text, Path::new("crates/rodwave/src/lib.rs"));
        example
    }

    #[test]
    fn names_are_found_segment_by_segment() {
        let crates = [example()];
        assert_eq!(undefined("rodwave::chain::Chain", &crates), Some(vec![]));
        assert_eq!(
            undefined("rodwave::{chain, horn}", &crates),
            Some(vec!["horn"])
        );
        assert_eq!(
            undefined("rodwave::gone", &crates),
            Some(vec!["gone"]),
            "a comment defines nothing"
        );
        assert_eq!(undefined("other::chain", &crates), None);
    }

    #[test]
    fn a_doc_comment_that_opens_with_a_clause_is_found_and_one_that_goes_on_with_it_is_not() {
        let found = example().clauses;
        let lines: Vec<_> = found
            .iter()
            .map(|(_, line, words)| (*line, words.as_str()))
            .collect();
        assert_eq!(lines, [(9, "What it is.")]);
    }

    #[test]
    fn mentions_have_page_and_anchor() {
        let example = example();
        assert!(example.front_page_has_theory);
        assert_eq!(example.equations.len(), 1);
        assert_eq!(
            (
                example.equations[0].1.tex.as_str(),
                example.equations[0].1.line
            ),
            ("x^2\n", 3)
        );
        assert_eq!(example.mentions.len(), 1);
        assert_eq!(example.mentions[0].target, "docs/theory/chains.md#elements");
    }
}

//! Citations of numbered items in the sources and the documentation: `paper A, eq. 5`, `Figures 5
//! and 6 of paper E`, and in short `(A 5)`.
//!
//! A citation is read word by word, across the line breaks of comments. A citation without a paper,
//! such as `eq. 5` alone, is ignored, because its paper is unknown.

mod number;

use std::path::Path;

use crate::Outcome;
use crate::files::read;
use testbed::papers::files;

use self::number::{between, kind, number_or_range};
use super::numbered::{Kind, Numbered, Part, in_words};
use super::place::{self, Place};

/// Folders searched for citations, relative to the root of the workspace.
const PLACES: [&str; 7] = [
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "README.md",
    "crates",
    "docs",
    "fixtures",
    "xtask/src",
];

/// Numbered item that a file cites.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Citation {
    pub(crate) file: String,
    pub(crate) line: usize,
    pub(crate) cited: Numbered,
    /// `None` if the file is not a source of a crate or of a reproduction.
    pub(crate) place: Option<Place>,
}

impl Citation {
    /// Returns the fault that the thesis does not contain the cited item.
    pub(crate) fn fault(&self) -> String {
        let expected = in_words(self.cited.part, self.cited.kind);
        let Self {
            file, line, cited, ..
        } = self;
        format!("{file}, line {line}: `{cited}` is cited, expected {expected}")
    }
}

/// Returns every citation in the files of the workspace at `root`.
pub(crate) fn of_workspace(root: &Path) -> Outcome<Vec<Citation>> {
    let mut citations = Vec::new();
    let mut paths: Vec<_> = PLACES.map(|place| root.join(place)).into();
    while let Some(path) = paths.pop() {
        if path.is_dir() {
            paths.extend(files(&path)?);
        } else if path
            .extension()
            .is_some_and(|ending| ["rs", "md", "ron"].iter().any(|known| ending == *known))
        {
            let text = read(&path)?;
            let file = path
                .strip_prefix(root)?
                .to_string_lossy()
                .replace('\\', "/");
            citations.extend(of_text(&file, &text));
        }
    }
    citations.sort_by(|a, b| (&a.file, a.line).cmp(&(&b.file, b.line)));
    Ok(citations)
}

/// Returns every citation in `text`.
pub(crate) fn of_text(file: &str, text: &str) -> Vec<Citation> {
    let words: Vec<Word<'_>> = text
        .lines()
        .zip(1..)
        .flat_map(|(line, number)| {
            without_comment_mark(line)
                .split_whitespace()
                // the backslash of a string that continues on the next line
                .filter(|word| *word != "\\")
                .map(move |text| Word { text, line: number })
        })
        .collect();
    let mut citations = Vec::new();
    for at in 0..words.len() {
        let rest = words.get(at..).unwrap_or_default();
        let found = after_part(rest)
            .into_iter()
            .chain(before_part(rest))
            .chain(in_short(rest));
        for (line, cited) in found {
            citations.push(Citation {
                file: file.to_owned(),
                line,
                cited,
                place: place::of(file, text, line),
            });
        }
    }
    citations
}

#[derive(Debug, Clone, Copy)]
struct Word<'a> {
    text: &'a str,
    line: usize,
}

fn without_comment_mark(line: &str) -> &str {
    let line = line.trim_start();
    ["//!", "///", "//", "> "]
        .iter()
        .find_map(|mark| line.strip_prefix(mark))
        .unwrap_or(line)
}

/// Reads a citation such as `paper A, eqs. 3-4 and Table 1`, starting at its first word.
fn after_part(words: &[Word<'_>]) -> Vec<(usize, Numbered)> {
    let mut found = Vec::new();
    let Some((part, mut end, used)) = part(words) else {
        return found;
    };
    if !["", ",", "'s", "’s"].contains(&end) {
        return found;
    }
    let mut rest = words.get(used..).unwrap_or_default();
    loop {
        let joined = rest
            .first()
            .is_some_and(|word| ["and", "or"].contains(&word.text));
        if joined && !found.is_empty() {
            rest = rest.get(1..).unwrap_or_default();
        } else if !found.is_empty() && end != "," {
            return found;
        }
        let Some(run) = run(rest) else {
            return found;
        };
        found.extend(run.items(part));
        end = run.end;
        if !["", ","].contains(&end) {
            return found;
        }
        rest = rest.get(run.used..).unwrap_or_default();
    }
}

/// Reads a citation such as `Figures 5 and 6 of paper E`, starting at its first word.
fn before_part(words: &[Word<'_>]) -> Vec<(usize, Numbered)> {
    let Some(run) = run(words).filter(|run| run.end.is_empty()) else {
        return Vec::new();
    };
    let rest = words.get(run.used..).unwrap_or_default();
    let Some(("of", rest)) = rest.split_first().map(|(word, rest)| (word.text, rest)) else {
        return Vec::new();
    };
    // skips `the` in `of the survey`
    let rest = match rest.split_first() {
        Some((word, rest)) if word.text == "the" => rest,
        _ => rest,
    };
    part(rest).map_or_else(Vec::new, |(part, _, _)| run.items(part))
}

/// Reads a citation such as `(A 1, 5-7, Table 1)` or `(A 2, B 3)`, starting at its first word. A
/// number with a point is a section.
fn in_short(words: &[Word<'_>]) -> Vec<(usize, Numbered)> {
    let letter = |text: &str| match text.as_bytes() {
        [letter] => Part::of_letter(char::from(*letter)),
        _ => None,
    };
    let mut found = Vec::new();
    let Some((first, mut rest)) = words.split_first() else {
        return found;
    };
    let Some(mut part) = first.text.strip_prefix('(').and_then(letter) else {
        return found;
    };
    while let Some((word, others)) = rest.split_first() {
        let end = if let Some(run) = run(rest) {
            found.extend(run.items(part));
            rest = rest.get(run.used..).unwrap_or_default();
            run.end
        } else if let Some((first, last, end)) =
            number_or_range(word.text).filter(|(first, ..)| !first.contains('.'))
        {
            found.extend(between(first, last).into_iter().map(|number| {
                let kind = Kind::Equation;
                (word.line, Numbered { part, kind, number })
            }));
            rest = others;
            end
        } else if let Some(next) = letter(word.text).filter(|_| !found.is_empty()) {
            part = next;
            rest = others;
            ","
        } else {
            break;
        };
        if end != "," {
            break;
        }
    }
    found
}

/// Returns the part of the thesis, the remainder of its last word, and the number of words.
fn part<'a>(words: &[Word<'a>]) -> Option<(Part, &'a str, usize)> {
    let first = words
        .first()?
        .text
        .trim_start_matches(|c: char| !c.is_alphanumeric());
    if let Some(end) = first
        .strip_prefix("survey")
        .or_else(|| first.strip_prefix("Survey"))
    {
        return Some((Part::Survey, end, 1));
    }
    if !first.eq_ignore_ascii_case("paper") {
        return None;
    }
    let name = words.get(1)?.text;
    let part = Part::of_letter(name.chars().next()?)?;
    let end = name.get(1..)?;
    (!end.starts_with(char::is_alphanumeric)).then_some((part, end, 2))
}

/// Kind of item, and its numbers.
#[derive(Debug)]
struct Run<'a> {
    kind: Kind,
    numbers: Vec<(usize, String)>,
    /// Remainder of the word after the last number.
    end: &'a str,
    used: usize,
}

impl Run<'_> {
    fn items(&self, part: Part) -> Vec<(usize, Numbered)> {
        self.numbers
            .iter()
            .map(|(line, number)| {
                (
                    *line,
                    Numbered {
                        part,
                        kind: self.kind,
                        number: number.clone(),
                    },
                )
            })
            .collect()
    }
}

/// Reads `eq. 5`, `eqs. 3-4` or `Figures 3, 4 and 5`, starting at the first word.
fn run<'a>(words: &[Word<'a>]) -> Option<Run<'a>> {
    let first = words.first()?.text.trim_start_matches('(');
    let (kind, several) = kind(first)?;
    let mut numbers = Vec::new();
    let mut used = 1;
    let mut end = "";
    loop {
        // a further number follows a comma or a word
        let joined = used > 1
            && words
                .get(used)
                .is_some_and(|word| ["and", "or", "to"].contains(&word.text));
        if used > 1 && !joined && end != "," {
            break;
        }
        let at = used + usize::from(joined);
        let Some((word, (first, last, after))) = words
            .get(at)
            .and_then(|word| Some((word, number_or_range(word.text)?)))
        else {
            break;
        };
        numbers.extend(
            between(first, last)
                .into_iter()
                .map(|number| (word.line, number)),
        );
        end = after;
        used = at + 1;
        if !several || !["", ","].contains(&end) {
            break;
        }
    }
    (!numbers.is_empty()).then_some(Run {
        kind,
        numbers,
        end,
        used,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_equation_that_is_not_there_is_a_fault_with_its_place() {
        let citations = of_text("a.rs", &"\nP D, eqs. 14-15".replace('P', "paper"));
        assert_eq!(
            citations[1].fault(),
            "a.rs, line 2: `P D, eq. 15` is cited, expected eq. 1 to 14, δ".replace("P ", "paper ")
        );
    }
}

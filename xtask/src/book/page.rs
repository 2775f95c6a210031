//! Contents of a page for the checks: headings, links, pictures, equations and code spans, each
//! with its line.

use std::ops::Range;
use std::path::{Component, Path, PathBuf};

use pulldown_cmark::{CodeBlockKind, Event, Options, Parser, Tag, TagEnd};

/// Parsed page of the book.
#[derive(Debug, Default)]
pub(super) struct Page {
    pub(super) headings: Vec<Heading>,
    /// Links and pictures whose targets are in the repository.
    pub(super) links: Vec<Link>,
    pub(super) equations: Vec<Equation>,
    /// Code spans within sentences that are not formulas.
    pub(super) code: Vec<Code>,
    /// Sentences without code and formulas.
    pub(super) prose: Vec<Prose>,
    /// Faults in the Markdown of the page.
    pub(super) faults: Vec<(usize, String)>,
}

#[derive(Debug)]
pub(super) struct Heading {
    pub(super) level: usize,
    pub(super) text: String,
    /// Anchor, as Git hosts and mdBook form it.
    pub(super) anchor: String,
    pub(super) line: usize,
}

#[derive(Debug)]
pub(super) struct Link {
    pub(super) target: String,
    pub(super) picture: bool,
    /// Position in the source, including the brackets.
    pub(super) span: Range<usize>,
    pub(super) line: usize,
}

#[derive(Debug)]
pub(super) struct Equation {
    pub(super) tex: String,
    pub(super) display: bool,
    /// Position in the source, including the dollars or fences.
    pub(super) span: Range<usize>,
    pub(super) line: usize,
}

#[derive(Debug)]
pub(super) struct Code {
    pub(super) text: String,
    /// Number of preceding headings.
    pub(super) section: usize,
    pub(super) line: usize,
}

#[derive(Debug)]
pub(super) struct Prose {
    pub(super) text: String,
    pub(super) line: usize,
}

impl Page {
    pub(super) fn read(source: &str) -> Self {
        let lines = Lines::of(source);
        let mut page = Self::default();
        let mut heading: Option<(usize, String, usize)> = None;
        let mut fence: Option<(Range<usize>, String)> = None;
        let mut in_code_block = false;
        let mut sentence = Prose {
            text: String::new(),
            line: 1,
        };
        for (event, span) in Parser::new_ext(source, markdown()).into_offset_iter() {
            let line = lines.at(span.start);
            match event {
                Event::Start(Tag::Heading { level, .. }) => {
                    heading = Some((level as usize, String::new(), line));
                }
                Event::End(TagEnd::Heading(_)) => {
                    if let Some((level, text, line)) = heading.take() {
                        page.push_heading(level, text, line);
                    }
                }
                Event::Start(Tag::Link { dest_url, .. }) => {
                    page.push_link(&dest_url, false, span, line);
                }
                Event::Start(Tag::Image { dest_url, .. }) => {
                    page.push_link(&dest_url, true, span, line);
                }
                Event::Start(Tag::CodeBlock(kind)) => {
                    in_code_block = true;
                    if matches!(&kind, CodeBlockKind::Fenced(info) if &**info == "math") {
                        fence = Some((span, String::new()));
                    }
                }
                Event::End(TagEnd::CodeBlock) => {
                    in_code_block = false;
                    if let Some((span, tex)) = fence.take() {
                        page.equations.push(Equation {
                            tex,
                            display: true,
                            line: lines.at(span.start),
                            span,
                        });
                    }
                }
                Event::Start(Tag::TableRow | Tag::TableHead) => {
                    page.check_row(&source[span], line);
                }
                Event::End(TagEnd::Paragraph | TagEnd::TableCell | TagEnd::Item) => {
                    page.end_sentence(&mut sentence);
                }
                Event::Code(text) => {
                    if let Some((_, title, _)) = &mut heading {
                        title.push_str(&text);
                    }
                    page.push_code(source, &text, span, line);
                }
                Event::Text(text) => {
                    if let Some((_, tex)) = &mut fence {
                        tex.push_str(&text);
                    } else if !in_code_block {
                        if let Some((_, title, _)) = &mut heading {
                            title.push_str(&text);
                        }
                        if sentence.text.is_empty() {
                            sentence.line = line;
                        }
                        sentence.text.push_str(&text);
                    }
                }
                Event::SoftBreak | Event::HardBreak => sentence.text.push(' '),
                _ => {}
            }
        }
        page.end_sentence(&mut sentence);
        page
    }

    /// Returns the index of the heading of level 2 with this text.
    pub(super) fn section_named(&self, text: &str) -> Option<usize> {
        self.headings
            .iter()
            .position(|heading| heading.level == 2 && heading.text == text)
    }

    fn push_heading(&mut self, level: usize, text: String, line: usize) {
        let plain = anchor_of(&text);
        let twins = self
            .headings
            .iter()
            .filter(|other| anchor_of(&other.text) == plain)
            .count();
        let anchor = if twins == 0 {
            plain
        } else {
            format!("{plain}-{twins}")
        };
        self.headings.push(Heading {
            level,
            text,
            anchor,
            line,
        });
    }

    fn push_link(&mut self, target: &str, picture: bool, span: Range<usize>, line: usize) {
        if !target.contains("://") && !target.starts_with("mailto:") {
            self.links.push(Link {
                target: target.to_owned(),
                picture,
                span,
                line,
            });
        }
    }

    fn push_code(&mut self, source: &str, text: &str, span: Range<usize>, line: usize) {
        let before = source[..span.start].ends_with('$');
        let after = source[span.end..].starts_with('$');
        match (before, after) {
            (true, true) => self.equations.push(Equation {
                tex: text.to_owned(),
                display: false,
                span: span.start - 1..span.end + 1,
                line,
            }),
            (false, false) => self.code.push(Code {
                text: text.to_owned(),
                section: self.headings.len(),
                line,
            }),
            _ => self.faults.push((
                line,
                format!("formula `{text}` has a dollar on one side only"),
            )),
        }
    }

    /// Checks the formulas in a row of a table for bars. Git hosts take a bar in a table for the
    /// border of a cell, even within code.
    fn check_row(&mut self, row: &str, line: usize) {
        let mut rest = row;
        while let Some((_, behind)) = rest.split_once("$`") {
            let Some((formula, after)) = behind.split_once("`$") else {
                break;
            };
            if formula.contains('|') {
                self.faults.push((
                    line,
                    format!(
                        "formula `{formula}` has a bar within a table: write \\lvert and \\rvert"
                    ),
                ));
            }
            rest = after;
        }
    }

    fn end_sentence(&mut self, sentence: &mut Prose) {
        if !sentence.text.is_empty() {
            self.prose.push(Prose {
                text: std::mem::take(&mut sentence.text),
                line: sentence.line,
            });
        }
    }
}

/// Returns a path without `.` and `..`, or `None` if it leads above the root.
pub(super) fn normal(path: &Path) -> Option<PathBuf> {
    let mut out = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir => {
                if !out.pop() {
                    return None;
                }
            }
            Component::Normal(name) => out.push(name),
            Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    Some(out)
}

/// Returns the Markdown options common to mdBook and Git hosts.
fn markdown() -> Options {
    Options::ENABLE_TABLES | Options::ENABLE_STRIKETHROUGH
}

/// Returns letters, digits, hyphens and underscores of a heading, in lower case, with hyphens for
/// blanks.
fn anchor_of(heading: &str) -> String {
    heading
        .trim()
        .chars()
        .filter_map(|c| match c {
            ' ' => Some('-'),
            '-' | '_' => Some(c),
            c if c.is_alphanumeric() => Some(c.to_ascii_lowercase()),
            _ => None,
        })
        .collect()
}

/// Line numbers of byte positions.
struct Lines(Vec<usize>);

impl Lines {
    fn of(source: &str) -> Self {
        Self(source.match_indices('\n').map(|(at, _)| at).collect())
    }

    fn at(&self, position: usize) -> usize {
        1 + self.0.partition_point(|&end| end < position)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_taken_apart() {
        let page = Page::read(
            "# Title\n\nSee $`E'`$ and `cmod::branch`, [there](other.md#part), [web](https://a.b).\n\n\
             ```math\nx = 1\n\\tag{A 1}\n```\n\n## In the code\n\n`rodwave`\n",
        );
        assert_eq!(page.headings[0].anchor, "title");
        assert_eq!(page.headings[1].anchor, "in-the-code");
        assert_eq!(page.links.len(), 1);
        assert_eq!(page.links[0].line, 3);
        assert_eq!(page.equations.len(), 2);
        assert_eq!(page.equations[0].tex, "E'");
        assert_eq!(page.equations[1].tex, "x = 1\n\\tag{A 1}\n");
        assert_eq!(page.code.len(), 2);
        assert_eq!(page.code[1].section, 2);
        assert!(page.faults.is_empty());
    }

    #[test]
    fn equal_headings_have_numbered_anchors() {
        let page = Page::read("## Errors\n\n## Errors\n\n## Poisson's ratio, K & M\n");
        let anchors: Vec<_> = page.headings.iter().map(|h| h.anchor.as_str()).collect();
        assert_eq!(anchors, ["errors", "errors-1", "poissons-ratio-k--m"]);
    }

    #[test]
    fn a_bar_in_a_table_and_a_lost_dollar_are_faults() {
        let page = Page::read("| a | b |\n|---|---|\n| $`|z|`$ | 1 |\n\nhalf `x`$ a formula\n");
        assert_eq!(page.faults.len(), 2, "{:?}", page.faults);
    }
}

//! Error messages about sheets, with file, line and column, field, the text found, the text
//! expected, and the nearest known name.

use std::fmt;
use std::path::Path;
use std::sync::Arc;

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};

use super::mistake::Mistake;

/// The mistakes in a sheet: the first mistake, and the others in the order of the text.
///
/// Displayed as text, the error is one line, `sheet.toml:12:9: specimen.lenght: ...`; as a
/// [`Diagnostic`] it shows an excerpt of the sheet for each mistake.
#[derive(Debug)]
pub struct SheetError {
    source: Arc<NamedSource<String>>,
    line: usize,
    column: usize,
    mistake: Mistake,
    others: Vec<Self>,
}

impl SheetError {
    /// Creates the error for `mistakes` in `text`.
    pub(super) fn of(path: &Path, text: &str, mistakes: Vec<Mistake>) -> Box<Self> {
        let name = path.display().to_string();
        let source = Arc::new(NamedSource::new(name, text.to_owned()));
        let of_one = |mut mistake: Mistake| {
            mistake.place = shown(text, mistake.place.start, mistake.place.end);
            let (line, column) = line_and_column(text, mistake.place.start);
            Self {
                source: Arc::clone(&source),
                line,
                column,
                mistake,
                others: Vec::new(),
            }
        };
        let mut mistakes = mistakes.into_iter();
        let first = mistakes.next();
        let first = first.unwrap_or_else(|| Mistake::new(0..0, "cannot be read"));
        Box::new(Self {
            others: mistakes.map(of_one).collect(),
            ..of_one(first)
        })
    }

    /// Returns the line of the mistake, from 1.
    #[must_use]
    pub fn line(&self) -> usize {
        self.line
    }

    /// Returns the column of the mistake, from 1, in characters.
    #[must_use]
    pub fn column(&self) -> usize {
        self.column
    }

    /// Returns the place of the mistake in the sheet, such as `specimen.length`; empty outside of
    /// all fields.
    #[must_use]
    pub fn field(&self) -> &str {
        &self.mistake.field
    }

    /// Returns the text found and the text expected, without the place.
    #[must_use]
    pub fn problem(&self) -> &str {
        &self.mistake.problem
    }

    /// Returns a hint, such as the nearest known name, if there is one.
    #[must_use]
    pub fn advice(&self) -> Option<&str> {
        self.mistake.advice.as_deref()
    }

    /// Returns the mistakes further down in the sheet.
    #[must_use]
    pub fn others(&self) -> &[Self] {
        &self.others
    }

    /// Returns field and problem in words, with the number of further mistakes.
    #[must_use]
    pub fn in_words(&self) -> String {
        let place = match self.field() {
            "" => String::new(),
            field => format!("{field}: "),
        };
        let more = match self.others.len() {
            0 => "",
            1 => " (and 1 more mistake)",
            more => &format!(" (and {more} more mistakes)"),
        };
        format!("{place}{}{more}", self.problem())
    }
}

impl fmt::Display for SheetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}:{}:{}: {}",
            self.source.name(),
            self.line,
            self.column,
            self.in_words()
        )
    }
}

impl std::error::Error for SheetError {}

impl Diagnostic for SheetError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        let advice = self.mistake.advice.as_ref()?;
        Some(Box::new(advice))
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&*self.source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = &self.mistake.place;
        let here = LabeledSpan::new(Some("here".to_owned()), place.start, place.len());
        Some(Box::new(std::iter::once(here)))
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        if self.others.is_empty() {
            return None;
        }
        let others = self.others.iter();
        Some(Box::new(others.map(|other| other as &dyn Diagnostic)))
    }
}

/// Returns the first line of a place, limited to the text.
fn shown(text: &str, start: usize, end: usize) -> std::ops::Range<usize> {
    let within = |mut at: usize| {
        at = at.min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1; // 0 is a boundary
        }
        at
    };
    let start = within(start);
    let end = within(end).max(start);
    let place = text.get(start..end).unwrap_or_default();
    let line = place.lines().next().unwrap_or_default();
    start..start + line.len()
}

fn line_and_column(text: &str, at: usize) -> (usize, usize) {
    let before = text.get(..at).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let line = before.get(line_start..).unwrap_or_default();
    (before.matches('\n').count() + 1, line.chars().count() + 1)
}

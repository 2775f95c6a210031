//! Error messages about sheets: file, line and column, field, text found and expected, nearest known name.

use std::fmt;
use std::path::Path;

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use ron::error::{Error, Position, SpannedError};

/// An error in a sheet.
///
/// Its text is one line, `sheet.ron:12:9: specimen.lenght: ...`; as a [`Diagnostic`] it is an excerpt of the sheet.
#[derive(Debug)]
pub struct SheetError {
    source: NamedSource<String>,
    line: usize,
    column: usize,
    start: usize,
    length: usize,
    field: String,
    problem: String,
    advice: Option<String>,
}

impl SheetError {
    /// The RON reader's error on `text`, at `field`.
    #[must_use]
    pub fn of(path: &Path, text: &str, field: &str, error: &SpannedError) -> Self {
        let (problem, advice) = in_words(&error.code);
        let start = offset(text, &error.span.start);
        let end = offset(text, &error.span.end).max(start);
        let (start, length) = narrowed(text, start, end, &error.code);
        let (line, column) = line_and_column(text, start);
        // serde writes the place of unnamed enum content as `?`
        let field = field.trim_matches(['.', '?']).replace(".?", "");
        Self {
            source: NamedSource::new(path.display().to_string(), text.to_owned()),
            line,
            column,
            start,
            length,
            field,
            problem,
            advice,
        }
    }

    /// Line of the mistake, from 1.
    #[must_use]
    pub fn line(&self) -> usize {
        self.line
    }

    /// Column of the mistake, from 1, in characters.
    #[must_use]
    pub fn column(&self) -> usize {
        self.column
    }

    /// Place of the mistake in the sheet, as `specimen.length`; empty outside of all fields.
    #[must_use]
    pub fn field(&self) -> &str {
        &self.field
    }

    /// What was found and what was expected, without the place.
    #[must_use]
    pub fn problem(&self) -> &str {
        &self.problem
    }

    /// What may help, as the nearest known name.
    #[must_use]
    pub fn advice(&self) -> Option<&str> {
        self.advice.as_deref()
    }
}

impl fmt::Display for SheetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}: ", self.source.name(), self.line, self.column)?;
        if !self.field.is_empty() {
            write!(f, "{}: ", self.field)?;
        }
        f.write_str(&self.problem)
    }
}

impl std::error::Error for SheetError {}

impl Diagnostic for SheetError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        let advice = self.advice.as_ref()?;
        Some(Box::new(advice))
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let here = LabeledSpan::new(Some("here".to_owned()), self.start, self.length);
        Some(Box::new(std::iter::once(here)))
    }
}

/// The text found, and a hint.
fn in_words(error: &Error) -> (String, Option<String>) {
    let nearest = |found: &str, expected: &[&str]| {
        let best = expected
            .iter()
            .map(|name| (strsim::damerau_levenshtein(found, name), name))
            .min()?;
        // a name with a third of its letters wrong is a different word
        (3 * best.0 <= found.chars().count().max(3)).then(|| format!("did you mean `{}`?", best.1))
    };
    match error {
        Error::NoSuchStructField {
            expected, found, ..
        } => (
            format!("there is no field `{found}`, only {}", quoted(expected)),
            nearest(found, expected),
        ),
        Error::NoSuchEnumVariant {
            expected, found, ..
        } => (
            format!("found `{found}`, expected one of {}", quoted(expected)),
            nearest(found, expected),
        ),
        Error::MissingStructField { field, .. } => (
            format!("the field `{field}` is missing"),
            Some(format!("add `{field}: ...,` inside these brackets")),
        ),
        Error::DuplicateStructField { field, .. } => {
            (format!("the field `{field}` stands twice"), None)
        }
        Error::InvalidValueForType { expected, found } => {
            (format!("found {found}, expected {expected}"), None)
        }
        Error::Message(text) => (text.clone(), None),
        Error::ExpectedString => (
            "expected a text in quotes".to_owned(),
            Some("quantities are texts with their unit, as \"800 mm\"".to_owned()),
        ),
        other => (lower_case(&other.to_string()), None),
    }
}

fn quoted(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    quoted.join(", ")
}

fn lower_case(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map(|first| first.to_lowercase().chain(letters).collect())
        .unwrap_or_default()
}

/// The byte offset of a RON position (line and column from 1, in characters) in the text.
fn offset(text: &str, position: &Position) -> usize {
    let line_start: usize = text
        .split_inclusive('\n')
        .take(position.line.saturating_sub(1))
        .map(str::len)
        .sum();
    let line = &text[line_start..];
    line_start
        + line
            .char_indices()
            .nth(position.col.saturating_sub(1))
            .map_or(line.len(), |(at, _)| at)
}

/// The relevant part of a span: the word or the quoted text at its end, or all of it for a missing field.
fn narrowed(text: &str, start: usize, end: usize, error: &Error) -> (usize, usize) {
    if let Error::NoSuchStructField { found, .. } | Error::NoSuchEnumVariant { found, .. } = error
        && let Some(at) = text[..end.min(text.len())].rfind(found.as_str())
    {
        return (at, found.len());
    }
    let span = &text[start..end];
    let trimmed = span.trim_start_matches([' ', '\n', '\t', '\r', ',']);
    let start = end - trimmed.len();
    (start, trimmed.trim_end().len())
}

fn line_and_column(text: &str, at: usize) -> (usize, usize) {
    let before = &text[..at];
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (
        before.matches('\n').count() + 1,
        before[line_start..].chars().count() + 1,
    )
}

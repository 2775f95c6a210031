//! A mistake in a sheet, in words.

use std::ops::Range;

/// Bytes of the text.
pub(super) type Place = Range<usize>;

/// A mistake in a sheet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Mistake {
    /// Its place in the text.
    pub(super) place: Place,
    /// Its field, as `specimen.length`; empty outside of all fields.
    pub(super) field: String,
    /// The text found and the text expected.
    pub(super) problem: String,
    /// A hint, such as the nearest known name.
    pub(super) advice: Option<String>,
}

impl Mistake {
    /// A mistake outside of all fields.
    pub(super) fn new(place: Place, problem: impl Into<String>) -> Self {
        Self {
            place,
            field: String::new(),
            problem: problem.into(),
            advice: None,
        }
    }
}

/// The name of `expected` nearest to `found`; `None` if a third of its letters are wrong, for it is
/// a different word then.
pub(super) fn nearest<'a, N: AsRef<str>>(found: &str, expected: &'a [N]) -> Option<&'a N> {
    let best = expected
        .iter()
        .map(|name| (strsim::damerau_levenshtein(found, name.as_ref()), name))
        .min_by_key(|(distance, _)| *distance)?;
    (3 * best.0 <= found.chars().count().max(3)).then_some(best.1)
}

/// `did you mean ...?`
pub(super) fn did_you_mean(name: &str) -> String {
    format!("did you mean `{name}`?")
}

/// The names with commas between them.
pub(super) fn quoted<N: AsRef<str>>(names: &[N]) -> String {
    let quoted: Vec<String> = names
        .iter()
        .map(|name| format!("`{}`", name.as_ref()))
        .collect();
    quoted.join(", ")
}

/// `text` with a small first letter, unless it begins with an abbreviation.
pub(super) fn lower_case(text: &str) -> String {
    let mut letters = text.chars();
    let Some(first) = letters.next() else {
        return String::new();
    };
    if letters.clone().next().is_some_and(char::is_uppercase) {
        return text.to_owned();
    }
    first.to_lowercase().chain(letters).collect()
}

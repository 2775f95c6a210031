//! A mistake in a sheet, in words.

use std::ops::Range;

/// Range of bytes in the text.
pub(super) type Place = Range<usize>;

/// A mistake in a sheet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Mistake {
    /// Place in the text.
    pub(super) place: Place,
    /// Field of the mistake, such as `specimen.length`; empty outside of all fields.
    pub(super) field: String,
    /// The text found and the text expected.
    pub(super) problem: String,
    /// A hint, such as the nearest known name.
    pub(super) advice: Option<String>,
}

impl Mistake {
    /// Creates a mistake outside of all fields.
    pub(super) fn new(place: Place, problem: impl Into<String>) -> Self {
        Self {
            place,
            field: String::new(),
            problem: problem.into(),
            advice: None,
        }
    }
}

/// Minimum number of letters by which a name is recognised from its beginning.
const BEGINNING: usize = 3;

/// Returns the only name of `expected` that begins with `found`, or otherwise the nearest name.
/// Returns `None` if more than a third of the letters of `found` are wrong, because it is then
/// probably a different word.
pub(crate) fn nearest<'a, N: AsRef<str>>(found: &str, expected: &'a [N]) -> Option<&'a N> {
    let letters = found.chars().count();
    let mut begun = expected
        .iter()
        .filter(|name| letters >= BEGINNING && name.as_ref().starts_with(found));
    if let (Some(only), None) = (begun.next(), begun.next()) {
        return Some(only);
    }
    let best = expected
        .iter()
        .map(|name| (strsim::damerau_levenshtein(found, name.as_ref()), name))
        .min_by_key(|(distance, _)| *distance)?;
    (3 * best.0 <= letters.max(3)).then_some(best.1)
}

pub(super) fn did_you_mean(name: &str) -> String {
    format!("did you mean `{name}`?")
}

/// Returns the names in backquotes, separated by commas.
pub(crate) fn quoted(names: impl IntoIterator<Item: AsRef<str>>) -> String {
    let names = names.into_iter();
    let quoted: Vec<String> = names.map(|name| format!("`{}`", name.as_ref())).collect();
    quoted.join(", ")
}

/// Returns `text` with a lower-case first letter, unless it begins with an abbreviation.
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

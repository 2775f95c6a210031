//! Words of a citation: `eqs.`, `Table`, `7`, `A8-A10`.

use crate::traceability::numbered::Kind;

/// Returns the kind that a word names, and true if the word is a plural.
pub(super) fn kind(word: &str) -> Option<(Kind, bool)> {
    Some(match word.to_lowercase().as_str() {
        "eq." | "equation" => (Kind::Equation, false),
        "eqs." | "equations" => (Kind::Equation, true),
        "table" => (Kind::Table, false),
        "tables" => (Kind::Table, true),
        "figure" | "fig." => (Kind::Figure, false),
        "figures" | "figs." => (Kind::Figure, true),
        _ => return None,
    })
}

/// Reads `7`, `(7)`, `A16,` or `3-4).`: returns one number or the ends of a range, and the
/// remainder of the word.
pub(super) fn number_or_range(word: &str) -> Option<(&str, Option<&str>, &str)> {
    let word = word.trim_start_matches('(');
    let (first, after) = number(word)?;
    let range = after.strip_prefix('-').or_else(|| after.strip_prefix('–'));
    match range.and_then(number) {
        Some((last, after)) => Some((first, Some(last), after)),
        None => Some((first, None, after)),
    }
}

/// Returns all numbers of a range, or only the first and the last if the numbers between them
/// cannot be counted.
pub(super) fn between(first: &str, last: Option<&str>) -> Vec<String> {
    let Some(last) = last else {
        return vec![first.to_owned()];
    };
    let counted = |number: &str| -> Option<(String, u32)> {
        let before = number.trim_end_matches(|c: char| c.is_ascii_digit());
        let count = number.get(before.len()..)?.parse().ok()?;
        Some((before.to_owned(), count))
    };
    match (counted(first), counted(last)) {
        (Some((before, from)), Some((same, to))) if before == same && from < to && to < 100 => {
            (from..=to)
                .map(|count| format!("{before}{count}"))
                .collect()
        }
        _ => vec![first.to_owned(), last.to_owned()],
    }
}

/// Returns the number at the beginning of `word`, without the letter of a panel, and the remainder.
fn number(word: &str) -> Option<(&str, &str)> {
    let digits = |from: usize| {
        word.get(from..).map_or(0, |rest| {
            rest.chars().take_while(char::is_ascii_digit).count()
        })
    };
    let appendix = usize::from(word.starts_with('A'));
    let whole = digits(appendix);
    if whole == 0 {
        return None;
    }
    let mut end = appendix + whole;
    if word.get(end..)?.starts_with('.') {
        let decimals = digits(end + 1);
        if decimals > 0 {
            end += 1 + decimals;
        }
    }
    let (number, after) = word.split_at_checked(end)?;
    let panel = after
        .strip_prefix(|c: char| c.is_ascii_lowercase())
        .unwrap_or(after);
    (!panel.starts_with(char::is_alphanumeric)).then_some((number, panel))
}

//! Texts in place of the wildcards of a pattern.

use std::path::{Component, Path};
use std::str::Chars;

/// Returns the texts of `path` in place of the wildcards of `pattern`, which matches the path in
/// `folder`; wildcards next to each other have one text. Pattern and texts determine the path, so
/// that two files of one pattern have different texts.
pub(super) fn texts(pattern: &str, path: &Path, folder: &Path) -> Vec<String> {
    let pattern = Path::new(pattern);
    let within = match path.strip_prefix(folder) {
        Ok(within) if pattern.is_relative() => within,
        _ => path,
    };
    let path = with_slashes(within);
    // if the path lacks a part of the pattern, the whole path is the text, which no other file has
    texts_between(&with_slashes(pattern), &path).unwrap_or_else(|| vec![path])
}

/// Returns the path with `/` between its parts, and without `.` as a part.
fn with_slashes(path: &Path) -> String {
    let parts = path.components().filter(|part| *part != Component::CurDir);
    let parts: Vec<_> = parts
        .map(|part| part.as_os_str().to_string_lossy())
        .collect();
    parts.join("/")
}

/// Returns the texts of [`texts`], if the path has all parts of the pattern between its wildcards.
fn texts_between(pattern: &str, path: &str) -> Option<Vec<String>> {
    let between = between_wildcards(pattern);
    let (first, others) = between.split_first()?;
    let mut rest = path.strip_prefix(first.as_str())?;
    let mut texts = Vec::with_capacity(others.len());
    if let Some((last, others)) = others.split_last() {
        for literal in others {
            let (text, after) = rest.split_once(literal.as_str())?;
            texts.push(text.to_owned());
            rest = after;
        }
        texts.push(rest.strip_suffix(last.as_str())?.to_owned());
    }
    Some(texts)
}

/// Returns the parts of a pattern before, between and after its wildcards `*`, `?`, `[..]` and
/// `**/`.
fn between_wildcards(pattern: &str) -> Vec<String> {
    let pattern = pattern.replace("**/", "*");
    let mut chars = pattern.chars();
    let mut parts = Vec::new();
    let mut part = String::new();
    let mut follows_wildcard = false;
    while let Some(c) = chars.next() {
        let is_wildcard = matches!(c, '*' | '?' | '[');
        if c == '[' {
            skip_class(&mut chars);
        }
        match (is_wildcard, follows_wildcard) {
            (false, _) => part.push(c),
            (true, false) => parts.push(std::mem::take(&mut part)),
            (true, true) => {}
        }
        follows_wildcard = is_wildcard;
    }
    parts.push(part);
    parts
}

/// Skips a class of characters after its `[`. The first character, after `!` if there is one,
/// belongs to the class even if it is `]`.
fn skip_class(chars: &mut Chars<'_>) {
    if chars.next() == Some('!') {
        chars.next();
    }
    while chars.next().is_some_and(|c| c != ']') {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wildcards_have_the_texts_between_the_literal_parts() {
        for (pattern, path, texts) in [
            ("force-*.csv", "force-10.csv", &["10"][..]),
            ("force-*.csv", "force-.csv", &[""]),
            ("*-b.csv", "1-b-b.csv", &["1-b"]),
            ("day*/f-?.csv", "day12/f-3.csv", &["12", "3"]),
            ("tek??*CH1.csv", "tek0001CH1.csv", &["0001"]),
            ("f-[!]0][1-9].csv", "f-17.csv", &["17"]),
            ("f-[]0]-*.csv", "f-]-b-c.csv", &["]", "b-c"]),
            ("**/f-*.csv", "f-1.csv", &["", "1"]),
            ("**/f-*.csv", "a/b/f-1.csv", &["a/b/", "1"]),
            ("*", "hit", &["hit"]),
            ("hit.csv", "hit.csv", &[]),
        ] {
            let found = texts_between(pattern, path).unwrap();
            assert_eq!(found, texts, "{pattern}");
            assert!(glob::Pattern::new(pattern).unwrap().matches(path));
        }
        assert_eq!(texts_between("force-*.csv", "free-1.csv"), None);
    }
}

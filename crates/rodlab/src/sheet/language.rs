//! Languages of sheets, recognised by their content.

/// Language of a sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// TOML, in which choices have names such as `two_point`.
    Toml,
    /// RON, in which choices have names such as `TwoPoint`.
    Ron,
    /// JSON, with the names and the structure of TOML; usually written by programs.
    Json,
}

impl Language {
    /// Returns the language of `text`, recognised by its first characters outside comments; `None`
    /// if the text begins like none of the languages.
    ///
    /// JSON begins with a brace, TOML with a quoted key, a key and `=` or `.`, or a header in
    /// brackets, RON with `#!`, a parenthesis, or a name and a bracket.
    #[must_use]
    pub fn of(text: &str) -> Option<Self> {
        let start = without_comments(text);
        if start.starts_with("#!") {
            return Some(Self::Ron); // an attribute, such as `#![enable(implicit_some)]`
        }
        match start.chars().next()? {
            '{' => return Some(Self::Json),
            '[' | '"' | '\'' => return Some(Self::Toml),
            '(' => return Some(Self::Ron),
            _ => {}
        }
        if !start.starts_with(|c: char| c.is_alphabetic() || c == '_') {
            return None;
        }
        let behind =
            start.trim_start_matches(|c: char| c.is_alphanumeric() || matches!(c, '_' | '-'));
        match without_comments(behind).chars().next()? {
            '=' | '.' => Some(Self::Toml),
            '(' | '{' => Some(Self::Ron),
            _ => None,
        }
    }

    /// Returns the extension of files in this language.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Toml => "toml",
            Self::Ron => "ron",
            Self::Json => "json",
        }
    }

    /// Returns the name of the choice `variant`, such as `TwoPoint`, in this language.
    pub(crate) fn name_of(self, variant: &str) -> String {
        match self {
            Self::Ron => variant.to_owned(),
            Self::Toml | Self::Json => snake_case(variant),
        }
    }
}

/// Returns `text` without leading white space and leading comments of TOML or RON.
fn without_comments(text: &str) -> &str {
    let mut rest = text.trim_start();
    loop {
        let behind = if rest.starts_with("//") || (rest.starts_with('#') && !rest.starts_with("#!"))
        {
            rest.split_once('\n').map(|(_, behind)| behind)
        } else if rest.starts_with("/*") {
            rest.split_once("*/").map(|(_, behind)| behind)
        } else {
            return rest;
        };
        rest = behind.unwrap_or_default().trim_start();
    }
}

/// Converts a name such as `TwoPoint` to `two_point`, or `H1` to `h1`.
pub(crate) fn snake_case(name: &str) -> String {
    let mut words = String::with_capacity(name.len() + 4);
    for letter in name.chars() {
        if letter.is_uppercase() && !words.is_empty() {
            words.push('_');
        }
        words.extend(letter.to_lowercase());
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_language_is_told_by_the_first_words() {
        for (text, expected) in [
            ("job = \"modulus\"\n", Some(Language::Toml)),
            ("# a rod\n\n  job='frf'", Some(Language::Toml)),
            ("[specimen]\nlength = \"1 m\"", Some(Language::Toml)),
            ("method.two_point.free_end = \"a\"", Some(Language::Toml)),
            ("\"job\" = \"frf\"", Some(Language::Toml)),
            (
                "// a rod\n/* of\nsteel */ Modulus(title: \"\")",
                Some(Language::Ron),
            ),
            ("Modulus // a rod\n(title: \"\")", Some(Language::Ron)),
            ("#![enable(implicit_some)]\nFrf()", Some(Language::Ron)),
            ("(template: \"a\")", Some(Language::Ron)),
            ("\n {\"job\": \"frf\"}", Some(Language::Json)),
            ("", None),
            ("# nothing", None),
            ("Dear all", None),
            ("title: a rod", None),
            ("1.5, 2.5", None),
        ] {
            assert_eq!(Language::of(text), expected, "{text}");
        }
    }

    #[test]
    fn names_of_choices_are_in_small_letters() {
        for (name, expected) in [
            ("TwoPoint", "two_point"),
            ("H1", "h1"),
            ("Hv", "hv"),
            ("LsDyna", "ls_dyna"),
            ("GeneralisedMaxwell", "generalised_maxwell"),
        ] {
            assert_eq!(snake_case(name), expected);
        }
    }
}

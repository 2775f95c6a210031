//! Error of the deserializer, which becomes a mistake with its place.

use std::fmt;

use serde::de::{self, Expected, Unexpected};

use super::super::language::Language;
use super::super::mistake::{Mistake, Place};
use super::super::tree::{Node, Value};
use super::reading::Reading;

/// Error of a reading. Its place is added by the enclosing values.
#[derive(Debug, thiserror::Error)]
#[error("{what}")]
pub(super) struct Fault {
    what: What,
    place: Option<Place>,
    field: String,
}

#[derive(Debug, thiserror::Error)]
enum What {
    /// A required field is missing.
    #[error("the field `{0}` is missing")]
    Missing(&'static str),
    #[error("{problem}")]
    Other {
        problem: String,
        advice: Option<String>,
    },
}

impl Fault {
    pub(super) fn new(problem: impl Into<String>, advice: Option<String>) -> Self {
        Self {
            what: What::Other {
                problem: problem.into(),
                advice,
            },
            place: None,
            field: String::new(),
        }
    }

    /// Creates the fault that `found` is not the expected value.
    pub(super) fn found(found: &Node, expected: &str) -> Self {
        let problem = format!("found {}, expected {expected}", found.in_words());
        Self::new(problem, None)
    }

    /// Gives the fault the place of `reading`, unless it has one.
    pub(super) fn at(mut self, reading: &Reading<'_>) -> Self {
        if self.place.is_none() {
            self.place = Some(match self.what {
                What::Missing(_) => end_of(reading),
                What::Other { .. } => reading.node.place.clone(),
            });
            self.field = reading.at.to_string();
        }
        self
    }

    /// Gives the fault the place `place`, in the field of `reading`.
    pub(super) fn at_place(mut self, place: &Place, reading: &Reading<'_>) -> Self {
        self.place = Some(place.clone());
        self.field = reading.at.to_string();
        self
    }

    pub(super) fn is_missing(&self) -> bool {
        matches!(self.what, What::Missing(_))
    }

    /// Returns the field that contains the mistake.
    pub(super) fn field(&self) -> &str {
        &self.field
    }

    /// Returns the field that must be stated or corrected to remove the mistake.
    pub(super) fn spot(&self) -> String {
        match self.what {
            What::Missing(name) if self.field.is_empty() => name.to_owned(),
            What::Missing(name) => format!("{}.{name}", self.field),
            What::Other { .. } => self.field.clone(),
        }
    }

    pub(super) fn into_mistake(self, language: Language) -> Mistake {
        let (problem, advice) = match self.what {
            What::Missing(name) => {
                let advice = match language {
                    Language::Ron => format!("add `{name}: ...,` inside these brackets"),
                    Language::Toml => format!("add a line `{name} = ...`"),
                    Language::Json => format!("add `\"{name}\": ...`"),
                };
                (format!("the field `{name}` is missing"), Some(advice))
            }
            What::Other { problem, advice } => (problem, advice),
        };
        Mistake {
            place: self.place.unwrap_or(0..0),
            field: self.field,
            problem,
            advice,
        }
    }
}

/// Returns the place at which a missing field must be added: in RON and JSON the closing bracket,
/// in TOML the header of the table or, for the root, the beginning of the text.
fn end_of(reading: &Reading<'_>) -> Place {
    let place = &reading.node.place;
    match (&reading.node.value, reading.pass.language) {
        (Value::Table(_), Language::Toml) if reading.at.to_string().is_empty() => 0..0,
        (Value::Table(_) | Value::Choice(_), Language::Ron | Language::Json) => {
            place.end.saturating_sub(1)..place.end
        }
        _ => place.clone(),
    }
}

impl de::Error for Fault {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self::new(message.to_string(), None)
    }

    fn missing_field(field: &'static str) -> Self {
        Self {
            what: What::Missing(field),
            place: None,
            field: String::new(),
        }
    }

    fn invalid_type(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        let (found, expected) = (words_of(found), in_words(&expected.to_string()));
        Self::new(format!("found {found}, expected {expected}"), None)
    }

    fn invalid_value(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::invalid_type(found, expected)
    }
}

fn words_of(found: Unexpected<'_>) -> String {
    match found {
        Unexpected::Bool(value) => format!("`{value}`"),
        Unexpected::Unsigned(number) => format!("the number `{number}`"),
        Unexpected::Signed(number) => format!("the number `{number}`"),
        Unexpected::Float(number) => format!("the number `{number}`"),
        Unexpected::Str(text) => format!("the text {text:?}"),
        Unexpected::Unit | Unexpected::Option => "nothing".to_owned(),
        Unexpected::Seq => "a list".to_owned(),
        Unexpected::Map => "fields".to_owned(),
        other => other.to_string(),
    }
}

/// Describes in words the types that a sheet can contain.
fn in_words(expected: &str) -> String {
    match expected {
        "usize" | "u8" | "u16" | "u32" | "u64" => "a whole number of 0 or more",
        "isize" | "i8" | "i16" | "i32" | "i64" => "a whole number",
        "f32" | "f64" => "a number",
        "a string" => "text in quotes",
        "a boolean" => "`true` or `false`",
        other => other,
    }
    .to_owned()
}

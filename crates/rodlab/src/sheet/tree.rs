//! Sheets in any language, as values with their places in the text.

mod json;
mod ron;
mod toml;

use super::language::Language;
use super::mistake::{Mistake, Place, quoted};

/// A value and its place.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub(super) value: Value,
    pub(super) place: Place,
}

/// A value of a sheet.
#[derive(Debug, Clone)]
pub(super) enum Value {
    /// `None` in RON, or `null` in JSON.
    Nothing,
    Bool(bool),
    Integer(i64),
    /// A whole number beyond the range of [`Value::Integer`].
    Unsigned(u64),
    Float(f64),
    Text(String),
    List(Vec<Node>),
    /// Names with their values: the fields of a table, or a map.
    Table(Vec<Entry>),
    /// A named choice with its settings, such as `TwoPoint(..)` in RON. In every language the whole
    /// sheet is a choice, with the job as its name.
    Choice(Choice),
}

/// A value with its name.
#[derive(Debug, Clone)]
pub(super) struct Entry {
    pub(super) name: String,
    pub(super) name_place: Place,
    pub(super) node: Node,
}

/// A named choice.
#[derive(Debug, Clone)]
pub(super) struct Choice {
    pub(super) name: String,
    pub(super) name_place: Place,
    pub(super) content: Option<Box<Node>>,
}

/// Field that names the job of a sheet in TOML and JSON.
pub(super) const JOB: &str = "job";

/// Reads `text` in its language.
///
/// # Errors
///
/// All syntax errors, or a single mistake if the text is not in any of the languages.
pub(super) fn of(text: &str) -> Result<(Language, Node), Vec<Mistake>> {
    let Some(language) = Language::of(text) else {
        let start = text.len() - text.trim_start().len();
        let first = text
            .get(start..)
            .and_then(|rest| rest.split_whitespace().next());
        let end = start + first.map_or(0, str::len);
        return Err(vec![Mistake::new(
            start..end,
            "not the beginning of a test sheet, which in TOML is a line such as `job = \"modulus\"`, in RON a name such as `Modulus(`",
        )]);
    };
    let node = match language {
        Language::Ron => ron::read(text).map_err(|mistake| vec![mistake])?,
        Language::Toml => headed(toml::read(text)?),
        Language::Json => headed(json::read(text).map_err(|mistake| vec![mistake])?),
    };
    Ok((language, node))
}

/// Converts `root` to the choice of the job that its field `job` names, with the other fields as
/// settings. A root without this field is returned unchanged.
fn headed(mut root: Node) -> Node {
    let Value::Table(entries) = &mut root.value else {
        return root;
    };
    let is_job = |entry: &Entry| entry.name == JOB && matches!(entry.node.value, Value::Text(_));
    let Some(at) = entries.iter().position(is_job) else {
        return root;
    };
    let job = entries.remove(at);
    let Value::Text(name) = job.node.value else {
        return root;
    };
    let place = root.place.clone();
    Node {
        value: Value::Choice(Choice {
            name,
            name_place: job.node.place,
            content: Some(Box::new(root)),
        }),
        place,
    }
}

impl Node {
    /// Returns the text of a value without parts, as written; `None` for a value with parts.
    pub(super) fn as_written(&self) -> Option<String> {
        match &self.value {
            Value::Nothing => Some("none".to_owned()),
            Value::Bool(value) => Some(value.to_string()),
            Value::Integer(number) => Some(number.to_string()),
            Value::Unsigned(number) => Some(number.to_string()),
            Value::Float(number) => Some(number.to_string()),
            Value::Text(text) => Some(text.clone()),
            Value::Choice(choice) if choice.content.is_none() => Some(choice.name.clone()),
            Value::List(_) | Value::Table(_) | Value::Choice(_) => None,
        }
    }

    /// Describes the value in the words that follow "found".
    pub(super) fn in_words(&self) -> String {
        match &self.value {
            Value::Nothing => "nothing".to_owned(),
            Value::Bool(value) => format!("`{value}`"),
            Value::Integer(number) => format!("the number `{number}`"),
            Value::Unsigned(number) => format!("the number `{number}`"),
            Value::Float(number) => format!("the number `{number}`"),
            Value::Text(text) => format!("the text {text:?}"),
            Value::List(_) => "a list".to_owned(),
            Value::Table(entries) if entries.is_empty() => "no fields".to_owned(),
            Value::Table(entries) => {
                let names = quoted(entries.iter().take(4).map(|entry| &entry.name));
                let more = if entries.len() > 4 { ", .." } else { "" };
                format!("the fields {names}{more}")
            }
            Value::Choice(choice) => format!("`{}`", choice.name),
        }
    }
}

//! Sheets in RON, as values with their places.
//!
//! The reader of the crate `ron` finds where values begin and end. It returns slices of the text,
//! from which the places are computed.

use ron::Options;
use ron::error::SpannedError;
use ron::extensions::Extensions;
use ron::value::RawValue;
use serde::Deserialize;
use serde::de::{Deserializer as _, MapAccess, SeqAccess, Visitor};

use super::{Choice, Entry, Node, Place, Value};
use crate::sheet::mistake::{Mistake, lower_case};

pub(super) fn read(text: &str) -> Result<Node, Mistake> {
    let text = Text(text);
    let mut reader = ron::Deserializer::from_str_with_options(text.0, &options())
        .map_err(|error| text.mistake(text.0, &error))?;
    let root = <&RawValue>::deserialize(&mut reader)
        .map_err(|error| text.mistake(text.0, &reader.span_error(error)))?;
    reader
        .end()
        .map_err(|error| text.mistake(text.0, &reader.span_error(error)))?;
    text.node(root.trim().get_ron())
}

/// Returns the options of the reader, with which optional fields need no `Some(..)`.
fn options() -> Options {
    Options::default().with_default_extension(Extensions::IMPLICIT_SOME)
}

/// The whole text. All pieces are slices of it.
#[derive(Clone, Copy)]
struct Text<'a>(&'a str);

/// Contents of a pair of brackets.
enum Parts<'a> {
    /// Fields or entries of a map, with their names as written.
    Named(Vec<(&'a str, &'a RawValue)>),
    Unnamed(Vec<&'a RawValue>),
}

impl<'a> Text<'a> {
    fn place(self, piece: &str) -> Place {
        let start = piece.as_ptr().addr().saturating_sub(self.0.as_ptr().addr());
        start..start + piece.len()
    }

    fn mistake(self, piece: &str, error: &SpannedError) -> Mistake {
        let base = self.place(piece).start;
        let start = offset(piece, &error.span.start);
        let end = offset(piece, &error.span.end).max(start);
        let found = piece.get(start..end).unwrap_or_default();
        let skipped = found.len() - found.trim_start_matches([' ', '\n', '\t', '\r', ',']).len();
        let length = found.trim_end().len().max(skipped);
        Mistake::new(
            base + start + skipped..base + start + length,
            lower_case(&error.code.to_string()),
        )
    }

    /// Reads the value that fills the slice `piece`.
    fn node(self, piece: &'a str) -> Result<Node, Mistake> {
        let value = match piece.chars().next() {
            Some('(' | '{') => self.bracket(piece)?,
            Some('[') => {
                let values: Vec<&RawValue> = self.of(piece)?;
                let nodes = values
                    .into_iter()
                    .map(|value| self.node(value.trim().get_ron()));
                Value::List(nodes.collect::<Result<_, _>>()?)
            }
            Some('"') => Value::Text(self.of(piece)?),
            Some('\'') => Value::Text(self.of::<char>(piece)?.to_string()),
            Some('0'..='9' | '+' | '-' | '.') => self.number(piece)?,
            _ => self.word(piece)?,
        };
        Ok(Node {
            value,
            place: self.place(piece),
        })
    }

    fn of<T: Deserialize<'a>>(self, piece: &'a str) -> Result<T, Mistake> {
        options()
            .from_str(piece)
            .map_err(|error| self.mistake(piece, &error))
    }

    fn number(self, piece: &'a str) -> Result<Value, Mistake> {
        self.of(piece)
            .map(Value::Integer)
            .or_else(|_| self.of(piece).map(Value::Unsigned))
            .or_else(|_| self.of(piece).map(Value::Float))
    }

    /// Reads a value that begins with a letter: a keyword, a raw string, or a choice.
    fn word(self, piece: &'a str) -> Result<Value, Mistake> {
        let is_raw_name = piece
            .strip_prefix("r#")
            .is_some_and(|rest| !rest.starts_with(['"', '#']));
        if !is_raw_name && (piece.starts_with("r\"") || piece.starts_with("r#")) {
            return self.of(piece).map(Value::Text);
        }
        let is_of_name = |c: char| c.is_alphanumeric() || matches!(c, '_' | '#');
        let behind = piece.trim_start_matches(is_of_name);
        let name = piece.strip_suffix(behind).unwrap_or(piece);
        match name {
            "true" => return Ok(Value::Bool(true)),
            "false" => return Ok(Value::Bool(false)),
            "None" => return Ok(Value::Nothing),
            "inf" | "NaN" | "b" => return self.of(piece).map(Value::Float),
            _ => {}
        }
        let content = if behind.trim().is_empty() {
            None
        } else {
            let content =
                RawValue::from_ron(behind).map_err(|error| self.mistake(behind, &error))?;
            let content = content.trim().get_ron();
            Some(Node {
                value: self.bracket(content)?,
                place: self.place(content),
            })
        };
        let content = content.map(single);
        if let ("Some", Some(content)) = (name, content.as_ref()) {
            return Ok(content.value.clone());
        }
        Ok(Value::Choice(Choice {
            name: name.strip_prefix("r#").unwrap_or(name).to_owned(),
            name_place: self.place(name),
            content: content.map(Box::new),
        }))
    }

    /// Reads fields, a tuple or a map in brackets.
    fn bracket(self, piece: &'a str) -> Result<Value, Mistake> {
        let mut reader = ron::Deserializer::from_str_with_options(piece, &options())
            .map_err(|error| self.mistake(piece, &error))?;
        let parts = if piece.starts_with('{') {
            reader.deserialize_map(PartsOf { are_fields: false })
        } else {
            reader.deserialize_any(PartsOf { are_fields: true })
        };
        let parts = parts.map_err(|error| self.mistake(piece, &reader.span_error(error)))?;
        match parts {
            Parts::Named(parts) => {
                let entries = parts.into_iter().map(|(name, value)| {
                    Ok(Entry {
                        name: self.name(name)?,
                        name_place: self.place(name),
                        node: self.node(value.trim().get_ron())?,
                    })
                });
                Ok(Value::Table(entries.collect::<Result<_, _>>()?))
            }
            // `()` has no fields
            Parts::Unnamed(parts) if parts.is_empty() => Ok(Value::Table(Vec::new())),
            Parts::Unnamed(parts) => {
                let nodes = parts
                    .into_iter()
                    .map(|part| self.node(part.trim().get_ron()));
                Ok(Value::List(nodes.collect::<Result<_, _>>()?))
            }
        }
    }

    /// Reads a name; the names in a map may be in quotes.
    fn name(self, written: &'a str) -> Result<String, Mistake> {
        if written.starts_with(['"', 'r']) && written.ends_with(['"', '#']) {
            self.of(written)
        } else {
            Ok(written.to_owned())
        }
    }
}

/// Returns the content of a choice: for `Mass("1 kg")` the text itself, for
/// `Window("1 ms", "2 ms")` a list.
fn single(content: Node) -> Node {
    match content.value {
        Value::List(mut nodes) if nodes.len() == 1 => nodes.pop().unwrap_or(Node {
            value: Value::Nothing,
            place: content.place,
        }),
        value => Node { value, ..content },
    }
}

/// Visitor that separates the contents of a pair of brackets.
struct PartsOf {
    /// True if the names are field names, which have no quotes.
    are_fields: bool,
}

impl<'de> Visitor<'de> for PartsOf {
    type Value = Parts<'de>;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("fields, values or a map in brackets")
    }

    fn visit_unit<E>(self) -> Result<Parts<'de>, E> {
        Ok(Parts::Unnamed(Vec::new()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut values: A) -> Result<Parts<'de>, A::Error> {
        let mut parts = Vec::new();
        while let Some(value) = values.next_element()? {
            parts.push(value);
        }
        Ok(Parts::Unnamed(parts))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Parts<'de>, A::Error> {
        let mut parts = Vec::new();
        if self.are_fields {
            while let Some(entry) = entries.next_entry::<&str, &RawValue>()? {
                parts.push(entry);
            }
        } else {
            while let Some((name, value)) = entries.next_entry::<&RawValue, &RawValue>()? {
                parts.push((name.trim().get_ron(), value));
            }
        }
        Ok(Parts::Named(parts))
    }
}

/// Returns the byte offset in the text of a RON position (line and column from 1, in characters).
fn offset(text: &str, position: &ron::error::Position) -> usize {
    let line_start: usize = text
        .split_inclusive('\n')
        .take(position.line.saturating_sub(1))
        .map(str::len)
        .sum();
    let line = text.get(line_start..).unwrap_or_default();
    line_start
        + line
            .char_indices()
            .nth(position.col.saturating_sub(1))
            .map_or(line.len(), |(at, _)| at)
}

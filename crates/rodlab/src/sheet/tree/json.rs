//! Sheets in JSON, as values with their places.

use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;

use super::{Entry, Node, Place, Value};
use crate::sheet::mistake::{Mistake, lower_case};

pub(super) fn read(text: &str) -> Result<Node, Mistake> {
    let root: &RawValue = serde_json::from_str(text).map_err(|error| mistake(text, &error))?;
    node(text, root.get())
}

/// Returns the value of `piece`, a slice of `text`.
fn node(text: &str, piece: &str) -> Result<Node, Mistake> {
    let refused =
        |error: serde_json::Error| Mistake::new(place(text, piece), lower_case(&error.to_string()));
    let value = match piece.chars().next() {
        Some('{') => {
            let Fields(fields) = serde_json::from_str(piece).map_err(refused)?;
            let entries = fields.into_iter().map(|(name, value)| {
                let node = node(text, value.get())?;
                Ok(Entry {
                    // the JSON reader returns only the places of values, not those of names
                    name_place: node.place.clone(),
                    name,
                    node,
                })
            });
            Value::Table(entries.collect::<Result<_, _>>()?)
        }
        Some('[') => {
            let values: Vec<&RawValue> = serde_json::from_str(piece).map_err(refused)?;
            let nodes = values.into_iter().map(|value| node(text, value.get()));
            Value::List(nodes.collect::<Result<_, _>>()?)
        }
        Some('"') => Value::Text(serde_json::from_str(piece).map_err(refused)?),
        Some('t' | 'f') => Value::Bool(serde_json::from_str(piece).map_err(refused)?),
        Some('n') => Value::Nothing,
        _ => serde_json::from_str(piece)
            .map(Value::Integer)
            .or_else(|_| serde_json::from_str(piece).map(Value::Unsigned))
            .or_else(|_| serde_json::from_str(piece).map(Value::Float))
            .map_err(refused)?,
    };
    Ok(Node {
        value,
        place: place(text, piece),
    })
}

/// Fields of an object in their order, including repeated fields.
struct Fields<'a>(Vec<(String, &'a RawValue)>);

impl<'de: 'a, 'a> Deserialize<'de> for Fields<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct All;

        impl<'de> Visitor<'de> for All {
            type Value = Fields<'de>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Fields<'de>, A::Error> {
                let mut fields = Vec::new();
                while let Some(entry) = entries.next_entry()? {
                    fields.push(entry);
                }
                Ok(Fields(fields))
            }
        }

        deserializer.deserialize_map(All)
    }
}

fn place(text: &str, piece: &str) -> Place {
    let start = piece.as_ptr().addr().saturating_sub(text.as_ptr().addr());
    start..start + piece.len()
}

/// Returns the mistake at the line and column of `error`; the column counts bytes.
fn mistake(text: &str, error: &serde_json::Error) -> Mistake {
    let lines = text.split_inclusive('\n');
    let before: usize = lines
        .take(error.line().saturating_sub(1))
        .map(str::len)
        .sum();
    let at = (before + error.column().saturating_sub(1)).min(text.len());
    let words = error.to_string();
    let place = format!(" at line {} column {}", error.line(), error.column());
    Mistake::new(
        at..at,
        lower_case(words.strip_suffix(&place).unwrap_or(&words)),
    )
}

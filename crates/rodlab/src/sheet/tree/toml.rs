//! Sheets in TOML, as values with their places.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::{Entry, Node, Place, Value};
use crate::sheet::mistake::Mistake;

pub(super) fn read(text: &str) -> Result<Node, Vec<Mistake>> {
    let (table, errors) = DeTable::parse_recoverable(text);
    if !errors.is_empty() {
        let mistakes = errors.iter();
        return Err(mistakes
            .map(|error| mistake(text, error.span().unwrap_or(0..0), error.message()))
            .collect());
    }
    let place = table.span();
    Ok(Node {
        value: fields(table.into_inner())?,
        place,
    })
}

/// Returns the mistake `problem` in `text`. It names a repeated key; for a backslash that starts no
/// escape it has a hint, because such a backslash is often part of a Windows path.
fn mistake(text: &str, place: Place, problem: &str) -> Mistake {
    if problem == "duplicate key"
        && let Some(key) = text.get(place.clone())
    {
        let name = key.trim_matches(['"', '\'']);
        return Mistake::new(place, format!("the field `{name}` is stated twice"));
    }
    if !problem.contains("escaped value") && !problem.contains("unicode") {
        return Mistake::new(place, problem);
    }
    Mistake {
        advice: Some("write C:/Users/... or use single quotes".to_owned()),
        ..Mistake::new(
            place,
            "in double quotes a backslash starts an escape sequence, and this sequence is not valid",
        )
    }
}

fn fields(table: DeTable<'_>) -> Result<Value, Vec<Mistake>> {
    let entries = table.into_iter().map(|(name, value)| {
        Ok(Entry {
            name_place: name.span(),
            name: name.into_inner().into_owned(),
            node: node(value)?,
        })
    });
    let mut entries = entries.collect::<Result<Vec<_>, Vec<Mistake>>>()?;
    entries.sort_by_key(|entry| entry.name_place.start); // the reader sorts tables by name
    Ok(Value::Table(entries))
}

fn node(value: Spanned<DeValue<'_>>) -> Result<Node, Vec<Mistake>> {
    let place = value.span();
    let value = match value.into_inner() {
        DeValue::String(text) => Value::Text(text.into_owned()),
        DeValue::Integer(number) => integer(number.as_str(), number.radix(), &place)?,
        DeValue::Float(number) => {
            let found = number.as_str().parse();
            Value::Float(found.map_err(|_| beyond(&place))?)
        }
        DeValue::Boolean(value) => Value::Bool(value),
        // a date without quotes is read as text
        DeValue::Datetime(date) => Value::Text(date.to_string()),
        DeValue::Array(values) => {
            let nodes = values.into_iter().map(node);
            Value::List(nodes.collect::<Result<_, _>>()?)
        }
        DeValue::Table(table) => fields(table)?,
    };
    Ok(Node { value, place })
}

fn integer(digits: &str, radix: u32, place: &Place) -> Result<Value, Vec<Mistake>> {
    let small = i64::from_str_radix(digits, radix).map(Value::Integer);
    small
        .or_else(|_| u64::from_str_radix(digits, radix).map(Value::Unsigned))
        .map_err(|_| beyond(place))
}

fn beyond(place: &Place) -> Vec<Mistake> {
    vec![Mistake::new(
        place.clone(),
        "is beyond the range of numbers",
    )]
}

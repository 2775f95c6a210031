//! Value of a sheet as a deserializer.

use std::fmt;

use serde::de::{DeserializeSeed, Error as _, Unexpected, Visitor};
use serde::{Deserializer, forward_to_deserialize_any};

use super::super::language::Language;
use super::super::mistake::{Place, did_you_mean, nearest, quoted};
use super::super::tree::{Choice, JOB, Node, Value};
use super::access::{Chosen, Fields, Values};
use super::{Fault, Filler, Pass, QUANTITY};

/// Path from the root of a sheet to a value, written as `method.two_point.free_end` or
/// `tests[0].name`.
#[derive(Debug)]
pub(super) struct At<'a> {
    outer: Option<&'a Self>,
    step: Step<'a>,
}

#[derive(Debug)]
pub(super) enum Step<'a> {
    /// The root, or a step that adds nothing to the path. An example is the step to the settings of
    /// the job in TOML and JSON, because they are fields of the root.
    Stay,
    Name(&'a str),
    /// Step to the settings of the choice with this name.
    Choice(&'a str),
    Index(usize),
}

impl<'a> At<'a> {
    pub(super) const ROOT: Self = Self {
        outer: None,
        step: Step::Stay,
    };

    /// Returns the path to a part of the value at this path.
    pub(super) fn to(&'a self, step: Step<'a>) -> Self {
        let outer = Some(self);
        Self { outer, step }
    }

    /// Returns the path without the names of choices: `method.free_end`.
    fn of_statement(&self) -> String {
        let mut place = self.outer.map(Self::of_statement).unwrap_or_default();
        match self.step {
            Step::Stay | Step::Choice(_) => {}
            Step::Name(name) if place.is_empty() => place.push_str(name),
            Step::Name(name) => {
                place.push('.');
                place.push_str(name);
            }
            Step::Index(index) => place.push_str(&format!("[{index}]")),
        }
        place
    }

    fn is_root(&self) -> bool {
        self.outer.is_none()
    }
}

impl fmt::Display for At<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let outer = self.outer.map(ToString::to_string).unwrap_or_default();
        f.write_str(&outer)?;
        match self.step {
            Step::Stay => Ok(()),
            Step::Name(name) | Step::Choice(name) if outer.is_empty() => f.write_str(name),
            Step::Name(name) | Step::Choice(name) => write!(f, ".{name}"),
            Step::Index(index) => write!(f, "[{index}]"),
        }
    }
}

/// A value with its path from the root.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reading<'a> {
    pub(super) node: &'a Node,
    pub(super) at: &'a At<'a>,
    pub(super) pass: &'a Pass,
}

/// Reads the value, or a filler in its place. A fault without a place gets the place of the value.
pub(super) fn read_value<'de, T: DeserializeSeed<'de>>(
    seed: T,
    reading: Reading<'_>,
) -> Result<T::Value, Fault> {
    let value = if reading.is_filled() {
        seed.deserialize(Filler::default())
    } else {
        reading.note_value();
        seed.deserialize(reading)
    };
    reading.placed(value)
}

/// A name with its place.
#[derive(Debug, Clone, Copy)]
struct Name<'a> {
    text: &'a str,
    place: &'a Place,
}

impl<'a> Reading<'a> {
    /// Returns the value `node` at the path `at`, in the same pass.
    pub(super) fn part(self, node: &'a Node, at: &'a At<'a>) -> Self {
        Self { node, at, ..self }
    }

    /// Gives the fault of a result the place of the value, unless it has one.
    fn placed<T>(&self, result: Result<T, Fault>) -> Result<T, Fault> {
        result.map_err(|fault| fault.at(self))
    }

    /// Notes a value without parts as a statement of the sheet; the values of a list form one
    /// statement.
    fn note_value(&self) {
        let value = match &self.node.value {
            Value::List(nodes) if nodes.is_empty() => Some("none".to_owned()),
            _ => self.node.as_written(),
        };
        if let Some(value) = value {
            match (&self.at.step, self.at.outer) {
                (Step::Index(_), Some(list)) => self.pass.note(list.of_statement(), ", ", &value),
                _ => self.note_statement(&value),
            }
        }
    }

    /// Passes a text to `visitor`. If the sheet is drawn and the text states an uncertainty, a draw
    /// of the quantity is passed instead.
    fn text<'de, V: Visitor<'de>>(&self, text: &str, visitor: V) -> Result<V::Value, Fault> {
        match self.pass.drawn(text) {
            Some(drawn) => visitor.visit_str(&drawn),
            None => visitor.visit_str(text),
        }
    }

    /// Notes a statement at this place, after the name of a choice that is already noted there.
    fn note_statement(&self, value: &str) {
        self.pass.note(self.at.of_statement(), " ", value);
    }

    /// Returns true if a filler replaces the value.
    pub(super) fn is_filled(&self) -> bool {
        let filled = &self.pass.filled;
        !filled.is_empty() && filled.contains(&self.at.to_string())
    }

    /// Returns the fault that the value at this place is not the `expected` one.
    fn refused(&self, expected: &str) -> Fault {
        Fault::found(self.node, expected).at(self)
    }

    /// Passes the fields of the value to a visitor; `name` is the name of their type.
    fn fields<'de, V: Visitor<'de>>(
        self,
        name: &str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        match &self.node.value {
            Value::Table(entries) => {
                self.placed(visitor.visit_map(Fields::new(self, entries, fields)))
            }
            // in a choice without settings, every setting has its default
            Value::Nothing => self.placed(visitor.visit_map(Fields::new(self, &[], fields))),
            // the name of the type itself may be written, as in `Sweep(..)`
            Value::Choice(Choice {
                name: written,
                content: Some(content),
                ..
            }) if *written == self.pass.language.name_of(name) => {
                let at = self.at.to(Step::Stay);
                self.part(content, &at).fields("", fields, visitor)
            }
            _ => Err(self.refused(match self.pass.language {
                Language::Ron => "fields in round brackets, such as `(name: value)`",
                Language::Toml => "a table of fields",
                Language::Json => "an object with fields",
            })),
        }
    }

    /// Returns the name and the settings of the choice that this value represents.
    fn choice(&self) -> Option<(Name<'a>, Option<&'a Node>)> {
        match &self.node.value {
            Value::Choice(choice) => {
                let name = Name {
                    text: &choice.name,
                    place: &choice.name_place,
                };
                Some((name, choice.content.as_deref()))
            }
            _ if self.pass.language == Language::Ron => None,
            Value::Text(text) => {
                let place = &self.node.place;
                Some((Name { text, place }, None))
            }
            Value::Table(entries) => match entries.as_slice() {
                [only] if !self.at.is_root() => {
                    let name = Name {
                        text: &only.name,
                        place: &only.name_place,
                    };
                    Some((name, Some(&only.node)))
                }
                _ => None,
            },
            _ => None,
        }
    }
}

macro_rules! numbers {
    ($($method:ident)*) => {$(
        fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
            match self.node.value {
                Value::Integer(_) | Value::Unsigned(_) => self.deserialize_any(visitor),
                _ => Err(self.refused("a whole number")),
            }
        }
    )*};
}

macro_rules! texts {
    ($($method:ident)*) => {$(
        fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
            match &self.node.value {
                Value::Text(text) => self.text(text, visitor),
                _ => Err(self.refused("text in quotes")),
            }
        }
    )*};
}

impl<'de> Deserializer<'de> for Reading<'_> {
    type Error = Fault;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match &self.node.value {
            Value::Nothing => visitor.visit_unit(),
            Value::Bool(value) => visitor.visit_bool(*value),
            Value::Integer(number) => visitor.visit_i64(*number),
            Value::Unsigned(number) => visitor.visit_u64(*number),
            Value::Float(number) => visitor.visit_f64(*number),
            Value::Text(text) => self.text(text, visitor),
            Value::List(nodes) => visitor.visit_seq(Values::new(self, nodes)),
            Value::Table(entries) => visitor.visit_map(Fields::all(self, entries)),
            Value::Choice(_) => {
                let found = self.node.in_words();
                Err(Fault::invalid_type(Unexpected::Other(&found), &visitor))
            }
        }
    }

    numbers! {
        deserialize_i8 deserialize_i16 deserialize_i32 deserialize_i64 deserialize_i128
        deserialize_u8 deserialize_u16 deserialize_u32 deserialize_u64 deserialize_u128
    }

    texts! { deserialize_char deserialize_str deserialize_string deserialize_identifier }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.node.value {
            Value::Integer(_) | Value::Unsigned(_) | Value::Float(_) => {
                self.deserialize_any(visitor)
            }
            _ => Err(self.refused("a number")),
        }
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.node.value {
            Value::Bool(_) => self.deserialize_any(visitor),
            _ => Err(self.refused("`true` or `false`")),
        }
    }

    // no sheet has values of these types
    forward_to_deserialize_any! { f32 bytes byte_buf unit_struct tuple_struct }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.node.value {
            Value::Nothing => visitor.visit_none(),
            _ => visitor.visit_some(self),
        }
    }

    fn deserialize_unit<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match &self.node.value {
            Value::Nothing => visitor.visit_unit(),
            Value::Table(entries) if entries.is_empty() => visitor.visit_unit(),
            _ => Err(self.refused("nothing")),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Fault> {
        if name == QUANTITY {
            self.deserialize_any(visitor)
        } else {
            visitor.visit_newtype_struct(self)
        }
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match &self.node.value {
            Value::List(nodes) => visitor.visit_seq(Values::new(self, nodes)),
            _ => Err(self.refused("a list in square brackets")),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, Fault> {
        match &self.node.value {
            Value::List(nodes) if nodes.len() == len => {
                self.placed(visitor.visit_seq(Values::new(self, nodes)))
            }
            Value::List(nodes) => {
                let found = format!("found {} values, expected {len}", nodes.len());
                Err(Fault::new(found, None).at(&self))
            }
            _ => Err(self.refused(&format!("{len} values in brackets"))),
        }
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match &self.node.value {
            Value::Table(entries) => visitor.visit_map(Fields::all(self, entries)),
            _ => Err(self.refused(match self.pass.language {
                Language::Ron => "names with their values in braces, such as `{\"name\": value}`",
                Language::Toml => "a table of names with their values",
                Language::Json => "an object of names with their values",
            })),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        self.fields(name, fields, visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        let language = self.pass.language;
        let names: Vec<String> = variants
            .iter()
            .map(|variant| language.name_of(variant))
            .collect();
        let Some((name, content)) = self.choice() else {
            if self.at.is_root() && language != Language::Ron {
                let advice = format!(
                    "begin the sheet with a line such as `{JOB} = \"modulus\"`; the jobs are {}",
                    quoted(&names)
                );
                return Err(
                    Fault::new(format!("the field `{JOB}` is missing"), Some(advice))
                        .at_place(&(0..0), &self),
                );
            }
            let hint = match &self.node.value {
                Value::Text(_) => ", without quotes",
                Value::Table(entries) if entries.len() > 1 => ", and only one",
                _ => "",
            };
            return Err(self.refused(&format!("one of {}{hint}", quoted(&names))));
        };
        let same = variants
            .iter()
            .zip(&names)
            .find(|(_, known)| *known == name.text);
        let variant = if let Some((variant, _)) = same {
            *variant
        } else {
            let meant = nearest(name.text, &names);
            let fault = Fault::new(
                format!("found `{}`, expected one of {}", name.text, quoted(&names)),
                meant.map(|meant| did_you_mean(meant)),
            )
            .at_place(name.place, &self);
            // continues with the choice that was probably meant
            let meant = variants
                .iter()
                .zip(&names)
                .find(|(_, known)| Some(*known) == meant);
            let Some((variant, _)) = meant else {
                return Err(fault);
            };
            self.pass
                .noted
                .borrow_mut()
                .push(fault.into_mistake(language));
            *variant
        };
        let is_job = self.at.is_root() && language != Language::Ron;
        let at = self.at.to(if is_job {
            Step::Stay
        } else {
            Step::Choice(name.text)
        });
        if !self.at.is_root() {
            match content {
                Some(_) => self.note_statement(variant),
                // statements have the same name in every language
                None => self.pass.note_again(variant),
            }
        }
        let nothing = Node {
            value: Value::Nothing,
            place: name.place.clone(),
        };
        let content = self.part(content.unwrap_or(&nothing), &at);
        visitor.visit_enum(Chosen { variant, content })
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_unit()
    }
}

//! Access to the parts of a value of a sheet: values of a list, fields of a table, settings of a
//! choice.

use serde::Deserializer as _;
use serde::de::value::StrDeserializer;
use serde::de::{
    DeserializeSeed, EnumAccess, Error as _, MapAccess, SeqAccess, VariantAccess, Visitor,
};

use super::super::language::Language;
use super::super::mistake::{did_you_mean, nearest, quoted};
use super::super::tree::{Entry, Node, Value};
use super::reading::{Reading, Step, read_value};
use super::{Fault, Filler};

/// Values of a list.
pub(super) struct Values<'a> {
    list: Reading<'a>,
    nodes: std::iter::Enumerate<std::slice::Iter<'a, Node>>,
}

impl<'a> Values<'a> {
    pub(super) fn new(list: Reading<'a>, nodes: &'a [Node]) -> Self {
        Self {
            list,
            nodes: nodes.iter().enumerate(),
        }
    }
}

impl<'de> SeqAccess<'de> for Values<'_> {
    type Error = Fault;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Fault> {
        let Some((index, node)) = self.nodes.next() else {
            return Ok(None);
        };
        let at = self.list.at.to(Step::Index(index));
        read_value(seed, self.list.part(node, &at)).map(Some)
    }
}

/// Field: its name in the type, and its name and value in the sheet. A missing field that must be
/// filled has no name and value in the sheet.
type Field<'a> = (&'a str, Option<(&'a str, &'a Node)>);

/// Fields of a table.
pub(super) struct Fields<'a> {
    table: Reading<'a>,
    fields: std::vec::IntoIter<Field<'a>>,
    value: Option<Option<(&'a str, &'a Node)>>,
}

impl<'a> Fields<'a> {
    /// Returns all entries, whatever their names are.
    pub(super) fn all(table: Reading<'a>, entries: &'a [Entry]) -> Self {
        let mut seen: Vec<Field<'a>> = Vec::with_capacity(entries.len());
        for entry in entries {
            if seen.iter().any(|(name, _)| *name == entry.name) {
                note_second(&table, entry);
            } else {
                seen.push((&entry.name, Some((&entry.name, &entry.node))));
            }
        }
        Self {
            table,
            fields: seen.into_iter(),
            value: None,
        }
    }

    /// Returns the fields of a type with the fields `known`. Unknown fields are noted as mistakes,
    /// and read as the known fields that were probably meant.
    pub(super) fn new(
        table: Reading<'a>,
        entries: &'a [Entry],
        known: &'static [&'static str],
    ) -> Self {
        let of_sheet = &table.pass.of_sheet;
        if table.at.to_string().is_empty() {
            of_sheet.set(known);
        }
        let mut fields: Vec<Field<'a>> = Vec::with_capacity(known.len());
        let is_stated = |name: &str| entries.iter().any(|entry| entry.name == name);
        for entry in entries {
            let is_new = |name: &str| !fields.iter().any(|(taken, _)| *taken == name);
            let name = match known.iter().find(|name| **name == entry.name) {
                Some(name) if is_new(name) => Some(name),
                Some(_) => {
                    note_second(&table, entry);
                    None
                }
                None => {
                    let meant = nearest(&entry.name, known);
                    let words = if known.is_empty() {
                        format!("there is no field `{}`: none is expected here", entry.name)
                    } else {
                        format!("there is no field `{}`, only {}", entry.name, quoted(known))
                    };
                    let is_of_sheet = of_sheet.get().contains(&entry.name.as_str());
                    let advice = if table.pass.language == Language::Toml && is_of_sheet {
                        let advice =
                            "it is a field of the sheet itself: put it above the first [table]";
                        Some(advice.to_owned())
                    } else {
                        meant.map(|meant| did_you_mean(meant))
                    };
                    note(&table, entry, &words, advice);
                    meant.filter(|name| !is_stated(name) && is_new(name))
                }
            };
            if let Some(name) = name {
                fields.push((name, Some((&entry.name, &entry.node))));
            }
        }
        if !table.pass.filled.is_empty() {
            for name in known {
                let is_missing = !fields.iter().any(|(taken, _)| taken == name);
                if is_missing
                    && table
                        .pass
                        .filled
                        .contains(&table.at.to(Step::Name(name)).to_string())
                {
                    fields.push((name, None));
                }
            }
        }
        Self {
            table,
            fields: fields.into_iter(),
            value: None,
        }
    }
}

fn note(table: &Reading<'_>, entry: &Entry, problem: &str, advice: Option<String>) {
    let at = table.at.to(Step::Name(&entry.name));
    let reading = table.part(&entry.node, &at);
    let fault = Fault::new(problem, advice).at_place(&entry.name_place, &reading);
    let mistake = fault.into_mistake(table.pass.language);
    table.pass.noted.borrow_mut().push(mistake);
}

fn note_second(table: &Reading<'_>, entry: &Entry) {
    let problem = format!("the field `{}` is stated twice", entry.name);
    note(table, entry, &problem, None);
}

impl<'de> MapAccess<'de> for Fields<'_> {
    type Error = Fault;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Fault> {
        let Some((name, value)) = self.fields.next() else {
            return Ok(None);
        };
        self.value = Some(value);
        seed.deserialize(StrDeserializer::new(name)).map(Some)
    }

    fn next_value_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value, Fault> {
        match self.value.take() {
            Some(Some((name, node))) => {
                let at = self.table.at.to(Step::Name(name));
                read_value(seed, self.table.part(node, &at))
            }
            Some(None) => seed.deserialize(Filler::default()),
            None => Err(Fault::custom("a value without its name")),
        }
    }
}

/// A choice whose name is known.
pub(super) struct Chosen<'a> {
    /// Name of the choice in the type.
    pub(super) variant: &'static str,
    /// Settings of the choice.
    pub(super) content: Reading<'a>,
}

impl<'de, 'a> EnumAccess<'de> for Chosen<'a> {
    type Error = Fault;
    type Variant = Settings<'a>;

    fn variant_seed<T: DeserializeSeed<'de>>(
        self,
        seed: T,
    ) -> Result<(T::Value, Settings<'a>), Fault> {
        Ok((
            seed.deserialize(StrDeserializer::new(self.variant))?,
            Settings(self.content),
        ))
    }
}

/// Settings of a choice.
pub(super) struct Settings<'a>(Reading<'a>);

impl<'de> VariantAccess<'de> for Settings<'_> {
    type Error = Fault;

    fn unit_variant(self) -> Result<(), Fault> {
        match &self.0.node.value {
            Value::Nothing => Ok(()),
            Value::Table(entries) if entries.is_empty() => Ok(()),
            _ if self.0.is_filled() => Ok(()),
            _ => {
                Err(Fault::found(self.0.node, "the name alone, as it has no settings").at(&self.0))
            }
        }
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Fault> {
        read_value(seed, self.0)
    }

    fn tuple_variant<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, Fault> {
        if self.0.is_filled() {
            return Filler::default().deserialize_tuple(len, visitor);
        }
        self.0.deserialize_tuple(len, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        if self.0.is_filled() {
            return Filler::default().deserialize_struct("", fields, visitor);
        }
        self.0.deserialize_struct("", fields, visitor)
    }
}

//! Placeholders for faulty values, so that a sheet can be read to its end. A sheet with
//! placeholders is discarded after its faults are listed.

use serde::de::value::{MapDeserializer, SeqDeserializer, StrDeserializer};
use serde::de::{
    DeserializeSeed, EnumAccess, Error as _, IntoDeserializer, VariantAccess, Visitor,
};
use serde::{Deserializer, forward_to_deserialize_any};

use super::{Fault, QUANTITY};

/// A value of any required type: the number 1, an empty list, a table with all fields filled, or
/// the first choice.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Filler {
    depth: u8,
}

/// Maximum depth of nested fillers, for types that contain themselves.
const DEEPEST: u8 = 20;

impl Filler {
    fn inner(self) -> Result<Self, Fault> {
        if self.depth < DEEPEST {
            Ok(Self {
                depth: self.depth + 1,
            })
        } else {
            Err(Fault::custom("a type that contains itself"))
        }
    }
}

macro_rules! filled {
    ($($method:ident => $visit:ident($($value:expr)?);)*) => {$(
        fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
            visitor.$visit($($value)?)
        }
    )*};
}

impl<'de> Deserializer<'de> for Filler {
    type Error = Fault;

    filled! {
        deserialize_any => visit_u64(1);
        deserialize_bool => visit_bool(false);
        deserialize_char => visit_char('1');
        deserialize_str => visit_str("1");
        deserialize_string => visit_str("1");
        deserialize_identifier => visit_str("1");
        deserialize_option => visit_none();
        deserialize_unit => visit_unit();
        deserialize_ignored_any => visit_unit();
    }

    forward_to_deserialize_any! {
        i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 bytes byte_buf unit_struct tuple_struct
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Fault> {
        if name == QUANTITY {
            visitor.visit_none() // the quantity returns its example
        } else {
            visitor.visit_newtype_struct(self.inner()?)
        }
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        self.deserialize_tuple(0, visitor)
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, Fault> {
        let values = std::iter::repeat_n(self.inner()?, len);
        visitor.visit_seq(SeqDeserializer::new(values))
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        self.deserialize_struct("", &[], visitor)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        let filler = self.inner()?;
        let fields = fields.iter().map(|name| (*name, filler));
        visitor.visit_map(MapDeserializer::new(fields))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        let variant = variants
            .first()
            .ok_or_else(|| Fault::custom("a choice of nothing"))?;
        visitor.visit_enum(First {
            of: self.inner()?,
            variant,
        })
    }
}

impl IntoDeserializer<'_, Fault> for Filler {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

struct First {
    of: Filler,
    variant: &'static str,
}

impl<'de> EnumAccess<'de> for First {
    type Error = Fault;
    type Variant = Filler;

    fn variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<(T::Value, Filler), Fault> {
        Ok((
            seed.deserialize(StrDeserializer::new(self.variant))?,
            self.of,
        ))
    }
}

impl<'de> VariantAccess<'de> for Filler {
    type Error = Fault;

    fn unit_variant(self) -> Result<(), Fault> {
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Fault> {
        seed.deserialize(self)
    }

    fn tuple_variant<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, Fault> {
        self.deserialize_tuple(len, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        self.deserialize_struct("", fields, visitor)
    }
}

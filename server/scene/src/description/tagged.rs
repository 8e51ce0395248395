//! Unions tagged by `kind` whose parse errors keep their exact path.
//!
//! Serde's own internal tagging buffers the object and loses the path inside it. Here the object
//! is collected, the kind picks the type, and the rest goes through `serde_path_to_error`; the
//! inner path travels outward in the message (see `parse`).

use std::fmt;

use serde::de::{DeserializeOwned, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};

use super::parse::{located, located_message};

/// Defines an enum of newtype variants that is tagged by `kind` in JSON.
macro_rules! tagged_union {
    (
        $(#[$meta:meta])*
        pub enum $name:ident {
            $($(#[$variant_meta:meta])* $kind:literal => $variant:ident($inner:ty)),+ $(,)?
        }
    ) => {
        $(#[$meta])*
        #[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema, ts_rs::TS)]
        #[serde(tag = "kind")]
        pub enum $name {
            $($(#[$variant_meta])* #[serde(rename = $kind)] $variant($inner)),+
        }

        impl<'de> serde::Deserialize<'de> for $name {
            fn deserialize<D: serde::Deserializer<'de>>(
                deserializer: D,
            ) -> Result<Self, D::Error> {
                const KINDS: &[&str] = &[$($kind),+];
                let (kind, members) =
                    crate::description::tagged::kind_and_members(deserializer, KINDS)?;
                $(
                    if kind == $kind {
                        return crate::description::tagged::inner(members).map(Self::$variant);
                    }
                )+
                Err(crate::description::tagged::unknown_kind(&kind, KINDS))
            }
        }
    };
}
pub(super) use tagged_union;

/// Collects an object and takes its `kind` out.
pub(super) fn kind_and_members<'de, D: Deserializer<'de>>(
    deserializer: D,
    kinds: &[&str],
) -> Result<(String, Map<String, Value>), D::Error> {
    let mut members = deserializer.deserialize_map(ObjectVisitor)?;
    match members.remove("kind") {
        Some(Value::String(kind)) => Ok((kind, members)),
        Some(other) => Err(unknown_kind(&other.to_string(), kinds)),
        None => Err(unknown_kind("nothing", kinds)),
    }
}

/// Reads the members of the picked kind.
pub(super) fn inner<T: DeserializeOwned, E: Error>(members: Map<String, Value>) -> Result<T, E> {
    serde_path_to_error::deserialize(Value::Object(members)).map_err(|error| {
        let path = error.path().to_string();
        E::custom(located_message(&located(&path, &error.inner().to_string())))
    })
}

/// The error of a `kind` that is none of the known ones.
pub(super) fn unknown_kind<E: Error>(found: &str, kinds: &[&str]) -> E {
    let found = crate::error::abbreviate(found);
    let allowed = kinds.join(", ");
    E::custom(format!(
        "at `kind`: found {found}, allowed one of {allowed}"
    ))
}

/// Collects an object, refusing duplicate names.
struct ObjectVisitor;

impl<'de> Visitor<'de> for ObjectVisitor {
    type Value = Map<String, Value>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an object with a `kind`")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut members = Map::new();
        while let Some(name) = map.next_key::<String>()? {
            if members.contains_key(&name) {
                return Err(A::Error::custom(format!("duplicate field `{name}`")));
            }
            let StrictValue(value) = map.next_value()?;
            members.insert(name, value);
        }
        Ok(members)
    }
}

/// Any JSON value without duplicate names in its objects; `serde_json`'s own keeps the last one.
struct StrictValue(Value);

impl<'de> serde::Deserialize<'de> for StrictValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(StrictVisitor).map(Self)
    }
}

struct StrictVisitor;

impl<'de> Visitor<'de> for StrictVisitor {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Value, E> {
        let number = serde_json::Number::from_f64(value);
        number
            .map(Value::Number)
            .ok_or_else(|| E::custom("found a number that is not finite, allowed finite numbers"))
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_none<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Value, A::Error> {
        let mut elements = Vec::new();
        while let Some(StrictValue(element)) = seq.next_element()? {
            elements.push(element);
        }
        Ok(Value::Array(elements))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Value, A::Error> {
        ObjectVisitor.visit_map(map).map(Value::Object)
    }
}

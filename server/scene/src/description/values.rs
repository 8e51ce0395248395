//! Values that several parts of a description share.

use std::borrow::Cow;
use std::fmt;

use glam::DVec3;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use ts_rs::TS;

use crate::scene::Aabb;

/// A linear Rec. 709 RGB triple; a single number in JSON stands for three equal channels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, TS)]
#[ts(type = "number | [number, number, number]")]
pub struct Rgb(pub [f64; 3]);

impl Rgb {
    /// Three equal channels.
    pub const fn grey(value: f64) -> Self {
        Self([value; 3])
    }
}

/// A scale along x, y and z; a single number in JSON stands for a uniform scale.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, TS)]
#[ts(type = "number | [number, number, number]")]
pub struct Scale(pub [f64; 3]);

/// Reads a number or three numbers without buffering, so that errors keep their path.
struct NumberOrTriple;

impl<'de> Visitor<'de> for NumberOrTriple {
    type Value = [f64; 3];

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number or three numbers")
    }

    fn visit_f64<E>(self, value: f64) -> Result<Self::Value, E> {
        Ok([value; 3])
    }

    fn visit_u64<E>(self, value: u64) -> Result<Self::Value, E> {
        Ok([value as f64; 3])
    }

    fn visit_i64<E>(self, value: i64) -> Result<Self::Value, E> {
        Ok([value as f64; 3])
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
        let mut triple = [0.0; 3];
        for (i, component) in triple.iter_mut().enumerate() {
            *component = seq
                .next_element()?
                .ok_or_else(|| A::Error::invalid_length(i, &self))?;
        }
        match seq.next_element::<serde::de::IgnoredAny>()? {
            None => Ok(triple),
            Some(_) => Err(A::Error::custom(
                "invalid length 4 or more, expected a number or three numbers",
            )),
        }
    }
}

/// The schema of [`NumberOrTriple`].
fn number_or_triple_schema(description: &str) -> Schema {
    json_schema!({
        "description": description,
        "anyOf": [
            {"type": "number"},
            {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3},
        ],
    })
}

impl<'de> Deserialize<'de> for Rgb {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NumberOrTriple).map(Self)
    }
}

impl<'de> Deserialize<'de> for Scale {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NumberOrTriple).map(Self)
    }
}

impl JsonSchema for Rgb {
    fn schema_name() -> Cow<'static, str> {
        "Rgb".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        number_or_triple_schema("Linear Rec. 709 RGB, or one number for three equal channels.")
    }
}

impl JsonSchema for Scale {
    fn schema_name() -> Cow<'static, str> {
        "Scale".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        number_or_triple_schema("Scale along x, y and z, or one number for all three.")
    }
}

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(deny_unknown_fields)]
pub struct Bounds {
    /// Lowest corner. Unit: m.
    pub min: [f64; 3],
    /// Highest corner; above `min` in every component. Unit: m.
    pub max: [f64; 3],
}

impl Bounds {
    /// As the scene holds it.
    pub(crate) fn aabb(&self) -> Aabb {
        Aabb {
            min: DVec3::from_array(self.min),
            max: DVec3::from_array(self.max),
        }
    }
}

/// The unit vector along a validated direction, which is never short.
pub(crate) fn unit(direction: [f64; 3]) -> DVec3 {
    let direction = DVec3::from_array(direction);
    direction / direction.length()
}

/// Scale, then rotation about x, then y, then z (the fixed axes), then translation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(deny_unknown_fields, default)]
pub struct Transform {
    /// Unit: m.
    pub translation: [f64; 3],
    /// About x, then y, then z. Unit: degree. Range: −36000 to 36000 each.
    pub rotation_degrees: [f64; 3],
    /// Factors; magnitude 1e−6 to 1e6 each. A negative factor mirrors.
    pub scale: Scale,
}

impl Default for Transform {
    fn default() -> Self {
        Self {
            translation: [0.0; 3],
            rotation_degrees: [0.0; 3],
            scale: Scale([1.0; 3]),
        }
    }
}

//! The published JSON Schema of the format.

use crate::description::SceneDescription;

/// The JSON Schema (2020-12) of a scene, version 1.
pub fn json_schema() -> serde_json::Value {
    schemars::schema_for!(SceneDescription).to_value()
}

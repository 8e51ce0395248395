//! A technique's name is also its key in the scene description. Tier *none*: needs no device.

use serde_json::Value;
use tyndall_tests::conventions::{layout, source};

/// What every technique builds on, so no scene asks for it by name.
const NOT_A_CHOICE: [&str; 3] = ["area_lights", "shadow_maps", "surfaces"];

fn strings(value: &Value, found: &mut Vec<String>) {
    match value {
        Value::String(text) => found.push(text.clone()),
        Value::Array(values) => values.iter().for_each(|value| strings(value, found)),
        Value::Object(fields) => fields.values().for_each(|value| strings(value, found)),
        _ => {}
    }
}

#[test]
fn every_technique_is_a_key_of_the_scene_description() {
    let schema = tyndall_scene::json_schema();
    let mut keys = Vec::new();
    strings(&schema["$defs"]["Technique"], &mut keys);
    assert!(
        keys.iter().any(|key| key == "reference"),
        "the schema has no list of techniques"
    );
    let paths = source::paths(&source::root()).unwrap();
    let paths: Vec<&str> = paths.iter().map(String::as_str).collect();
    let (rust, wesl) = layout::technique_names(&paths);
    for name in rust
        .union(&wesl)
        .filter(|name| !NOT_A_CHOICE.contains(&name.as_str()))
    {
        assert!(
            keys.contains(name),
            "technique `{name}` is no value of render.technique: {keys:?}"
        );
    }
}

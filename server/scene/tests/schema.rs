//! The published JSON Schema is the one of the code, and docs/scene.md names every member.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::Value;

#[test]
fn the_committed_schema_is_current() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("schema/scene-v1.json");
    let current = serde_json::to_string_pretty(&tyndall_scene::json_schema()).unwrap() + "\n";
    if std::env::var_os("TYNDALL_BLESS").is_some_and(|bless| bless == "1") {
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(&file, &current).unwrap();
        println!("written: {}", file.display());
    }
    let committed = std::fs::read_to_string(&file).unwrap();
    assert!(
        committed == current,
        "server/scene/schema/scene-v1.json is out of date: run this test with TYNDALL_BLESS=1"
    );
}

#[test]
fn every_member_of_the_schema_is_documented() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/scene.md");
    let text = std::fs::read_to_string(file).unwrap();
    let mut names = BTreeSet::new();
    collect(&tyndall_scene::json_schema(), &mut names);
    assert!(names.len() > 50);
    let missing: Vec<&String> = names
        .iter()
        .filter(|name| !text.contains(&format!("`{name}`")))
        .collect();
    assert!(missing.is_empty(), "docs/scene.md lacks {missing:?}");
}

fn collect(schema: &Value, names: &mut BTreeSet<String>) {
    match schema {
        Value::Object(members) => {
            if let Some(Value::Object(properties)) = members.get("properties") {
                names.extend(properties.keys().cloned());
            }
            members.values().for_each(|member| collect(member, names));
        }
        Value::Array(elements) => elements.iter().for_each(|element| collect(element, names)),
        _ => {}
    }
}

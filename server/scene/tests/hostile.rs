//! Hostile input: refused with its cause, and never a panic.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests, too, fail by unwrapping and say what they skip"
)]

use std::path::Path;

use crate::support::glb;
use proptest::prelude::*;
use serde_json::{Value, json};
use tyndall_scene::{Limits, SceneDescription, SceneError, load, load_with, presets};

/// One triangle: three positions, then three 16-bit indices.
fn triangle_bytes() -> Vec<u8> {
    let mut bytes = Vec::new();
    for coordinate in [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        bytes.extend(coordinate.to_le_bytes());
    }
    for index in [0_u16, 1, 2] {
        bytes.extend(index.to_le_bytes());
    }
    bytes
}

fn triangle() -> Value {
    json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
             "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 6},
        ],
        "buffers": [{"byteLength": 42}],
        "materials": [{}],
        "textures": [{"source": 0}],
        "images": [{"uri": "image.png"}],
    })
}

fn write(folder: &Path, name: &str, bytes: &[u8]) -> std::path::PathBuf {
    let file = folder.join(name);
    std::fs::write(&file, bytes).unwrap();
    file
}

fn load_glb(json: &Value, bin: &[u8]) -> Result<tyndall_scene::Loaded, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    load(&write(folder.path(), "a.glb", &glb(&json.to_string(), bin)))
}

/// The place and cause of the refusal of a changed triangle.
fn refusal(change: impl FnOnce(&mut Value)) -> String {
    let mut json = triangle();
    change(&mut json);
    match load_glb(&json, &triangle_bytes()) {
        Ok(_) => panic!("loads: {json}"),
        Err(error) => error.to_string(),
    }
}

fn assert_refused(part: &str, change: impl FnOnce(&mut Value)) {
    let text = refusal(change);
    assert!(text.contains(part), "{text:?} lacks {part:?}");
    assert!(text.starts_with("geometry[0].path: a.glb: "), "{text}");
}

#[test]
fn the_triangle_itself_loads() {
    let loaded = load_glb(&triangle(), &triangle_bytes()).unwrap();
    assert_eq!(loaded.scene.geometry.meshes[0].indices, [0, 1, 2]);
    assert_eq!(loaded.scene.geometry.meshes[0].normals[0], [0.0, 0.0, 1.0]);
}

#[test]
fn uris_may_not_leave_the_folder() {
    for (uri, why) in [
        ("../secret.bin", "'..'"),
        ("%2e%2e/secret.bin", "'..'"),
        ("/etc/passwd", "absolute"),
        ("file:///etc/passwd", "scheme"),
        ("http://host/a.bin", "scheme"),
        ("a\\..\\b", "backslash"),
        ("%zz", "well-formed"),
        ("absent.bin", "absent.bin"),
        ("data:application/octet-stream;base64,@@@", "base64"),
        ("data:nothing", "no comma"),
    ] {
        assert_refused("buffers[0].uri", |json| {
            json["buffers"][0]["uri"] = json!(uri);
        });
        let text = refusal(|json| json["buffers"][0]["uri"] = json!(uri));
        assert!(text.contains(why), "{text}");
        assert_refused("images[0]", |json| {
            json["images"][0]["uri"] = json!(uri);
            json["materials"][0]["emissiveTexture"] = json!({"index": 0});
            json["meshes"][0]["primitives"][0]["material"] = json!(0);
        });
    }
}

#[test]
fn node_trees_are_bounded_and_without_cycles() {
    assert_refused("nodes[0] is reached twice", |json| {
        json["nodes"][0]["children"] = json!([0]);
    });
    assert_refused("nodes[7] does not exist", |json| {
        json["nodes"][0]["children"] = json!([7]);
    });
    assert_refused("nested deeper than 64", |json| {
        let chain: Vec<Value> = (1..=100).map(|next| json!({"children": [next]})).collect();
        json["nodes"] = Value::Array(chain);
    });
    assert_refused("scenes[3] does not exist", |json| json["scene"] = json!(3));
    assert_refused("meshes[9] does not exist", |json| {
        json["nodes"][0]["mesh"] = json!(9);
    });
    assert_refused("nodes[0].rotation", |json| {
        json["nodes"][0]["rotation"] = json!([0, 0, 0, 0]);
    });
    assert_refused("nodes[0].matrix", |json| {
        json["nodes"][0]["matrix"] = json!(vec![1.0; 16]);
    });
    assert_refused("nodes[0].translation", |json| {
        json["nodes"][0]["translation"] = json!([1e39, 0, 0]);
    });
}

#[test]
fn every_range_of_an_accessor_is_checked() {
    let position = "accessors[0]";
    assert_refused(position, |json| json["accessors"][0]["count"] = json!(4));
    assert_refused(position, |json| {
        json["accessors"][0]["count"] = json!(u64::MAX);
    });
    assert_refused(position, |json| {
        json["accessors"][0]["byteOffset"] = json!(4);
    });
    assert_refused(position, |json| {
        json["accessors"][0]["byteOffset"] = json!(u64::MAX);
    });
    assert_refused(position, |json| {
        json["bufferViews"][0]["byteStride"] = json!(4);
    });
    assert_refused(position, |json| {
        json["bufferViews"][0]["byteStride"] = json!(u64::MAX);
    });
    assert_refused(position, |json| {
        json["accessors"][0]["type"] = json!("MAT4");
    });
    assert_refused(position, |json| {
        json["accessors"][0]["componentType"] = json!(5124);
    });
    assert_refused("wrong type", |json| {
        json["accessors"][0]["type"] = json!("VEC2");
    });
    assert_refused("wrong type", |json| {
        json["accessors"][1]["componentType"] = json!(5122);
    });
    assert_refused("accessors[5] does not exist", |json| {
        json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(5);
    });
    assert_refused("bufferViews[5] does not exist", |json| {
        json["accessors"][0]["bufferView"] = json!(5);
    });
    assert_refused("bufferViews[0]", |json| {
        json["bufferViews"][0]["byteLength"] = json!(43);
    });
    assert_refused("bufferViews[0]", |json| {
        json["bufferViews"][0]["byteOffset"] = json!(u64::MAX);
    });
    assert_refused("buffers[2] does not exist", |json| {
        json["bufferViews"][0]["buffer"] = json!(2);
    });
    assert_refused("buffers[0].byteLength", |json| {
        json["buffers"][0]["byteLength"] = json!(99);
    });
    assert_refused("sparse", |json| {
        json["accessors"][0]["sparse"] = json!({
            "count": 4,
            "indices": {"bufferView": 1, "componentType": 5123},
            "values": {"bufferView": 0},
        });
    });
    assert_refused("sparse.values", |json| {
        json["accessors"][0]["sparse"] = json!({
            "count": 3,
            "indices": {"bufferView": 1, "componentType": 5123},
            "values": {"bufferView": 1},
        });
    });
    assert_refused("the limit is", |json| {
        json["accessors"][0] = json!({"componentType": 5126, "count": 1_u64 << 40, "type": "VEC3"});
    });
}

#[test]
fn vertices_and_indices_are_checked() {
    for bad in [f32::NAN, f32::INFINITY, 1e20] {
        let mut bytes = triangle_bytes();
        bytes[4..8].copy_from_slice(&bad.to_le_bytes());
        let text = load_glb(&triangle(), &bytes).unwrap_err().to_string();
        assert!(
            text.contains("POSITION") && text.contains("vertex 0"),
            "{text}"
        );
    }
    let mut bytes = triangle_bytes();
    bytes[38] = 3;
    let text = load_glb(&triangle(), &bytes).unwrap_err().to_string();
    assert!(
        text.contains("element 1 is 3, but there are 3 vertices"),
        "{text}"
    );

    let mut bytes = triangle_bytes();
    bytes[38] = 0;
    let loaded = load_glb(&triangle(), &bytes).unwrap();
    assert!(loaded.scene.geometry.meshes.is_empty());
    assert!(loaded.warnings[0].contains("1 triangles without area dropped"));
}

#[test]
fn unknown_required_extensions_are_refused_by_name() {
    for name in [
        "KHR_draco_mesh_compression",
        "EXT_meshopt_compression",
        "VENDOR_x",
    ] {
        assert_refused(name, |json| json["extensionsRequired"] = json!([name]));
    }
    let mut json = triangle();
    json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    load_glb(&json, &triangle_bytes()).unwrap();
}

/// A PNG that says it is 65535 pixels a side.
fn huge_png() -> Vec<u8> {
    let mut png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec();
    png.extend(65_535_u32.to_be_bytes());
    png.extend(65_535_u32.to_be_bytes());
    png.extend([8, 6, 0, 0, 0]);
    png.extend(0x6d3f_5a4e_u32.to_be_bytes());
    png.extend(b"\0\0\0\0IDAT");
    png
}

#[test]
fn images_are_refused_before_they_take_memory() {
    let mut json = triangle();
    json["materials"][0]["emissiveTexture"] = json!({"index": 0});
    json["meshes"][0]["primitives"][0]["material"] = json!(0);
    let bytes = glb(&json.to_string(), &triangle_bytes());
    for (image, why) in [
        (huge_png(), "images[0]"),
        (b"\xff\xd8\xff\xe0nonsense".to_vec(), "images[0]"),
        (b"GIF89a".to_vec(), "neither PNG nor JPEG"),
        (Vec::new(), "neither PNG nor JPEG"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), "image.png", &image);
        let file = write(folder.path(), "a.glb", &bytes);
        let text = load(&file).unwrap_err().to_string();
        assert!(text.contains(why), "{text}");
    }
}

#[test]
fn limits_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(
        folder.path(),
        "a.glb",
        &glb(&triangle().to_string(), &triangle_bytes()),
    );
    for (limits, what) in [
        (
            Limits {
                triangles: 0,
                ..Limits::default()
            },
            "the limit is 0",
        ),
        (
            Limits {
                vertices: 2,
                ..Limits::default()
            },
            "the limit is 2",
        ),
        (
            Limits {
                instances: 0,
                ..Limits::default()
            },
            "instances",
        ),
        (
            Limits {
                file_bytes: 100,
                ..Limits::default()
            },
            "bytes",
        ),
        (
            Limits {
                total_bytes: 100,
                ..Limits::default()
            },
            "bytes",
        ),
        (
            Limits {
                node_depth: 0,
                ..Limits::default()
            },
            "nested deeper than 0",
        ),
    ] {
        let text = load_with(&file, &limits).unwrap_err().to_string();
        assert!(text.contains(what), "{text}");
    }
}

#[test]
fn truncated_files_never_panic() {
    let folder = tempfile::tempdir().unwrap();
    let mut json = triangle();
    json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {}}]}});
    json["nodes"][0]["extensions"] = json!({"KHR_lights_punctual": {"light": 0}});
    json["nodes"][0]["rotation"] = json!([0, 0, 0, 1]);
    let good = glb(&json.to_string(), &triangle_bytes());
    load(&write(folder.path(), "a.glb", &good)).unwrap();
    for length in 0..good.len() {
        load(&write(folder.path(), "a.glb", &good[..length])).unwrap_err();
    }
}

#[test]
fn malformed_obj_and_mtl_never_panic() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "short.mtl", b"newmtl a\nKd 0.5\n");
    write(folder.path(), "range.mtl", b"newmtl a\nKd 2 0 0\n");
    let head = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (text, why) in [
        ("f 1 2 4\n", "out of bounds"),
        ("f 1 2 9223372036854775807\n", "too large"),
        ("f 1/9223372036854775807 2 3\n", "line 4"),
        ("f 1//-9223372036854775808 2 3\n", "line 4"),
        ("f 0 1 2\n", "index 0"),
        ("f a b c\n", "whole number"),
        ("f -9 -8 -7\n", "out of bounds"),
        ("v 1\n", "OBJ"),
        ("mtllib ../x.mtl\n", "'..'"),
        ("mtllib absent.mtl\n", "absent.mtl"),
        ("mtllib short.mtl\nf 1 2 3\n", "short.mtl, line 2"),
        ("mtllib range.mtl\nf 1 2 3\n", "outside 0 to 1"),
    ] {
        let file = write(folder.path(), "a.obj", format!("{head}{text}").as_bytes());
        let error = load(&file).unwrap_err().to_string();
        assert!(error.contains(why), "{text:?}: {error}");
    }
    for text in [
        "",
        "vt\n",
        "vn 1\n",
        "f\n",
        "g\n",
        "o\n",
        "usemtl\n",
        "\u{0}\n",
        "f 1 2 3\n",
    ] {
        let file = write(folder.path(), "a.obj", format!("{head}{text}").as_bytes());
        match load(&file) {
            Ok(_) => println!("{text:?}: loads"),
            Err(error) => println!("{text:?}: {error}"),
        }
    }
}

#[test]
fn files_that_are_none_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["absent.json", "absent.glb", "absent.obj", "a.stl", "none"] {
        let error = load(&folder.path().join(name)).unwrap_err();
        assert!(!error.to_string().is_empty());
    }
    let sub = folder.path().join("folder.glb");
    std::fs::create_dir(&sub).unwrap();
    let text = load(&sub).unwrap_err().to_string();
    assert!(text.contains("not a regular file"), "{text}");
    let file = write(folder.path(), "a.json", b"\xff\xfe");
    assert!(matches!(load(&file).unwrap_err(), SceneError::Io { .. }));
}

/// Places in a JSON value, by a walk in order.
fn places(value: &Value, path: String, places_found: &mut Vec<String>) {
    match value {
        Value::Array(elements) => {
            for (i, element) in elements.iter().take(8).enumerate() {
                places(element, format!("{path}/{i}"), places_found);
            }
        }
        Value::Object(members) => {
            for (name, member) in members {
                places(member, format!("{path}/{name}"), places_found);
            }
        }
        _ => {}
    }
    places_found.push(path);
}

fn any_value() -> impl Strategy<Value = Value> {
    prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        any::<f64>().prop_map(Value::from),
        (-2.0_f64..2.0).prop_map(Value::from),
        "[a-z./\\\\:]{0,12}".prop_map(Value::from),
        Just(json!([])),
        Just(json!([0, 0, 0])),
        Just(json!([1e30, -1e30, 1e-30])),
        Just(json!({})),
        Just(json!({"kind": "sphere"})),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_scenes_never_panic_and_name_a_path(
        preset in 0_usize..6,
        mutations in prop::collection::vec((any::<prop::sample::Index>(), any_value()), 1..4),
    ) {
        let name = presets::names()[preset].name;
        let mut scene = serde_json::to_value(presets::description(name).unwrap()).unwrap();
        for (place, value) in mutations {
            let mut found = Vec::new();
            places(&scene, String::new(), &mut found);
            let path = place.get(&found);
            if let Some(target) = scene.pointer_mut(path) {
                *target = value;
            }
        }
        match SceneDescription::from_json(&scene.to_string()) {
            Ok(description) => {
                let again = SceneDescription::from_json(&description.to_json().unwrap()).unwrap();
                prop_assert_eq!(&again, &description);
                if let Ok(loaded) = tyndall_scene::build(description, None) {
                    let facts = tyndall_scene::facts(&loaded.scene);
                    prop_assert!(facts.optical_thickness.is_finite());
                    prop_assert!(facts.bounds.min.is_finite() && facts.bounds.max.is_finite());
                }
            }
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }
}

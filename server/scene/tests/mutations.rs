//! Ten thousand changed scenes and models of each format: each is read or refused with its reason, and
//! soon. Pictures have tests of their own where they are decoded.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests, too, fail by unwrapping"
)]

use std::path::Path;
use std::time::Duration;

use base64::Engine as _;
use serde_json::{Value, json};
use tyndall_mutations::{Kind, attack};
use tyndall_scene::{Limits, SceneDescription, facts, load_with, outline, presets};

use crate::support::glb;

const SOON: Duration = Duration::from_secs(2);

/// A folder for files that are written again and again, in memory where the system has one there.
fn folder() -> tempfile::TempDir {
    let memory = Path::new("/dev/shm");
    let made = if memory.is_dir() {
        tempfile::tempdir_in(memory)
    } else {
        tempfile::tempdir()
    };
    made.unwrap()
}

/// Limits that keep what a changed number asks for small.
fn limits() -> Limits {
    Limits {
        triangles: 100_000,
        vertices: 100_000,
        environment_pixels: 1 << 16,
        texture_pixels: 1 << 16,
        grid_bytes: 4 << 20,
        ..Limits::default()
    }
}

/// Attacks the file `changed` of a folder by loading the file `loaded`.
fn attack_file(folder: &Path, changed: &str, loaded: &str, seeds: &[Vec<u8>], kind: Kind) {
    let limits = limits();
    attack(changed, seeds, kind, SOON, |bytes| {
        std::fs::write(folder.join(changed), bytes).unwrap();
        match load_with(&folder.join(loaded), &limits) {
            Ok(loaded) => {
                assert!(facts(&loaded.scene).optical_thickness.is_finite());
                let map = loaded.scene.environment.and_then(|light| light.map);
                for value in map.iter().flat_map(|map| map.pixels.as_flattened()) {
                    assert!((0.0..=1e9).contains(value), "radiance of {value}");
                }
                true
            }
            Err(error) => {
                assert!(!error.to_string().is_empty());
                false
            }
        }
    });
}

#[test]
fn changed_scenes_are_harmless() {
    let seeds: Vec<Vec<u8>> = ["cornell_fog", "swinging_lamp", "cloud", "light_shafts"]
        .map(|name| {
            let description = presets::description(name).unwrap();
            description.to_json().unwrap().into_bytes()
        })
        .into();
    let limits = limits();
    attack("scene", &seeds, Kind::Text, SOON, |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else {
            return false;
        };
        match SceneDescription::from_json(text) {
            Ok(description) => outline(description, &limits).is_ok(),
            Err(error) => {
                assert!(!error.to_string().is_empty());
                false
            }
        }
    });
}

/// One textured triangle with a light and a camera.
fn triangle(buffer: &Value) -> Value {
    json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [
            {"mesh": 0, "rotation": [0, 0, 0, 1], "children": [2]},
            {"camera": 0, "translation": [0, 0, 3]},
            {"extensions": {"KHR_lights_punctual": {"light": 0}}},
        ],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0.5}, "alphaMode": "MASK"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
             "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 6},
        ],
        "buffers": [buffer],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {}}]}},
    })
}

fn vertices() -> Vec<u8> {
    let mut bytes = Vec::new();
    for coordinate in [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        bytes.extend(coordinate.to_le_bytes());
    }
    bytes.extend([0, 0, 1, 0, 2, 0]);
    bytes
}

#[test]
fn changed_gltf_files_are_harmless() {
    let folder = folder();
    let data = base64::engine::general_purpose::STANDARD.encode(vertices());
    let uri = format!("data:application/octet-stream;base64,{data}");
    let text = triangle(&json!({"byteLength": 42, "uri": uri})).to_string();
    attack_file(
        folder.path(),
        "a.gltf",
        "a.gltf",
        &[text.into_bytes()],
        Kind::Text,
    );
}

#[test]
fn changed_glb_files_are_harmless() {
    let folder = folder();
    let text = triangle(&json!({"byteLength": 42})).to_string();
    let seeds = [glb(&text, &vertices())];
    attack_file(folder.path(), "a.glb", "a.glb", &seeds, Kind::Binary);
}

const OBJ: &[u8] = b"mtllib a.mtl\no a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 1\n\
    vn 0 0 1\nusemtl red\nf 1/1/1 2/2/1 3/1/1\ng b\nf -1//1 -2//1 -3//1\nl 1 2\ns 1\n";
const MTL: &[u8] = b"newmtl red\nKa 0 0 0\nKd 1 0.5 0.25\nKs 0.1 0.1 0.1\nKe 2 2 2\nNs 30\nd 0.9\n\
    illum 2\nmap_Kd a.png\nnewmtl blue\nKd 0 0 1\nTr 0.5\n";

#[test]
fn changed_obj_and_mtl_files_are_harmless() {
    let folder = folder();
    let mut png = Vec::new();
    let encoder = png::Encoder::new(&mut png, 1, 1);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[7]).unwrap();
    writer.finish().unwrap();
    std::fs::write(folder.path().join("a.png"), png).unwrap();
    std::fs::write(folder.path().join("a.mtl"), MTL).unwrap();
    attack_file(folder.path(), "a.obj", "a.obj", &[OBJ.to_vec()], Kind::Text);
    std::fs::write(folder.path().join("a.obj"), OBJ).unwrap();
    attack_file(folder.path(), "a.mtl", "a.obj", &[MTL.to_vec()], Kind::Text);
}

#[test]
fn changed_environment_maps_are_harmless() {
    use exr::prelude::{Image, SpecificChannels, Vec2, WritableImage as _};
    let folder = folder();
    let channels = SpecificChannels::rgb(|at: Vec2<usize>| (at.x() as f32, 0.5, at.y() as f32));
    let image = Image::from_channels((8, 4), channels);
    image
        .write()
        .to_file(folder.path().join("seed.exr"))
        .unwrap();
    let seed = std::fs::read(folder.path().join("seed.exr")).unwrap();
    let scene = json!({
        "version": 1,
        "camera": {"position": [0, 0, 3], "target": [0, 0, 0]},
        "lights": [{"kind": "environment", "radiance": 1, "map": "a.exr"}],
    });
    std::fs::write(folder.path().join("a.json"), scene.to_string()).unwrap();
    attack_file(folder.path(), "a.exr", "a.json", &[seed], Kind::Binary);
}

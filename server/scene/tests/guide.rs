//! The examples in README.md and docs/scene.md load, or are refused with the message beside them.
//!
//! Each fenced JSON block says after `json` what it is: a whole `scene`, a part of one by its member's
//! name, or the description of `raw` voxels. With `refused` behind that, the next block is the error.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests, too, fail by unwrapping"
)]

use crate::support;

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::{Value, json};
use tyndall_scene::{Limits, SceneDescription, build_with, json_schema};

/// A fenced block of a document.
#[derive(Debug, Clone)]
struct Block {
    /// Document and line, for messages.
    place: String,
    /// What stands behind the opening fence.
    info: String,
    text: String,
}

fn blocks(document: &str) -> Vec<Block> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(document);
    blocks_of(document, &std::fs::read_to_string(path).unwrap())
}

fn blocks_of(document: &str, text: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut open: Option<Block> = None;
    for (index, line) in text.lines().enumerate() {
        match (line.trim().strip_prefix("```"), &mut open) {
            (Some(info), None) => {
                open = Some(Block {
                    place: format!("{document}:{}", index + 1),
                    info: info.to_owned(),
                    text: String::new(),
                });
            }
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (None, Some(block)) => {
                block.text.push_str(line);
                block.text.push('\n');
            }
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "{document} ends inside a fenced block");
    blocks
}

/// A folder with every file that an example names.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    let volumes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../volume/tests/fixtures");
    write(
        "smoke.vdb",
        &std::fs::read(volumes.join("small.vdb")).unwrap(),
    );
    write("chair.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let positions: Vec<u8> = [0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
        .iter()
        .flat_map(|coordinate| coordinate.to_le_bytes())
        .collect();
    let model = json!({
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": positions.len()}],
        "bufferViews": [{"buffer": 0, "byteLength": positions.len()}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                       "min": [0, 0, 0], "max": [1, 1, 0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
        "scene": 0,
    });
    write("hall.glb", &support::glb(&model.to_string(), &positions));
    image::RgbImage::new(2, 2)
        .save(folder.path().join("wall.png"))
        .unwrap();
    let mut sky = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n".to_vec();
    sky.extend([128; 8]);
    write("sky.hdr", &sky);
    folder
}

/// The scene that a block shows, whole or a part of.
fn scene(block: &Block, part: &str) -> Result<String, String> {
    if part == "scene" {
        return Ok(block.text.clone());
    }
    let mut scene = json!({
        "version": 1,
        "camera": {"position": [0, 1, 4], "target": [0, 1, 0]},
    });
    if !["camera", "geometry", "lights", "media", "render"].contains(&part) {
        return Err(format!("is marked `{}`, which is no part", block.info));
    }
    let value: Value = serde_json::from_str(&block.text).map_err(|error| error.to_string())?;
    scene[part] = value;
    Ok(scene.to_string())
}

/// A scene with the voxels that a block describes, beside which these are written.
fn raw_voxels(block: &Block, folder: &Path) -> Result<String, String> {
    let sidecar: Value = serde_json::from_str(&block.text).map_err(|error| error.to_string())?;
    let size = sidecar.get("size").or_else(|| sidecar.get("dims_xyz"));
    let sides: Vec<u64> = serde_json::from_value(size.cloned().unwrap_or_default())
        .map_err(|error| error.to_string())?;
    let number = sidecar.get("type").or_else(|| sidecar.get("dtype"));
    let number = number.and_then(Value::as_str).unwrap_or_default();
    let bytes = match number.split(' ').next() {
        Some("u8") => 1,
        Some("float32") => 4,
        _ => return Err(format!("the length of {number} is unknown here")),
    };
    let voxels = vec![0; usize::try_from(bytes * sides.iter().product::<u64>()).unwrap()];
    std::fs::write(folder.join("fog.raw"), voxels).unwrap();
    std::fs::write(folder.join("fog.raw.json"), &block.text).unwrap();
    let scene = json!({
        "version": 1,
        "camera": {"position": [0, 1, 4], "target": [0, 1, 0]},
        "media": [{"kind": "grid", "path": "fog.raw", "sigma_t": 1, "albedo": 1}],
    });
    Ok(scene.to_string())
}

fn load(text: &str, folder: &Path) -> Result<(), String> {
    SceneDescription::from_json(text)
        .and_then(|description| build_with(description, Some(folder), &Limits::default()))
        .map(|_| ())
        .map_err(|error| error.to_string())
}

/// What is wrong with the example at `index`; nothing if the block is no JSON.
fn complaint(blocks: &[Block], index: usize, folder: &Path) -> Option<String> {
    let block = &blocks[index];
    let words: Vec<&str> = block.info.split_whitespace().collect();
    let (part, refused) = match words[..] {
        ["json", part] => (part, false),
        ["json", part, "refused"] => (part, true),
        ["json", ..] => return Some(format!("{}: does not say what it is", block.place)),
        _ => return None,
    };
    let text = match part {
        "raw" => raw_voxels(block, folder),
        _ => scene(block, part),
    };
    let found = text.and_then(|text| load(&text, folder));
    let wrong = if refused {
        let expected = blocks.get(index + 1).map_or("", |next| next.text.trim());
        match found {
            Ok(()) => Some("is not refused".to_owned()),
            Err(error) if error == expected => None,
            Err(error) => Some(format!("is refused with {error}")),
        }
    } else {
        found.err()
    };
    wrong.map(|wrong| format!("{}: {wrong}", block.place))
}

#[test]
fn examples_load_or_are_refused_as_they_say() {
    let folder = folder();
    for (document, least) in [("README.md", 2), ("docs/scene.md", 15)] {
        let blocks = blocks(document);
        let examples = blocks
            .iter()
            .filter(|block| block.info.starts_with("json"))
            .count();
        assert!(examples >= least, "{document} has {examples} examples");
        let complaints: Vec<String> = (0..blocks.len())
            .filter_map(|index| complaint(&blocks, index, folder.path()))
            .collect();
        assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    }
}

#[test]
fn wrong_examples_are_found() {
    let folder = folder();
    for (text, part) in [
        ("```json\n{}\n```", "does not say"),
        ("```json medium\n{}\n```", "no part"),
        ("```json scene\n{\"version\": 1}\n```", "camera"),
        ("```json camera\n{\"position\": [0, 1, 4]}\n```", "target"),
        (
            "```json geometry\n[{\"kind\": \"obj\", \"path\": \"gone.obj\"}]\n```",
            "gone.obj",
        ),
        ("```json lights refused\n[]\n```", "not refused"),
        (
            "```json media refused\n[{\"kind\": \"fog\"}]\n```\n```text\nanother error\n```",
            "is refused with",
        ),
        (
            "```json raw\n{\"size\": [2, 2], \"type\": \"u8\"}\n```",
            "description",
        ),
    ] {
        let blocks = blocks_of("a.md", text);
        let complaint = complaint(&blocks, 0, folder.path()).unwrap_or_default();
        assert!(complaint.contains(part), "{text}: {complaint}");
    }
}

#[test]
fn every_kind_has_an_example_in_the_guide() {
    let mut shown = BTreeSet::new();
    for block in blocks("docs/scene.md") {
        if block.info.starts_with("json") && !block.info.ends_with("refused") {
            kinds(&serde_json::from_str(&block.text).unwrap(), "", &mut shown);
        }
    }
    let mut all = BTreeSet::new();
    kinds(&json_schema(), "const", &mut all);
    assert!(all.len() > 12, "{all:?}");
    let missing: Vec<&String> = all.difference(&shown).collect();
    assert!(missing.is_empty(), "no example of {missing:?}");
}

/// Collects the values of all members `kind`; in a schema, of the `member` inside them.
fn kinds(value: &Value, member: &str, found: &mut BTreeSet<String>) {
    match value {
        Value::Object(members) => {
            let kind = members.get("kind");
            let kind = kind.and_then(|kind| kind.get(member).or(Some(kind)));
            found.extend(kind.and_then(Value::as_str).map(str::to_owned));
            members
                .values()
                .for_each(|value| kinds(value, member, found));
        }
        Value::Array(elements) => elements
            .iter()
            .for_each(|value| kinds(value, member, found)),
        _ => {}
    }
}

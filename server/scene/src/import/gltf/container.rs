//! The outermost layer of a file: GLB chunks or plain JSON.

use gltf::json::Root;
use gltf::json::extensions::texture::Info;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use tyndall_files::guarded;

use super::file::File;
use crate::error::{SceneError, abbreviate};

/// A parsed file before its buffers.
pub(super) struct Container {
    pub(super) root: Root,
    /// Extensions of each material's normal texture, which the crate reads of other textures only.
    pub(super) normal_extensions: Vec<Option<Info>>,
    /// The BIN chunk of a GLB.
    pub(super) blob: Option<Vec<u8>>,
}

/// The part of a file that [`Root`] leaves out.
#[derive(Deserialize)]
struct LeftOut {
    #[serde(default)]
    materials: Vec<LeftOutMaterial>,
}

#[derive(Deserialize)]
struct LeftOutMaterial {
    #[serde(default, rename = "normalTexture")]
    normal_texture: Option<LeftOutTexture>,
}

#[derive(Deserialize)]
struct LeftOutTexture {
    #[serde(default)]
    extensions: Option<Info>,
}

/// Length of the header of a GLB and of the header of a chunk. Unit: byte.
const GLB_HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

/// Reads a `.glb` by its magic, anything else as JSON.
pub(super) fn read(file: &File, bytes: &[u8]) -> Result<Container, SceneError> {
    if !bytes.starts_with(b"glTF") {
        return both(file, bytes, None);
    }
    let word = |at: usize| -> Option<usize> {
        let word = bytes.get(at..at.checked_add(4)?)?;
        Some(u32::from_le_bytes(word.try_into().ok()?) as usize)
    };
    let refused = |message: &str| file.refused("GLB", message);
    let version = word(4).ok_or_else(|| refused("the header is cut off"))?;
    let length = word(8).ok_or_else(|| refused("the header is cut off"))?;
    if version != 2 {
        return Err(refused(&format!("version {version}, allowed 2")));
    }
    if length > bytes.len() || length < GLB_HEADER {
        let message = format!(
            "the header says {length} bytes, the file has {}",
            bytes.len()
        );
        return Err(refused(&message));
    }

    let (mut json, mut blob) = (None, None);
    let mut at = GLB_HEADER;
    // Padding after the last chunk may be too short for another header.
    while at + CHUNK_HEADER <= length {
        let size = word(at).ok_or_else(|| refused("a chunk header is cut off"))?;
        let start = at + CHUNK_HEADER;
        let end = start.checked_add(size).filter(|end| *end <= length);
        let end = end.ok_or_else(|| {
            refused(&format!(
                "the chunk at byte {at} says {size} bytes, {} are left",
                length - start
            ))
        })?;
        let kind = &bytes[at + 4..start];
        match (kind, &json, &blob) {
            (b"JSON", None, _) => json = Some(&bytes[start..end]),
            (b"BIN\0", Some(_), None) => blob = Some(bytes[start..end].to_vec()),
            (_, None, _) => return Err(refused("the first chunk is not JSON")),
            // Others are to be ignored.
            _ => {}
        }
        at = end.next_multiple_of(4);
    }
    let json = json.ok_or_else(|| refused("there is no JSON chunk"))?;
    both(file, json, blob)
}

/// What the crate reads of the JSON, and what it leaves out.
fn both(file: &File, json: &[u8], blob: Option<Vec<u8>>) -> Result<Container, SceneError> {
    let parsed = guarded("glTF", || (parse(json), parse(json)));
    let (root, left_out) = parsed.map_err(|failed| file.refused("JSON", failed.to_string()))?;
    let root = root.map_err(|error| refused(file, &error))?;
    let left_out: LeftOut = left_out.map_err(|error| refused(file, &error))?;
    let extensions = |material: LeftOutMaterial| material.normal_texture?.extensions;
    Ok(Container {
        root,
        normal_extensions: left_out.materials.into_iter().map(extensions).collect(),
        blob,
    })
}

type ParseError = serde_path_to_error::Error<serde_json::Error>;

fn parse<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, ParseError> {
    let mut deserializer = serde_json::Deserializer::from_slice(bytes);
    serde_path_to_error::deserialize(&mut deserializer)
}

fn refused(file: &File, error: &ParseError) -> SceneError {
    let path = error.path().to_string();
    let location = if path == "." { "JSON".to_owned() } else { path };
    let message = error.inner().to_string();
    // The path says more than the line of a text that people rarely see.
    let message = message.split(" at line ").next().unwrap_or(&message);
    file.refused(location, abbreviate(message))
}

//! The bytes of all buffers of a file.

use gltf::json::Root;

use super::file::File;
use super::uri;
use crate::error::SceneError;
use crate::import::importer::Importer;

/// The bytes of all buffers, each cut to its declared length.
pub(super) struct Buffers(pub(super) Vec<Vec<u8>>);

impl Buffers {
    /// Reads all buffers of a file.
    pub(super) fn load(
        file: &File,
        root: &Root,
        blob: Option<Vec<u8>>,
        importer: &Importer,
    ) -> Result<Self, SceneError> {
        let mut blob = blob;
        let mut buffers = Vec::new();
        for (i, buffer) in root.buffers.iter().enumerate() {
            let location = format!("buffers[{i}]");
            let mut bytes = match &buffer.uri {
                Some(text) => uri::read(file, importer, text, &format!("{location}.uri"))?,
                None if i == 0 => blob.take().ok_or_else(|| {
                    file.refused(&location, "has no uri, and the file has no BIN chunk")
                })?,
                None => return Err(file.refused(&location, "has no uri")),
            };
            let length = buffer.byte_length.0;
            if length > bytes.len() as u64 {
                let found = bytes.len();
                return Err(file.refused(
                    format!("{location}.byteLength"),
                    format!("{length} bytes, but there are {found}"),
                ));
            }
            bytes.truncate(usize::try_from(length).unwrap_or(usize::MAX));
            buffers.push(bytes);
        }
        Ok(Self(buffers))
    }
}

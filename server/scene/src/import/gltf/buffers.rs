//! Buffers and the views into them.

use gltf::json::Root;

use super::{Document, File, uri};
use crate::error::SceneError;
use crate::import::Importer;

/// The bytes of all buffers, each cut to its declared length.
pub(super) struct Buffers(Vec<Vec<u8>>);

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

/// The bytes of a buffer view.
#[derive(Debug, Clone, Copy)]
pub(super) struct View<'a> {
    pub(super) bytes: &'a [u8],
    /// Distance from element to element, if the view gives one. Unit: byte.
    pub(super) stride: Option<usize>,
}

impl<'a> Document<'a> {
    /// The view at `index`, its range checked.
    pub(super) fn view(&self, index: usize, location: &str) -> Result<View<'a>, SceneError> {
        let root = self.root;
        let view = self
            .file
            .element(&root.buffer_views, "bufferViews", index, location)?;
        let place = format!("bufferViews[{index}]");
        let buffer = view.buffer.value();
        let bytes = self
            .file
            .element(&self.buffers.0, "buffers", buffer, &place)?;
        let start = view.byte_offset.map_or(0, |offset| offset.0);
        let range = start
            .checked_add(view.byte_length.0)
            .and_then(|end| Some(usize::try_from(start).ok()?..usize::try_from(end).ok()?));
        let bytes = range.and_then(|range| bytes.get(range)).ok_or_else(|| {
            let message = format!(
                "{} bytes from byte {start} leave buffers[{buffer}], which has {}",
                view.byte_length.0,
                bytes.len()
            );
            self.file.refused(&place, message)
        })?;
        Ok(View {
            bytes,
            stride: view.byte_stride.map(|stride| stride.0),
        })
    }
}

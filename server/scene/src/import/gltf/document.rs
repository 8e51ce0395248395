//! A parsed file with its buffers, and the views into them.

use gltf::json::Root;

use super::buffers::Buffers;
use super::file::File;
use crate::error::SceneError;

/// A file with its buffers.
pub(super) struct Document<'a> {
    pub(super) file: &'a File<'a>,
    pub(super) root: &'a Root,
    /// Of each material's normal texture.
    pub(super) normal_extensions: &'a [Option<gltf::json::extensions::texture::Info>],
    pub(super) buffers: &'a Buffers,
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

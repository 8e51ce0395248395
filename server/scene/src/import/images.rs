//! Images of files and `data:` URIs, decoded within limits.

use std::io::Cursor;

use image::{ImageFormat, ImageReader};

use crate::error::SceneError;
use crate::limits::{Limits, limit};
use crate::scene::{ColorSpace, Wrap};

/// What a texture was made from: uses that agree share the texture.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct Key {
    pub(super) identity: String,
    pub(super) color_space: ColorSpace,
    pub(super) wrap: [Wrap; 2],
}

/// Where an image comes from, for messages; unique in the scene.
#[derive(Debug, Clone)]
pub(super) struct Source {
    /// JSON path that led here.
    pub(super) path: String,
    /// The file that names the image.
    pub(super) file: String,
    /// Where in the file.
    pub(super) location: String,
}

/// An encoded image.
#[derive(Debug)]
pub(super) struct Image {
    pub(super) source: Source,
    /// PNG or JPEG.
    pub(super) bytes: Vec<u8>,
}

impl Image {
    fn refused(&self, message: String) -> SceneError {
        let source = self.source.clone();
        SceneError::Model {
            path: source.path,
            file: source.file,
            location: source.location,
            message,
        }
    }

    /// Decodes to width, height and RGBA; the size is checked before memory is taken. `total` counts the
    /// pixels of all images.
    pub(super) fn decode(
        &self,
        limits: &Limits,
        total: &mut u64,
    ) -> Result<(u32, u32, Vec<u8>), SceneError> {
        let format = image::guess_format(&self.bytes).ok();
        let Some(format @ (ImageFormat::Png | ImageFormat::Jpeg)) = format else {
            return Err(self.refused("neither PNG nor JPEG".to_owned()));
        };
        let reader = || {
            let mut reader = ImageReader::with_format(Cursor::new(&self.bytes), format);
            let mut most = image::Limits::default();
            most.max_image_width = Some(limits.texture_side);
            most.max_image_height = Some(limits.texture_side);
            reader.limits(most);
            reader
        };
        let (width, height) = reader()
            .into_dimensions()
            .map_err(|error| self.refused(error.to_string()))?;
        let side = limits.texture_side;
        if width > side || height > side || width == 0 || height == 0 {
            return Err(self.refused(format!(
                "{width}×{height} pixels, allowed 1 to {side} a side"
            )));
        }
        let pixels = u64::from(width) * u64::from(height);
        *total = total.saturating_add(pixels);
        limit(
            &self.source.path,
            "the number of pixels of all textures",
            *total,
            limits.texture_pixels,
        )?;
        let decoded = reader()
            .decode()
            .map_err(|error| self.refused(error.to_string()))?;
        Ok((width, height, decoded.into_rgba8().into_raw()))
    }
}

//! Images of files and `data:` URIs, decoded within limits.

use tyndall_files::{ImageError, ImageLimits, decode_image};

use crate::error::SceneError;
use crate::limits::Limits;
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
        let most = ImageLimits {
            side: limits.texture_side,
            pixels: limits.texture_pixels.saturating_sub(*total),
        };
        let decoded = decode_image(&self.bytes, most).map_err(|error| match error {
            ImageError::Pixels { found, .. } => SceneError::Limit {
                path: self.source.path.clone(),
                what: "the number of pixels of all textures",
                found: total.saturating_add(found),
                limit: limits.texture_pixels,
            },
            other => self.refused(other.to_string()),
        })?;
        let (width, height) = (decoded.width(), decoded.height());
        *total = total.saturating_add(u64::from(width) * u64::from(height));
        Ok((width, height, decoded.into_rgba8().into_raw()))
    }
}

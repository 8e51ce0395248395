//! Images of files and `data:` URIs, decoded within limits.

use std::io::Cursor;

use image::{ImageFormat, ImageReader};

use super::{Importer, limit};
use crate::error::SceneError;
use crate::geometry::{ColorSpace, Texture, Wrap};

/// What a texture was made from: uses that agree share the texture.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct Key {
    identity: String,
    color_space: ColorSpace,
    wrap: [Wrap; 2],
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
}

impl Importer<'_> {
    /// The index of the texture of an image, read and decoded at its first use.
    pub(super) fn texture(
        &mut self,
        source: Source,
        color_space: ColorSpace,
        wrap: [Wrap; 2],
        read: impl FnOnce(&Self, Source) -> Result<Image, SceneError>,
    ) -> Result<usize, SceneError> {
        let name = format!("{} {}", source.file, source.location);
        let key = Key {
            // Images of glTF files are numbered; files are the same wherever they are named.
            identity: name.clone(),
            color_space,
            wrap,
        };
        if let Some(index) = self.textures.get(&key) {
            return Ok(*index);
        }
        let image = read(self, source)?;
        let (width, height, pixels) = self.decode(&image)?;
        self.geometry.textures.push(Texture {
            name,
            width,
            height,
            pixels,
            color_space,
            wrap,
        });
        let index = self.geometry.textures.len() - 1;
        self.textures.insert(key, index);
        Ok(index)
    }

    /// The texture of an image file.
    pub(super) fn texture_file(
        &mut self,
        path: &str,
        file: &str,
        color_space: ColorSpace,
    ) -> Result<usize, SceneError> {
        let source = Source {
            path: path.to_owned(),
            file: file.to_owned(),
            location: "image".to_owned(),
        };
        self.texture(
            source,
            color_space,
            [Wrap::Repeat; 2],
            |importer, source| {
                let bytes = importer.folder.read(&source.path, &source.file)?;
                Ok(Image { source, bytes })
            },
        )
    }

    /// Decodes to RGBA; the size is checked before memory is taken.
    fn decode(&mut self, image: &Image) -> Result<(u32, u32, Vec<u8>), SceneError> {
        let format = image::guess_format(&image.bytes).ok();
        let Some(format @ (ImageFormat::Png | ImageFormat::Jpeg)) = format else {
            return Err(image.refused("neither PNG nor JPEG".to_owned()));
        };
        let reader = || {
            let mut reader = ImageReader::with_format(Cursor::new(&image.bytes), format);
            let mut limits = image::Limits::default();
            limits.max_image_width = Some(self.limits.texture_side);
            limits.max_image_height = Some(self.limits.texture_side);
            reader.limits(limits);
            reader
        };
        let (width, height) = reader()
            .into_dimensions()
            .map_err(|error| image.refused(error.to_string()))?;
        let side = self.limits.texture_side;
        if width > side || height > side || width == 0 || height == 0 {
            return Err(image.refused(format!(
                "{width}×{height} pixels, allowed 1 to {side} a side"
            )));
        }
        let pixels = u64::from(width) * u64::from(height);
        self.texture_pixels = self.texture_pixels.saturating_add(pixels);
        limit(
            &image.source.path,
            "the number of pixels of all textures",
            self.texture_pixels,
            self.limits.texture_pixels,
        )?;
        let decoded = reader()
            .decode()
            .map_err(|error| image.refused(error.to_string()))?;
        Ok((width, height, decoded.into_rgba8().into_raw()))
    }
}

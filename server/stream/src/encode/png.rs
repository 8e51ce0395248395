//! PNG for pictures that no longer change: lossless, decoded by every browser.
//!
//! Alpha is always opaque, so three channels are written. `Fast` compression is ten to twenty
//! times quicker than the default for files about a tenth larger.

use super::{EncodeError, Picture};

/// Keeps the buffer of RGB rows between frames.
#[derive(Debug, Default)]
pub(super) struct PngEncoder {
    rgb: Vec<u8>,
}

impl PngEncoder {
    pub(super) fn encode(
        &mut self,
        picture: Picture<'_>,
        out: &mut Vec<u8>,
    ) -> Result<(), EncodeError> {
        self.rgb.clear();
        self.rgb.reserve(picture.rgba.len() / 4 * 3);
        for pixel in picture.rgba.chunks_exact(4) {
            self.rgb.extend_from_slice(&pixel[..3]);
        }
        let mut encoder = png::Encoder::new(out, picture.width, picture.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Fast);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.rgb)?;
        writer.finish()?;
        Ok(())
    }
}

//! JPEG by libjpeg-turbo: two to four times faster than the pure-Rust encoders.

use super::{Chroma, EncodeError, Picture};

/// A compressor that is used again for every frame.
#[derive(Debug)]
pub(super) struct JpegEncoder {
    compressor: turbojpeg::Compressor,
}

impl JpegEncoder {
    pub(super) fn new() -> Result<Self, EncodeError> {
        Ok(Self {
            compressor: turbojpeg::Compressor::new()?,
        })
    }

    pub(super) fn encode(
        &mut self,
        picture: Picture<'_>,
        quality: u8,
        chroma: Chroma,
        out: &mut Vec<u8>,
    ) -> Result<(), EncodeError> {
        if !(1..=100).contains(&quality) {
            return Err(EncodeError::Quality { found: quality });
        }
        self.compressor.set_quality(i32::from(quality))?;
        self.compressor.set_subsamp(match chroma {
            Chroma::Quarter => turbojpeg::Subsamp::Sub2x2,
            Chroma::Full => turbojpeg::Subsamp::None,
        })?;
        let width = picture.width as usize;
        let compressed = self.compressor.compress_to_owned(turbojpeg::Image {
            pixels: picture.rgba,
            width,
            pitch: width * 4,
            height: picture.height as usize,
            format: turbojpeg::PixelFormat::RGBX,
        })?;
        out.extend_from_slice(&compressed);
        Ok(())
    }
}

//! PNG, JPEG and Radiance files of strangers.

use std::io::Cursor;

use image::codecs::hdr::HdrDecoder;
use image::{DynamicImage, ImageDecoder as _, ImageFormat, ImageReader};

use crate::guard::{DecoderFailed, guarded};

/// How large a picture may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ImageLimits {
    /// Longest side. Unit: pixel.
    pub side: u32,
    /// All pixels.
    pub pixels: u64,
}

/// Why a picture was not decoded.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// It is of another format.
    #[error("neither {allowed}")]
    Format {
        /// The formats that are read here, in words.
        allowed: &'static str,
    },
    /// It has no pixels, or a side is too long.
    #[error("{width}×{height} pixels, allowed 1 to {side} a side")]
    Side {
        /// Unit: pixel.
        width: u32,
        /// Unit: pixel.
        height: u32,
        /// Longest side. Unit: pixel.
        side: u32,
    },
    /// It has too many pixels.
    #[error("{found} pixels, allowed {limit}")]
    Pixels {
        /// How many it has.
        found: u64,
        /// How many it may have.
        limit: u64,
    },
    /// It does not follow its format.
    #[error(transparent)]
    Broken(#[from] image::ImageError),
    /// The decoder is at fault.
    #[error(transparent)]
    Decoder(#[from] DecoderFailed),
}

/// Decodes a PNG or JPEG, by its first bytes.
///
/// # Errors
/// [`ImageError`], before memory is taken for a picture that is too large.
pub fn decode_image(bytes: &[u8], limits: ImageLimits) -> Result<DynamicImage, ImageError> {
    let format = image::guess_format(bytes).ok();
    let Some(format @ (ImageFormat::Png | ImageFormat::Jpeg)) = format else {
        return Err(ImageError::Format {
            allowed: "PNG nor JPEG",
        });
    };
    let reader = || {
        let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
        let mut most = image::Limits::default();
        // Up to four channels of 16 bits, twice while they are converted.
        most.max_alloc = Some(limits.pixels.saturating_mul(16));
        reader.limits(most);
        reader
    };
    guarded("PNG and JPEG", || {
        let (width, height) = reader().into_dimensions()?;
        check(width, height, limits)?;
        Ok(reader().decode()?)
    })?
}

/// Decodes a Radiance picture, and gives the exposure that its header names, if it names one.
///
/// # Errors
/// [`ImageError`], before memory is taken for a picture that is too large.
pub fn decode_radiance(
    bytes: &[u8],
    limits: ImageLimits,
) -> Result<(DynamicImage, Option<f32>), ImageError> {
    guarded("Radiance", || {
        let decoder = HdrDecoder::new(Cursor::new(bytes))?;
        let (width, height) = decoder.dimensions();
        check(width, height, limits)?;
        let exposure = decoder.metadata().exposure;
        Ok((DynamicImage::from_decoder(decoder)?, exposure))
    })?
}

fn check(width: u32, height: u32, limits: ImageLimits) -> Result<(), ImageError> {
    let ImageLimits { side, pixels } = limits;
    if width == 0 || height == 0 || width > side || height > side {
        return Err(ImageError::Side {
            width,
            height,
            side,
        });
    }
    let found = u64::from(width) * u64::from(height);
    if found > pixels {
        let limit = pixels;
        return Err(ImageError::Pixels { found, limit });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: ImageLimits = ImageLimits {
        side: 4096,
        pixels: 1 << 20,
    };

    /// A PNG of one palette pixel whose palette is cut off within a colour.
    fn cut_palette() -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_palette(vec![1, 2, 3, 4]);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(&[1]).unwrap();
        writer.finish().unwrap();
        bytes
    }

    #[test]
    fn a_palette_that_is_no_multiple_of_three_is_an_error() {
        let error = decode_image(&cut_palette(), LIMITS)
            .unwrap_err()
            .to_string();
        assert!(error.contains("PNG") && !error.contains('\n'), "{error}");
    }

    #[test]
    fn pictures_are_refused_by_their_size_before_they_are_decoded() {
        let mut bytes = Vec::new();
        let encoder = png::Encoder::new(&mut bytes, 100, 50);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(&[9; 5000]).unwrap();
        writer.finish().unwrap();
        assert_eq!(decode_image(&bytes, LIMITS).unwrap().width(), 100);
        let text = |side, pixels| {
            let error = decode_image(&bytes, ImageLimits { side, pixels });
            error.unwrap_err().to_string()
        };
        assert_eq!(text(99, 1 << 20), "100×50 pixels, allowed 1 to 99 a side");
        assert_eq!(text(4096, 4999), "5000 pixels, allowed 4999");
        let other = decode_image(b"GIF89a", LIMITS).unwrap_err();
        assert_eq!(other.to_string(), "neither PNG nor JPEG");
    }
}

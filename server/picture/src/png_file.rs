//! 8-bit sRGB as PNG.

use std::path::Path;

use crate::PictureError;

/// PNG bytes of `pixels`, row by row from the top.
///
/// # Errors
/// [`PictureError::Png`] if their count is not `width` × `height`.
pub fn encode_png(width: u32, height: u32, pixels: &[[u8; 3]]) -> Result<Vec<u8>, PictureError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels.as_flattened())?;
    writer.finish()?;
    Ok(bytes)
}

/// Writes `pixels` to a PNG file.
///
/// # Errors
/// As [`encode_png`], and [`PictureError::Io`].
pub fn write_png(
    path: &Path,
    width: u32,
    height: u32,
    pixels: &[[u8; 3]],
) -> Result<(), PictureError> {
    let bytes = encode_png(width, height, pixels)?;
    std::fs::write(path, bytes).map_err(|error| PictureError::io(path, error))
}

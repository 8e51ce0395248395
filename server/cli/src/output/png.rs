//! The displayed picture as PNG.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use tyndall_render::Still;

/// Writes 8-bit sRGB.
pub fn write(path: &Path, still: &Still) -> anyhow::Result<()> {
    let frame = &still.frame;
    let mut encoder = png::Encoder::new(
        BufWriter::new(File::create(path)?),
        frame.width,
        frame.height,
    );
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    let rgb: Vec<u8> = frame
        .rgba
        .chunks_exact(4)
        .flat_map(|pixel| [pixel[0], pixel[1], pixel[2]])
        .collect();
    writer.write_image_data(&rgb)?;
    writer.finish()?;
    Ok(())
}

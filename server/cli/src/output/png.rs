//! The displayed picture as PNG.

use std::path::Path;

use tyndall_picture::write_png;
use tyndall_render::Still;

/// Writes 8-bit sRGB.
pub fn write(path: &Path, still: &Still) -> anyhow::Result<()> {
    let frame = &still.frame;
    let pixels: Vec<[u8; 3]> = frame
        .rgba
        .chunks_exact(4)
        .map(|pixel| [pixel[0], pixel[1], pixel[2]])
        .collect();
    write_png(path, frame.width, frame.height, &pixels)?;
    Ok(())
}

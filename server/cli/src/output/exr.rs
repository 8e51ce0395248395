//! A still as layered OpenEXR.

use std::path::Path;

use tyndall_picture::{Layers, Metadata, write_exr};
use tyndall_render::Still;

/// Writes every plane that the still has, and where it comes from.
pub fn write(path: &Path, still: &Still, metadata: &Metadata) -> anyhow::Result<()> {
    write_exr(path, &layers(still), metadata)?;
    Ok(())
}

fn rgb(pixels: &[[f32; 4]]) -> Vec<[f32; 3]> {
    pixels.iter().map(|p| [p[0], p[1], p[2]]).collect()
}

fn layers(still: &Still) -> Layers {
    Layers {
        width: still.frame.width,
        height: still.frame.height,
        beauty: rgb(&still.radiance),
        base: still.base.as_deref().map(rgb),
        traced: still.traced.as_deref().map(rgb),
        estimated_error: still
            .square_error
            .as_ref()
            .map(|errors| errors.iter().map(|e| e.sqrt()).collect()),
        transmittance: Some(still.radiance.iter().map(|p| p[3]).collect()),
        variance: still.variance.clone(),
        samples: still.samples_per_pixel.clone(),
        depth: still.depth.clone(),
        normal: still.normal.clone(),
        albedo: still.albedo.clone(),
    }
}

//! Linear radiance and transmittance as OpenEXR.

use std::path::Path;

use exr::prelude::*;
use tyndall_render::Still;
use tyndall_scene::Scene;

/// Writes channels R, G, B (radiance, W·m⁻²·sr⁻¹) and T (mean transmittance), 32-bit float, with the
/// scene's name, samples and seed as attributes.
pub fn write(path: &Path, scene: &Scene, still: &Still) -> anyhow::Result<()> {
    let (width, height) = (still.frame.width as usize, still.frame.height as usize);
    let channel = |name: &str, index: usize| AnyChannel {
        name: Text::from(name),
        sample_data: FlatSamples::F32(still.radiance.iter().map(|pixel| pixel[index]).collect()),
        quantize_linearly: false,
        sampling: Vec2(1, 1),
    };
    let channels = AnyChannels::sort(
        [
            channel("R", 0),
            channel("G", 1),
            channel("B", 2),
            channel("T", 3),
        ]
        .into_iter()
        .collect(),
    );
    let mut attributes = LayerAttributes::named("beauty");
    attributes.software_name = Some(Text::from(concat!("tyndall ", env!("CARGO_PKG_VERSION"))));
    let text = |value: &str| AttributeValue::Text(Text::from(value));
    attributes.other.extend([
        (Text::from("tyndall.scene"), text(&scene.name)),
        (
            Text::from("tyndall.samples"),
            AttributeValue::I32(still.frame.samples as i32),
        ),
        (
            Text::from("tyndall.seed"),
            text(&scene.render.seed.to_string()),
        ),
    ]);
    let layer = Layer::new(
        (width, height),
        attributes,
        Encoding::FAST_LOSSLESS,
        channels,
    );
    Image::from_layer(layer).write().to_file(path)?;
    Ok(())
}

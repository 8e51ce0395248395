//! A finished still as the bytes of its file.

use tyndall_picture::{
    Format, Layer, Layers, Metadata, Output, PictureError, encode_exr, encode_png, scene_hash,
};
use tyndall_render::Still;
use tyndall_scene::{Scene, SceneDescription};
use tyndall_stream::encode::{Chroma, EncodeChoice, EncodeError, Encoder, Picture};

/// Of JPEG files.
const JPEG_QUALITY: u8 = 95;

/// A still and where it comes from.
#[derive(Debug, Clone)]
pub struct FinishedStill {
    /// The picture.
    pub still: Still,
    /// Written into files that have room for it.
    pub metadata: Metadata,
}

impl FinishedStill {
    /// A still of a scene of this description, rendered by the adapter and driver of these names.
    ///
    /// # Errors
    /// [`EncodeFailed::Picture`] where the description has a number that is not finite.
    pub fn new(
        still: Still,
        description: &SceneDescription,
        scene: &Scene,
        (adapter, driver): (&str, &str),
    ) -> Result<Self, EncodeFailed> {
        let metadata = Metadata {
            scene: scene.name.clone(),
            scene_hash: scene_hash(description)?,
            technique: scene.render.technique.name().to_owned(),
            seed: scene.render.seed,
            samples: still.frame.samples,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            adapter: format!("{adapter} ({driver})"),
        };
        Ok(Self { still, metadata })
    }
}

/// Why a still could not be encoded.
#[derive(Debug, thiserror::Error)]
pub enum EncodeFailed {
    /// The PNG or EXR encoder refused.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The JPEG encoder refused.
    #[error(transparent)]
    Jpeg(#[from] EncodeError),
}

/// The bytes of the file that `output` wants.
///
/// # Errors
/// [`EncodeFailed`] when the encoder refuses.
pub fn encode(finished: &FinishedStill, output: &Output) -> Result<Vec<u8>, EncodeFailed> {
    let frame = &finished.still.frame;
    match output.format {
        Format::Exr => {
            let layers = layers(&finished.still, output);
            Ok(encode_exr(&layers, &finished.metadata)?)
        }
        Format::Png => {
            let shown = frame.rgba.chunks_exact(4);
            let pixels: Vec<[u8; 3]> = shown.map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
            Ok(encode_png(frame.width, frame.height, &pixels)?)
        }
        Format::Jpeg => {
            let picture = Picture {
                width: frame.width,
                height: frame.height,
                rgba: &frame.rgba,
            };
            let choice = EncodeChoice::Jpeg {
                quality: JPEG_QUALITY,
                chroma: Chroma::Full,
            };
            let mut bytes = Vec::new();
            Encoder::new()?.encode(picture, choice, &mut bytes)?;
            Ok(bytes)
        }
    }
}

fn rgb(pixels: &[[f32; 4]]) -> Vec<[f32; 3]> {
    pixels.iter().map(|p| [p[0], p[1], p[2]]).collect()
}

/// The planes that the still has and the output wants.
fn layers(still: &Still, output: &Output) -> Layers {
    let is = |layer: Layer| output.wants(layer);
    let root = |errors: &Vec<f32>| errors.iter().map(|error| error.sqrt()).collect();
    let transmittance = || still.radiance.iter().map(|p| p[3]).collect();
    Layers {
        width: still.frame.width,
        height: still.frame.height,
        beauty: rgb(&still.radiance),
        base: still.base.as_deref().filter(|_| is(Layer::Base)).map(rgb),
        traced: still
            .traced
            .as_deref()
            .filter(|_| is(Layer::Traced))
            .map(rgb),
        estimated_error: still
            .square_error
            .as_ref()
            .filter(|_| is(Layer::EstimatedError))
            .map(root),
        transmittance: is(Layer::Transmittance).then(transmittance),
        variance: still.variance.clone().filter(|_| is(Layer::Variance)),
        samples: still
            .samples_per_pixel
            .clone()
            .filter(|_| is(Layer::Samples)),
        depth: still.depth.clone().filter(|_| is(Layer::Depth)),
        normal: still.normal.clone().filter(|_| is(Layer::Normal)),
        albedo: still.albedo.clone().filter(|_| is(Layer::Albedo)),
    }
}

//! Layers as `OpenEXR`: one part, 32-bit float, channels `R G B`, `variance.R` … `albedo.B`.
//!
//! The names follow `OpenEXR`'s convention of `layer.channel`, so viewers group them.

use std::io::Cursor;
use std::path::Path;

use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    Text, Vec2, WritableImage as _,
};

use crate::{Layers, Metadata, PictureError};

/// Writes `layers` and `metadata` to `path`, lossless.
///
/// # Errors
/// As [`encode_exr`], and [`PictureError::Io`].
pub fn write_exr(path: &Path, layers: &Layers, metadata: &Metadata) -> Result<(), PictureError> {
    let bytes = encode_exr(layers, metadata)?;
    std::fs::write(path, bytes).map_err(|source| PictureError::io(path, source))
}

/// The bytes of a file with `layers` and `metadata`, lossless.
///
/// # Errors
/// [`PictureError::Layer`] if a plane has another size, [`PictureError::Content`] if the picture can't be
/// encoded.
pub fn encode_exr(layers: &Layers, metadata: &Metadata) -> Result<Vec<u8>, PictureError> {
    layers.check()?;
    let mut channels = Channels::default();
    channels.rgb(["R", "G", "B"], Some(&layers.beauty));
    channels.rgb(["base.R", "base.G", "base.B"], layers.base.as_ref());
    channels.rgb(["traced.R", "traced.G", "traced.B"], layers.traced.as_ref());
    channels.grey("estimated_error", layers.estimated_error.as_ref());
    channels.grey("transmittance", layers.transmittance.as_ref());
    channels.rgb(
        ["variance.R", "variance.G", "variance.B"],
        layers.variance.as_ref(),
    );
    channels.grey("samples", layers.samples.as_ref());
    channels.grey("depth.Z", layers.depth.as_ref());
    channels.rgb(["normal.X", "normal.Y", "normal.Z"], layers.normal.as_ref());
    channels.rgb(["albedo.R", "albedo.G", "albedo.B"], layers.albedo.as_ref());

    let mut attributes = LayerAttributes::named("tyndall");
    attributes.software_name = Some(text(&format!("tyndall {}", metadata.version)));
    for (name, value) in metadata.entries() {
        let name = text(&format!("tyndall.{name}"));
        // The format has no empty text.
        if !value.is_empty() {
            let value = AttributeValue::Text(text(&value));
            attributes.other.insert(name, value);
        }
    }
    let layer = Layer::new(
        (layers.width as usize, layers.height as usize),
        attributes,
        Encoding::FAST_LOSSLESS,
        AnyChannels::sort(channels.0.into_iter().collect()),
    );
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        .to_buffered(&mut bytes)
        .map_err(|error| PictureError::content(Path::new("OpenEXR"), error))?;
    let mut bytes = bytes.into_inner();
    sort_attributes(&mut bytes);
    Ok(bytes)
}

/// Where the attributes begin, after the magic number and the version. Unit: byte.
const ATTRIBUTES: usize = 8;

/// Brings the attributes of a file of one part into the order of their names: the encoder writes them in
/// another one each time, and the same picture is to have the same bytes. Their order means nothing.
fn sort_attributes(bytes: &mut [u8]) {
    let Some(mut sorted) = attributes(bytes) else {
        return;
    };
    sorted.sort_unstable();
    let sorted: Vec<u8> = sorted.concat();
    bytes[ATTRIBUTES..ATTRIBUTES + sorted.len()].copy_from_slice(&sorted);
}

/// The attributes of a file of one part, each with its name, type and length; `None` if it is cut short.
fn attributes(bytes: &[u8]) -> Option<Vec<&[u8]>> {
    let mut rest = bytes.get(ATTRIBUTES..)?;
    let mut attributes = Vec::new();
    while *rest.first()? != 0 {
        let name = rest.iter().position(|byte| *byte == 0)? + 1;
        let kind = rest.get(name..)?.iter().position(|byte| *byte == 0)? + 1;
        let length = rest.get(name + kind..)?.first_chunk::<4>()?;
        let whole = name + kind + 4 + usize::try_from(u32::from_le_bytes(*length)).ok()?;
        attributes.push(rest.get(..whole)?);
        rest = rest.get(whole..)?;
    }
    Some(attributes)
}

/// The format's text has one byte a character: others become question marks.
fn text(value: &str) -> Text {
    let latin = |c: char| if (c as u32) < 256 { c } else { '?' };
    Text::from(value.chars().map(latin).collect::<String>().as_str())
}

/// Channels gathered so far.
#[derive(Default)]
struct Channels(Vec<AnyChannel<FlatSamples>>);

impl Channels {
    fn grey(&mut self, name: &str, plane: Option<&Vec<f32>>) {
        if let Some(plane) = plane {
            self.add(name, plane.clone());
        }
    }

    fn rgb(&mut self, names: [&str; 3], plane: Option<&Vec<[f32; 3]>>) {
        if let Some(plane) = plane {
            for (c, name) in names.into_iter().enumerate() {
                self.add(name, plane.iter().map(|pixel| pixel[c]).collect());
            }
        }
    }

    fn add(&mut self, name: &str, values: Vec<f32>) {
        self.0.push(AnyChannel {
            name: Text::from(name),
            sample_data: FlatSamples::F32(values),
            quantize_linearly: false,
            sampling: Vec2(1, 1),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_picture_has_the_same_bytes() {
        let layers = Layers {
            width: 2,
            height: 1,
            beauty: vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]],
            ..Layers::default()
        };
        let metadata = Metadata {
            scene: "fog".to_owned(),
            scene_hash: "hash".to_owned(),
            technique: "reference".to_owned(),
            adapter: "none".to_owned(),
            ..Metadata::default()
        };
        let first = encode_exr(&layers, &metadata).unwrap();
        for _ in 0..20 {
            assert!(encode_exr(&layers, &metadata).unwrap() == first);
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        std::fs::write(&path, &first).unwrap();
        let (read, found) = crate::read_exr(&path).unwrap();
        assert_eq!((read.beauty, found.scene), (layers.beauty, metadata.scene));
    }
}

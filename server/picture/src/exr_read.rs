//! `OpenEXR` to layers: this program's files, and the R, G and B of anybody else's.

use std::io::Cursor;
use std::path::Path;

use exr::error::Error;
use exr::prelude::{AttributeValue, ReadChannels as _, ReadLayers as _};
use tyndall_files::{ExrLimits, guarded, read_exr_header};

use crate::error::whole;
use crate::{Layers, Metadata, PictureError};

/// Largest file that is read: 8K with every layer of this program.
const LIMITS: ExrLimits = ExrLimits {
    pixels: 64 << 20,
    channels: 64,
    bytes: 4 << 30,
};

/// Reads the first part of a file.
///
/// # Errors
/// [`PictureError`] if it can't be read, or has neither R, G and B nor Y.
pub fn read_exr(path: &Path) -> Result<(Layers, Metadata), PictureError> {
    let refused = |error| match error {
        Error::Io(source) => PictureError::io(path, source),
        other => PictureError::content(path, other),
    };
    let bytes = whole(path)?;
    read_exr_header(&bytes, LIMITS).map_err(|error| PictureError::content(path, error))?;
    let decode = || {
        let parts = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level();
        let layer = parts.all_channels().first_valid_layer().all_attributes();
        layer.from_buffered(Cursor::new(&bytes))
    };
    let image = guarded("OpenEXR", decode)
        .map_err(|failed| PictureError::content(path, failed))?
        .map_err(refused)?;
    let layer = image.layer_data;
    let plane = |name: &str| -> Option<Vec<f32>> {
        let channels = layer.channel_data.list.iter();
        let mut named = channels.filter(|channel| channel.name.to_string() == name);
        named
            .next()
            .map(|channel| channel.sample_data.values_as_f32().collect())
    };
    let rgb = |names: [&str; 3]| -> Option<Vec<[f32; 3]>> {
        let [r, g, b] = names.map(plane);
        let (r, g, b) = (r?, g?, b?);
        Some(
            r.into_iter()
                .zip(g)
                .zip(b)
                .map(|((r, g), b)| [r, g, b])
                .collect(),
        )
    };
    let grey = || plane("Y").map(|y| y.into_iter().map(|value| [value; 3]).collect());
    let Some(beauty) = rgb(["R", "G", "B"]).or_else(grey) else {
        let found: Vec<String> = layer
            .channel_data
            .list
            .iter()
            .map(|channel| channel.name.to_string())
            .collect();
        return Err(PictureError::content(
            path,
            format_args!("channels {}: expected R, G and B, or Y", found.join(", ")),
        ));
    };
    let layers = Layers {
        width: layer.size.0 as u32,
        height: layer.size.1 as u32,
        beauty,
        base: rgb(["base.R", "base.G", "base.B"]),
        traced: rgb(["traced.R", "traced.G", "traced.B"]),
        estimated_error: plane("estimated_error"),
        // "T" is what versions before the layers wrote.
        transmittance: plane("transmittance").or_else(|| plane("T")),
        variance: rgb(["variance.R", "variance.G", "variance.B"]),
        samples: plane("samples"),
        depth: plane("depth.Z"),
        normal: rgb(["normal.X", "normal.Y", "normal.Z"]),
        albedo: rgb(["albedo.R", "albedo.G", "albedo.B"]),
    };
    layers.check()?;
    let mut metadata = Metadata::default();
    for (name, value) in &layer.attributes.other {
        if let (Some(name), AttributeValue::Text(value)) =
            (name.to_string().strip_prefix("tyndall."), value)
        {
            metadata.set(name, value.to_string());
        }
    }
    Ok((layers, metadata))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::write_exr;

    #[test]
    fn every_layer_and_attribute_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.exr");
        let rgb = |shift: f32| (0..6).map(|i| [shift + i as f32, 0.5, -shift]).collect();
        let grey = |shift: f32| Some((0..6).map(|i| shift * i as f32).collect());
        let layers = Layers {
            width: 3,
            height: 2,
            beauty: rgb(1.0),
            base: Some(rgb(5.0)),
            traced: Some(rgb(6.0)),
            estimated_error: grey(0.3),
            transmittance: grey(0.1),
            variance: Some(rgb(2.0)),
            samples: grey(4.0),
            depth: grey(7.0),
            normal: Some(rgb(3.0)),
            albedo: Some(rgb(0.25)),
        };
        let metadata = Metadata {
            scene: "Halle mit Nebel, größer 霧".into(),
            scene_hash: "00ff".into(),
            technique: "reference".into(),
            seed: u64::MAX,
            samples: 17,
            version: "1.2.3".into(),
            adapter: "llvmpipe (Mesa)".into(),
        };
        write_exr(&path, &layers, &metadata).unwrap();
        let (read, read_metadata) = read_exr(&path).unwrap();
        assert_eq!(read, layers);
        // What the format can't say is replaced.
        assert_eq!(read_metadata.scene, "Halle mit Nebel, größer ?");
        assert_eq!(read_metadata.seed, u64::MAX);
        assert_eq!(read_metadata.scene_hash, "00ff");

        let bare = Layers {
            width: 3,
            height: 2,
            beauty: rgb(1.0),
            ..Layers::default()
        };
        write_exr(&path, &bare, &Metadata::default()).unwrap();
        assert_eq!(read_exr(&path).unwrap().0, bare);
    }

    #[test]
    fn a_file_that_asks_for_terabytes_is_refused_by_its_header() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.exr");
        let layers = Layers {
            width: 1,
            height: 1,
            beauty: vec![[0.5; 3]],
            ..Layers::default()
        };
        write_exr(&path, &layers, &Metadata::default()).unwrap();
        let mut bytes = std::fs::read(&path).unwrap();
        let name = b"dataWindow\0box2i\0";
        let at = bytes.windows(name.len()).position(|window| window == name);
        let corner = at.unwrap() + name.len() + 4 + 8;
        let far = 1_600_000_i32.to_le_bytes();
        bytes[corner..corner + 8].copy_from_slice(&[far, far].concat());
        std::fs::write(&path, bytes).unwrap();
        let error = read_exr(&path).unwrap_err().to_string();
        assert!(error.contains("x.exr: "), "{error}");
        assert!(error.contains("pixels is 2560003200001"), "{error}");
    }

    #[test]
    fn a_layer_of_another_size_is_named() {
        let layers = Layers {
            width: 2,
            height: 2,
            beauty: vec![[0.0; 3]; 4],
            depth: Some(vec![1.0; 3]),
            ..Layers::default()
        };
        let error = write_exr(Path::new("never.exr"), &layers, &Metadata::default());
        assert_eq!(
            error.unwrap_err().to_string(),
            "layer depth: 3 pixels, expected 4"
        );
    }
}
